"""The same viewer in a notebook, as an anywidget."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

from ..errors import TypeMismatch
from ..shapes import shown
from .figure import VIEWER
from .motion import Motion


def show(motion: Motion) -> Any:
    """A replay to put last in a cell.

    Args:
        motion: What to show.

    Returns:
        A widget; assign `.motion = another` to change what it shows.

    Raises:
        TypeMismatch: It is not a `Motion`.
    """
    return _widget_class()(data=_data(motion))


@cache
def _widget_class() -> type[Any]:
    """The widget's class; anywidget is imported only when a notebook asks for one."""
    import anywidget
    import traitlets

    class Replay(anywidget.AnyWidget):
        """Shows one motion; viewer and robot go to the page once, not into the notebook."""

        _esm = (VIEWER / "widget.js").read_text(encoding="utf-8")
        data = traitlets.Unicode().tag(sync=True)

        def __init__(self, **traits: Any) -> None:
            super().__init__(**traits)
            self.on_msg(_answer)

        def __repr__(self) -> str:
            return f"Replay: {json.loads(self.data)['alt']}"

        @property
        def motion(self) -> dict[str, Any]:
            """What is shown, as the viewer reads it."""
            data: dict[str, Any] = json.loads(self.data)
            return data

        @motion.setter
        def motion(self, motion: Motion) -> None:
            self.data = _data(motion)

    return Replay


def _data(motion: Motion) -> str:
    if not isinstance(motion, Motion):
        raise TypeMismatch(
            f"motion is {shown(motion)}, expected what lk.replay.motion_of(log, title) returns"
        )
    return motion.to_json()


def _answer(widget: Any, message: Any, _buffers: Any) -> None:
    """Send the shared files to the page that asks for them."""
    if message.get("kind") == "files":
        files = [(VIEWER / name).read_bytes() for name in ("viewer.js", "robot.js")]
        widget.send({"kind": "files"}, buffers=files)
