"""nbgrader's gradebook: one writer, who changes the automatic scores and nothing else.

Manual grades and comments stay; formgrader finds a notebook to open for every submission.
"""

from __future__ import annotations

import fcntl
import warnings
from collections.abc import Iterable, Iterator, Mapping, Set
from contextlib import contextmanager, suppress
from datetime import datetime
from pathlib import Path
from typing import Any

from nbgrader.preprocessors import NbGraderPreprocessor
from sqlalchemy import text as sql
from sqlalchemy.exc import DatabaseError, OperationalError, SAWarning

from ...course.authoring.layout import Course
from ...course.notebook import by_hand, grade_id, nbgrader_info, question_of, read_cells, words_of
from ...errors import LabkitError
from ..atomic import write
from ..each import Failure, for_student
from ..grading.results import Result, Results
from ..nbgrader_api import nbgrader_api
from ..rules import apply_lateness
from ..submission import Submission, digest, read_stamp, read_time
from ..whys import credit_whys
from .autograded_notebook import as_text, in_release_form, release_source, with_verdicts


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
                f"the gradebook does not know {assignment}, as if it were a new one; type: "
                f"labkit release {assignment}"
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
    """Update the gradebook to the present rules: whys that nobody marks, and late work.

    Raises:
        LabkitError: The rules, or the term's record, cannot be used.
    """
    credit_whys(course, book, assignment)
    _update_times(course, book, assignment)
    apply_lateness(course, book, assignment)


def _update_times(course: Course, book: Any, assignment: str) -> None:
    """Set when each graded file was handed in, which may have become known since it was graded.

    A file that was put in its place since then has another time, and changes nothing.
    """
    results = Results(course, assignment)

    def update(submission: Any, files: Submission) -> None:
        text = read_stamp(files.folder)
        when = read_time(text)
        stated = when and when.replace(tzinfo=None)
        if (text and when is None) or stated == submission.timestamp:
            return
        result, (data, _, _) = results.get(files.student), files.read()
        if result is not None and result.hashes["submission"] == digest(data):
            submission.timestamp = stated

    for one in book.assignment_submissions(assignment):
        student = one.student.id  # whose failure is named where the work is graded
        for_student(student, update, one, Submission.of(course, assignment, student))


def _record(course: Course, book: Any, source: Any, result: Result) -> list[str]:
    """Write one student's scores, whole or not at all; nbgrader commits who the student is first.

    Returns:
        What a person should look at.
    """
    notebook = with_verdicts(in_release_form(source, result), result)
    written = as_text(notebook)
    when, note = timestamp(course, result)
    book.update_or_create_student(result.student)
    submission = book.update_or_create_submission(result.assignment, result.student, timestamp=when)
    notes = [f"{result.student}: {note}"] if note else []
    folder = course.root / "autograded" / result.student / result.assignment
    path = folder / f"{result.assignment}.ipynb"
    notes += _write_scores(
        submission, result, automatic_scores(notebook, result), _changed(path, notebook)
    )
    book.db.flush()
    before = path.read_bytes() if path.exists() else None
    write(path, written)
    try:
        book.db.commit()
    except BaseException:  # the next try must see again which answers have changed
        path.unlink() if before is None else write(path, before)
        raise
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
            if book.db.execute(sql("PRAGMA quick_check(1)")).scalar() != "ok":
                raise _damaged("parts of it are lost")
            with suppress(OSError):
                (course.root / "gradebook.db").chmod(0o600)
            try:
                yield book
            except BaseException:
                book.db.rollback()
                raise
    except OperationalError as error:
        raise LabkitError(
            f"gradebook.db: {error.orig}; correct that and type the same again"
        ) from None
    except DatabaseError as error:
        raise _damaged(error.orig) from None


def _damaged(why: object) -> LabkitError:
    return LabkitError(
        f"gradebook.db is damaged: {why}; restore a copy of it, which has the marks and comments "
        "given by hand. Without one, move the file away and type labkit release, then labkit grade "
        "for each assignment: automatic marks come back from results/"
    )


@contextmanager
def quiet_database() -> Iterator[None]:
    """Suppress SQLAlchemy's warnings about nbgrader's queries, which labkit cannot change."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", category=SAWarning)
        yield


def timestamp(course: Course, result: Result) -> tuple[datetime | None, str]:
    """When a submission was handed in, by the file beside it, and a note if that is unreadable."""
    text = read_stamp(course.submitted / result.student / result.assignment)
    when = read_time(text)
    bad = f"timestamp.txt says {text[:40]!r}, which is not a time; counted as in time"
    return when, bad if text and when is None else ""


def automatic_scores(notebook: Any, result: Result) -> dict[str, float | None]:
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
            found[name] = determine_grade(cell)[0] if words_of(cell.source) else 0.0
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
            name, why = question_of(grade.name), ""
            if given is None:
                grade.needs_manual_grade = score is None
            elif grade.name in changed:
                why = "the answer has changed since"
            elif score is not None and grade.auto_score not in {None, score}:
                why = f"the grader gives {score:g} now"
            elif grade.needs_manual_grade:
                why = "the answer, its full points or the grader's mark has changed since"
            if why:
                grade.needs_manual_grade = True
                says = f"was marked {given:g} by hand, and {why}; look at it again"
                yield f"{result.student}: {name} {says}"
            grade.auto_score = score


class Refused(NbGraderPreprocessor):  # type: ignore[misc]
    """Refuses nbgrader's own autograde, which would run students' code in its own process."""

    def preprocess(self, nb: Any, resources: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
        """Raise a LabkitError."""
        raise LabkitError(f"type: labkit grade {resources['nbgrader']['assignment']}")
