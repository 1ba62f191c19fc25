"""The time of a hand-in, from the file beside it."""

from __future__ import annotations

import re
import time
from datetime import UTC, datetime, tzinfo
from pathlib import Path
from zoneinfo import ZoneInfo

TIMESTAMP = "timestamp.txt"
"""The name of the file, which nbgrader's exchange writes."""


def read_stamp(folder: Path) -> str:
    """The text of the time file beside a submission; empty if there is none."""
    path = folder / TIMESTAMP
    if path.is_symlink() or not path.is_file():
        return ""
    with path.open(encoding="utf-8", errors="replace") as file:
        return file.read(200).strip()


_TWO_DATES = re.compile(r"(?<!\d)\d{1,2}([./-])\d{1,2}\1\d{2,4}(?!\d)")
"""Dates such as 01.03.2026 and 3/1/26, whose order of day and month is not certain."""


def read_time(text: str, zone: tzinfo = UTC) -> datetime | None:
    """The time in a text, in ``zone`` if the text names none; None if it is not clear."""
    from dateutil.parser import parse

    if _TWO_DATES.search(text) or not re.search(r"\d{4}", text):  # without a year it is today
        return None
    try:
        when: datetime = parse(text, tzinfos=_zone)
        when = (when if when.tzinfo else when.replace(tzinfo=zone)).astimezone(UTC)
    except (ValueError, OverflowError, KeyError):
        return None
    return when if 2000 <= when.year < 2100 else None


def _zone(name: str | None, offset: int | None) -> tzinfo | int | None:
    """The zone that a time names; an unknown name is an error, and never local time."""
    from dateutil.tz import tzlocal

    if name is None or offset is not None:
        return offset
    return tzlocal() if name in time.tzname else ZoneInfo(name)
