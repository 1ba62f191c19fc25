"""Data and names that a stranger wrote, made safe; numbers, times and names for a sentence."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from typing import Any

from .sandbox.protocol import clean_line, clean_text

__all__ = ["LONGEST", "clean_data", "clean_line", "clean_text", "few", "from_no_formula",
           "how_many", "no_formula", "safe_name"]  # fmt: skip

_RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
_FORMULAS = frozenset("=+-@\t\r")
LONGEST = 80
"""The longest name of a student's folder, in bytes; results, pages and attempts take that name."""


def clean_data(data: Any) -> Any:
    """Plain data, as from JSON, with `clean_text` of every text in it."""
    if isinstance(data, str):
        return clean_text(data)
    if isinstance(data, list):
        return [clean_data(x) for x in data]
    if isinstance(data, dict):
        return {clean_text(key): clean_data(x) for key, x in data.items()}
    return data


def safe_name(name: str) -> str:
    """A name as a folder's: letters and marks of any script, digits, and ``. _ @ -`` within.

    The result is short, in Unicode's composed form, never empty or hidden, and never looks like a
    command's option.
    """
    text = re.sub("['’`]", "", unicodedata.normalize("NFC", name))  # as Moodle, O'Brien
    text = "".join(c if c in "._@" or unicodedata.category(c)[0] in "LMN" else "-" for c in text)
    text = re.sub(r"-+", "-", re.sub(r"\.+", ".", text)).strip("-._@")
    text = text.encode()[:LONGEST].decode(errors="ignore").strip("-._@")
    return f"student-{text}".rstrip("-") if not text or _RESERVED.fullmatch(text) else text


def no_formula(cell: str) -> str:
    """A cell that no spreadsheet runs: one that could begin a formula gets a leading quote."""
    return f"'{cell}" if cell.lstrip("'")[:1] in _FORMULAS else cell


def from_no_formula(cell: str) -> str:
    """The text from which `no_formula` made a cell."""
    return cell[1:] if cell[:1] == "'" and cell.lstrip("'")[:1] in _FORMULAS else cell


def how_many(count: float, what: str) -> str:
    """A number of things, for a sentence: 0 students, 1 student, 2.5 points."""
    return f"{count:.12g} {what}{'s' * (count != 1)}"


def few(names: Sequence[str]) -> str:
    """The first few names, for a sentence."""
    return ", ".join(names[:5]) + ", ..." * (len(names) > 5)
