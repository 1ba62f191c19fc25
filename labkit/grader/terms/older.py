"""Move files of a term from the places where an older labkit stored them."""

from __future__ import annotations

import os
import re
from pathlib import Path

from ...course.authoring.layout import Course
from .term import PERSONAL_FILES

_RESULT = re.compile(r"(.+)-((?:[0-9a-f]{8}-){2}[0-9a-f]{8}|--)\.json")
_EXPLANATION = re.compile(r"(.+)-(\w+)\.html")


def relocate(term: Course, *, archived: bool) -> None:
    """Move files that an older labkit stored elsewhere; no existing file is overwritten.

    Archives had all files side by side.  Earlier results and the pages of ``labkit explain`` had
    the student's name in their own names; now each student has a folder.

    Args:
        term: The term under way, or an archived one.
        archived: Whether the term is archived.
    """
    if archived:
        for name in PERSONAL_FILES:
            _move(term.root / Path(name).name, term.root / name)
    named = [(path, _RESULT) for path in term.results.glob("**/old/*.json")]
    named += [(path, _EXPLANATION) for path in (term.build / "explain").glob("*.html")]
    for path, pattern in named:
        if match := pattern.fullmatch(path.name):
            _move(path, path.parent / match[1] / f"{match[2]}{path.suffix}")


def _move(path: Path, to: Path) -> None:
    if path != to and os.path.lexists(path) and not os.path.lexists(to):
        to.parent.mkdir(parents=True, exist_ok=True)
        path.rename(to)
