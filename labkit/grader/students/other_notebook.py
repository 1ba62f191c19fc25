"""Tells a notebook of another assignment by what nbgrader calls its cells.

A stranger's file is searched, and not parsed; in the text of a cell the quotes are escaped.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from ...course.layout import Course

_GRADE_ID = re.compile(rb'"grade_id"\s*:\s*"([^"\\]{1,200})"')


def grade_ids(data: bytes) -> frozenset[bytes]:
    """What nbgrader calls the cells of a notebook."""
    return frozenset(_GRADE_ID.findall(data))


def released(course: Course) -> Mapping[str, frozenset[bytes]]:
    """What nbgrader calls the cells of each assignment that was released."""
    files = {name: course.release / name / f"{name}.ipynb" for name in course.names()}
    return {name: grade_ids(file.read_bytes()) for name, file in files.items() if file.is_file()}


def made_for(data: bytes, assignment: str, known: Mapping[str, frozenset[bytes]]) -> str:
    """The assignment whose cells a notebook has, if it has more of them than of the one asked."""
    if assignment not in known:
        return assignment
    found = grade_ids(data)
    return max(known, key=lambda name: (len(known[name] & found), name == assignment))
