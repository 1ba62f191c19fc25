"""The speed of the book's live arm in a headless Chromium."""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "tests"))
BOOK = ROOT / "book/_build/html"
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
SPEED = """async () => {
    const panel = document.querySelector('.lk-live').live;
    panel.pause(true);
    const session = new labkitLive.Session(panel.mujoco, panel.settings);
    session.advance(2);
    const began = performance.now();
    session.advance(5);
    const factor = 5000 / (performance.now() - began);
    session.close();
    panel.host.dataset.rerun = '';
    panel.curves.last && panel.recompute();
    while (!panel.host.dataset.rerun) await new Promise((r) => setTimeout(r, 5));
    return [factor, +panel.host.dataset.rerun];
}"""


def measure():
    """Milliseconds from click to motion and from dial to curve, real-time factor, sizes in MB.

    These are the best of three visits, or None if the book has not been built.
    """
    from live_reference import LAWS, apart

    runs = [
        {"plant": plant, "controller": law, "task": task, "duration": 5.0}
        for plant in ("ideal", "baxter")
        for law in LAWS
        for task in ("line", "circle")
    ]
    found = {"live_vs_python_rad": max(apart(runs))}
    if not (BOOK / "live.html").exists():
        names = ("first_motion_ms", "rtf", "rerun_ms", "requests")
        return found | {f"live_{name}": None for name in names}
    size = sum(p.stat().st_size for p in BOOK.rglob("*") if p.is_file())
    zipped = ROOT / "dist/book.zip"
    sizes = {
        "book_mb": size / 1e6,
        "book_zip_mb": zipped.stat().st_size / 1e6 if zipped.exists() else None,
    }
    return found | visits() | sizes


def visits(times=3):
    """The times that a reader waits on the live page."""
    from chromium import program
    from playwright.sync_api import sync_playwright

    first, outside, speeds = [], [], []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program(), args=FLAGS)
        for _ in range(times):
            page = browser.new_page()
            page.on(
                "request",
                lambda r: (
                    None if r.url.startswith(("file:", "data:", "blob:")) else outside.append(r.url)
                ),
            )
            page.goto((BOOK / "live.html").as_uri())
            page.click(".lk-live .lk-load")
            first.append(
                int(
                    page.wait_for_selector("[data-first-motion]", timeout=120_000).get_attribute(
                        "data-first-motion"
                    )
                )
            )
            page.wait_for_function(
                "document.querySelector('.lk-live').live.curves.last", timeout=120_000
            )
            speeds.append(page.evaluate(SPEED))
            page.close()
        browser.close()
    return {
        "live_first_motion_ms": min(first),
        "live_rtf": max(speed for speed, _ in speeds),
        "live_rerun_ms": min(rerun for _, rerun in speeds),
        "live_requests": len(outside),
    }
