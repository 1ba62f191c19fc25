"""The weight of each page of the built book: `python -m tests.book.weigh [FOLDER [NAME]]`.

A page is opened twice, light and dark, as a reader opens it, and left alone for two seconds. Its
time is what the main thread of its renderer has computed by then, in processor seconds of this
machine (CDP's TaskDuration in ticks of the thread), the smaller of the two. Its bytes are those of
all files that it asked for, unpacked; the live arm is loaded by a click and not among them.
The command ends with 1 if a limit is broken.
"""

import sys
from pathlib import Path
from urllib.parse import unquote, urlparse

from tests.accessibility import violations

ROOT = Path(__file__).parents[2]
LIMITS = {"kB": 1000, "kB of script": 150, "requests outside": 0, "s": 0.8, "faults": 0}
FOLDER = 18  # [MB]


def listen(page):
    """A set of the addresses that a page asks for from now on."""
    asked = set()
    page.on("request", lambda request: asked.add(request.url))
    return asked


def outside(asked):
    """The addresses that are not in the folder of the book."""
    return [address for address in asked if not address.startswith(("file:", "data:", "blob:"))]


def loaded(asked):
    """The kilobytes of these addresses, those of scripts, and how many lead outside.

    The index of the search is data, though it is written as a script.
    """
    paths = {Path(unquote(urlparse(x).path)) for x in asked if x.startswith("file:")}
    scripts = {p for p in paths if p.suffix in {".js", ".mjs"} and p.name != "searchindex.js"}
    sizes = (sum(p.stat().st_size for p in some) / 1e3 for some in (paths, scripts))
    return dict(zip(LIMITS, (*sizes, len(outside(asked))), strict=False))


def weighed(browser, path):
    """What a page loads, computes and breaks, by the names of `LIMITS`; and its faults."""
    faults, seconds = [], []
    for scheme in ("light", "dark"):
        context = browser.new_context(viewport={"width": 1280, "height": 900}, color_scheme=scheme)
        page = context.new_page()
        asked = listen(page)
        client = context.new_cdp_session(page)
        client.send("Performance.enable", {"timeDomain": "threadTicks"})
        page.goto(path.as_uri())
        page.wait_for_timeout(2000)
        told = client.send("Performance.getMetrics")["metrics"]
        seconds += [x["value"] for x in told if x["name"] == "TaskDuration"]
        found = loaded(asked)
        faults += [f"{scheme}: {fault}" for fault in violations(page)]
        context.close()
    return found | {"s": min(seconds), "faults": len(faults)}, faults


def main(folder, name):
    """Print a line for each page, and say which limits are broken."""
    from playwright.sync_api import sync_playwright

    sys.path.append(str(ROOT / "book/_tools"))
    from chromium import program

    broken = []
    with sync_playwright() as playwright:
        flags = ["--no-sandbox", "--enable-unsafe-swiftshader", "--allow-file-access-from-files"]
        browser = playwright.chromium.launch(executable_path=program(), args=flags)
        for path in sorted(folder.rglob(f"{name}.html")):
            if "_static" not in path.parts:
                found, faults = weighed(browser, path)
                page = path.relative_to(folder).as_posix()
                print(f"{page:40}", *(f"{x:.3g} {key}" for key, x in found.items()), sep="  ")
                print(end="".join(f"    {fault}\n" for fault in faults))
                broken += [f"{page}: {x:.4g} {k}" for k, x in found.items() if x > LIMITS[k]]
    size = sum(x.stat().st_size for x in folder.rglob("*") if x.is_file()) / 1e6
    broken += [f"the folder: {size:.1f} MB"] * (size > FOLDER)
    print(f"the folder: {size:.1f} MB", "Limits that are broken:", *broken or ["none"], sep="\n")
    return bool(broken)


if __name__ == "__main__":
    folder, name = [*sys.argv[1:], *(ROOT / "book/_build/html", "*")[len(sys.argv) - 1 :]]
    sys.exit(main(Path(folder).resolve(), name))
