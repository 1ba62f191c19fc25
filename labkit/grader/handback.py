"""The ways back to students: nbgrader's exchange, and Moodle's feedback files.

The exchange knows a submission by a secret that came with it (``nbgrader.exchange``).  Moodle knows
a participant by the number in the name of a folder, ``NAME_PARTICIPANT_assignfeedback_file``
(github.com/moodle/moodle, ``mod/assign/feedback/file/importziplib.php``).
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterable
from pathlib import Path

from ..course.layout import Course
from ..errors import LabkitError
from .lms import known
from .submission import read_file

SECRET = "submission_secret.txt"
_LARGEST = 1
"""Of a file beside a submission, in [MiB]."""


def read_secret(folder: Path) -> bytes | None:
    """What the exchange put beside a submission; None where it came from elsewhere.

    Raises:
        LabkitError: It is a link, or too large: somebody else's doing.
    """
    path = folder / SECRET
    return read_file(path, _LARGEST) if path.exists() or path.is_symlink() else None


def for_exchange(course: Course, assignment: str, page: Path) -> bool:
    """Lay beside a student's page what ``nbgrader release_feedback`` asks for.

    Args:
        course: The course.
        assignment: Which.
        page: ``feedback/STUDENT/ASSIGNMENT/NAME.html``.

    Returns:
        Whether the submission came through the exchange.
    """
    folder = course.submitted / page.parents[1].name / assignment
    secret = read_secret(folder)
    if secret is not None:
        (page.parent / SECRET).write_bytes(secret)
        stamp = folder / "timestamp.txt"
        when = read_file(stamp, _LARGEST) if stamp.exists() else b""
        (page.parent / "timestamp.txt").write_bytes(when)
    return secret is not None


def moodle_zip(course: Course, assignment: str, pages: Iterable[Path], to: Path) -> int:
    """Write the zip that Moodle takes under *Upload multiple feedback files in a zip*.

    Args:
        course: The course.
        assignment: Which.
        pages: ``feedback/STUDENT/ASSIGNMENT/NAME.html``.
        to: The file to write.

    Returns:
        How many pages are in it.

    Raises:
        LabkitError: No page is of a student whom Moodle's download named.
    """
    people = known(course, assignment)
    mine = [
        (people[student], page)
        for page in pages
        if (student := page.parents[1].name) in people and people[student].system == "moodle"
    ]
    if not mine:
        raise LabkitError(
            f"nobody's {assignment} was collected from Moodle, whose numbers the zip needs; "
            f"first: labkit collect {assignment} MOODLES.zip"
        )
    to.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(to, "w", zipfile.ZIP_DEFLATED) as archive:
        for who, page in mine:
            name = re.sub(r"[_/\\]", " ", who.name)  # the number comes after the first underscore
            folder = f"{name}_{who.number}_assignfeedback_file"
            archive.write(page, f"{folder}/{page.name}")
    return len(mine)
