"""The feedback files that Moodle takes: a zip with a page for each participant.

Moodle knows a participant by the number in the name of a folder,
``NAME_PARTICIPANT_assignfeedback_file`` (github.com/moodle/moodle,
``mod/assign/feedback/file/importziplib.php``).
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterable
from pathlib import Path

from ..course.layout import Course
from ..errors import LabkitError
from .identity import lms_users


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
    people = lms_users(course, assignment)
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
