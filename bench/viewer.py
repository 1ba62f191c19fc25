"""How soon a reader of the book can watch a motion, in a headless Chromium."""

import shutil
import tempfile
from pathlib import Path

import labkit as lk
from labkit.replay import Motion, motion_html, shared_files

TIMES = 5
CHROMIUM = ("chromium", "chromium-browser", "google-chrome")


def motion():
    """A turn of the shoulder, as a run gives it."""
    with lk.Arm() as arm:
        q = arm.robot.neutral
        goal = q + [0.5, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0]
        log = lk.run(
            arm,
            lk.Trajectory(lk.Line(q, goal), lk.Quintic(5.0)),
            lambda s, x: lk.JointPosition(x.position),
        )
    return Motion(side="left", t=log.t, q=log.q, title="Turn", label="position mode")


def page(folder):
    """A page of its own with one motion, written into ``folder``."""
    for name, path in shared_files().items():
        shutil.copy(path, folder / name)
    file = folder / "motion.html"
    file.write_text(f"<!doctype html><meta charset=utf-8><body>{motion_html(motion(), root='')}")
    return file


def measure():
    """Milliseconds from opening a page until its motion can be played, the best of several."""
    from playwright.sync_api import sync_playwright

    program = next(filter(None, map(shutil.which, CHROMIUM)), None)
    if program is None:
        raise RuntimeError("chromium is missing: apt-get install chromium")
    flags = [
        "--no-sandbox",
        "--use-gl=angle",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
    ]
    times = []
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        url = page(Path(folder)).as_uri()
        browser = playwright.chromium.launch(executable_path=program, args=flags)
        for _ in range(TIMES):
            tab = browser.new_page()
            tab.goto(url)
            tab.wait_for_selector("[data-ready]")
            times.append(tab.evaluate("performance.now()"))
            tab.close()
        browser.close()
    return {"motion_ready_ms": min(times)}


if __name__ == "__main__":
    print(measure())
