"""The time until a reader of the book can read and watch a motion, in a headless Chromium."""

import shutil
import tempfile
from pathlib import Path

import labkit as lk
from labkit.replay import Motion

TIMES = 5
BOOK = Path("book/_build/html/index.html")


def motion():
    """A rotation of the shoulder, as a motion of a run."""
    with lk.Arm() as arm:
        q = arm.robot.neutral
        goal = q + [0.5, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0]
        log = lk.run(
            arm,
            lk.Trajectory(lk.Line(q, goal), lk.Quintic(5.0)),
            lambda s, x: lk.JointPosition(x.position),
        )
    return Motion(robot="left", t=log.t, q=log.q, title="Turn", label="position mode")


def page(folder):
    """A page with one motion, written into ``folder``."""
    from figures.embed import motion_html, shared_files

    for name, path in shared_files().items():
        shutil.copy(path, folder / name)
    file = folder / "motion.html"
    file.write_text(f"<!doctype html><meta charset=utf-8><body>{motion_html(motion(), root='')}")
    return file


def measure():
    """Milliseconds until the book's first page is loaded and until a motion can be played.

    Both are the best of several; they are None if the book has not been built.
    """
    from chromium import program
    from playwright.sync_api import sync_playwright

    flags = [
        "--no-sandbox",
        "--use-gl=angle",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
    ]
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program(), args=flags)
        motion_ready = _best(
            browser, page(Path(folder)).as_uri(), "[data-ready]", "performance.now()"
        )
        loaded = "performance.getEntriesByType('navigation')[0].loadEventEnd"
        book = BOOK.resolve().as_uri() if BOOK.exists() else None
        page_ready = _best(browser, book, "main", loaded) if book else None
        browser.close()
    return {"motion_ready_ms": motion_ready, "page_ready_ms": page_ready}


def _best(browser, url, wanted, clock):
    times = []
    for _ in range(TIMES):
        tab = browser.new_page()
        tab.goto(url)
        tab.wait_for_selector(wanted)
        times.append(tab.evaluate(clock))
        tab.close()
    return min(times)
