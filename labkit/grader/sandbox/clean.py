"""Text that a stranger wrote, made safe to store and to show, where it enters.

A result is cleaned as a whole, too, when it is made and when it is read.
"""

from __future__ import annotations

import re

_CONTROL = r"\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ufeff"
_UNSAFE = re.compile(f"[{_CONTROL}]")
_SURROGATE = re.compile("[\ud800-\udfff]")


def clean_text(text: str) -> str:
    """A text of several lines that any file, database and terminal takes.

    Lone surrogates, which UTF-8 cannot hold, become U+FFFD.  Control characters other than tab and
    newline are left out, among them a terminal's escape, the marks that turn the direction of
    writing, and a carriage return before a newline.
    """
    return _UNSAFE.sub("", _SURROGATE.sub("\ufffd", text))


def clean_line(text: str, most: int = 500) -> str:
    """A text as one short line: `clean_text`, with every run of white space as one space.

    Args:
        text: A sentence, or the name of a person or of a file.
        most: Characters to keep.
    """
    return re.sub(r"\s+", " ", _UNSAFE.sub(" ", _SURROGATE.sub("\ufffd", text))).strip()[:most]
