"""The templates for files that the grader writes; Jinja escapes values in HTML and XML."""

from __future__ import annotations

import json
from base64 import b64encode
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape

from ..replay import figure_html, viewer_scripts

TEMPLATES = Path(__file__).parent / "templates"


@cache
def _environment() -> Environment:
    return Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=select_autoescape(["html.j2", "xml.j2"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )


def render(template: str, **values: Any) -> str:
    """Fill a template, such as "feedback.html.j2", with values."""
    return _environment().get_template(template).render(values)


def render_page(template: str, style: str = "", *, replays: bool = False, **values: Any) -> str:
    """Fill the template of a page, which loads nothing but its own style and scripts.

    Args:
        template: The name of the template, such as "feedback.html.j2".
        style: A style that is added to the style of all pages.
        replays: Whether the page shows replays, and so needs the viewer and the robot.
        values: The other values that the template needs.  It also gets
            ``recorded_html`` for a motion, which ``motion_of`` reads from the text in a result.
    """
    style = file("feedback.css") + style
    code = (*viewer_scripts(), file("feedback.js")) if replays else ()
    return render(
        template,
        style=style,
        scripts=code,
        policy=_policy(style, code),
        motion_of=lambda text: json.loads(text or "null"),
        recorded_html=figure_html,
        **values,
    )


@cache
def file(name: str) -> str:
    """The text of a file beside the templates."""
    return (TEMPLATES / name).read_text(encoding="utf-8")


@cache
def _policy(style: str, scripts: tuple[str, ...]) -> str:
    """The content security policy: this style, these scripts, nothing else."""
    rules = f"default-src 'none'; style-src {_hash(style)}; base-uri 'none'; form-action 'none'"
    return f"{rules}; script-src {' '.join(map(_hash, scripts))}" if scripts else rules


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"
