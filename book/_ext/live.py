"""The directive ``live-arm``, which puts a live panel into a page; a click loads it.

Its argument is the kind of panel, its options are the settings, and its text is the caption::

    :::{live-arm} open
    :plant: ideal
    :controller: workspaceImpedance
    :path: circle
    Drag the arm.
    :::

Before the click the figure shows a still picture of the panel, or a loop if it has one.
`make_stills.py` takes them; the still of an open panel has the name of its page.
"""

from __future__ import annotations

import json
from html import escape
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from figure import Figure, named
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

PIECES = ("open", "stiffness", "age", "singular")
SETTINGS = ("controller", "path")
STILLS = Path(__file__).parents[1] / "static" / "stills"
WITHOUT = "In print, or without JavaScript, the recorded runs and the text show the same thing."


def names(text: str) -> list[str]:
    """Return the names in a text that separates them by commas."""
    return [name.strip() for name in text.split(",")]


class LiveArm(SphinxDirective):
    """The directive that puts a live panel into a page."""

    required_arguments = 1
    has_content = True
    option_spec: ClassVar[dict[str, Any]] = {
        "name": directives.unchanged_required,
        "title": directives.unchanged_required,
        "plant": lambda x: directives.choice(x, ("ideal", "baxter")),
        "controller": directives.unchanged_required,
        "controllers": names,
        "path": directives.unchanged_required,
        "paths": names,
        "seconds": float,
    }

    def run(self) -> list[nodes.Node]:
        """Return the figure and the script that makes its button work."""
        piece = directives.choice(self.arguments[0], PIECES)
        own = {k: v for k, v in self.options.items() if k not in (*SETTINGS, "name")}
        settings = {k: v for k, v in self.options.items() if k in SETTINGS}
        title = own.setdefault("title", "The live arm")
        data = json.dumps({"piece": piece, **own, "settings": settings}).replace("<", "\\u003c")
        static = "../" * self.env.docname.count("/") + "_static/"
        shown = self.env.docname.replace("/", "_") if piece == "open" else f"live_{piece}"
        still = f"{shown}.webp"
        if not (STILLS / still).exists():
            raise self.error(f"static/stills has no {still}; run book/_tools/make_stills.py")
        media = "(prefers-reduced-motion: no-preference)"
        loop = f'<source type="image/avif" media="{media}" srcset="{static}stills/{shown}.avif">'
        before = (
            f'<figure class="lk-live" role="group" aria-label="{escape(title)}">'
            f'<picture class="lk-still">{loop * (STILLS / f"{shown}.avif").exists()}'
            f'<img class="dark-light" src="{static}stills/{still}" width="1480" height="800" '
            f'alt="{escape(title)}: the first view" loading="lazy"></picture>'
            f'<script type="application/json">{data}</script>'
            f'<div class="lk-offer"><p class="lk-without">{WITHOUT}</p></div></figure>'
            f'<script defer src="{static}live/boot.js"></script><div class="lk-caption">'
        )
        figure = Figure(before=before, after="</div>")
        self.state.nested_parse(self.content, self.content_offset, figure)
        return [named(figure, self.state.document, self.options.get("name"))]


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directive with Sphinx."""
    app.add_directive("live-arm", LiveArm)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
