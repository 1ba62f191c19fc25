"""Markdown and HTML of students on nbgrader's pages and on ours: nothing in it runs.

``nbgrader_config.py`` puts these filters in the place of nbconvert's own, for formgrader and for
``nbgrader generate_feedback``: their templates show Markdown as it is, whatever
``HTMLExporter.sanitize_html`` says, and nbconvert's ``clean_html`` knows no paragraphs.
"""

from __future__ import annotations

from html import escape
from typing import Any

import bleach
from jinja2 import pass_context
from nbconvert import HTMLExporter

_TAGS = (
    {"a", "abbr", "b", "blockquote", "br", "code", "del", "div", "em", "hr", "i", "kbd", "p", "pre"}
    | {"s", "small", "span", "strong", "sub", "sup", "details", "summary"}
    | {"h1", "h2", "h3", "h4", "h5", "h6", "dd", "dl", "dt", "li", "ol", "ul"}
    | {"table", "tbody", "td", "tfoot", "th", "thead", "tr"}
)
_LINKS = ("http://", "https://", "mailto:", "#")
"""Others could lead to a page that was handed in."""
_exporter = HTMLExporter(exclude_anchor_links=True)


@pass_context
def markdown(context: Any, source: str) -> str:
    """Markdown as HTML of known elements; as it was typed, where it cannot be read."""
    try:
        html = str(_exporter.markdown2html(context, source))
    except Exception:  # such as a picture that was not handed in
        html = f"<pre>{escape(source)}</pre>"
    return clean(html)


def clean(html: str | bytes) -> str:
    """HTML with known elements and links alone; anything else is shown as text."""
    text = html.decode(errors="replace") if isinstance(html, bytes) else html
    return str(bleach.clean(text, tags=_TAGS, attributes=_is_link))


def _is_link(tag: str, name: str, value: str) -> bool:
    return (tag, name) == ("a", "href") and value.lower().startswith(_LINKS)
