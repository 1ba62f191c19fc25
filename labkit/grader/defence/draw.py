"""The defence: three of a student's own accepted functions, each with a mistake put into it.

The questions are drawn under a key of the term, so each student has their own questions, which stay
the same when the page is printed again.  A mistake is used only if the question's checks reject the
function with it; if the question runs an arm, the arm must miss a limit.
"""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import Course
from ...course.marking import PublicResult, recognise, try_public
from ...course.question import Call, Loop, Question, Tuned
from ...course.verdict import Misconception, Outcome
from ...errors import LabkitError
from ..each import Failure
from ..grading import public_evidence
from ..grading.current_results import current_results
from ..grading.grade import parse
from ..grading.plan import Plan, imports, plan
from ..grading.results import Answer, Numbers, Run
from ..grading.worker import in_sandbox
from ..sandbox.launch import Sandbox
from ..sandbox.limits import Limits, slowness
from ..sandbox.session import RemoteFunction, Session
from ..seeds import key_of
from ..students.roster import read_roster
from ..submission import Submission, did_you_mean, is_name
from ..whys import rank
from .edits import Edit, edits, shown

ASKED = 3
"""The number of questions in one defence."""
FULL = 3
"""The full marks for each question."""
LONG = 24
"""Functions with more lines are chosen only if there are no shorter ones."""
TRIES = 3
"""The number of mistakes that are tried in a function to find a known misconception."""


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
        known: The known mistake that gives the same answers, if there is one.
    """

    of: Accepted
    edit: Edit
    run: Run | None
    own: Run | None
    numbers: Numbers | None
    known: Misconception | None

    @property
    def given(self) -> str:
        """The arguments of the law in its run besides state and target, such as "(kp=40.0)"."""
        tests = [t for t in self.of.question.tests if self.run and t.name == self.run["test"]]
        loops = [case for test in tests for case in test.cases if isinstance(case, Loop)]
        return Call((), loops[0].kwargs).shown("") if loops and loops[0].kwargs else ""


def draw(course: Course, student: str) -> tuple[Asked, ...]:
    """The questions of a student's defence; fewer where fewer answers can be asked about.

    Raises:
        LabkitError: There is no such student, nothing was handed in, or there are too few questions
            because work has no result.
        NoIsolation: No sandbox can be made here.
    """
    answers, missing = accepted(course, student)
    secret = partial(rank, key_of(course, "defence"), student)

    def order(one: Accepted) -> tuple[bool, bool, bytes]:
        long = len(shown(one.answer.source)) > LONG
        return not one.drives, long, secret(f"defence/{one.assignment}/{one.question.name}")

    asked: tuple[Asked, ...] = ()
    if answers:
        modules = {name: None for one in answers for name in imports(one.bundle.data["cells"])}
        limits = Limits().scaled(slowness())

        def drawn(sandbox: Sandbox) -> tuple[Asked, ...]:
            found = (_ask(course, student, x, sandbox, limits) for x in sorted(answers, key=order))
            return tuple(islice(filter(None, found), ASKED))

        asked = in_sandbox(drawn, course, tuple(modules))
    if len(asked) < ASKED and missing:
        raise LabkitError(
            f"{ASKED} accepted answers that a mistake can be put into are needed, and {student} "
            f"has {len(asked)}; {'; '.join(missing)}"
        )
    return asked


def accepted(course: Course, student: str) -> tuple[list[Accepted], list[str]]:
    """A student's answers that earned full marks, and why other work has no result.

    Raises:
        LabkitError: The student handed in nothing, or does not exist.
    """
    found: list[Accepted] = []
    missing: list[str] = []
    people = read_roster(course).students
    roster = [one.id for one in people]
    worked = False
    for name in sorted(path.stem for path in course.bundle.glob("*.json")):
        for result in current_results(course, name, student):
            worked = True
            if isinstance(result, Failure):
                missing.append(f"{name}: {result.why}")
                continue
            answers = {q.verdict.name: q for q in result.questions if q.verdict.right}
            bundle = Bundle.of(course, name).of_student(student)
            found += [
                Accepted(bundle, question, answers[question.name], tuple(answers))
                for question in bundle.questions
                if question.name in answers and edits(answers[question.name].source)
            ]
    if not worked and student in roster:
        raise LabkitError(
            f"{student} has handed in nothing, so there is nothing to ask about and no mark to "
            "enter; --absent-zero of labkit export counts the missing defence as 0"
        )
    if not worked:
        folders = [path.name for path in course.submitted.glob("*") if is_name(path.name)]
        raise LabkitError(
            f"there is no student {student!r}: not in the roster, and nothing of theirs is in "
            "submitted/ or results/; give the name of the student's folder"
            f"{did_you_mean(student, [*map(str, people), *folders])}"
        )
    return found, missing


def _ask(
    course: Course, student: str, one: Accepted, sandbox: Sandbox, limits: Limits
) -> Asked | None:
    """A question about an answer, with a known mistake if possible, and otherwise with another.

    None if no mistake changes what the checks say.
    """
    data, _, why = Submission.of(course, one.assignment, student).read()
    if why:
        raise LabkitError(f"{one.assignment}: {why}")
    cells = parse(data, sandbox, limits)
    if isinstance(cells, str):
        raise LabkitError(f"{one.assignment}: {cells}")
    todo = plan(cells, one.bundle.data["cells"])
    source = todo.source(one.question.name)
    secret = partial(rank, key_of(course, "defence"), student)
    mistakes = sorted(edits(source), key=lambda e: secret(f"{one.question.name}/{e.at}/{e.now}"))
    found = (_tried(edit, one, todo, sandbox, limits) for edit in mistakes[:TRIES])
    first: Asked | None = None
    for asked in filter(None, found):
        if asked.known:
            return asked
        first = first or asked
    return first


def _tried(edit: Edit, one: Accepted, todo: Plan, sandbox: Sandbox, limits: Limits) -> Asked | None:
    """A question with this mistake; None if the checks accept it, or it only raises an error."""
    question = one.question
    place = todo.places[question.name]
    steps = [
        replace(step, source=edit.cell) if step.number == place else step for step in todo.steps
    ]
    with closing(Session(sandbox, steps, limits)) as session:
        session.right = [name for name in one.right if name != question.name]
        function = RemoteFunction(question, session)
        tried = try_public(question, function)
        function.session.close_question()
    if tried.outcome is not Outcome.WRONG:
        return None
    run, numbers = _worst(question, tried), public_evidence.numbers(question, tried)
    if run is None and (one.drives or numbers is None):
        return None
    return Asked(
        one,
        edit,
        run,
        next((x for x in one.answer.runs if run and x["test"] == run["test"]), None),
        None if run else numbers,
        _known(question, tried),
    )


def _worst(question: Question, tried: PublicResult) -> Run | None:
    """The first public run that is not as good as it must be."""
    failed = {x.name for x in tried.results if x.outcome in (Outcome.WRONG, Outcome.ERROR)}
    return next(
        (run for run in public_evidence.runs(question, tried) if run["test"] in failed), None
    )


def _known(question: Question, tried: PublicResult) -> Misconception | None:
    found = recognise(question, [tried.answers.get(call) for call in question.calls])
    return found and Misconception(found.name, found.says)
