"""The notebook's widgets, imported only when one is shown, because they need anywidget."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import anywidget
import traitlets

from .player import VIEWER, in_its_place
from .session import LiveSession


class Widget(anywidget.AnyWidget):
    """Shows data in the viewer, whose files go to the page once, and leaves a picture behind.

    Attributes:
        words: Caption and description.
        picture: Function that returns the picture as the bytes of a PNG file.
    """

    words: str
    picture: Callable[[], bytes]

    _esm = (VIEWER / "widget.js").read_text(encoding="utf-8")
    data = traitlets.Unicode().tag(sync=True)

    def __init__(self, **traits: Any) -> None:
        """Make a widget that sends the shared files to a page that asks for them."""
        super().__init__(**traits)
        self.on_msg(self._answer)

    def _answer(self, _: Any, message: Any, __: Any) -> None:
        if message.get("kind") == "files":
            files = [(VIEWER / name).read_bytes() for name in ("viewer.js", "robot.js")]
            self.send({"kind": "files"}, buffers=files)

    def _ipython_display_(self) -> None:
        from IPython.display import display

        display(self.fallback(), raw=True)
        data, metadata = self._repr_mimebundle_()  # type: ignore[misc]
        display(data, metadata=metadata, raw=True)

    def fallback(self) -> dict[str, str]:
        """The picture and its caption as a notebook output."""
        return in_its_place(self.words, self.picture())

    def __repr__(self) -> str:
        return self.words


class Replay(Widget):
    """Shows one motion."""


class Live(Widget):
    """Shows a session and passes the user's actions on to it."""

    session: LiveSession

    def close(self) -> None:
        """Pause, which leaves the arm at rest and free for other cells."""
        self.session.close()
        super().close()
