"""The notebook's widgets.  Only who shows one imports this: it brings anywidget with it."""

from __future__ import annotations

import json
from html import escape
from pathlib import Path
from typing import Any

import anywidget
import traitlets

from ..errors import NothingKept
from ..log import Log
from .figure import VIEWER, figure_html, filled, viewer_scripts
from .saved import Saved
from .session import Session


class Widget(Saved, anywidget.AnyWidget):
    """Shows some data; viewer and robot go to the page once, not into the notebook."""

    _esm = (VIEWER / "widget.js").read_text(encoding="utf-8")
    data = traitlets.Unicode().tag(sync=True)

    def __init__(self, **traits: Any) -> None:
        """Answer the page that asks for the shared files."""
        super().__init__(**traits)
        self.on_msg(self._answer)

    def _answer(self, _: Any, message: Any, __: Any) -> None:
        if message.get("kind") == "files":
            files = [(VIEWER / name).read_bytes() for name in ("viewer.js", "robot.js")]
            self.send({"kind": "files"}, buffers=files)

    def __repr__(self) -> str:
        return self.words


class Replay(Widget):
    """Shows one motion."""

    def save(self, path: Any) -> None:
        """Write a page that plays anywhere, without network and kernel, 1.4 MB.

        Args:
            path: Where to; its name should end in ".html".
        """
        title, words = escape(str(json.loads(self.data)["title"])), self.words
        scripts = "".join(f"<script>{text}</script>\n" for text in viewer_scripts())
        figure = figure_html(self.data, words, words, words)
        page = filled("page.html", title=title, figure=figure, scripts=scripts)
        Path(path).write_text(page, encoding="utf-8")


class Live(Widget):
    """Shows one session and passes on what the hand does."""

    session: Session

    @property
    def log(self) -> Log:
        """The run that was kept last.

        Raises:
            NothingKept: None was.
        """
        if not self.session.logs:
            raise NothingKept("no run was kept: press Start, then Keep this run in the view")
        return self.session.logs[-1]

    @property
    def logs(self) -> tuple[Log, ...]:
        """All runs that were kept."""
        return tuple(self.session.logs)

    def close(self) -> None:
        """End it; the arm is at rest and free."""
        self.session.close()
        super().close()
