"""Debian's Chromium for every test that needs a browser."""

from pathlib import Path

import pytest

CHROMIUM = "/usr/bin/chromium"
ARGUMENTS = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]  # fmt: skip


@pytest.fixture(scope="session")
def playwright():
    """Playwright's driver."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        yield driver


@pytest.fixture(scope="session")
def chromium(playwright):
    """Debian's Chromium, with WebGL in software."""
    assert Path(CHROMIUM).exists(), "Chromium is missing: apt-get install chromium"
    flags = [*ARGUMENTS, "--enable-unsafe-swiftshader"]
    browser = playwright.chromium.launch(executable_path=CHROMIUM, args=flags)
    yield browser
    browser.close()


@pytest.fixture(scope="session")
def blind_chromium(playwright):
    """The same without WebGL."""
    flags = [*ARGUMENTS, "--disable-3d-apis"]
    browser = playwright.chromium.launch(executable_path=CHROMIUM, args=flags)
    yield browser
    browser.close()


@pytest.fixture(scope="session")
def open_chromium(playwright):
    """A Chromium in which axe-core may read the style sheets of a page from the disk."""
    flags = [*ARGUMENTS, "--enable-unsafe-swiftshader", "--allow-file-access-from-files"]
    browser = playwright.chromium.launch(executable_path=CHROMIUM, args=flags)
    yield browser
    browser.close()
