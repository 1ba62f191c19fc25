"""The time of a hand-in, as the file beside it says."""

from __future__ import annotations

from datetime import UTC, datetime, tzinfo
from pathlib import Path

TIMESTAMP = "timestamp.txt"
"""Its name; nbgrader's exchange writes it."""


def read_stamp(folder: Path) -> str:
    """What the file beside a submission says of its time; empty where there is none."""
    path = folder / TIMESTAMP
    if path.is_symlink() or not path.is_file():
        return ""
    with path.open(encoding="utf-8", errors="replace") as file:
        return file.read(200).strip()


def read_time(text: str, zone: tzinfo = UTC) -> datetime | None:
    """A time as it is written, in a zone if it does not say; None if it is not a time."""
    from dateutil.parser import parse

    try:
        when: datetime = parse(text)
        when = (when if when.tzinfo else when.replace(tzinfo=zone)).astimezone(UTC)
    except (ValueError, OverflowError):
        return None
    return when if 2000 <= when.year < 2100 else None
