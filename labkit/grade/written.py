"""A submission written down in the release's form, with its verdicts, for people to read.

nbgrader's formgrader opens it; its metadata is the release's, whatever the student's said.
"""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import nbformat

from .course import Course
from .notebook import Notebook, without_hidden
from .results import Result, write
from .says import question_lines


def in_release_form(source: Notebook, result: Result) -> Notebook:
    """The release's cells with the student's answers in them, his own cells where they stood.

    Args:
        source: The release, from nbgrader's source folder.
        result: Of the submission.
    """
    notebook = copy.deepcopy(source)
    answers = {question["name"]: question["source"] for question in result.questions}
    extra: dict[str, list[Any]] = {}
    for number, own in enumerate(result.own):
        code = own["type"] == "code"
        make: Any = nbformat.v4.new_code_cell if code else nbformat.v4.new_markdown_cell
        extra.setdefault(own["after"], []).append(make(own["source"], id=f"own-{number:04d}"))
    for cell in notebook.cells:
        if cell.metadata.get("lab") == "answer":
            cell.source = answers.get(cell.metadata["nbgrader"]["grade_id"], "")
    notebook.cells = extra.get("", []) + [
        one for cell in notebook.cells for one in (cell, *extra.get(cell["id"], []))
    ]
    return notebook


def with_verdicts(notebook: Notebook, result: Result) -> Notebook:
    """The verdicts as the outputs of the checks, in the form that nbgrader reads marks from."""
    verdicts = {question["name"]: question for question in result.questions}
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
        grade_id = cell.metadata.get("nbgrader", {}).get("grade_id", "")
        if not cell.metadata.get("nbgrader", {}).get("grade"):
            continue
        name = grade_id.removesuffix("-check")
        cell.source = without_hidden(cell.source)
        question = verdicts.get(name)
        text = "\n".join(question_lines(question)) if question else result.rejected
        earned = question["earned"] if question else 0.0
        cell.execution_count = 1
        cell.outputs = [
            nbformat.v4.new_output("stream", name="stdout", text=text + "\n"),
            nbformat.v4.new_output(
                "execute_result", {"text/plain": repr(float(earned))}, execution_count=1
            ),
        ]
    return notebook


def release_source(course: Course, assignment: str) -> Notebook:
    """The release with its metadata."""
    path = course.source / assignment / f"{assignment}.ipynb"
    return nbformat.read(path, as_version=4)


def save(notebook: Notebook, path: Path) -> None:
    """Write a notebook, whole or not at all."""
    write(path, nbformat.writes(notebook) + "\n")
