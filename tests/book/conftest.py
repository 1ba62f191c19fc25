"""The built book, made once for the whole session, and pages of it as a reader opens them."""

import fcntl
import subprocess
import sys
from pathlib import Path

import pytest
from weigh import listen, outside

ROOT = Path(__file__).parents[2]
HTML, SAMPLED = ROOT / "book/_build/html", ROOT / "build/book-sample/_build/html"
sys.path[:0] = [str(ROOT / "book/_ext")]
ABORTED = "net::ERR_ABORTED"
"""The errors of a request whose page was left; a request for a missing file has another error."""
BUILD = [sys.executable, str(ROOT / "book/_tools/build_book.py")]


@pytest.fixture(scope="session")
def book(testrun_uid, pytestconfig):
    """The folder of the book, which the first worker builds while a second one waits.

    The gate builds a page of each kind, `make soak` all of them.
    """
    whole = pytestconfig.option.markexpr != "not soak"
    lock = ROOT / "build/book.lock"
    lock.parent.mkdir(exist_ok=True)
    with lock.open("a+") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        file.seek(0)
        if file.read() != testrun_uid:
            command = BUILD if whole else [*BUILD, "--sample"]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-6000:]
            file.truncate(0)
            file.write(testrun_uid)
    return HTML if whole else SAMPLED


@pytest.fixture
def visit(book, chromium):
    """Open a page of the book; assert at the end that it made no request and no complaint."""
    seen, pages = [], []

    def go(name, *, phone=False, browser=chromium, **options):
        size = {"width": 390, "height": 844} if phone else {"width": 1280, "height": 900}
        context = browser.new_context(viewport=size, **options)
        page = context.new_page()
        page.set_default_timeout(120_000)  # only so that no test hangs
        page.on("console", lambda m: m.type == "error" and seen.append(m.text))
        page.on("pageerror", lambda e: seen.append(str(e)))
        page.on("requestfailed", lambda r: r.failure == ABORTED or seen.append(f"missing: {r.url}"))
        page.asked = listen(page)
        pages.append(page)
        name, _, place = name.partition("#")
        page.goto((book / name).as_uri() + (f"#{place}" if place else ""))
        return page

    yield go
    for page in pages:
        page.context.close()
        seen += outside(page.asked)
    assert seen == []
