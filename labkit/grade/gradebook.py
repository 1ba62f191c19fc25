"""nbgrader's gradebook: one writer, who changes the automatic scores and nothing else.

Manual grades and comments stay; formgrader finds a notebook to open for every submission.
"""

from __future__ import annotations

import fcntl
import logging
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from datetime import datetime
from typing import Any

from ..errors import LabkitError
from .course import Course
from .engines import nbgrader_api
from .results import Bundle, Result
from .written import in_release_form, release_source, save, with_verdicts


def record(course: Course, assignment: str, results: Iterable[Result]) -> list[str]:
    """Write results into the gradebook, the scores of all or of none, and a notebook for each.

    Args:
        course: The course.
        assignment: Which.
        results: Of its students.

    Returns:
        What a person should look at, a sentence each.

    Raises:
        LabkitError: The gradebook does not know the assignment.
    """
    source, notes = release_source(course, assignment), []
    late = _late_rule(course)
    with open_gradebook(course) as book:
        if assignment not in {known.name for known in book.assignments}:
            seed = Bundle.of(course, assignment).data["seed"]
            raise LabkitError(
                f"the gradebook does not know {assignment}, as if it were a new one; type: "
                f"labkit release {assignment} --seed {seed}"
            )
        submissions = []
        for result in results:  # first: with each of these nbgrader commits what was done before
            when, note = timestamp(course, result)
            notes += [f"{result.student}: {note}"] if note else []
            book.update_or_create_student(result.student)
            known = {} if when is None else {"timestamp": when}
            made = book.update_or_create_submission(assignment, result.student, **known)
            submissions.append((made, result))
        for submission, result in submissions:
            notes += _write_scores(submission, result)
            submission.late_submission_penalty = None
            for notebook in submission.notebooks:
                notebook.late_submission_penalty = late(result.student, notebook, submission)
            book.db.flush()
            written = with_verdicts(in_release_form(source, result), result)
            folder = course.root / "autograded" / result.student / assignment
            save(written, folder / f"{assignment}.ipynb")
        book.db.commit()
    return notes


def comments(course: Course, assignment: str) -> dict[str, dict[str, str]]:
    """What was written by hand: by student, then by question."""
    found: dict[str, dict[str, str]] = {}
    with open_gradebook(course) as book:
        for submission in book.assignment_submissions(assignment):
            said = {c.name: c.manual_comment for n in submission.notebooks for c in n.comments}
            found[str(submission.student.id)] = {k: v for k, v in said.items() if v}
    return found


@contextmanager
def open_gradebook(course: Course) -> Iterator[Any]:
    """The gradebook as nbgrader sees it; whatever is wrong, nothing is written by halves.

    A second one, in another terminal, waits until the first is closed.
    """
    course.build.mkdir(parents=True, exist_ok=True)
    with (
        open(course.build / ".gradebook", "w") as writer,
        quiet_database(),
        nbgrader_api(course).gradebook as book,
    ):
        fcntl.flock(writer, fcntl.LOCK_EX)
        try:
            yield book
        except BaseException:
            book.db.rollback()
            raise


@contextmanager
def quiet_database() -> Iterator[None]:
    """Keep back what SQLAlchemy warns of in nbgrader's queries; nobody here can change them."""
    from sqlalchemy.exc import SAWarning

    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", category=SAWarning)
        yield


def timestamp(course: Course, result: Result) -> tuple[datetime | None, str]:
    """When a submission came in, as whoever collected it says; and a note if that is unreadable."""
    from dateutil.parser import parse

    path = course.submitted / result.student / result.assignment / "timestamp.txt"
    if path.is_symlink() or not path.is_file() or path.stat().st_size > 200:
        return None, ""
    text = path.read_text(encoding="utf-8", errors="replace").strip()
    try:
        return parse(text), ""
    except (ValueError, OverflowError):
        return None, f"timestamp.txt says {text[:40]!r}, which is no time; counted as in time"


def _write_scores(submission: Any, result: Result) -> Iterator[str]:
    earned = {f"{q['name']}-check": q["earned"] for q in result.questions}
    for notebook in submission.notebooks:
        for grade in notebook.grades:
            score = float(earned.get(grade.name, 0.0))
            by_hand = grade.manual_score is not None
            if by_hand and grade.auto_score not in {None, score}:
                yield (
                    f"{result.student}: {grade.name} was marked {grade.manual_score:g} by hand and "
                    f"is {score:g} now by itself; look at it again"
                )
                grade.needs_manual_grade = True
            elif not by_hand:
                grade.needs_manual_grade = False
            grade.auto_score = score


def _late_rule(course: Course) -> Any:
    """The course's own rule for late work, from nbgrader's settings."""
    from nbgrader.plugins import LateSubmissionPlugin
    from traitlets.utils.importstring import import_item

    config = nbgrader_api(course).config
    chosen = config.get("AssignLatePenalties", {}).get("plugin_class", LateSubmissionPlugin)
    plugin = (import_item(chosen) if isinstance(chosen, str) else chosen)(config=config)
    plugin.log.setLevel(logging.CRITICAL)

    def late(student: str, notebook: Any, submission: Any) -> float | None:
        if submission.total_seconds_late <= 0:
            return None
        penalty: float | None = plugin.late_submission_penalty(
            student, notebook.score, submission.total_seconds_late
        )
        return penalty

    return late
