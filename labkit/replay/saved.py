"""What stays in a saved notebook: a picture and its caption, for pages without a kernel.

JupyterLab prefers a widget to all else in an output and says "model not found" where its kernel is
gone.  So the picture is an output of its own before the widget's, and a style sheet shows one of
the two: the picture until the widget lives, and beside it in a browser that draws no 3-D.
"""

from __future__ import annotations

import base64
from collections.abc import Callable
from html import escape
from io import BytesIO
from itertools import chain, repeat
from typing import Any

import numpy as np

from ..robot import SIDES, Robot
from ..shapes import Array

LIFT = 0.6
"""Power of the picture's brightness, below 1 to lighten what is dark."""

_STYLE = """<style>
.jp-OutputArea-child:has(.lk-saved):has(+ .jp-OutputArea-child :is(.lk-player, .widget-box))\
:not(:has(+ .jp-OutputArea-child .lk-stage > .lk-note)),
.jp-OutputArea-child:has(.lk-saved) + .jp-OutputArea-child:not(:has(:is(.lk-player, .widget-box)))
{ position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }
.lk-saved { margin: 0; } .lk-saved img { max-width: 100%; border-radius: 8px; background: #e9edf2; }
body[data-jp-theme-light="false"] .lk-saved img { background: #8a95a2; }
</style>"""


class Saved:
    """A widget that leaves its picture in the notebook.

    Attributes:
        words: Caption and description.
        picture: Makes the picture, a PNG file's bytes.
    """

    words: str
    picture: Callable[[], bytes]

    def _ipython_display_(self) -> None:
        from IPython.display import display

        display(self.fallback(), raw=True)
        data, metadata = self._repr_mimebundle_()  # type: ignore[attr-defined]
        display(data, metadata=metadata, raw=True)

    def fallback(self) -> dict[str, str]:
        """The picture and its caption as an output."""
        return in_its_place(self.words, self.picture())


def in_its_place(words: str, picture: bytes | None = None) -> dict[str, str]:
    """An output that stands for the widget after it, where there is no kernel.

    Args:
        words: What is to be seen there.
        picture: A PNG file's bytes, if there is one.
    """
    told = escape(words)
    data = base64.b64encode(picture or b"").decode()
    shown = f'<img alt="{told}" src="data:image/png;base64,{data}">' if picture else ""
    page = f'<figure class="lk-saved">{shown}<figcaption>{told}</figcaption></figure>{_STYLE}'
    return {"text/plain": words, "text/html": page}


def still(robot: Robot, q: Any, *paths: Array, around: Any = None) -> bytes:
    """A picture of an arm, with paths drawn into it: a PNG file's bytes, or those of an empty one.

    Args:
        robot: Which arm; only Baxter's have a body to show.
        q: Joint angles, shape (n,) in [rad].
        *paths: Points of lines, each of shape (K, 3) in [m]: red, black, then grey ones.
        around: Further points that must be in sight, shape (K, 3) in [m].
    """
    from PIL import Image, ImageDraw

    from ..arm import Arm
    from ..tags import Camera, Intrinsics, looking_at

    width, height = 640, 400
    picture = np.full((height, width, 3), 255, dtype=np.uint8)
    with Arm(robot, q0=np.clip(q, robot.lower, robot.upper)) as arm:
        points = np.vstack([arm.tip()[0], *paths[:2], *([] if around is None else [around])])
        at = 0.5 * (points.min(0) + points.max(0))
        radius = 0.5 * float(np.linalg.norm(np.ptp(points, axis=0))) + 0.12
        away = radius / np.sin(np.radians(17.5)) * _direction(robot)
        focus = height / 2 / np.tan(np.radians(17.5))
        lens = Intrinsics(width, height, focus, focus)
        camera = Camera(arm.world, looking_at(at + away, at), lens)
        if robot.name in SIDES:
            picture = np.array(camera.image())
        T_cw = np.linalg.inv(camera.T_wc)
    ground = (picture == 255).all(axis=2)
    light = 255.0 * (picture / 255.0) ** LIFT  # a black gripper shows its shape
    whole = Image.fromarray(np.dstack([light, np.where(ground, 0.0, 255.0)]).astype(np.uint8))
    colours = chain(("#b3001b", "#1f2328"), repeat("#57606a"))
    for points, colour in reversed(list(zip(paths, colours, strict=False))):
        seen = points @ T_cw[:3, :3].T + T_cw[:3, 3]
        if (seen[:, 2] <= 0.0).any():  # a large wall that reaches behind the camera
            continue
        pixels = lens.project(seen)
        ImageDraw.Draw(whole).line(list(map(tuple, pixels.tolist())), colour, 3)
    file = BytesIO()
    whole.save(file, "PNG", optimize=True)
    return file.getvalue()


def _direction(robot: Robot) -> Array:
    """From where the viewer's first picture looks, as `rig.js` has it."""
    azimuth, up = 1.2 * (-1 if robot.name == "right" else 1), 0.5
    return np.array([np.cos(up) * np.cos(azimuth), np.cos(up) * np.sin(azimuth), np.sin(up)])
