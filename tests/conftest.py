"""Tools of all tests: repeatable runs of hypothesis, states drawn from a seed, a browser."""

from collections import Counter
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

SOAK = {"soak", "study", "test_build.py", "test_live_pages.py", "test_reading.py", "test_search.py"}
"""Folders and files of tests that the gate leaves out, but for the files and tests of `GATE`."""
GATE = {"test_controllers.py", "test_a_mouse_pulls_the_hand_and_lets_it_go",
        "test_a_page_is_run_again_if_what_computes_it_has_changed"}  # fmt: skip
FIRST = "test_pages_of_the_contents_exist"


def pytest_addoption(parser):
    """An option that writes the golden file of messages again."""
    parser.addoption("--golden", action="store_true", help="write what messages say again")


def pytest_terminal_summary(terminalreporter):
    """Say how long each folder of tests took, over all workers."""
    took = Counter()
    for report in (x for found in terminalreporter.stats.values() for x in found):
        if hasattr(report, "duration"):
            took["/".join(report.nodeid.partition("::")[0].split("/")[:-1][:2])] += report.duration
    for folder, seconds in took.most_common(12):
        terminalreporter.write_line(f"{folder}: {seconds:.0f} s")


def _turn(item):
    """The order of a test: one worker builds the book first; other tests of the book come last."""
    return ("book" in item.fixturenames) * (1 if item.name != FIRST else -1)


def pytest_collection_modifyitems(items):
    """Mark what only `make soak` runs; one worker builds the book first, its readers come last."""
    for item in items:
        if set(item.path.parts) & SOAK and not {item.path.name, item.originalname} & GATE:
            item.add_marker(pytest.mark.soak)
    items.sort(key=_turn)


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
