"""Explain why an answer has its mark, with the numbers of the hidden case that decided.

The answer is tried once more in a sandbox, and the details of hidden cases are shown.  They are for
the instructor only.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..course.authoring.bundle import Bundle
from ..course.authoring.layout import Course
from ..course.messages import summary, test_line, wrapped
from ..course.serialize import question_data
from ..course.verdict import Outcome
from ..errors import LabkitError, UnknownName
from .feedback import page
from .files import write
from .grade import grade
from .marks import Mark, MarkLine, marks_of
from .plan import imports
from .results import Result
from .sandbox.launch import Isolation
from .sandbox.limits import Limits, slowness
from .submission import Submission, none_of
from .worker import in_sandbox

_PRIVATE = "this page shows hidden cases, so it is for instructors and not for students"


def explain(course: Course, assignment: str, student: str, question: str) -> str:
    """Explain to the instructor why an answer has its mark.

    The answer is tried again with all hidden cases shown, and a page is written with any numbers
    and runs of it.

    Args:
        course: The course.
        assignment: The assignment.
        student: The student who gave the answer.
        question: The name of the question.

    Raises:
        UnknownName: No question of this name was released.
        LabkitError: There is no mark to explain.
        NoIsolation: No sandbox can be made on this machine.
    """
    bundle = Bundle.of(course, assignment)
    by_hand = [cell["grade_id"] for cell in bundle.data["cells"] if "points" in cell]
    if question in by_hand:
        raise LabkitError(f"a person marks {question}, in formgrader: Manual Grading, {assignment}")
    asked = [q.name for q in bundle.questions]
    if question not in asked:
        raise UnknownName("question", question, [*asked, *by_hand])
    mark = next(iter(marks_of(course, assignment, student)), None)
    if mark is None or mark.result is None:
        why = (mark and mark.missing) or none_of(course, assignment, student)
        raise LabkitError(f"there is no mark to explain: {why}")
    if mark.result.rejected:
        raise LabkitError(f"{assignment} of {student} was rejected: {mark.result.rejected}")
    return "\n".join(_explained(course, bundle, question, mark, mark.result))


def _explained(
    course: Course, bundle: Bundle, name: str, mark: Mark, result: Result
) -> Iterator[str]:
    """What there is to say about an answer, part by part."""
    student = mark.student
    before = next(x for x in result.questions if x.verdict.name == name)
    how = Isolation.of(result.isolation)
    again = _grade_again(course, student, _with_cases_public(bundle, name), how)
    was, now = before.verdict, again.questions[0].verdict
    (line,) = lines = tuple(line for line in mark.lines if line.name == name) or (
        MarkLine(name, was.points, was.earned),
    )
    given = "no mark" if line.score is None else f"{line.score:g}"
    origin = f" ({line.origin})" if line.origin else ""
    yield f"{student}, {name}: {given} of {line.points:g}{origin}"
    yield "\nWhat the student has read, and may be shown:"
    yield from (wrapped(f"Note: {note}.") for note in before.notes)
    yield from map(wrapped, summary(was))
    hidden = {test.name for test in was.tests if test.hidden}
    if now.earned != was.earned:
        says = "Since this mark was made, the release or labkit has changed: now it earns"
        yield "\n" + wrapped(f"{says} {now.earned:g} of {now.points:g}.")
    elif hidden:
        yield "\nThe hidden case that decided; do not show it before the term ends:"
        yield from (wrapped(f"  {test_line(x, now)}") for x in now.tests if x.name in hidden)
    elif was.outcome in (Outcome.WRONG, Outcome.ERROR):
        yield "\nThe tests that the student has seen decided this mark; no hidden case did."
    if line.comment:
        yield f"\nComment: {line.comment}"
    yield f"\nThe answer:\n{before.source or '(none)'}"
    file = course.build / "explain" / student / f"{name}.html"
    head = replace(mark, lines=lines, penalty=0.0, late="", raw=line.score, points=line.points)
    write(file, page(replace(again, notes=(*again.notes, _PRIVATE)), head))
    yield f"\nThe same as a page, with any numbers and runs, for you only: {file}"


def _with_cases_public(bundle: Bundle, name: str) -> Bundle:
    """A bundle with one question only, all of whose cases are public."""
    question = next(q for q in bundle.questions if q.name == name)
    tests = tuple(
        replace(test, cases=tuple(replace(case, hidden=False) for case in test.cases))
        for test in question.tests
    )
    return Bundle({**bundle.data, "questions": [question_data(replace(question, tests=tests))]})


def _grade_again(course: Course, student: str, bundle: Bundle, how: Isolation) -> Result:
    """Grade the questions of a bundle in a submission, without storing the result."""
    submission = Submission.of(course, bundle.data["assignment"], student)
    data, note, why = submission.read()
    if why:
        raise LabkitError(why)

    limits = Limits().scaled(slowness())
    return in_sandbox(
        lambda sandbox: grade(data, student, bundle, sandbox, limits, note),
        course,
        imports(bundle.data["cells"]),
        how,
    )
