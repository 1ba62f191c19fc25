"""An assignment that has no notebook, in nbgrader's gradebook: the defence."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import nbformat

from ...course.authoring.layout import Course
from ..atomic import write
from .autograded_notebook import as_text


def enter_tasks(
    course: Course, book: Any, assignment: str, student: str, texts: Mapping[str, str], full: float
) -> list[Any]:
    """Make a submission of a student, with a manual task for each text that formgrader shows.

    Args:
        course: The course.
        book: Its gradebook.
        assignment: The assignment.
        student: The student.
        texts: The text of each task, by its name.
        full: Full marks for each task.

    Returns:
        The grades of the tasks, in order; those that were there before are kept.
    """
    cells = [_cell(name, text, full) for name, text in texts.items()]
    notebook = nbformat.v4.new_notebook(cells=cells)
    for folder in (course.source, course.root / "autograded" / student):
        write(folder / assignment / f"{assignment}.ipynb", as_text(notebook))
    book.update_or_create_assignment(assignment)
    book.update_or_create_notebook(assignment, assignment)
    for name in texts:
        about = {"cell_type": "markdown"}
        book.update_or_create_source_cell(name, assignment, assignment, **about)
        book.update_or_create_task_cell(name, assignment, assignment, max_score=full, **about)
    book.update_or_create_student(student)
    submission = book.update_or_create_submission(assignment, student)
    found = [grade for notebook in submission.notebooks for grade in notebook.grades]
    return sorted(found, key=lambda grade: list(texts).index(grade.name))


def _cell(name: str, text: str, full: float) -> Any:
    cell = nbformat.v4.new_markdown_cell(text, id=name.replace("_", "-"))
    cell.metadata.nbgrader = {
        "grade_id": name,
        "points": full,
        "grade": True,
        "solution": False,
        "task": True,
        "locked": False,
        "schema_version": 3,
    }
    return cell
