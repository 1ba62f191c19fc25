"""Explain: why one answer has its mark, with the numbers of the hidden case that decided.

The answer runs once more in a sandbox, and the hidden cases with it; what comes of that is for the
instructor alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

from ...course.bugs import Found, Telling
from ...course.bundle import Bundle
from ...course.forms import Measured
from ...course.layout import Course
from ...course.messages import line as of_test
from ...course.messages import summary, wrapped
from ...course.own_arm import DEMO
from ...course.serialize import question_data
from ...course.verdict import Outcome, Verdict
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

_ALONE = "all cases are laid open here, so this page is for teachers and not for students"


@dataclass(frozen=True)
class Explanation:
    """Why an answer has its mark.

    Attributes:
        mark: Of the whole submission.
        line: Of this question.
        told: The verdict that the student has seen.
        found: The verdict with hidden cases laid open.
        source: The student's answer.
        page: With the numbers and runs, for the instructor.
        judged: By which arm, and how near, where the question is about one's own.
    """

    mark: Mark
    line: MarkLine
    told: Verdict
    found: Verdict
    source: str
    page: Path
    judged: tuple[str, ...] = ()

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        yield _head(self.mark, self.line)
        yield from map(wrapped, self.judged)
        yield "\nWhat the student has read, and may be shown:"
        yield from map(wrapped, summary(self.told))
        hidden = {test.name for test in self.told.tests if test.hidden}
        if self.told.outcome is Outcome.NOT_ATTEMPTED:
            pass  # no case decided it
        elif hidden:
            yield "\nThe hidden case that decided; do not show it before the term ends:"
            tests = (test for test in self.found.tests if test.name in hidden)
            yield from (wrapped(f"  {of_test(test)}") for test in tests)
        elif not self.told.right:
            yield ("\nThe tests that the student has seen decided this mark; no hidden case did.")
        if (self.told.right, self.told.earned) != (self.found.right, self.found.earned):
            yield "\nATTENTION: this time it came out otherwise:"
            yield from map(wrapped, summary(self.found))
        if self.line.comment:
            yield f"\nComment: {self.line.comment}"
        yield f"\nThe answer:\n{self.source or '(none)'}"
        yield f"\nNumbers and runs, for you alone: {self.page}"


@dataclass(frozen=True)
class ByHand:
    """Why an answer that a person marks has its mark: the mark of the whole, and this line of it.

    Attributes:
        mark: Of the whole submission.
        line: Of this question.
        assignment: Where formgrader has it.
    """

    mark: Mark
    line: MarkLine
    assignment: str

    def __str__(self) -> str:
        where = f"in formgrader: Manual Grading, {self.assignment}, Show All Names"
        says = f"A person marks it, {where}."
        if self.line.automatic == 0.0:
            says = f"It was left blank or as it was handed out. If it earns more, give it {where}."
        elif self.line.automatic is not None:
            says = (
                "This why is not one of those that are drawn for a person to mark, so it has its "
                f"points for being there. A mark that you give counts instead, {where}."
            )
        written = self.mark.result.written.get(self.line.name) if self.mark.result else ""
        lines = [_head(self.mark, self.line), wrapped(says)]
        lines += [f"\nComment: {self.line.comment}"] * bool(self.line.comment)
        return "\n".join([*lines, f"\nThe answer:\n{written or '(none)'}"])


def _head(mark: Mark, line: MarkLine) -> str:
    """Whose mark for what, and where it comes from."""
    given = "no mark" if line.score is None else f"{line.score:g}"
    origin = f" ({line.origin})" if line.origin else ""
    return f"{mark.student}, {line.name}: {given} of {line.points:g}{origin}"


def explain(
    course: Course, student: str, question: str, assignment: str | None = None
) -> Explanation | ByHand:
    """Try an answer again with every hidden case laid open; nothing is run that a person marks.

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
        own = next((line for line in mark.lines if line.name == question), None)
        if own is None:
            raise LabkitError(f"there is no mark to explain: {mark.missing}")
        return ByHand(mark, own, name)
    told = next((x for x in mark.result.questions if x.verdict.name == question), None)
    if told is None:
        raise LabkitError(f"{question} is newer than the mark; type: labkit grade {name}")
    result = _again(course, student, _laid_open(bundle.of_student(student), question))
    (answer,) = result.questions
    file = course.build / "explain" / student / f"{question}.html"
    lines = tuple(line for line in mark.lines if line.name == question)
    notes = (*result.notes, _ALONE)
    line = lines[0] if lines else MarkLine(question, told.verdict.points, told.verdict.earned)
    shown = replace(mark, lines=lines, penalty=0.0, late="", raw=line.score, points=line.points)
    write(file, page(replace(result, notes=notes), shown))
    judged = _judged(bundle, student, question)
    if judged and PUBLIC_ARM in mark.result.notes:
        judged += (PUBLIC_ARM,)
    return Explanation(mark, line, told.verdict, answer.verdict, told.source, file, judged)


def _judged(bundle: Bundle, student: str, name: str) -> tuple[str, ...]:
    """By which arm a question about one's own is judged, and how near a number has to be."""
    judge = next(q.judge for q in bundle.questions if q.name == name)
    if not isinstance(judge, Measured | Found | Telling):
        return ()
    given = bundle.arms.arm(student) is not None
    arm = f"the arm that the course gave {student}" if given else f'the public arm "{DEMO}"'
    near = f", within {judge.tolerance:g} {judge.unit}" if isinstance(judge, Measured) else ""
    return (f"Judged by {arm}{near}.",)


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
    limits = Limits()
    submission = Submission.of(course, bundle.data["assignment"], student)
    data, note, why = submission.read(limits.notebook)
    if why:
        raise LabkitError(why)

    def again(sandbox: Sandbox) -> Result:
        return grade(data, student, bundle, sandbox, limits.scaled(slowness()), note)

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
