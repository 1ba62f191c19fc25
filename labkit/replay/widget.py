"""The viewer as a widget in a notebook."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from .. import se3
from ..errors import TypeMismatch
from ..shapes import Array, shown
from .motion import Motion
from .saved import body, still
from .surroundings import faces, outline, placed

if TYPE_CHECKING:
    from .front import Replay

BOARD = 0.12
"""Side of the square that represents a tag's board, as in `marks.js`, in [m]."""


GHOSTS = (0.12, 0.47, 0.82), (0.78, 0.47, 0.0), (0.16, 0.62, 0.4), (0.6, 0.36, 0.77)
SEEN_THROUGH = 0.38
"""Colours and opacity of see-through arms, as in `player.js` and `body.js`."""


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
    from .front import Replay

    made = Replay(data=motion.to_json())
    made.words = f"{motion.title}. {motion.description}"
    made.picture = lambda: motion_still(motion)
    return made


def motion_still(motion: Motion) -> bytes:
    """Draw a motion half way, or at its largest force, as the viewer would, as a PNG file."""
    from ..model import Model
    from ..tags.surface import in_colour

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
