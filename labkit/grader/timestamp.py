"""The time of a hand-in, from the file beside it."""

from __future__ import annotations

from datetime import UTC, datetime, tzinfo
from pathlib import Path

TIMESTAMP = "timestamp.txt"
"""The name of the file, which nbgrader's exchange writes."""


def read_stamp(folder: Path) -> str:
    """The text of the time file beside a submission; empty if there is none."""
    path = folder / TIMESTAMP
    if path.is_symlink() or not path.is_file():
        return ""
    with path.open(encoding="utf-8", errors="replace") as file:
        return file.read(200).strip()


def read_time(text: str, zone: tzinfo = UTC) -> datetime | None:
    """The time in a text, in ``zone`` if the text names none; None if it is not clear.

    It is ISO 8601 or nbgrader's own form, ``2026-11-06 10:00:00.000000 UTC``.
    """
    try:
        when = datetime.fromisoformat(text.removesuffix(" UTC") + "Z" * text.endswith(" UTC"))
        when = (when if when.tzinfo else when.replace(tzinfo=zone)).astimezone(UTC)
    except (ValueError, OverflowError):
        return None
    return when if 2000 <= when.year < 2100 else None
