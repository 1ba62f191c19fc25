"""nbgrader's interface to a course, and who handed in."""

from __future__ import annotations

import logging
import os
import re
import sys
from pathlib import Path
from typing import Any

from ..course.layout import Course
from .clean import clean_line
from .each import Failed


def nbgrader_api(course: Course) -> Any:
    """The interface of nbgrader to this course, set up as its own ``nbgrader_config.py`` says."""
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


def reason(result: dict[str, Any]) -> str:
    """Why nbgrader failed: the last exception in its log, or else the log's last line."""
    lines = [x for x in f"{result.get('log', '')}\n{result.get('error', '')}".splitlines() if x]
    errors = [x.strip() for x in lines if re.match(r"\s*[\w.]+(Error|Exception)\b", x)]
    return clean_line((errors or lines or ["nbgrader gave no reason"])[-1])
