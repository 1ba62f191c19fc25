"""The same viewer in a notebook, as an anywidget."""

from __future__ import annotations

import json
from functools import cache
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import TypeMismatch
from ..plotting import as_drawn
from ..shapes import Array, shown
from .figure import VIEWER, figure_html, viewer_scripts
from .motion import Motion
from .saved import Saved, still
from .surroundings import outline

BOARD = 0.12
"""Side of the square that stands for a tag's board, as `marks.js` draws it, in [m]."""


def show(motion: Motion) -> Any:
    """A replay to put last in a cell.

    Args:
        motion: What to show.

    Returns:
        A widget; its ``save("run.html")`` writes a page.

    Raises:
        TypeMismatch: It is not a `Motion`.
    """
    if not isinstance(motion, Motion):
        raise TypeMismatch(
            f"motion is {shown(motion)}, expected what lk.replay.motion_of(log, title) returns"
        )
    made = _replay_class()(data=motion.to_json())
    made.words = as_drawn(f"{motion.title}. {motion.description}")
    made.picture = lambda: motion_still(motion)
    return made


@cache
def source() -> str:
    """The front end of the notebook's widgets."""
    return (VIEWER / "widget.js").read_text(encoding="utf-8")


@cache
def widget_class() -> type[Any]:
    """What all of them are; anywidget is imported only when a notebook asks for one."""
    import anywidget
    import traitlets

    class Widget(Saved, anywidget.AnyWidget):
        """Shows some data; viewer and robot go to the page once, not into the notebook."""

        _esm = source()
        data = traitlets.Unicode().tag(sync=True)

        def __init__(self, **traits: Any) -> None:
            super().__init__(**traits)
            self.on_msg(answer)

        def __repr__(self) -> str:
            return self.words

    return Widget


@cache
def _replay_class() -> type[Any]:
    class Replay(widget_class()):  # type: ignore[misc]
        """Shows one motion."""

        def __repr__(self) -> str:
            return f"Replay: {self.words}"

        def save(self, path: Any) -> None:
            """Write a page that plays anywhere, without network and kernel, 1.4 MB.

            Args:
                path: Where to; its name should end in ".html".
            """
            save(self.data, self.words, path)

    return Replay


def motion_still(motion: Motion) -> bytes:
    """The first view of a motion: the arm half way, all paths, what the arm meets: a PNG file."""
    from ..model import Model

    model, half = Model(motion.robot), len(motion.q) // 2
    few = slice(None, None, max(1, len(motion.q) // 60))

    def tips_of(q: Array) -> Array:
        return np.array([model.pose(row)[:3, 3] for row in q[few]])

    tips = tips_of(motion.q)
    path = tips if motion.path is None else motion.path
    met, board = [outline(x, tips) for x in motion.things.values()], None
    if motion.board_position is not None and motion.board_rotation is not None:
        square = np.array([[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0], [1, 1, 0]]) * BOARD / 2.0
        board = square @ motion.board_rotation[half].T + motion.board_position[half]
        met.append(board)
    others = map(tips_of, motion.ghosts.values())
    return still(motion.robot, motion.q[half], tips, path, *others, *met, around=board)


def save(data: str, words: str, path: Any) -> None:
    """Write a page with one motion, the viewer and the robot in it."""
    title = escape(str(json.loads(data)["title"]))
    scripts = "".join(f"<script>{text}</script>\n" for text in viewer_scripts())
    start = (
        'for (const f of document.querySelectorAll(".lk-embed")) { f.dataset.mounted = "1"; '
        "labkitViewer.mount(f, "
        "JSON.parse(f.querySelector('[type=\"application/json\"]').textContent)); }"
    )
    Path(path).write_text(
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{title}</title></head>\n"
        f"<body><main><h1>{title}</h1>\n{figure_html(data, words, words, words)}</main>\n"
        f"{scripts}<script>{start}</script></body></html>\n",
        encoding="utf-8",
    )


def answer(widget: Any, message: Any, _buffers: Any) -> None:
    """Send the shared files to the page that asks for them."""
    if message.get("kind") == "files":
        files = [(VIEWER / name).read_bytes() for name in ("viewer.js", "robot.js")]
        widget.send({"kind": "files"}, buffers=files)
