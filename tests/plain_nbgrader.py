"""nbgrader's own engine, which runs a student's code in one process with the hidden cases.

labkit never does so.  In these tests it is the control: attacks that isolation stops succeed in it.
"""

from __future__ import annotations

import base64
import json
import zlib

import nbformat

from labkit.course.authoring.bundle import Bundle
from labkit.course.notebook import check_id, grade_id
from labkit.course.serialize import question_data
from labkit.grader.gradebook import nbgrader_api, quiet_database
from labkit.grader.release import generate

HIDDEN = """### BEGIN HIDDEN TESTS
import base64, json, zlib
from labkit.course import read_question, student
packed = json.loads(zlib.decompress(base64.b85decode("{}")))
student.desk().questions["{}"] = read_question(packed)
### END HIDDEN TESTS
"""


def pack_hidden(course, assignment):
    """Put a release's hidden cases into its source notebook, where nbgrader looks for them."""
    path = course.source / assignment / f"{assignment}.ipynb"
    notebook = nbformat.read(path, as_version=4)
    for question in Bundle.of(course, assignment).questions:
        text = json.dumps(question_data(question)).encode()
        packed = base64.b85encode(zlib.compress(text)).decode()
        (cell,) = [x for x in notebook.cells if grade_id(x) == check_id(question.name)]
        cell.source = HIDDEN.format(packed, question.name) + cell.source
    nbformat.write(notebook, path)
    generate(course, assignment)


def grade_with_nbgrader(course, assignment, student):
    """The score by nbgrader's own engine."""
    api = nbgrader_api(course)
    for steps in ("sanitize_preprocessors", "autograde_preprocessors"):
        api.config.Autograde.pop(steps, None)
    with quiet_database():
        result = api.autograde(assignment, student, force=True, create=True)
        assert result["success"], result["log"]
        with api.gradebook as book:
            return book.find_submission(assignment, student).score
