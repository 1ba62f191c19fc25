"""The templates of what the grader writes; Jinja escapes every value in HTML and XML."""

from __future__ import annotations

from base64 import b64encode
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape

from ..replay import viewer_scripts

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


@cache
def file(name: str) -> str:
    """The text of a file beside the templates."""
    return (TEMPLATES / name).read_text(encoding="utf-8")


@cache
def scripts() -> tuple[str, ...]:
    """What shows replays on a page."""
    return (*viewer_scripts(), file("feedback.js"))


@cache
def policy(style: str, scripts: tuple[str, ...]) -> str:
    """The content security policy: this style, these scripts, nothing else."""
    rules = ["default-src 'none'", f"style-src {_hash(style)}"]
    rules += [f"script-src {' '.join(map(_hash, scripts))}"] if scripts else []
    return "; ".join([*rules, "base-uri 'none'", "form-action 'none'"])


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"
