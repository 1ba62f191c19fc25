"""The picture and caption that remain in a saved notebook, for pages without a kernel.

JupyterLab prefers a widget to everything else in an output, and shows "model not found" if its
kernel is gone.  So the picture is a separate output before the widget's, and a style sheet shows
the picture until the widget runs, and beside the widget in a browser that cannot draw 3-D.
"""

from __future__ import annotations

import base64
from collections.abc import Callable, Iterable
from html import escape
from io import BytesIO
from typing import Any

import numpy as np

from ..robot import Robot
from ..shapes import Array
from .figure import filled

LIFT = 0.6
"""Exponent of the picture's brightness, below 1 to lighten dark parts."""

NEWTON, FORCE = 0.01, "#c77700"
"""Length of a force's arrow per newton, in [m], and its colour, as in `player.js`."""

BACK = 0.005
"""Distance by which see-through parts are set back, in [m], so that they hide no coinciding arm."""


class Saved:
    """A widget that leaves its picture in the notebook.

    Attributes:
        words: Caption and description.
        picture: Function that returns the picture as the bytes of a PNG file.
    """

    words: str
    picture: Callable[[], bytes]

    def _ipython_display_(self) -> None:
        from IPython.display import display

        display(self.fallback(), raw=True)
        data, metadata = self._repr_mimebundle_()  # type: ignore[attr-defined]
        display(data, metadata=metadata, raw=True)

    def fallback(self) -> dict[str, str]:
        """The picture and its caption as a notebook output."""
        return in_its_place(self.words, self.picture())


def in_its_place(words: str, picture: bytes | None = None) -> dict[str, str]:
    """Make an output that replaces the widget after it if there is no kernel.

    Args:
        words: What the widget shows.
        picture: The bytes of a PNG file, if there is a picture.
    """
    told = escape(words)
    data = base64.b64encode(picture or b"").decode()
    shown = f'<img alt="{told}" src="data:image/png;base64,{data}">' if picture else ""
    return {"text/plain": words, "text/html": filled("still.html", shown=shown, told=told)}


def still(
    robot: Robot,
    q: Any,
    *paths: Array,
    around: Any = None,
    alone: bool = False,
    through: Iterable[tuple[Any, float]] = (),
    force: Any = (0.0, 0.0, 0.0),
) -> bytes:
    """Draw an arm and its surroundings, as the bytes of a PNG file.

    Args:
        robot: The arm.
        q: Joint angles, shape (n,) in [rad].
        *paths: Points of lines, each of shape (K, 3) in [m]: red, black, then grey ones.
        around: Further points that must be in view, shape (K, 3) in [m].
        alone: Leave out body, head and the other arm.
        through: See-through surfaces, each with its opacity from 0 to 1.
        force: Force on the tip, shape (3,) in [N].
    """
    from PIL import Image, ImageDraw

    from ..model import Model
    from ..tags import Intrinsics, looking_at
    from ..tags.rendering import FAR, Window, draw

    tip = Model(robot).pose(q)[:3, 3]
    points = np.vstack([tip, *paths[:2], *([] if around is None else [around])])
    at = 0.5 * (points.min(0) + points.max(0))
    radius = 0.5 * float(np.linalg.norm(np.ptp(points, axis=0))) + 0.12
    along = np.array([0.318, -0.818 if robot.name == "right" else 0.818, 0.479])  # as in `rig.js`
    T_wc = looking_at(at + radius / np.sin(np.radians(17.5)) * along, at)
    lens = Intrinsics(640, 400, *[200.0 / np.tan(np.radians(17.5))] * 2)

    def layer(surface: Any, before: Any, opacity: float) -> tuple[Any, Any]:
        colours, depth = draw(surface, lens, T_wc, Window(0, 0, lens.width, lens.height))
        seen = np.where((depth < before - BACK) & (depth < 0.99 * FAR), opacity, 0.0)
        return Image.fromarray((255.0 * np.dstack([colours, seen])).astype(np.uint8)), depth

    solid = body(robot, q, alone)
    whole, depth = layer(solid._replace(colours=solid.colours**LIFT), FAR, 1.0)
    for surface, opacity in through:
        whole.alpha_composite(layer(surface, depth, opacity)[0])
    colours = ["#b3001b", "#1f2328", *["#57606a"] * len(paths)]
    lines = [*zip(paths, colours, strict=False)][::-1]
    if (size := float(np.linalg.norm(force))) > 0.05:
        lines.append((np.array([tip, tip + NEWTON * np.asarray(force)]), FORCE))
    paint, T_cw = ImageDraw.Draw(whole), np.linalg.inv(T_wc)
    for points, colour in lines:
        seen = points @ T_cw[:3, :3].T + T_cw[:3, 3]
        if (seen[:, 2] > 0.0).all():  # leaves out a large wall that reaches behind the camera
            pixels = lens.project(seen)
            paint.line([*map(tuple, pixels.tolist())], colour, 3)
            if colour == FORCE:
                right, down = pixels[1] - pixels[0]
                turn = np.degrees(np.arctan2(-right, -down))
                paint.regular_polygon((*pixels[1], 9), 3, turn, FORCE)
                paint.text((*(pixels[1] + [12, -9]),), f"{size:.1f} N", FORCE, font_size=18)
    file = BytesIO()
    whole.save(file, "PNG", optimize=True)
    return file.getvalue()


def body(robot: Robot, q: Array, alone: bool) -> Any:
    """The surface of a robot whose arm is at q, shape (n,) in [rad], or of this arm alone."""
    from ..tags.visuals import RobotVisuals

    seen = RobotVisuals([(robot, q)])
    return seen.surface([not alone or x.parent in robot.joint_names for x in seen.pieces])
