"""A motion as a figure on a page, in HTML without inline code, for feedback and for the book."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from html import escape
from pathlib import Path
from string import Template
from typing import Any

VIEWER = Path(__file__).parents[1] / "data" / "viewer"


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


def compact(data: Any) -> str:
    """Data as JSON without spaces."""
    return json.dumps(data, separators=(",", ":"), ensure_ascii=False)
