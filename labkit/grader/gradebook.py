"""nbgrader's gradebook: one writer, who changes the automatic scores and nothing else.

Manual grades and comments stay; formgrader finds a notebook to open for every submission.
"""

from __future__ import annotations

import copy
import fcntl
import logging
import os
import re
import sys
import warnings
from collections.abc import Iterable, Iterator, Mapping, Set
from contextlib import contextmanager
from itertools import groupby
from pathlib import Path
from typing import Any

import nbformat
from nbgrader.preprocessors import NbGraderPreprocessor
from sqlalchemy.exc import DatabaseError, OperationalError, SAWarning

from ..course.authoring.layout import Course
from ..course.messages import summary
from ..course.notebook import (
    Notebook,
    by_hand,
    grade_id,
    kind,
    nbgrader_info,
    question_of,
    read_cells,
    words_of,
)
from ..errors import LabkitError
from .clean import clean_line
from .each import Failure, for_student
from .files import write
from .results import Answer, Result
from .rules import FILE as RULES
from .rules import read_rules
from .submission import read_stamp, read_time


def record(course: Course, assignment: str, results: Iterable[Result]) -> list[str | Failure]:
    """Write results into the gradebook, and a notebook for each; each student separately.

    Args:
        course: The course.
        assignment: The assignment.
        results: The results of its students.

    Returns:
        Sentences on what a person should look at, and a failure for each student not written.

    Raises:
        LabkitError: The gradebook does not know the assignment, or cannot be used.
    """
    said: list[str | Failure] = []
    source = release_source(course, assignment)
    with open_gradebook(course) as book:
        if assignment not in {known.name for known in book.assignments}:
            raise LabkitError(
                f"{assignment} is missing from the gradebook; type: labkit release {assignment}"
            )
        for result in results:
            about = (course, book, source, result)
            done = for_student(result.student, _record, *about, of_all=(OperationalError,))
            if isinstance(done, Failure):
                book.db.rollback()
            said += [done] if isinstance(done, Failure) else done
        apply_rules(course, book, assignment)
    return said


def apply_rules(course: Course, book: Any, assignment: str) -> None:
    """Update due date, extensions and penalties in the gradebook to the present rules.

    If the file has no due date, the one that was set in formgrader counts.

    Raises:
        LabkitError: The rules cannot be used.
    """
    rules = read_rules(course)
    due = rules.due(assignment)
    for submission in book.assignment_submissions(assignment):
        if due is not None:
            submission.assignment.duedate = due.replace(tzinfo=None)
        if submission.assignment.duedate is None:
            submission.extension = None  # nbgrader would add it to no date, which raises TypeError
        elif (course.root / RULES).exists():
            submission.extension = rules.longer(submission.student.id, assignment)
        late = submission.total_seconds_late
        for notebook in submission.notebooks:
            taken = rules.late.penalty(notebook.score, late)
            notebook.late_submission_penalty = taken or None
    book.db.commit()


def _record(course: Course, book: Any, source: Notebook, result: Result) -> list[str]:
    """Write one student's scores, whole or not at all, and then the notebook.

    Returns:
        What a person should look at.
    """
    assignment, student = result.assignment, result.student
    notebook = _written_down(source, result)
    text = nbformat.writes(notebook) + "\n"
    stated = read_stamp(course.submitted / student / assignment)
    when = read_time(stated)
    notes = []
    if stated and when is None:
        says = f"timestamp.txt says {stated[:40]!r}, which is not a time; counted as in time"
        notes.append(f"{student}: {says}")
    book.update_or_create_student(student)
    submission = book.update_or_create_submission(assignment, student, timestamp=when)
    path = course.root / "autograded" / student / assignment / f"{assignment}.ipynb"
    scores = _automatic_scores(notebook, result)
    notes += _write_scores(submission, result, scores, _changed(path, notebook))
    book.db.commit()  # before the file: the next try must see again which answers have changed
    write(path, text)
    return notes


def _changed(path: Path, notebook: Any) -> set[str]:
    """Cells marked by hand whose text has changed since they were last recorded."""
    try:
        before = {grade_id(cell): cell["source"] for cell in read_cells(path)}
    except LabkitError:
        return set()
    cells = {grade_id(cell): cell.source for cell in notebook.cells if by_hand(cell)}
    return {name for name, text in cells.items() if before.get(name, text) != text}


@contextmanager
def open_gradebook(course: Course) -> Iterator[Any]:
    """Open the gradebook as nbgrader sees it; after an error nothing is half written.

    A second process that opens the gradebook waits until the first has closed it.

    Raises:
        LabkitError: The file is damaged, or cannot be read or written now.
    """
    course.build.mkdir(parents=True, exist_ok=True)
    try:
        with (
            open(course.build / ".gradebook", "w") as writer,
            quiet_database(),
            nbgrader_api(course).gradebook as book,
        ):
            fcntl.flock(writer, fcntl.LOCK_EX)
            (course.root / "gradebook.db").chmod(0o600)
            try:
                yield book
            except BaseException:
                book.db.rollback()
                raise
    except DatabaseError as error:
        raise LabkitError(
            f"gradebook.db: {error.orig}; correct that, or restore a copy of the file, which has "
            "the marks given by hand"
        ) from None


@contextmanager
def quiet_database() -> Iterator[None]:
    """Suppress SQLAlchemy's warnings about nbgrader's queries, which labkit cannot change."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", category=SAWarning)
        yield


def _automatic_scores(notebook: Any, result: Result) -> dict[str, float | None]:
    """The automatic score of each cell of the gradebook; None for what a person must mark.

    An answer that is unchanged or in which a reader sees no word earns 0.

    Args:
        notebook: The submission in the release's form.
        result: The result of the submission.
    """
    from nbgrader.utils import determine_grade

    earned = {q.verdict.name: float(q.verdict.earned) for q in result.questions}
    found: dict[str, float | None] = {}
    for cell in notebook.cells:
        name = grade_id(cell)
        if nbgrader_info(cell).get("task"):
            found[name] = 0.0 if result.rejected else None
        elif by_hand(cell):
            written = len(cell.source) > 5000 or words_of(cell.source)
            found[name] = determine_grade(cell)[0] if written else 0.0
        elif nbgrader_info(cell).get("grade"):
            found[name] = earned.get(question_of(name), 0.0)
    return found


def _write_scores(
    submission: Any, result: Result, scores: Mapping[str, float | None], changed: Set[str]
) -> Iterator[str]:
    """Write automatic scores; marks by hand stay, to be looked at again after a change."""
    missing = 0.0 if result.rejected else None
    for notebook in submission.notebooks:
        for grade in notebook.grades:
            score, given = scores.get(grade.name, missing), grade.manual_score
            other = score is not None and grade.auto_score not in {None, score}
            if given is None:
                grade.needs_manual_grade = score is None
            elif grade.name in changed or other or grade.needs_manual_grade:
                grade.needs_manual_grade = True
                says = f"{question_of(grade.name)} was marked {given:g} by hand, and the answer or "
                says += "its points have changed since; look at it again"
                yield f"{result.student}: {says}"
            grade.auto_score = score


def _written_down(source: Notebook, result: Result) -> Notebook:
    """A submission in the release's form, for people to read and for nbgrader's marks.

    It has the release's cells with the student's answers in them, the student's own cells, and the
    verdicts as outputs of the checks.

    Args:
        source: The release, from nbgrader's source folder.
        result: The result of the submission.
    """
    notebook = copy.deepcopy(source)
    answers = {answer.verdict.name: answer for answer in result.questions}
    extra: dict[str, list[Any]] = {}
    for number, own in enumerate(result.own):
        code = own["type"] == "code"
        make: Any = nbformat.v4.new_code_cell if code else nbformat.v4.new_markdown_cell
        text = own["source"] if code else _as_typed(own["source"])
        extra.setdefault(own["after"], []).append(make(text, id=f"own-{number:04d}"))
    for cell in notebook.cells:
        name = grade_id(cell)
        answer = answers.get(question_of(name))
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
        if by_hand(cell):
            text = result.written.get(name, cell.source)
            if not nbgrader_info(cell)["task"] and text.split() != cell.source.split():
                cell.source = text  # a space more or less is not yet an answer
        elif kind(cell) == "answer":
            cell.source = answer.source if answer else ""
        elif nbgrader_info(cell).get("grade"):
            cell.execution_count, cell.outputs = 1, list(_outputs(answer, result.rejected))
    notebook.cells = extra.get("", []) + [
        one for cell in notebook.cells for one in (cell, *extra.get(cell["id"], []))
    ]
    return notebook


def _outputs(answer: Answer | None, rejected: str) -> Iterator[Any]:
    """What a check says, and the points in the form that nbgrader reads."""
    lines, earned = [rejected], 0.0
    if answer:
        lines = [*summary(answer.verdict), *(f"  Note: {note}." for note in answer.notes)]
        earned = float(answer.verdict.earned)
    yield nbformat.v4.new_output("stream", name="stdout", text="\n".join(lines) + "\n")
    points = {"text/plain": repr(earned)}
    yield nbformat.v4.new_output("execute_result", points, execution_count=1)


def _as_typed(source: str) -> str:
    """What a student typed as a block of text, in which no page finds markup to obey."""
    runs = [len([*run]) for tick, run in groupby(source) if tick == "`"]
    fence = "`" * (max(runs, default=0) + 3)
    return f"{fence}markdown\n{source}\n{fence}"


def release_source(course: Course, assignment: str) -> Notebook:
    """The release as graders have it; what students write in is as they were given it.

    Raises:
        LabkitError: A file of the release is damaged.
    """
    try:
        source, given = (
            nbformat.read(folder / assignment / f"{assignment}.ipynb", as_version=4)
            for folder in (course.source, course.release)
        )
    except (OSError, ValueError, nbformat.ValidationError) as error:
        why = clean_line(str(error), 80)
        says = f"the release of {assignment} is damaged: {why}; type: labkit release {assignment}"
        raise LabkitError(says) from None
    blank = {grade_id(cell): cell for cell in given.cells}
    for cell in source.cells:
        if nbgrader_info(cell).get("solution"):
            cell.source, cell.metadata = (blank[grade_id(cell)][x] for x in ("source", "metadata"))
    return source


def nbgrader_api(course: Course) -> Any:
    """The interface of nbgrader, configured by ``nbgrader_config.py``.

    Raises:
        LabkitError: That file cannot be run.
    """
    from nbgrader.apps import NbGraderAPI
    from nbgrader.coursedir import CourseDirectory
    from traitlets.config import Config
    from traitlets.config.loader import PyFileConfigLoader

    here = str(Path(sys.executable).parent)  # nbgrader calls programs that lie beside Python
    if here not in os.environ["PATH"].split(os.pathsep):
        os.environ["PATH"] = os.pathsep.join([here, os.environ["PATH"]])
    try:
        config = PyFileConfigLoader(_CONFIG, path=str(course.root)).load_config()
    except (Exception, SystemExit) as error:  # it is a program that the instructor wrote
        why = clean_line(f"{type(error).__name__}: {error}")
        says = f"{_CONFIG}, which reads {RULES}, cannot be run: {why}; correct it"
        raise LabkitError(says) from None
    settings = Config(config)
    settings.CourseDirectory.root = str(course.root)
    settings.Application.log_level = logging.CRITICAL
    return NbGraderAPI(CourseDirectory(config=settings), config=settings)


_CONFIG = "nbgrader_config.py"


def reason(result: dict[str, Any]) -> str:
    """Why nbgrader failed: the last exception in its log, or else the log's last line."""
    lines = [x for x in f"{result.get('log', '')}\n{result.get('error', '')}".splitlines() if x]
    errors = [x.strip() for x in lines if re.match(r"\s*[\w.]+(Error|Exception)\b", x)]
    return clean_line((errors or lines or ["nbgrader gave no reason"])[-1])


class Refused(NbGraderPreprocessor):  # type: ignore[misc]
    """Refuses nbgrader's own autograde, which would run students' code in its own process.

    Its own feedback is refused as well, which would take the place of labkit's pages.
    """

    def preprocess(self, nb: Any, resources: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
        """Raise a LabkitError."""
        name = resources["nbgrader"]["assignment"]
        raise LabkitError(f"type: labkit grade {name}, and then: labkit feedback {name}")
