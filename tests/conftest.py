"""Tools of all tests: repeatable runs of hypothesis, states drawn from a seed, a browser."""

from contextlib import contextmanager

import numpy as np
import pytest
from chromium import program
from hypothesis import HealthCheck, settings

import labkit as lk

settings.register_profile(
    "labkit",
    max_examples=40,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("labkit")

ARGUMENTS = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]  # fmt: skip


FIRST = "test_pages_of_the_contents_exist"


def pytest_addoption(parser):
    parser.addoption(
        "--quick", action="store_true", help="leave out what needs Chromium where it is missing"
    )


def _without_chromium(config):
    """Whether to leave out the tests that need Chromium."""
    try:
        return config.getoption("quick") and not program()
    except SystemExit:
        return True


def pytest_report_header(config):
    return ["Chromium is missing, so its tests are left out"] if _without_chromium(config) else []


def pytest_terminal_summary(terminalreporter, config):
    """Say at the end of `make quick` what it left out, so that nobody takes it for `make test`."""
    if config.getoption("quick") and config.getoption("ignore"):
        browser = ", what needs Chromium" if _without_chromium(config) else ""
        folders = ", ".join(config.getoption("ignore"))
        terminalreporter.write_line(
            f"make quick left out {folders}{browser} and all slow tests; make test runs them, "
            "and make soak what is marked soak"
        )


def _turn(item):
    """The order of a test: one worker builds the book first; other tests of the book come last."""
    return ("book" in item.fixturenames) * (1 if item.name != FIRST else -1)


def pytest_collection_modifyitems(config, items):
    """Order the tests; only `make quick` leaves out tests whose program is missing."""
    items.sort(key=_turn)
    if _without_chromium(config):
        left_out = [item for item in items if "playwright" in item.fixturenames]
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if item not in left_out]


@pytest.fixture(params=["left", "right"])
def side(request):
    """The side of each of Baxter's arms."""
    return request.param


@pytest.fixture
def model(side):
    """The model of each arm."""
    return lk.Model(side)


@pytest.fixture
def random():
    """Random numbers that are the same in every run."""
    return np.random.default_rng(2019)


@pytest.fixture
def states(random):
    """A function of a side and a count that draws joint angles within their limits, and speeds."""

    def draw(side="left", count=20):
        r = lk.robot(side)
        q = random.uniform(r.lower, r.upper, (count, 7))
        return list(zip(q, random.uniform(-r.speed, r.speed, (count, 7)), strict=True))

    return draw


@pytest.fixture
def ideal():
    """An ideal left arm at rest in its neutral pose."""
    with lk.Arm() as arm:
        yield arm


@pytest.fixture(scope="session")
def playwright():
    """Playwright's driver."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        yield driver


@contextmanager
def browser(playwright, *flags):
    """Chromium, closed at the end."""
    chromium = playwright.chromium.launch(executable_path=program(), args=[*ARGUMENTS, *flags])
    yield chromium
    chromium.close()


@pytest.fixture(scope="session")
def chromium(playwright):
    """A Chromium with WebGL in software."""
    with browser(playwright, "--enable-unsafe-swiftshader") as chromium:
        yield chromium


@pytest.fixture(scope="session")
def blind_chromium(playwright):
    """A Chromium without WebGL."""
    with browser(playwright, "--disable-3d-apis") as chromium:
        yield chromium


@pytest.fixture(scope="session")
def open_chromium(playwright):
    """A Chromium in which axe-core may read the style sheets of a page from the disk."""
    flags = ("--enable-unsafe-swiftshader", "--allow-file-access-from-files")
    with browser(playwright, *flags) as chromium:
        yield chromium
