"""Update the gradebook for a release with other questions after students have handed in."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from ...course.authoring.layout import Course
from ...course.notebook import grade_id, nbgrader_info, question_of
from ...errors import LabkitError
from .gradebook import open_gradebook


def migrate(course: Course, assignment: str, source: Any) -> list[str]:
    """Update the gradebook's cells to a new release after students have handed in.

    nbgrader's ``SaveCells`` refuses such a release, "Cannot add or remove cells for notebook ...
    because there are submissions associated with it", rather than lose marks.  Here the cells that
    are new get their rows, empty ones in every submission, and those that are gone lose theirs; a
    mark or a comment that somebody wrote by hand is never lost.  Where the full points change,
    marks given by hand wait for another look.

    Args:
        course: The course.
        assignment: The assignment.
        source: The new release's notebook, with its metadata.

    Returns:
        The questions that are new to students who have handed in; none if nobody has.

    Raises:
        LabkitError: A question that was marked or commented on by hand would be deleted.
    """
    from nbgrader.api import GradeCell, MissingEntry, SolutionCell, SourceCell, TaskCell

    cells = {grade_id(cell): (cell, nbgrader_info(cell)) for cell in source.cells if grade_id(cell)}
    graded = {k: pair for k, pair in cells.items() if pair[1]["grade"] or pair[1]["task"]}
    solved = {name for name, pair in cells.items() if pair[1]["solution"]}
    with open_gradebook(course) as book:
        try:
            notebook = book.find_notebook(assignment, assignment)
        except MissingEntry:
            return []
        if not notebook.submissions:
            return []
        there = [*notebook.grade_cells, *notebook.task_cells]
        gone = [c for c in there if c.name not in graded]
        gone += [c for c in notebook.solution_cells if c.name not in solved]
        _keep_what_was_written(gone)
        for cell in gone:
            for row in [*(cell.grades or ()), *(cell.comments or ())]:
                book.db.delete(row)
            book.db.delete(cell)
        for cell in notebook.source_cells:
            if cell.name not in cells:
                book.db.delete(cell)
        for cell in there:
            if cell.name in graded and float(graded[cell.name][1]["points"]) != cell.max_score:
                for grade in cell.grades:
                    grade.needs_manual_grade |= grade.manual_score is not None
        new = sorted(set(graded) - {c.name for c in there})
        for name in new:
            cell, known = graded[name]
            points = float(known["points"])
            kind = cell.cell_type
            row = TaskCell if known["task"] else GradeCell
            add = row(name=name, notebook=notebook, max_score=points, cell_type=kind)
            _add(book.db, add, notebook.submissions)
        for name in solved - {c.name for c in notebook.solution_cells}:
            _add(book.db, SolutionCell(name=name, notebook=notebook), notebook.submissions)
        for name in set(cells) - {c.name for c in notebook.source_cells}:
            kind = cells[name][0].cell_type
            book.db.add(SourceCell(name=name, notebook=notebook, cell_type=kind))
        book.db.commit()
    return [question_of(name) for name in new]


def _add(db: Any, cell: Any, submissions: Iterable[Any]) -> None:
    """Add a cell, with an empty row for it in every submission."""
    from nbgrader.api import Comment, Grade, GradeCell, SolutionCell

    db.add(cell)
    db.flush()
    rows = [Grade] * (not isinstance(cell, SolutionCell))
    rows += [Comment] * (not isinstance(cell, GradeCell))
    db.add_all([row(cell_id=cell.id, notebook=x) for row in rows for x in submissions])


def _keep_what_was_written(gone: Iterable[Any]) -> None:
    for cell in gone:
        marked = [g for g in cell.grades or () if g.manual_score is not None or g.extra_credit]
        said = [c for c in cell.comments or () if c.manual_comment]
        if marked or said:
            name = question_of(cell.name)
            raise LabkitError(
                f"{name} would go, with {len(marked) + len(said)} marks or comments given by hand; "
                "keep the question and give it 0 points"
            )
