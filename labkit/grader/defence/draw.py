"""The defence: three of a student's own accepted functions, each with a mistake put into it.

The questions are drawn under the term's key, so each student has their own, which stay the same
when the page is printed again.  A mistake is used only if the question's checks reject the function
with it; if the question runs an arm, the arm must miss a limit.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import Course
from ...course.marking import try_public
from ...course.question import Call, Loop, Question, Tuned
from ...course.verdict import Outcome
from ...errors import LabkitError
from ..each import Failure
from ..grading import public_evidence
from ..grading.current_results import current_results
from ..grading.grade import parse
from ..grading.plan import imports, plan
from ..grading.results import Answer, Numbers, Run
from ..grading.worker import in_sandbox
from ..roster import read_roster
from ..sandbox.launch import Sandbox
from ..sandbox.limits import Limits, slowness
from ..sandbox.session import RemoteFunction, Session
from ..seeds import key_of
from ..submission import Submission, did_you_mean, is_name
from ..whys import rank
from .edits import Edit, edits

ASKED = 3
"""The number of questions in one defence."""
FULL = 3
"""The full marks for each question."""
TRIES = 3
"""The number of mistakes that are tried in a function."""


@dataclass(frozen=True)
class Accepted:
    """An answer that earned full marks.

    Attributes:
        bundle: The bundle of its assignment, for this student.
        question: The question.
        answer: The answer with its verdict.
        right: The names of all questions in this notebook that earned full marks.
    """

    bundle: Bundle
    question: Question
    answer: Answer
    right: tuple[str, ...]

    @property
    def assignment(self) -> str:
        """The name of its assignment."""
        return str(self.bundle.data["assignment"])

    @property
    def drives(self) -> bool:
        """Whether the question runs an arm with the answer."""
        return any(isinstance(c, Loop | Tuned) for t in self.question.tests for c in t.cases)


@dataclass(frozen=True)
class Asked:
    """One question of a defence.

    Attributes:
        of: The answer that the question is about.
        edit: The mistake, and the functions with it.
        run: The run of the arm with the mistake, if the question has one.
        own: The run of the arm with the answer as it was handed in.
        numbers: Otherwise, the numbers returned with the mistake and those expected.
    """

    of: Accepted
    edit: Edit
    run: Run | None
    own: Run | None
    numbers: Numbers | None

    @property
    def given(self) -> str:
        """The arguments of the law in its run besides state and target, such as "(kp=40.0)"."""
        tests = [t for t in self.of.question.tests if self.run and t.name == self.run["test"]]
        loops = [case for test in tests for case in test.cases if isinstance(case, Loop)]
        return Call((), loops[0].kwargs).shown("") if loops and loops[0].kwargs else ""


def draw(course: Course, student: str) -> tuple[Asked, ...]:
    """The questions of a student's defence; fewer where fewer answers can be asked about.

    Raises:
        LabkitError: There is no such student, nothing was handed in, or work is not graded.
        NoIsolation: No sandbox can be made here.
    """
    secret = partial(rank, key_of(course, "defence"), student)
    answers = sorted(
        accepted(course, student),
        key=lambda x: (not x.drives, secret(f"{x.assignment}/{x.question.name}")),
    )
    if not answers:
        return ()
    limits = Limits().scaled(slowness())

    def drawn(sandbox: Sandbox) -> tuple[Asked, ...]:
        found = (_ask(course, student, one, sandbox, limits) for one in answers)
        return tuple(islice(filter(None, found), ASKED))

    modules = {name: None for one in answers for name in imports(one.bundle.data["cells"])}
    return in_sandbox(drawn, course, tuple(modules))


def accepted(course: Course, student: str) -> Iterator[Accepted]:
    """A student's answers that earned full marks, and that a mistake can be put into.

    Raises:
        LabkitError: There is no such student, nothing was handed in, or work is not graded.
    """
    known(course, student)
    worked = False
    for name in sorted(path.stem for path in course.bundle.glob("*.json")):
        for result in current_results(course, name, student):
            worked = True
            if isinstance(result, Failure):
                raise LabkitError(f"{name}: {result.why}")
            right = {q.verdict.name: q for q in result.questions if q.verdict.right}
            bundle = Bundle.of(course, name).of_student(student)
            for question in bundle.questions:
                if question.name in right and edits(right[question.name].source):
                    yield Accepted(bundle, question, right[question.name], tuple(right))
    if not worked:
        raise LabkitError(f"{student} has handed in nothing, so there is nothing to ask about")


def known(course: Course, student: str) -> None:
    """Raise a LabkitError if nobody has this folder."""
    people = [str(one) for one in read_roster(course).students]
    folders = [path.name for path in course.submitted.glob("*") if is_name(path.name)]
    if student not in folders and read_roster(course).get(student) is None:
        near = did_you_mean(student, [*people, *folders])
        raise LabkitError(f"there is no student {student!r}; give the name of a folder{near}")


def _ask(
    course: Course, student: str, one: Accepted, sandbox: Sandbox, limits: Limits
) -> Asked | None:
    """A question about an answer; None if no mistake that is tried changes what the checks say."""
    data, _, why = Submission.of(course, one.assignment, student).read()
    cells = why or parse(data, sandbox, limits)
    if isinstance(cells, str):
        raise LabkitError(f"{one.assignment}: {cells}")
    todo, question = plan(cells, one.bundle.data["cells"]), one.question
    place = todo.places[question.name]
    secret = partial(rank, key_of(course, "defence"), student)
    mistakes = edits(todo.source(question.name))
    mistakes.sort(key=lambda edit: secret(f"{question.name}/{edit.at}/{edit.now}"))
    for edit in mistakes[:TRIES]:
        steps = [replace(x, source=edit.cell) if x.number == place else x for x in todo.steps]
        with closing(Session(sandbox, steps, limits)) as session:
            session.right = [name for name in one.right if name != question.name]
            function = RemoteFunction(question, session)
            tried = try_public(question, function)
            function.session.close_question()
        failed = {x.name for x in tried.results if x.outcome in (Outcome.WRONG, Outcome.ERROR)}
        runs = [x for x in public_evidence.runs(question, tried) if x["test"] in failed]
        numbers = None if one.drives else public_evidence.numbers(question, tried)
        if tried.outcome is Outcome.WRONG and (runs or numbers):
            run = next(iter(runs), None)
            own = [x for x in one.answer.runs if run and x["test"] == run["test"]]
            return Asked(one, edit, run, next(iter(own), None), None if run else numbers)
    return None
