"""The time of a hand-in, as the file beside it says."""

from __future__ import annotations

import re
import time
from datetime import UTC, datetime, tzinfo
from pathlib import Path
from zoneinfo import ZoneInfo

TIMESTAMP = "timestamp.txt"
"""Its name; nbgrader's exchange writes it."""


def read_stamp(folder: Path) -> str:
    """What the file beside a submission says of its time; empty where there is none."""
    path = folder / TIMESTAMP
    if path.is_symlink() or not path.is_file():
        return ""
    with path.open(encoding="utf-8", errors="replace") as file:
        return file.read(200).strip()


_TWO_DATES = re.compile(r"(?<!\d)\d{1,2}([./-])\d{1,2}\1\d{2,4}(?!\d)")
"""Such as 01.03.2026 and 3/1/26, which are two dates, by where one lives."""


def read_time(text: str, zone: tzinfo = UTC) -> datetime | None:
    """A time as it is written, in a zone if it does not say; None if it is not one time."""
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
    """The zone that a time names; nobody's is an error, and not this machine's."""
    from dateutil.tz import tzlocal

    if name is None or offset is not None:
        return offset
    return tzlocal() if name in time.tzname else ZoneInfo(name)
