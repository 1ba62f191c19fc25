"""Text that somebody else wrote, made safe to store and to show; done once, where it enters."""

from __future__ import annotations

import re
import unicodedata
from typing import Any

_CONTROL = r"\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ufeff"
_UNSAFE = re.compile(f"[{_CONTROL}]")
_SURROGATE = re.compile("[\ud800-\udfff]")
_RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
LONGEST = 80
"""Bytes of a folder's name, after which results, pages and attempts are called."""


def clean_text(text: str) -> str:
    """A text of several lines that any file, database and terminal takes.

    Lone surrogates, which UTF-8 cannot hold, become U+FFFD.  Control characters other than tab and
    newline, among them a terminal's escape and the marks that turn the direction of writing, are
    left out; a carriage return before a newline goes with them.
    """
    return _UNSAFE.sub("", _SURROGATE.sub("\ufffd", text))


def clean_line(text: str, most: int = 500) -> str:
    """A text as one short line: `clean_text`, with every run of white space as one space.

    Args:
        text: What somebody wrote: a sentence, the name of a person or of a file.
        most: Characters to keep.
    """
    return re.sub(r"\s+", " ", _UNSAFE.sub(" ", _SURROGATE.sub("\ufffd", text))).strip()[:most]


def clean_data(data: Any) -> Any:
    """Plain data, as JSON gives it, with `clean_text` of every text in it."""
    if isinstance(data, str):
        return clean_text(data)
    if isinstance(data, list):
        return [clean_data(x) for x in data]
    if isinstance(data, dict):
        return {clean_text(key): clean_data(x) for key, x in data.items()}
    return data


def safe_name(name: str) -> str:
    """A name as a folder's: letters and marks of any script, digits, and ``. _ @ -`` within.

    It is short, in Unicode's composed form, never empty, never hidden, and no command takes it for
    an option.
    """
    text = re.sub("['’`]", "", unicodedata.normalize("NFC", name))  # as Moodle, O'Brien
    text = "".join(c if c in "._@" or unicodedata.category(c)[0] in "LMN" else "-" for c in text)
    text = re.sub(r"-+", "-", re.sub(r"\.+", ".", text)).strip("-._@")
    text = text.encode()[:LONGEST].decode(errors="ignore").strip("-._@")
    return f"student-{text}".rstrip("-") if not text or _RESERVED.fullmatch(text) else text
