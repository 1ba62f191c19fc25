"""Take the pictures of the live arm: `python book/_tools/make_stills.py`, after `make book`.

Chromium draws each page's panel at four times its size, with the smooth edges and the shadow of a
graphics card.  Each view is taken on black and on white, so its transparency is known exactly, and
is shrunk.  The stills are book/static/stills/NAME.webp; `index.avif` is the loop of the first page:
the same pull at an arm that yields and at one that does not; the README has one of its pictures.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from chromium import program
from PIL import Image
from playwright.sync_api import Page, sync_playwright

ROOT = Path(__file__).resolve().parents[2]
STILLS = ROOT / "book/static/stills"
WIDE, HIGH = 740, 400
SIZE: Any = {"width": 2 * WIDE, "height": 2 * HIGH}
"""Size of a picture on the page, in [px], and of its file; a still is drawn twice as large."""
SECONDS, RATE = 6, 15
"""Length of the loop in [s], and its pictures in a second."""
AFTER = 0.9
"""Time of the arm in a still, in [s]."""
CARD = """const gl = WebGL2RenderingContext.prototype, real = gl.getParameter;
gl.getParameter = function (x) { return x === 0x9246 ? "a card" : real.call(this, x); };"""
"""Makes the viewer draw as with a graphics card."""
SHEET = f"""body {{ display: flex; flex-direction: row !important; margin: 0; overflow: hidden }}
    .lk-live {{ margin: 0 !important; max-width: none !important; width: var(--wide) }}
    .lk-player, .lk-stage {{ border: 0 !important; border-radius: 0 !important; background: none }}
    .lk-beside {{ display: block !important }}
    .lk-player > :not(.lk-beside), .lk-beside > :not(:first-child), .lk-bar, .lk-ring {{ display: none !important }}
    .lk-live .lk-stage .lk-canvas {{ height: {2 * HIGH}px !important; width: var(--wide) !important;
        max-height: none !important; aspect-ratio: auto !important }}
    .lk-tag {{ font-size: 44px !important; font-weight: 600; padding: 0 14px; color: #1f2328; background: #fff;
        border: 3px solid #57606a; border-radius: 10px }}
    .lk-tag.title {{ transform: translate(24px, {2 * HIGH - 90}px) !important }}"""  # noqa: E501
"""The style sheet of the pictures: nothing but the arms and their labels, large."""
READY = "e => e.querySelector('[data-ready]') || e.querySelector('.lk-load')?.click()"
MOUNT = """async ([own, wide, sheet, configs]) => {
    const body = document.createElement("body"), { labkitLive, labkitViewer, labkitRobot } = globalThis;
    const given = JSON.parse(own.querySelector('script[type="application/json"]').textContent);
    document.body.replaceWith(body);
    document.head.append(Object.assign(document.createElement("style"), { textContent: sheet }));
    body.style.setProperty("--wide", `${wide}px`);
    globalThis.panels = [];
    for (const config of configs ?? [given]) {
        const host = Object.assign(document.createElement("div"), { className: "lk-live" });
        body.append(host);
        const panel = await labkitLive.mount(host, config, labkitViewer, labkitRobot);
        panel.picture.stage.draw = () => {};
        panel.pause(true), panel.session.restart(), panels.push(panel);
    }
}"""  # noqa: E501
"""Replaces the page by panels that stand still and are drawn only by `stage.paint`."""
PAIR = [
    {"piece": "open", "plant": "baxter", "settings": {"controller": law, "path": "stay"},
     "view": {"azimuth": 1.05, "elevation": 0.24, "distance": 2.35, "target": [0.42, 0.12, -0.05]}}
    for law in ("workspaceImpedance", "baxtersOwn")
]  # fmt: skip
"""The two arms of the loop."""
PULL = """([force, dt]) => panels.forEach((panel, k) => {
    const { session, picture } = panel, still = [0, 0, 0], size = Math.hypot(...force);
    const told = (label, text) => { label.element.textContent = text; return label.element; };
    session.hands = size ? [{ name: "hand", act: () => ({ force, damping: [still, still, still] }) }] : [];
    panel.live(dt);
    picture.moved ??= picture.stage.label("", () => panel.now.goal.map((x, i) => x - 0.21 * (i === 2)));
    picture.title ??= picture.stage.label("", () => [0.6, 0, -0.9]);
    told(picture.title, ["impedance control", "position control"][k]).classList.add("title");
    told(picture.arrows.hand.label, size < 1 ? "" : `${size.toFixed(0)} N`);
    told(picture.moved, `${(1000 * panel.now.error).toFixed(0)} mm`);
})"""  # noqa: E501
"""Pulls all arms with a force for a time, and writes its newtons and their millimetres."""
PAINT = """(ground) => panels.forEach(({ element, picture: { stage } }) => {
    element.style.setProperty("--lk-sky", ground);
    stage.scene.traverse(({ material: m }) => { if (m?.isLineMaterial) m.linewidth = 10; });
    stage.paint();
})"""


def load(page: Page, address: str, k: int, configs: list[dict[str, Any]] | None = None) -> None:
    """Show nothing but the pictures of these panels, or of panel k of the page, from 0."""
    page.goto(address)
    own = page.locator(".lk-live").nth(k).element_handle()
    page.wait_for_function(READY, arg=own)
    page.evaluate(MOUNT, [own, 2 * WIDE / len(configs or "1"), SHEET, configs])


def taken(page: Page) -> Image.Image:
    """The picture that the page shows, with its transparency, at twice its size on a page."""
    black, white = (on(page, ground) for ground in ("#000", "#fff"))
    alpha = 1 - np.clip(white - black, 0, 1).mean(axis=-1, keepdims=True)
    colour = np.clip(black / np.maximum(alpha, 1 / 255), 0, 1)
    both = np.round(255 * np.concatenate([colour, alpha], axis=-1)).astype(np.uint8)
    return Image.fromarray(both, "RGBA").reduce(both.shape[0] // SIZE["height"])


def on(page: Page, ground: str) -> np.ndarray:
    """The page on a ground, (rows, columns, 3) from 0 to 1."""
    page.evaluate(PAINT, ground)
    return np.asarray(Image.open(io.BytesIO(page.screenshot(timeout=0))).convert("RGB")) / 255


def force(t: float) -> list[float]:
    """The pull of the loop at a time in [s], in [N]: it grows, turns a little, and lets go."""
    size = np.interp(t, [0.5, 1.5, 3.6, 3.8], [0, 30, 30, 0])
    turn = np.interp(t, [1.5, 3.6], [0, 0.9])
    return list(size * np.array([np.cos(turn), -np.sin(turn), 0.35 - 0.2 * turn]))


def loop(page: Page, address: str) -> Iterator[Image.Image]:
    """The pictures of the loop, from the middle of the pull, which the first one shows."""
    load(page, address, 0, PAIR)
    before = (SECONDS + 3) * RATE
    for k in range(before + SECONDS * RATE):
        page.evaluate(PULL, [force(k / RATE % SECONDS), 1 / RATE])
        if k >= before:
            yield taken(page)


def main() -> None:
    """Take the still of each live panel, and the loop of the first page."""
    with sync_playwright() as playwright:
        flags = ["--no-sandbox", "--enable-unsafe-swiftshader"]
        browser = playwright.chromium.launch(executable_path=program(), args=flags)
        for file in sorted((ROOT / "book/_build/html").rglob("*.html")):
            found = re.findall(r"/stills/(\w+)\.webp", file.read_text())
            for k, name in enumerate(found):
                page = browser.new_page(viewport=SIZE, device_scale_factor=2 - (name == "index"))
                page.add_init_script(CARD)
                page.set_default_timeout(600_000)  # only so that nothing waits for ever
                photograph(page, file.as_uri(), k, STILLS / f"{name}.webp")


def photograph(page: Page, address: str, k: int, to: Path) -> None:
    """Take the still of panel k of a page, and on the first page the loop."""
    if to.stem == "index":
        moving = [*loop(page, address)]
        still = moving[0]
        moving[0].save(to.with_suffix(".avif"), save_all=True, append_images=moving[1:],
                       duration=1000 // RATE, quality=50, speed=3)  # fmt: skip
        shown = Image.alpha_composite(Image.new("RGBA", still.size, "#f8f7f4"), still).reduce(2)
        shown.convert("RGB").quantize(256, kmeans=1).save(STILLS.parent / "baxter.png")
    else:
        load(page, address, k)
        page.evaluate("dt => panels[0].live(dt)", AFTER)
        still = taken(page)
    still.save(to, quality=80, method=6)


if __name__ == "__main__":
    main()
