"""Take a still picture of each live panel of the built book before any input.

Chromium loads the panel of a page and takes a screenshot.  The background of the arm becomes
transparent, because pages may be light or dark.  The program writes book/static/stills/NAME.webp,
which the directive `live-arm` shows until the panel is loaded.
"""

from __future__ import annotations

import argparse
import io
import re
from pathlib import Path

import numpy as np
from chromium import program
from PIL import Image
from playwright.sync_api import Page, sync_playwright

ROOT = Path(__file__).resolve().parents[2]
SIZE = {"width": 800, "height": 608}
STILLS = ROOT / "book/static/stills"
WIDE, HIGH = 680, 360
"""Size of a still on the page, in [px]; the picture has twice this number of pixels."""
FRAME = f""".lk-live .lk-player {{ border: 0 !important; border-radius: 0 !important }}
    .lk-live .lk-canvas {{ width: {WIDE}px !important; height: {HIGH}px !important;
        max-height: none !important; aspect-ratio: auto !important }}
    .lk-live .lk-beside {{ display: block !important }}
    .bd-header, .bd-header-article, .header-article {{ display: none !important }}"""
"""Style sheet for the picture: the canvas has a fixed size, and nothing covers it."""
AFTER = 0.9
"""Time of the arm in the picture, in [s]."""


def photograph(page: Page, address: str, k: int, to: Path) -> None:
    """Take a still of panel k, from 0, of the page at an address."""
    page.goto(address)
    panel = page.locator(".lk-live").nth(k)
    panel.locator(".lk-load").click()
    panel.locator("[data-ready]").first.wait_for()
    page.add_style_tag(content=FRAME)
    panel.evaluate("e => { e.live.pause(true); e.live.session.restart(); }")
    panel.evaluate(f"e => e.live.live({AFTER})")
    page.wait_for_timeout(1000)  # the stage is drawn again after its size has changed
    stage = panel.locator(".lk-canvas")
    seen = np.asarray(Image.open(io.BytesIO(stage.screenshot(timeout=0))).convert("RGB"))
    seen = seen[: 2 * HIGH, : 2 * WIDE]
    ground = np.where((seen == seen[9, 9]).all(axis=-1), 0, 255).astype(np.uint8)
    ground[:2] = ground[-2:] = 0  # edges between two pixels have the page's colour
    Image.fromarray(np.dstack([seen, ground])).save(to, quality=70, method=6)
    print(f"{to.relative_to(ROOT)}: {to.stat().st_size / 1000:.0f} kB", flush=True)


def main() -> None:
    """Take the still of each page that has a live panel."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--book", type=Path, default=ROOT / "book/_build/html")
    book = parser.parse_args().book
    STILLS.mkdir(exist_ok=True)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=program(), args=["--no-sandbox", "--enable-unsafe-swiftshader"]
        )
        page = browser.new_page(viewport=SIZE, color_scheme="light", device_scale_factor=2)
        page.set_default_timeout(600_000)  # only so that nothing waits for ever
        for file in sorted(book.rglob("*.html")):
            names = re.findall(r"stills/(\w+\.webp)", file.read_text(encoding="utf-8"))
            for k, name in enumerate(names):
                photograph(page, file.as_uri(), k, STILLS / name)
        browser.close()


if __name__ == "__main__":
    main()
