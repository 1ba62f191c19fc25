"""Explain: why one answer has its mark, with the numbers of the hidden case that decided.

The answer runs once more in a sandbox, and the hidden cases with it; what comes of that is for the
instructor alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import Course
from ...course.bugs import Found, Telling
from ...course.forms import Measured
from ...course.messages import summary, wrapped
from ...course.messages import test_line as of_test
from ...course.own_arm import DEMO
from ...course.serialize import question_data
from ...course.source import parsed
from ...course.verdict import Outcome
from ...errors import LabkitError, UnknownName
from ..atomic import write
from ..grading.grade import PUBLIC_ARM, grade
from ..grading.plan import imports
from ..grading.results import Result
from ..grading.worker import in_sandbox
from ..marks.mark import Mark, MarkLine
from ..marks.table import marks_of
from ..sandbox.launch import Sandbox
from ..sandbox.limits import Limits, slowness
from ..submission import Submission, none_of
from .page import page

_ALONE = "all cases are laid open here, so this page is for instructors and not for students"


def explain(course: Course, student: str, question: str, assignment: str | None = None) -> str:
    """Why an answer has its mark, for the instructor; nothing is run that a person marks.

    Any other answer is tried again with every hidden case laid open, and a page is written with its
    numbers and runs.

    Args:
        course: The course.
        student: Whose.
        question: Which.
        assignment: Where, if questions of several assignments have this name.

    Raises:
        UnknownName: No such question was released.
        LabkitError: There is no mark to explain.
        NoIsolation: No sandbox can be made here.
    """
    bundle = _bundle(course, question, assignment)
    name, by_hand = bundle.data["assignment"], question in _by_hand(bundle)
    everybody = marks_of(course, name, None if by_hand else student)  # a team's mark is for all
    mark = next((one for one in everybody if one.student == student), None)
    if mark is None or mark.result is None:
        why = (mark and mark.missing) or none_of(course, name, student)
        raise LabkitError(f"there is no mark to explain: {why}")
    if mark.result.rejected:
        raise LabkitError(f"{name} of {student} was rejected: {mark.result.rejected}")
    if by_hand:
        return "\n".join(_by_a_person(name, question, mark, mark.result))
    return "\n".join(_by_the_grader(course, bundle, question, mark, mark.result))


def _by_a_person(assignment: str, question: str, mark: Mark, result: Result) -> Iterator[str]:
    """Why an answer that a person marks has its mark."""
    line = next((line for line in mark.lines if line.name == question), None)
    if line is None:
        raise LabkitError(f"there is no mark to explain: {mark.missing}")
    where = f"in formgrader: Manual Grading, {assignment}, Show All Names"
    says = f"A person marks it, {where}."
    if line.automatic == 0.0:
        says = f"It was left blank or as it was handed out. If it earns more, give it {where}."
    elif line.automatic is not None:
        says = (
            "This why is not one of those that are drawn for a person to mark, so it has its "
            f"points for being there. A mark that you give counts instead, {where}."
        )
    yield _head(mark, line)
    yield wrapped(says)
    if line.comment:
        yield f"\nComment: {line.comment}"
    yield f"\nThe answer:\n{result.written.get(question) or '(none)'}"


def _by_the_grader(
    course: Course, bundle: Bundle, question: str, mark: Mark, result: Result
) -> Iterator[str]:
    """Why an answer that was tried has its mark."""
    student = mark.student
    before = next((x for x in result.questions if x.verdict.name == question), None)
    if before is None:
        name = bundle.data["assignment"]
        raise LabkitError(f"{question} is newer than the mark; type: labkit grade {name}")
    shown = before.verdict
    again = _again(course, student, _laid_open(bundle.of_student(student), question))
    now = again.questions[0].verdict
    lines = tuple(line for line in mark.lines if line.name == question)
    line = lines[0] if lines else MarkLine(question, shown.points, shown.earned)
    yield _head(mark, line)
    yield from map(wrapped, _judged(bundle, student, question, result))
    yield "\nWhat the student has read, and may be shown:"
    yield from (wrapped(f"Note: {note}.") for note in before.notes)
    yield from map(wrapped, summary(shown))
    hidden = {test.name for test in shown.tests if test.hidden}
    now_hash = bundle.of_student(student).data["hash"]
    changed = "the release" * (now_hash != result.hashes["bundle"])
    changed = changed or "labkit" * (again.hashes["engine"] != result.hashes["engine"])
    as_before = (shown.right, shown.earned) == (now.right, now.earned)
    if shown.outcome is Outcome.NOT_ATTEMPTED:
        pass  # no case decided it
    elif hidden:
        if not changed or (as_before and changed == "labkit"):
            yield "\nThe hidden case that decided; do not show it before the term ends:"
            yield from (wrapped(f"  {of_test(test)}") for test in now.tests if test.name in hidden)
    elif shown.outcome is Outcome.NOT_COUNTED:
        pass  # the tool that it uses did
    elif not shown.right:
        yield "\nThe tests that the student has seen decided this mark; no hidden case did."
    if not as_before:
        says = "ATTENTION: this time it came out otherwise:"
        if changed:
            says = (
                f"Since this mark was made {changed} has changed: now the answer earns "
                f"{now.earned:g} of {now.points:g}. If that is to count, type: labkit grade "
                f"{result.assignment} --student {student}, and with --lower if the mark is kept"
            )
        yield "\n" + wrapped(says)
        yield from map(wrapped, summary(now))
    if line.comment:
        yield f"\nComment: {line.comment}"
    yield f"\nThe answer:\n{_where_it_breaks(before.source) or '(none)'}"
    file = course.build / "explain" / student / f"{question}.html"
    head = replace(mark, lines=lines, penalty=0.0, late="", raw=line.score, points=line.points)
    write(file, page(replace(again, notes=(*again.notes, _ALONE)), head))
    yield f"\nNumbers and runs, for you alone: {file}"


def _where_it_breaks(source: str) -> str:
    """An answer; if Python cannot read it, the error is beside its line."""
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


def _head(mark: Mark, line: MarkLine) -> str:
    """Whose mark for what, and where it comes from."""
    given = "no mark" if line.score is None else f"{line.score:g}"
    origin = f" ({line.origin})" if line.origin else ""
    return f"{mark.student}, {line.name}: {given} of {line.points:g}{origin}"


def _judged(bundle: Bundle, student: str, name: str, result: Result) -> Iterator[str]:
    """By which arm a question about one's own is judged, and how near a number has to be."""
    judge = next(q.judge for q in bundle.questions if q.name == name)
    if isinstance(judge, Measured | Found | Telling):
        given = bundle.arms.arm(student) is not None
        arm = f"the arm that the course gave {student}" if given else f'the public arm "{DEMO}"'
        near = f", within {judge.tolerance:g} {judge.unit}" if isinstance(judge, Measured) else ""
        yield f"Judged by {arm}{near}."
        yield from (note for note in result.notes if note == PUBLIC_ARM)


def _laid_open(bundle: Bundle, name: str) -> Bundle:
    """One question of a bundle, every case of it public."""
    question = next(q for q in bundle.questions if q.name == name)
    tests = tuple(
        replace(test, cases=tuple(replace(case, hidden=False) for case in test.cases))
        for test in question.tests
    )
    return Bundle({**bundle.data, "questions": [question_data(replace(question, tests=tests))]})


def _again(course: Course, student: str, bundle: Bundle) -> Result:
    """Grade what a bundle asks of a submission, and keep nothing of it."""
    submission = Submission.of(course, bundle.data["assignment"], student)
    data, note, why = submission.read()
    if why:
        raise LabkitError(why)

    def again(sandbox: Sandbox) -> Result:
        return grade(data, student, bundle, sandbox, Limits().scaled(slowness()), note)

    return in_sandbox(again, course, imports(bundle.data["cells"]))


def _bundle(course: Course, question: str, assignment: str | None) -> Bundle:
    """The bundle that has a question."""
    names = [assignment] if assignment else [x.stem for x in sorted(course.bundle.glob("*.json"))]
    bundles = [Bundle.of(course, name) for name in names]
    asked = [[*(q["name"] for q in b.data["questions"]), *_by_hand(b)] for b in bundles]
    here = [b for b, questions in zip(bundles, asked, strict=True) if question in questions]
    if not here:
        raise UnknownName("question", question, dict.fromkeys(chain(*asked)))
    if len(here) > 1:
        several = ", ".join(b.data["assignment"] for b in here)
        raise LabkitError(f"{several} have {question}; say which with --assignment")
    return here[0]


def _by_hand(bundle: Bundle) -> list[str]:
    """The questions that a person marks."""
    return [cell["grade_id"] for cell in bundle.data["cells"] if "points" in cell]
