"""Make the landing page's film from pages of the built book: `make film`.

Chromium opens the pages, loads the live arm and uses it, and screenshots are taken.  The program
writes book/static/film.mp4 and its poster; the scenes, their durations and their captions are in
`figures/film.py`.
"""

from __future__ import annotations

import argparse
import io
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import imageio.v2 as imageio
import numpy as np
from chromium import program
from PIL import Image
from playwright.sync_api import Page, sync_playwright

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "book")]

from figures.film import FILM, POSTER, SCENES  # noqa: E402

RATE = 10
"""Frames per second."""
STEP = 4
"""Number of frames that show the same picture in moving scenes; fewer are smoother but slower."""
SIZE = {"width": 800, "height": 608}
COARSE = 30
"""How much detail H.264 may lose: at 18 the loss is invisible, 51 is the worst quality."""
POSTED = 55
"""The number of the frame that becomes the poster."""
LIVE = "document.querySelector('.lk-live').live"
TIP = (
    "() => { const { picture } = " + LIVE + ", { stage } = picture;"
    " stage.rig.frame(stage.canvas.clientWidth / stage.canvas.clientHeight);"
    " const box = stage.canvas.getBoundingClientRect();"
    " const p = stage.camera.position.clone().fromArray(picture.tip.p).project(stage.camera);"
    " return [box.left + (p.x + 1) * box.width / 2, box.top + (1 - p.y) * box.height / 2]; }"
)
"""JavaScript that returns the tip's position in the window, in [px]."""
DRESS = """() => {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(`.bd-header, .bd-header-article, .header-article { display: none !important }
        #lab-pointer { position: fixed; pointer-events: none; z-index: 99;
            width: 22px; height: 22px; margin: -11px;
            border-radius: 50%; border: 3px solid #b3001b; background: #b3001b44; left: -99px }`);
    document.adoptedStyleSheets = [...document.adoptedStyleSheets, sheet];
    const pointer = Object.assign(document.createElement("div"), { id: "lab-pointer" });
    document.body.append(pointer);
    addEventListener("pointermove", (e) => Object.assign(pointer.style,
        { left: `${e.clientX}px`, top: `${e.clientY}px` }), true);
}"""
"""JavaScript that hides the bars of the page and draws the mouse, which screenshots leave out."""
STILLS = {
    "stub": '[aria-label="A student\'s answer"]',
    "feedback": "img[src*=feedback]",
    "table": "#what-is-compared",
    "notebooks": "#the-notebooks",
}
"""The parts of the first page in the scenes without motion: an answer, feedback, tables."""

Scene = Callable[[Page, str], Iterator[int]]
"""Prepares the page for each picture in turn, and yields the number of frames that show it."""


def pull(page: Page, book: str) -> Iterator[int]:
    """Pull the hand from its circle and let go of it; the arm's time goes on between pictures."""
    load_live(page, book)
    for k in range(0, RATE * SCENES["pull"][0], STEP):
        if k == 28:
            at = page.evaluate(TIP)
            page.mouse.move(*at)
            page.mouse.down()
        if 28 < k <= 48:
            page.mouse.move(at[0] + 5 * (k - 28), at[1] + 1.5 * (k - 28))
        if k == 76:
            page.mouse.up()
        page.evaluate(f"{LIVE}.pause(true), {LIVE}.live({STEP} / {RATE})")  # after the mouse
        yield STEP


def gain(page: Page, book: str) -> Iterator[int]:
    """Set four gains, one after the other."""
    load_live(page, book)
    page.get_by_label("Arm", exact=True).select_option("realistic arm")
    page.get_by_label("Controller", exact=True).select_option("joint velocity")
    field = page.get_by_label("Kp, typed").first
    for value in (1, 3, 8, 14):
        before = page.evaluate(f"{LIVE}.said.textContent")
        field.fill(str(value))
        field.press("Enter")
        page.wait_for_function(f"before => {LIVE}.said.textContent !== before", arg=before)
        show(page, "fieldset:has(.lk-dials) >> nth=0")
        yield RATE * SCENES["gain"][0] // 4


def still(page: Page, book: str, name: str) -> Iterator[int]:
    """Show a part of the first page during the whole scene."""
    visit(page, f"{book}/index.html", STILLS[name])
    yield RATE * SCENES[name][0]


DRAWN: dict[str, Scene] = {
    "pull": pull,
    "gain": gain,
    **{name: partial(still, name=name) for name in STILLS},
}


def load_live(page: Page, book: str) -> None:
    """Load the live arm and pause it, because the film decides when its time passes."""
    visit(page, f"{book}/live.html", ".lk-live")
    page.locator(".lk-live .lk-load").first.click()
    page.wait_for_selector(".lk-live [data-ready]")
    page.evaluate(f"{LIVE}.pause(true)")
    show(page, ".lk-live")


def visit(page: Page, address: str, selector: str) -> None:
    """Open a page without its bars at an element, and wait until it has been drawn."""
    page.goto(address)
    page.evaluate(DRESS)
    show(page, selector)
    page.wait_for_timeout(1000)


def show(page: Page, selector: str) -> None:
    """Bring an element to the top of the window."""
    page.locator(selector).last.evaluate(
        "e => scrollTo({ top: scrollY + e.getBoundingClientRect().top - 16, behavior: 'instant' })"
    )


def photograph(page: Page) -> Any:
    """A screenshot of the window as an array."""
    return np.asarray(Image.open(io.BytesIO(page.screenshot(timeout=0))).convert("RGB"))


def main() -> None:
    """Take every scene, then write the film and its poster."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--book", type=Path, default=ROOT / "book/_build/html")
    parser.add_argument("--only", choices=DRAWN, help="make only this scene, to look at it")
    parser.add_argument("--to", type=Path, default=FILM)
    chosen = parser.parse_args()
    if not (chosen.book / "index.html").exists():
        raise SystemExit(f"{chosen.book} has no index.html; build the book first with `make book`")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=program(),
            args=["--no-sandbox", "--enable-unsafe-swiftshader"],
        )
        page = browser.new_page(viewport=SIZE, color_scheme="light")
        page.set_default_timeout(600_000)  # only so that nothing waits for ever
        with imageio.get_writer(
            chosen.to, fps=RATE, codec="libx264", quality=None,
            ffmpeg_params=["-crf", str(COARSE), "-preset", "slow", "-movflags", "+faststart"],
        ) as writer:  # fmt: skip
            for name in [chosen.only] if chosen.only else SCENES:
                shown = 0
                for stays in DRAWN[name](page, chosen.book.as_uri()):
                    picture = photograph(page)
                    for _ in range(stays):
                        writer.append_data(picture)
                    if name == "pull" and shown < POSTED <= shown + stays:
                        poster = chosen.to.with_suffix(POSTER.suffix)
                        Image.fromarray(picture).save(poster, quality=60, optimize=True)
                    shown += stays
                print(f"{name}: {shown / RATE:g} s of {SCENES[name][0]}", flush=True)
        browser.close()
    print(f"{chosen.to}: {chosen.to.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
