"""A motion as a figure on a page, as a widget in a notebook, and as the picture that it leaves.

JupyterLab prefers a widget to everything else in an output, and shows "model not found" if its
kernel is gone.  So the picture is a separate output before the widget's, and a style sheet shows
the picture until the widget runs, and beside the widget in a browser that cannot draw 3-D.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable, Mapping
from functools import cache
from html import escape
from io import BytesIO
from itertools import cycle
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import se3
from ..errors import TypeMismatch
from ..model import Model
from ..robot import Robot
from ..shapes import Array, shown
from .motion import Motion, compact
from .surroundings import faces, outline, placed

if TYPE_CHECKING:
    from .widgets import Replay

VIEWER = Path(__file__).parents[1] / "data" / "viewer"

LIFT = 0.6
"""Exponent of the picture's brightness, below 1 to lighten dark parts."""

NEWTON, FORCE = 0.01, "#c77700"
"""Length of a force's arrow per newton, in [m], and its colour, as in `player.js`."""

BACK = 0.005
"""Distance by which see-through parts are set back, in [m], so that they hide no coinciding arm."""

BOARD = 0.12
"""Side of the square that represents a tag's board, as in `marks.js`, in [m]."""

GHOSTS = (0.12, 0.47, 0.82), (0.78, 0.47, 0.0), (0.16, 0.62, 0.4), (0.6, 0.36, 0.77)
SEEN_THROUGH = 0.38
"""Colours and opacity of see-through arms, as in `player.js` and `body.js`."""


def recorded_html(data: Mapping[str, Any], description: str, caption: str) -> str:
    """Make a replay from the data of `Motion.data`, for a page that includes the viewer.

    Args:
        data: The data that the viewer reads.
        description: The motion in words.
        caption: Text under the figure.

    Returns:
        HTML; see `viewer_scripts`.
    """
    return figure_html(compact(data), description, caption, str(data["alt"]))


def filled(page: str, **values: str) -> str:
    """A template of `data/replay` with its values, which are HTML, filled in."""
    text = (VIEWER.parent / "replay" / page).read_text(encoding="utf-8")
    return Template(text).substitute(values)


@cache
def viewer_scripts() -> tuple[str, ...]:
    """The scripts of viewer and robot, 1.4 MB, for a page that must be a single file."""
    return tuple((VIEWER / name).read_text(encoding="utf-8") for name in ("viewer.js", "robot.js"))


def figure_html(
    data: str,
    description: str,
    caption: str,
    alt: str,
    poster: str | None = None,
    root: str | None = None,
) -> str:
    """Make the figure for the data of a viewer.

    Args:
        data: The data that the viewer reads, as JSON.
        description: A paragraph that readers can open.
        caption: Text under the figure.
        alt: One or two sentences for readers who cannot see the figure.
        poster: Address of a picture for print, for phones before the tap and for browsers without
            WebGL.
        root: Address of the folder with the viewer's files, ending in "/"; None if the page loads
            boot.js already, or includes the viewer.
    """
    picture = f'<p class="lk-alt">{escape(alt)}</p>'
    if poster:
        picture = f'<img class="lk-poster" src="{escape(poster)}" alt="{escape(alt)}">'
    words = f"<summary>Description in words</summary><p>{escape(description)}</p>"
    more = "" if description == caption else f"<details>{words}</details>"
    boot = f'\n<script defer src="{escape(root)}boot.js"></script>' if root is not None else ""
    safe = data.replace("<", "\\u003c")  # nothing in it can end the script element
    return (
        f'<figure class="lk-embed">\n{picture}\n'
        f'<script type="application/json">{safe}</script>\n'
        f"<figcaption>{escape(caption)}{more}</figcaption>\n</figure>{boot}\n"
    )


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

    from ..tags import Intrinsics, looking_at
    from ..tags.drawing import FAR, Window, draw

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
    from ..tags.drawing import RobotVisuals

    seen = RobotVisuals([(robot, q)])
    return seen.surface([not alone or x.parent in robot.joint_names for x in seen.pieces])


def show(motion: Motion) -> Replay:
    """Make a replay to put at the end of a cell.

    Args:
        motion: The motion to show.

    Returns:
        A widget; its ``save("run.html")`` writes a page.

    Raises:
        TypeMismatch: ``motion`` is not a `Motion`.
    """
    if not isinstance(motion, Motion):
        raise TypeMismatch(
            f"motion is {shown(motion)}, expected what lk.replay.motion_of(log, title) returns"
        )
    from .widgets import Replay

    made = Replay(data=motion.to_json())
    made.words = f"{motion.title}. {motion.description}"
    made.picture = lambda: motion_still(motion)
    return made


def motion_still(motion: Motion) -> bytes:
    """Draw a motion half way, or at its largest force, as the viewer would, as a PNG file."""
    from ..tags.drawing import in_colour

    force = np.zeros((len(motion.q), 3)) if motion.force is None else motion.force
    model, size = Model(motion.robot), np.linalg.norm(force, axis=1)
    half = int(size.argmax()) if size.any() else len(size) // 2
    few = slice(None, None, max(1, len(motion.q) // 60))

    def tips_of(q: Array) -> Array:
        return np.array([model.pose(row)[:3, 3] for row in q[few]])

    tips = tips_of(motion.q)
    path = tips if motion.path is None else motion.path
    met, board = {**motion.things}, motion.board_position
    if board is not None and motion.board_rotation is not None:
        T = se3.pose(motion.board_rotation[half], board[half])
        met["tag"] = placed("tag", T) | {"size": [BOARD, BOARD]}
    others = map(tips_of, motion.ghosts.values())
    arms = [body(motion.robot, q[half], True).corners for q in motion.ghosts.values()]
    through = [(in_colour(*arm), SEEN_THROUGH) for arm in zip(arms, cycle(GHOSTS), strict=False)]
    lines = tips, path, *others, *(outline(x, tips) for x in met.values())
    seen = {"around": board, "through": through + faces(motion.things), "force": force[half]}
    return still(motion.robot, motion.q[half], *lines, **seen)
