"""A submission written down in the release's form, with its verdicts, for people to read.

nbgrader's formgrader opens it; its metadata is the release's, whatever the student's said.
"""

from __future__ import annotations

import copy
import re
from pathlib import Path
from typing import Any

import nbformat

from ...course.authoring.layout import Course
from ...course.messages import summary
from ...course.notebook import Notebook, by_hand, grade_id, kind, nbgrader_info, question_of
from ...errors import LabkitError
from ..clean import clean_line
from ..grading.results import Answer, Result


def in_release_form(source: Notebook, result: Result) -> Notebook:
    """The release's cells with the student's answers in them, and the student's own cells.

    Args:
        source: The release, from nbgrader's source folder.
        result: The result of the submission.
    """
    notebook = copy.deepcopy(source)
    answers = {q.verdict.name: q.source for q in result.questions}
    extra: dict[str, list[Any]] = {}
    for number, own in enumerate(result.own):
        code = own["type"] == "code"
        make: Any = nbformat.v4.new_code_cell if code else nbformat.v4.new_markdown_cell
        text = own["source"] if code else as_typed(own["source"])
        extra.setdefault(own["after"], []).append(make(text, id=f"own-{number:04d}"))
    for cell in notebook.cells:
        name = grade_id(cell)
        if by_hand(cell):
            text = result.written.get(name, cell.source)
            if not nbgrader_info(cell)["task"] and text.split() != cell.source.split():
                cell.source = text  # a space more or less is not yet an answer
        elif kind(cell) == "answer":
            cell.source = answers.get(name, "")
    notebook.cells = extra.get("", []) + [
        one for cell in notebook.cells for one in (cell, *extra.get(cell["id"], []))
    ]
    return notebook


def with_verdicts(notebook: Notebook, result: Result) -> Notebook:
    """The verdicts as the outputs of the checks, in the form that nbgrader reads marks from."""
    answers = {question.verdict.name: question for question in result.questions}
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
        if not nbgrader_info(cell).get("grade") or by_hand(cell):
            continue
        answer = answers.get(question_of(grade_id(cell)))
        text = "\n".join(_told(answer)) if answer else result.rejected
        earned = answer.verdict.earned if answer else 0.0
        cell.execution_count = 1
        cell.outputs = [
            nbformat.v4.new_output("stream", name="stdout", text=text + "\n"),
            nbformat.v4.new_output(
                "execute_result", {"text/plain": repr(float(earned))}, execution_count=1
            ),
        ]
    return notebook


def as_typed(source: str, language: str = "markdown") -> str:
    """What a student typed as a block of text, in which no page finds markup to obey."""
    fence = "`" * (max(map(len, re.findall("`+", source)), default=0) + 3)
    return f"{fence}{language}\n{source}\n{fence}"


def _told(answer: Answer) -> list[str]:
    """A question's verdict, the verdict first, then why."""
    return [*summary(answer.verdict), *(f"  Note: {note}." for note in answer.notes)]


def release_source(course: Course, assignment: str) -> Notebook:
    """The release as graders have it; what students write in is as they were given it.

    Raises:
        LabkitError: A file of the release is damaged.
    """
    source, given = (
        _read(folder / assignment / f"{assignment}.ipynb", assignment)
        for folder in (course.source, course.release)
    )
    blank = {grade_id(cell): cell for cell in given.cells}
    for cell in source.cells:
        if nbgrader_info(cell).get("solution"):
            cell.source, cell.metadata = (blank[grade_id(cell)][x] for x in ("source", "metadata"))
    return source


def _read(path: Path, assignment: str) -> Notebook:
    try:
        return nbformat.read(path, as_version=4)
    except (OSError, ValueError, nbformat.ValidationError) as error:
        why = clean_line(str(error), 80)
        remedy = f"type: labkit release {assignment}"
        raise LabkitError(f"{path} is damaged: {why}; {remedy}") from None


def as_text(notebook: Notebook) -> str:
    """A notebook as the text of its file.

    Raises:
        UnicodeEncodeError: It holds what no file can hold.
    """
    text: str = nbformat.writes(notebook) + "\n"
    text.encode()
    return text
