"""A motion as a figure on a page, as a widget in a notebook, and as the picture that it leaves.

JupyterLab prefers a widget to everything else in an output, and shows "model not found" if its
kernel is gone.  So the picture is a separate output before the widget's, and a style sheet shows
the picture until the widget runs, and beside the widget in a browser that cannot draw 3-D.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping
from functools import cache
from html import escape
from io import BytesIO
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import TypeMismatch
from ..model import Model
from ..robot import SIDES
from ..shapes import Array, shown
from .motion import Motion, compact

if TYPE_CHECKING:
    from .widgets import Replay

VIEWER = Path(__file__).parents[1] / "data" / "viewer"
LIFT = 0.6  # exponent of the picture's brightness, below 1 to lighten dark parts
BACK = 0.005  # by which see-through parts are set back, in [m], so that they hide no coinciding arm
GHOST, SEEN_THROUGH = (0.12, 0.47, 0.82), 0.38  # colour and opacity of see-through arms
NEWTON = 0.01  # length of an arrow for 1 N, in [m], as in player.js


def figure_html(
    data: Mapping[str, Any],
    description: str,
    caption: str,
    poster: str | None = None,
    root: str | None = None,
) -> str:
    """Make the figure for the data of a viewer, such as `Motion.data`.

    Args:
        data: The data that the viewer reads, with an ``alt`` for readers who cannot see the figure.
        description: A paragraph that readers can open.
        caption: Text under the figure.
        poster: Address of a picture for print, for phones before the tap and for browsers without
            WebGL.
        root: Address of the folder with the viewer's files, ending in "/"; None if the page loads
            boot.js already, or includes the `viewer_scripts`.
    """
    alt = escape(str(data["alt"]))
    picture = f'<p class="lk-alt">{alt}</p>'
    if poster:
        picture = f'<img class="lk-poster" src="{escape(poster)}" alt="{alt}">'
    words = f"<summary>Description in words</summary><p>{escape(description)}</p>"
    more = "" if description == caption else f"<details>{words}</details>"
    boot = f'\n<script defer src="{escape(root)}boot.js"></script>' if root is not None else ""
    safe = compact(data).replace("<", "\\u003c")  # nothing in it can end the script element
    return (
        f'<figure class="lk-embed">\n{picture}\n'
        f'<script type="application/json">{safe}</script>\n'
        f"<figcaption>{escape(caption)}{more}</figcaption>\n</figure>{boot}\n"
    )


@cache
def viewer_scripts() -> tuple[str, ...]:
    """The scripts of viewer and robot, 1.4 MB, for a page that must be a single file."""
    return tuple((VIEWER / name).read_text(encoding="utf-8") for name in ("viewer.js", "robot.js"))


def in_its_place(words: str, picture: bytes | None = None) -> dict[str, str]:
    """Make an output that replaces the widget after it if there is no kernel.

    Args:
        words: What the widget shows.
        picture: The bytes of a PNG file, if there is a picture.
    """
    told = escape(words)
    data = base64.b64encode(picture or b"").decode()
    shown = f'<img alt="{told}" src="data:image/png;base64,{data}">' if picture else ""
    page = (VIEWER.parent / "replay/still.html").read_text(encoding="utf-8")
    return {"text/plain": words, "text/html": Template(page).substitute(shown=shown, told=told)}


def show(motion: Motion) -> Replay:
    """Make a replay to put at the end of a cell.

    Args:
        motion: The motion to show.

    Returns:
        A widget.

    Raises:
        TypeMismatch: ``motion`` is not a `Motion`.
    """
    if not isinstance(motion, Motion):
        raise TypeMismatch(
            f"motion is {shown(motion)}, expected what lk.replay.motion_of(log, title) returns"
        )
    from .widgets import Replay

    made = Replay(data=compact(motion.data()))
    made.words = f"{motion.title}. {motion.alt}"
    made.picture = lambda: still(motion)
    return made


def still(motion: Motion) -> bytes:
    """Draw the arm half way, paths, walls and the force on the tip, as the bytes of a PNG file."""
    from PIL import Image, ImageDraw
    from scipy.spatial.transform import Rotation

    from ..tags.camera import looking_at
    from ..tags.drawing import FAR, Intrinsics, RobotVisuals, Window, draw, in_colour

    robot, model = motion.robot, Model(motion.robot)
    few = slice(None, None, max(1, len(motion.q) // 60))
    k = len(motion.q) // 2

    def tips_of(q: Array) -> Array:
        return np.array([model.pose(row)[:3, 3] for row in q[few]])

    def body(q: Array) -> Any:
        seen = RobotVisuals([(robot, q)])
        return seen.surface([piece.parent in robot.joint_names for piece in seen.pieces])

    tips, tip = tips_of(motion.q), model.pose(motion.q[k])[:3, 3]
    path = tips if motion.path is None else motion.path
    elbow = model.point_on(motion.q[k], robot.n // 2, np.zeros(3))[0]
    points = np.vstack([tip, elbow, tips, path])
    at = 0.5 * (points.min(0) + points.max(0))
    radius = 0.5 * float(np.linalg.norm(np.ptp(points, axis=0))) + 0.12
    along = np.array([0.318, -0.818 if robot.name == "right" else 0.818, 0.479])  # as in `rig.js`
    T_wc = looking_at(at + radius / np.sin(np.radians(17.5)) * along, at)
    width, height = 640, 400  # drawn twice as large, so that its edges are smooth
    lens = Intrinsics(2 * width, 2 * height, *[height / np.tan(np.radians(17.5))] * 2)

    def layer(surface: Any, before: Any, opacity: float) -> tuple[Any, Any]:
        colours, depth = draw(surface, lens, T_wc, Window(0, 0, lens.width, lens.height))
        seen = np.where((depth < before - BACK) & (depth < 0.99 * FAR), opacity, 0.0)
        return Image.fromarray((255.0 * np.dstack([colours, seen])).astype(np.uint8)), depth

    solid = body(motion.q[k])
    whole, depth = layer(solid._replace(colours=solid.colours**LIFT), FAR, 1.0)
    for q in motion.ghosts.values():
        ghost = in_colour(body(q[k]).corners, GHOST)
        whole.alpha_composite(layer(ghost, depth, SEEN_THROUGH)[0])

    lines = [(tips_of(q), "#57606a") for q in motion.ghosts.values()]
    lines += [(path, "#1f2328"), (tips, "#b3001b")]
    for face in (thing for thing in motion.things.values() if "size" in thing):
        corners = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * face["size"][:2]
        turn = Rotation.from_quat(face["quaternion"]).as_matrix()[:, :2]
        lines.append((face["position"] + corners @ turn.T, "#57606a"))
    if motion.force is not None:
        arrow = NEWTON * motion.force[k]
        side = 0.15 * np.cross(arrow, along)
        head = np.array([0.0 * side, arrow, 0.7 * arrow + side, arrow, 0.7 * arrow - side])
        lines.append((tip + head, "#c77700"))
    if robot.name not in SIDES:  # which has no meshes
        joints = model.dynamics.frames(motion.q[k])[:, :3, 3]
        lines.append((np.vstack([joints, tip]), "#57606a"))
    T_cw = np.linalg.inv(T_wc)
    for points, ink in lines:
        pixels = lens.project(points @ T_cw[:3, :3].T + T_cw[:3, 3])
        ImageDraw.Draw(whole).line([*map(tuple, pixels.tolist())], ink, 6)
    file = BytesIO()
    whole.resize((width, height)).save(file, "PNG", optimize=True)
    return file.getvalue()
