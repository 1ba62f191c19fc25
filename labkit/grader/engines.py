"""Engines: ways to grade a submission.  Here nbgrader's own, in one process with the tests."""

from __future__ import annotations

import logging
import os
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..course.layout import Course
from .clean import clean_line
from .each import Failed


@dataclass(frozen=True)
class Mark:
    """What a student got for an assignment.

    Attributes:
        student: Whose.
        assignment: Which.
        score: Points, or None where grading failed.
        points: What full marks would be.
        says: Why it failed, if it did.
    """

    student: str
    assignment: str
    score: float | None
    points: float
    says: str = ""


def nbgrader_api(course: Course, *, own_engine: bool = False) -> Any:
    """The interface of nbgrader to this course, set up as its own ``nbgrader_config.py`` says.

    Args:
        course: The course.
        own_engine: Whether its autograde runs students' code itself, as it does unasked.
    """
    from nbgrader.apps import NbGraderAPI
    from nbgrader.coursedir import CourseDirectory
    from traitlets.config import Config
    from traitlets.config.loader import PyFileConfigLoader

    here = str(Path(sys.executable).parent)  # nbgrader calls programs that lie beside Python
    if here not in os.environ["PATH"].split(os.pathsep):
        os.environ["PATH"] = os.pathsep.join([here, os.environ["PATH"]])
    config = PyFileConfigLoader("nbgrader_config.py", path=str(course.root)).load_config()
    settings = Config(config)
    settings.CourseDirectory.root = str(course.root)
    settings.Application.log_level = logging.CRITICAL
    if own_engine:
        for steps in ("sanitize_preprocessors", "autograde_preprocessors"):
            settings.Autograde.pop(steps, None)
    return NbGraderAPI(CourseDirectory(config=settings), config=settings)


def students(course: Course, name: str) -> list[str]:
    """Who handed in an assignment, in order; of folders with a name that is fit."""
    return [student for student in _folders(course, name) if is_name(student)]


def misnamed(course: Course, name: str) -> list[Failed]:
    """Folders with a name that no database, page or terminal should be given, in plain letters."""
    return [
        Failed(
            plain_name(student),
            "a folder in submitted/ has this name, in which a page would see markup or a terminal "
            "commands; rename the folder and grade again",
        )
        for student in _folders(course, name)
        if not is_name(student)
    ]


def is_name(student: str) -> bool:
    """Whether a student may be called so: one clean line, which is not markup."""
    return clean_line(student) == student and not set(student) & set('<>"\\')


def plain_name(student: str) -> str:
    """A name as it may be shown: one that is not fit, in plain letters."""
    return student if is_name(student) else ascii(student)


def _folders(course: Course, name: str) -> list[str]:
    return sorted(p.name for p in course.submitted.glob("*") if os.path.lexists(p / name))


def grade_with_nbgrader(course: Course, name: str, student: str) -> Mark:
    """Grade one submission with nbgrader's own engine.

    The student's code runs in one process with the hidden cases: it can read and change them.
    """
    from .gradebook import quiet_database

    api = nbgrader_api(course, own_engine=True)
    with quiet_database():
        return _autograde(api, name, student)


def _autograde(api: Any, name: str, student: str) -> Mark:
    result = api.autograde(name, student, force=True, create=True)
    with api.gradebook as book:
        try:
            submission = book.find_submission(name, student)
        except Exception:
            return Mark(student, name, None, 0.0, reason(result))
        if not result["success"]:
            return Mark(student, name, None, submission.max_score, reason(result))
        return Mark(student, name, submission.score, submission.max_score)


def reason(result: dict[str, Any]) -> str:
    """Why nbgrader failed: the last exception in its log, or else the log's last line."""
    lines = [x for x in f"{result.get('log', '')}\n{result.get('error', '')}".splitlines() if x]
    errors = [x.strip() for x in lines if re.match(r"\s*[\w.]+(Error|Exception)\b", x)]
    return clean_line((errors or lines or ["nbgrader gave no reason"])[-1])
