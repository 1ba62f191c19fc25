"""Explain why an answer has its mark, with the numbers of the hidden case that decided.

The answer is tried once more in a sandbox, and the details of hidden cases are shown.  They are for
the instructor only.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..course.authoring.bundle import Bundle
from ..course.authoring.layout import Course
from ..course.judges import Found, Measured
from ..course.messages import summary, test_line, wrapped
from ..course.own_arm import DEMO
from ..course.serialize import question_data
from ..course.source import parsed
from ..course.verdict import Outcome
from ..errors import LabkitError, UnknownName
from .feedback import page
from .files import write
from .grade import grade
from .grading.worker import in_sandbox
from .marks import Mark, MarkLine, marks_of
from .plan import imports
from .results import Result
from .sandbox.launch import Sandbox
from .sandbox.limits import Limits, slowness
from .submission import Submission, none_of

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
    name, bundle = assignment, Bundle.of(course, assignment)
    asked = [q["name"] for q in bundle.data["questions"]]
    by_hand = [cell["grade_id"] for cell in bundle.data["cells"] if "points" in cell]
    if question in by_hand:
        raise LabkitError(f"a person marks {question}, in formgrader: Manual Grading, {name}")
    if question not in asked:
        raise UnknownName("question", question, [*asked, *by_hand])
    mark = next(iter(marks_of(course, name, student)), None)
    if mark is None or mark.result is None:
        why = (mark and mark.missing) or none_of(course, name, student)
        raise LabkitError(f"there is no mark to explain: {why}")
    if mark.result.rejected:
        raise LabkitError(f"{name} of {student} was rejected: {mark.result.rejected}")
    return "\n".join(_by_the_grader(course, bundle, question, mark, mark.result))


def _by_the_grader(
    course: Course, bundle: Bundle, question: str, mark: Mark, result: Result
) -> Iterator[str]:
    """Explain the mark of an answer that tests check."""
    student = mark.student
    before = next((x for x in result.questions if x.verdict.name == question), None)
    if before is None:
        name = bundle.data["assignment"]
        raise LabkitError(f"{question} is newer than the mark; type: labkit grade {name}")
    shown = before.verdict
    again = _grade_again(course, student, _with_cases_public(bundle.of_student(student), question))
    now = again.questions[0].verdict
    lines = tuple(line for line in mark.lines if line.name == question)
    line = lines[0] if lines else MarkLine(question, shown.points, shown.earned)
    yield _heading(mark, line)
    yield from map(wrapped, _judging_notes(bundle, student, question))
    yield "\nWhat the student has read, and may be shown:"
    yield from (wrapped(f"Note: {note}.") for note in before.notes)
    yield from map(wrapped, summary(shown))
    hidden = {test.name for test in shown.tests if test.hidden}
    made = bundle.of_student(student).data["hash"], again.hashes["engine"]
    if made != (result.hashes["bundle"], result.hashes["engine"]):
        earns = f"{now.earned:g} of {now.points:g}"
        says = f"Since this mark was made, the release or labkit has changed: now it earns {earns}."
        yield "\n" + wrapped(says)
    elif hidden and shown.outcome is not Outcome.NOT_ATTEMPTED:
        yield "\nThe hidden case that decided; do not show it before the term ends:"
        yield from (wrapped(f"  {test_line(x, now)}") for x in now.tests if x.name in hidden)
    elif shown.outcome in (Outcome.WRONG, Outcome.ERROR):
        yield "\nThe tests that the student has seen decided this mark; no hidden case did."
    if (shown.right, shown.earned) != (now.right, now.earned):
        yield "\nThis time the outcome was a different one:"
        yield from map(wrapped, summary(now))
    if line.comment:
        yield f"\nComment: {line.comment}"
    yield f"\nThe answer:\n{_with_syntax_error(before.source) or '(none)'}"
    file = course.build / "explain" / student / f"{question}.html"
    head = replace(mark, lines=lines, penalty=0.0, late="", raw=line.score, points=line.points)
    write(file, page(replace(again, notes=(*again.notes, _PRIVATE)), head))
    yield f"\nThe same as a page, with any numbers and runs, for you only: {file}"


def _with_syntax_error(source: str) -> str:
    """The text of an answer; if Python cannot read it, the error is beside its line."""
    try:
        parsed(source)
    except SyntaxError as error:
        lines, number = source.split("\n"), error.lineno or 1
        if number <= len(lines):
            lines[number - 1] += f"  <-- line {number}: {error.msg}"
        return "\n".join(lines)
    except (ValueError, RecursionError, MemoryError):
        pass
    return source


def _heading(mark: Mark, line: MarkLine) -> str:
    """A line with the student, the question, the mark and its origin."""
    given = "no mark" if line.score is None else f"{line.score:g}"
    origin = f" ({line.origin})" if line.origin else ""
    return f"{mark.student}, {line.name}: {given} of {line.points:g}{origin}"


def _judging_notes(bundle: Bundle, student: str, name: str) -> Iterator[str]:
    """The arm and the tolerance by which a question about one's own arm is judged, in words."""
    judge = next(q.judge for q in bundle.questions if q.name == name)
    if isinstance(judge, Measured | Found):
        given = bundle.arms.arm(student) is not None
        arm = f"the arm that the course gave {student}" if given else f'the public arm "{DEMO}"'
        near = f", within {judge.tolerance:g} {judge.unit}" if isinstance(judge, Measured) else ""
        yield f"Judged by {arm}{near}."


def _with_cases_public(bundle: Bundle, name: str) -> Bundle:
    """A bundle with one question only, all of whose cases are public."""
    question = next(q for q in bundle.questions if q.name == name)
    tests = tuple(
        replace(test, cases=tuple(replace(case, hidden=False) for case in test.cases))
        for test in question.tests
    )
    return Bundle({**bundle.data, "questions": [question_data(replace(question, tests=tests))]})


def _grade_again(course: Course, student: str, bundle: Bundle) -> Result:
    """Grade the questions of a bundle in a submission, without storing the result."""
    submission = Submission.of(course, bundle.data["assignment"], student)
    data, note, why = submission.read()
    if why:
        raise LabkitError(why)

    def again(sandbox: Sandbox) -> Result:
        return grade(data, student, bundle, sandbox, Limits().scaled(slowness()), note)

    return in_sandbox(again, course, imports(bundle.data["cells"]))
