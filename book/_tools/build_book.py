"""Build the book: `python book/_tools/build_book.py`, or `make book`.

This makes what the pages need (viewer, notation, the students' notebooks), runs the pages whose
kept runs in book/runs are stale, and then Jupyter Book with warnings as errors.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import yaml
from book_outputs import pack
from book_pages import BOOK, CACHE, HTML, ROOT, computed
from book_runs import PATHS, fill
from jupyter_cache import get_cache
from jupyter_cache.base import CacheBundleIn
from nbclient.exceptions import CellExecutionError
from nbformat import NotebookNode

MADE = BOOK / "generated"
SAMPLED = ROOT / "build/book-sample"
SAMPLE = (
    "index", "live", "instructor_guide", "chapters/torque", "reference",
    "generated/notebooks/03_velocity_control",
)  # fmt: skip
"""A page of each kind, for the gate; the first one is the root."""
UNASKED = ("**/*.map", "_static/**/*fontawesome*", "_static/locales")
"""Files of the themes that no page of this book asks for."""


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sample", action="store_true", help="build a page of each kind alone")
    parser.add_argument(
        "--publish", action="store_true", help="keep the runs in book/runs; also make dist/book.zip"
    )
    chosen = parser.parse_args(arguments)
    began = time.monotonic()
    prepare()
    pages = {k: x for k, x in computed().items() if not chosen.sample or k in SAMPLE}
    try:
        keys = fill(pages, _progress, keep=chosen.publish)
    except CellExecutionError as error:
        print(f"The book was not built, because a page failed.\n{error}", file=sys.stderr)
        return 1
    _hand_over(pages)
    if code := build(keys, SAMPLE if chosen.sample else ()):
        return code
    if chosen.sample:
        return 0
    size = sum(p.stat().st_size for p in HTML.rglob("*") if p.is_file()) / 1e6
    took = time.monotonic() - began
    print(f"book/_build/html/index.html ({size:.1f} MB, {took:.0f} s): double-click to open it")
    if chosen.publish:
        made = pack()
        print(f"{made.relative_to(ROOT)} ({made.stat().st_size / 1e6:.1f} MB): to hand out")
    return 0


def prepare() -> None:
    """Make the files that are not in the repository: viewer, notation, notebooks."""
    from figures.embed import shared_files

    for name, path in shared_files().items():
        _copy(path, BOOK / "static/viewer" / name)
    _live(BOOK / "live/bundle", BOOK / "static/live")
    _write(MADE / "parts/symbols.md", _symbols())
    _notebooks(MADE / "notebooks")


def _live(bundle: Path, folder: Path) -> None:
    """Write the live arm's scripts; MuJoCo's WebAssembly becomes one, for pages on file://."""
    for path in bundle.iterdir():
        if path.suffix != ".gz":
            _copy(path, folder / path.name)
    packed = base64.b64encode((bundle / "mujoco.wasm.gz").read_bytes()).decode()
    _write(folder / "mujoco-wasm.js", f'globalThis.labkitMuJoCoPacked="{packed}";\n')


def _symbols() -> str:
    """Return the table of symbols in Markdown."""
    from figures.notation import ERRORS, SYMBOLS

    rows = ["| In code | In formulas | Meaning | Shape | Unit |", "|---|---|---|---|---|"]
    for s in (*SYMBOLS, *ERRORS):
        meaning = re.sub(r"\b([TRp]_\w+)", r"`\1`", s.meaning)
        unit = s.unit.replace("^2", "²").replace(" ", "\N{NO-BREAK SPACE}")
        rows.append(f"| `{s.code}` | ${s.latex}$ | {meaning} | {s.shape} | {unit} |")
    return "\n".join(rows) + "\n"


def _notebooks(folder: Path) -> None:
    """Write all students' notebooks in assignments/ as pages and as downloads."""
    import nbformat

    found = sorted((ROOT / "assignments").glob("*/*.ipynb"))
    lines = [
        "# The notebooks",
        "",
        "Each notebook is shown here as students receive it, before any answer is written. "
        "Download it, or open it from the repository with `make lab`. The files are also in the "
        "folder `_static/notebooks` of this book.",
        "",
    ]
    for path in found:
        notebook = nbformat.read(path, as_version=4)
        title = _title(notebook, path.stem)
        page = _readable(notebook, f"{_download(path, 'Download this notebook')}, {path.name}.")
        _write(folder / path.name, nbformat.writes(page))
        _copy(path, BOOK / "static/notebooks" / path.name)
        lines.append(f"- [{title}](notebooks/{path.name}), {_download(path, 'download')}")
    if not found:
        lines.append("No notebook has been released into `assignments/` yet.")
    _write(MADE / "notebooks.md", "\n".join(lines) + "\n")
    names = {p.name for p in found}
    for old in [*folder.glob("*.ipynb"), *(BOOK / "static/notebooks").glob("*.ipynb")]:
        if old.name not in names:
            old.unlink()


def _download(path: Path, text: str) -> str:
    """A link that saves a file, even if the page was opened from disk.

    From disk, a browser would show the file instead of saving it, so the link contains its data.
    """
    data = base64.b64encode(path.read_bytes()).decode()
    return (
        f'<a href="data:application/x-ipynb+json;base64,{data}" download="{path.name}">{text}</a>'
    )


def _readable(notebook: dict, note: str) -> dict:
    """A copy for readers, which shows the code, is not run, and has a note below its title."""
    from nbformat.v4 import new_markdown_cell

    notebook["cells"].insert(1, new_markdown_cell(note, id="note"))
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            cell["outputs"], cell["execution_count"] = [], None
    notebook["metadata"]["mystnb"] = {"remove_code_source": False}
    return notebook


def _title(notebook: dict, stem: str) -> str:
    texts = (cell["source"] for cell in notebook["cells"] if cell["cell_type"] == "markdown")
    headings = (re.search(r"^# (.+)", text, re.M) for text in texts)
    return next((found[1].strip() for found in headings if found), stem)


def _hand_over(pages: Mapping[str, NotebookNode]) -> None:
    """Put the pages with their outputs where Jupyter Book looks before it runs a page."""
    shutil.rmtree(CACHE / "pages", ignore_errors=True)
    cache = get_cache(str(CACHE / "pages"))
    for name, page in pages.items():
        cache.cache_notebook_bundle(CacheBundleIn(page, name), check_validity=False)


def build(keys: Mapping[str, str], sample: Sequence[str] = ()) -> int:
    """Run Jupyter Book; a warning in the whole book is an error.

    Args:
        keys: The hash of what computes each page; if one differs, all pages are written anew.
        sample: The pages to build, in a folder of their own; by default all.
    """
    html = SAMPLED / "_build/html" if sample else HTML
    stamp, state = html.parent / "built.json", {"keys": keys, "by": _builder()}
    fresh = not stamp.exists() or json.loads(stamp.read_text()) != state
    stamp.unlink(missing_ok=True)
    run = "from jupyter_book.cli.main import main; main()"
    command = [sys.executable, "-c", run, "build", str(BOOK)]
    if sample:
        pages = [{"file": name} for name in sample[1:]]
        toc = {"format": "jb-book", "root": sample[0], "chapters": pages}
        _write(SAMPLED / "toc.yml", yaml.safe_dump(toc))
        command += ["--toc", str(SAMPLED / "toc.yml"), "--path-output", str(SAMPLED)]
    else:
        command += ["-W", "--keep-going"]
    environment = os.environ | {
        "PYTHONPATH": PATHS,
        "LAB_BOOK_CACHE": str(CACHE / "pages"),
        "PYDEVD_DISABLE_FILE_VALIDATION": "1",
    }
    if fresh:
        shutil.rmtree(html, ignore_errors=True)
        command.append("--all")
    with subprocess.Popen(
        command, env=environment, cwd=ROOT, text=True, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    ) as process:  # fmt: skip
        assert process.stdout
        log = list(_shown(process.stdout))
    (CACHE / "build.log").write_text("\n".join(log) + "\n")
    if process.returncode:
        print("The book was not built; the log is in build/book/build.log.", file=sys.stderr)
        for line in log:
            if re.search(r"WARNING:|ERROR|Error|Exception|ConclusionFails", line):
                print(f"  {line}", file=sys.stderr)
        return process.returncode
    for path in (BOOK / "static").rglob("*"):  # Sphinx does not copy these if no page has changed
        if path.is_file():
            _copy(path, html / "_static" / path.relative_to(BOOK / "static"))
    for unasked in UNASKED:
        for path in html.glob(unasked):
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    _without_unused_rules(html)
    stamp.write_text(json.dumps(state))
    return 0


def _without_unused_rules(html: Path) -> None:
    """Remove the rules of the themes' styles for classes that no page and no script names.

    A script composes the names that begin with `bs-`.
    """
    files = (path for kind in ("html", "js") for path in html.rglob(f"*.{kind}"))
    named = {name for path in files for name in re.findall(r"[\w-]+", path.read_text("utf-8"))}

    def used(rule: re.Match[str]) -> str:
        chosen = re.sub(r"/\*.*?\*/", "", rule[1], flags=re.S).split(",")
        shown = (set(re.findall(r"\.(?!bs-)(-?[a-zA-Z_][\w-]*)", one)) <= named for one in chosen)
        return rule[0] if any(shown) else ""

    for path in html.glob("_static/**/*.css"):
        rules = re.sub(r"([^{}]+)\{[^{}]*\}", used, path.read_text("utf-8"))
        path.write_text(re.sub(r"@media[^{}]*\{\s*\}", "", rules), "utf-8")


def _builder() -> str:
    """A hash of the book's own extension, which Sphinx does not watch."""
    files = sorted((BOOK / "_ext").glob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()[:16]


def _shown(lines: Iterator[str]) -> Iterator[str]:
    """Pass on the lines of a log, and show the progress."""
    for raw in lines:
        line = re.sub(r"\x1b\[[0-9;]*m", "", raw.rstrip()).rsplit("\r", 1)[-1]
        yield line
        if re.match(r"(reading|writing|executing)|.*Executing notebook", line, re.I):
            _progress(re.sub(r".*?(Executing notebook using)\s*.*", "executing a page", line)[:100])
    if sys.stdout.isatty():
        print("\r\x1b[K", end="")


def _progress(text: str, *, every: bool = True) -> None:
    """Show progress in one line that is rewritten; without a terminal, print a line at times."""
    if sys.stdout.isatty():
        print(f"\r\x1b[K{text}", end="", flush=True)
    elif every:
        print(text, flush=True)


def _copy(source: Path, target: Path) -> None:
    """Copy only the files that differ, so that unchanged pages are not built again."""
    if not target.exists() or target.read_bytes() != source.read_bytes():
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)


def _write(path: Path, text: str) -> None:
    if not path.exists() or path.read_text() != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


if __name__ == "__main__":
    sys.exit(main())
