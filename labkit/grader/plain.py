"""A course for nbgrader alone, without labkit's grader: hidden cases are nbgrader's hidden tests.

nbgrader runs a student's code in the instructor's own account, in one process with the hidden
cases.  So nothing is isolated, and a student who wants to can read or change what decides.
"""

from __future__ import annotations

import base64
import json
import shutil
import zlib
from collections.abc import Sequence
from pathlib import Path

import nbformat

from ..course.authoring.bundle import Bundle
from ..course.authoring.layout import Course
from ..course.notebook import BLANK, Notebook, check_id, grade_id
from ..course.serialize import question_data
from ..errors import LabkitError
from .rules import read_rules

_CONFIG = """\
c = get_config()
c.CourseDirectory.course_id = {!r}
c.ClearSolutions.code_stub = {{
    "python": "# Your code goes here, in place of the next line\\nraise NotImplementedError"
}}
c.Execute.timeout = 120
"""
_HIDDEN = """\
### BEGIN HIDDEN TESTS
import base64, json, zlib
from labkit.course import read_question, student
packed = json.loads(zlib.decompress(base64.b85decode("{}")))
student.desk().questions["{}"] = read_question(packed)
### END HIDDEN TESTS
"""
"""In a check's cell: the question with its hidden cases takes the place of the public one."""


def write_plain(course: Course, names: Sequence[str], to: Path) -> None:
    """Write a course that nbgrader's own commands prepare, grade and return.

    Args:
        course: The course; its assignments must be released.
        names: The assignments.
        to: The folder of the new course; assignments that are there are replaced.

    Raises:
        LabkitError: The folder holds another course.
    """
    config = to / "nbgrader_config.py"
    text = _CONFIG.format(read_rules(course).id)
    if config.exists() and config.read_text(encoding="utf-8") != text:
        raise LabkitError(f"{to} holds another course; name a new folder")
    for name in names:
        folder = to / "source" / name
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(course.release / name, folder)
        nbformat.write(_plain(course, name), folder / f"{name}.ipynb")
    config.write_text(text, encoding="utf-8")


def _plain(course: Course, name: str) -> Notebook:
    """The source of an assignment, its hidden cases in the cells of its checks."""
    notebook = nbformat.read(course.source / name / f"{name}.ipynb", as_version=4)
    questions = {check_id(q.name): q for q in Bundle.of(course, name).questions}
    for cell in notebook.cells:
        cell.source = cell.metadata.pop(BLANK, cell.source)
        if question := questions.get(grade_id(cell)):
            data = zlib.compress(json.dumps(question_data(question)).encode())
            packed = base64.b85encode(data).decode()
            cell.source = _HIDDEN.format(packed, question.name) + cell.source
    return notebook
