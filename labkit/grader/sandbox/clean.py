"""Make text by a stranger safe to store and to show, as soon as it arrives.

A whole result is also cleaned when it is made and when it is read.
"""

from __future__ import annotations

import re

_CONTROL = r"\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ufeff"
_UNSAFE = re.compile(f"[{_CONTROL}]")
_SURROGATE = re.compile("[\ud800-\udfff]")


def clean_text(text: str) -> str:
    """Make a text of several lines safe for every file, database and terminal.

    Lone surrogates, which UTF-8 cannot encode, become U+FFFD.  Control characters other than tab
    and newline are removed, such as the escape character, the marks that change the direction of
    writing, and the carriage return before a newline.
    """
    return _UNSAFE.sub("", _SURROGATE.sub("\ufffd", text))


def clean_line(text: str, most: int = 500) -> str:
    """Make a text one short, safe line, with each run of white space replaced by a space.

    Args:
        text: A sentence, or the name of a person or of a file.
        most: How many characters to keep.
    """
    return re.sub(r"\s+", " ", _UNSAFE.sub(" ", _SURROGATE.sub("\ufffd", text))).strip()[:most]
