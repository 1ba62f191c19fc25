"""Questions as data: the task, the tests, the judge and the known mistakes.

A question does not contain its answer's code, so students may have it; its hidden cases stay with
the grader.  A case calls the student's function and does not judge what is returned.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, is_dataclass, replace
from inspect import isroutine
from typing import Any

import numpy as np

from ..arm import Arm
from ..control import springs
from ..errors import TypeMismatch
from ..log import Log
from ..metrics import since, summary
from ..plant import IDEAL, Plant
from ..recordings import Runner, Trials
from ..run import run
from ..servo import Conveyor, Followed
from ..shapes import Array
from ..world import Thing, World
from .judges import Judge
from .verdict import Misconception


@dataclass(frozen=True, eq=False)
class Call:
    """One call of the student's function.

    Attributes:
        args: Positional arguments.
        kwargs: Arguments by name.
        expected: What the judge compares the answer with.
        hidden: Whether it is kept from students.
    """

    args: tuple[Any, ...]
    kwargs: Mapping[str, Any] = field(default_factory=dict)
    expected: Any = None
    hidden: bool = False

    def ask(self, function: Callable[..., Any]) -> Any:
        """The function's answer."""
        return function(*self.args, **self.kwargs)

    def shown(self, name: str) -> str:
        """The call as a student would type it, but for long arguments; see `is_shortened`."""
        words = [_short(x) for x in self.args]
        if len(", ".join(words)) > 60:
            words = [_sized(x) if isinstance(x, np.ndarray) else _short(x) for x in self.args]
        words += [f"{key}={_short(x)}" for key, x in self.kwargs.items()]
        return f"{name}({', '.join(words)})"


@dataclass(frozen=True, eq=False)
class Loop:
    """One closed-loop run with the student's function as the controller.

    Attributes:
        target: The target that the arm follows.
        kwargs: What the controller is given besides state and target.
        side: The side of Baxter's arm.
        plant: Parameters of the arm.
        things: Things in its world, such as a `labkit.Push`.
        seed: Seed of its noise.
        q0: Joint angles at the start, shape (n,) in [rad]; None is the ready pose.
        rate: Control rate, in [Hz].
        duration: Duration of the run, in [s]; None takes the target's.
        settle: Time to recover from the start, in [s]; the measures begin after it.
        expected: Upper limits of measures of the run, which are fields of `metrics.Summary`.
        hidden: Whether it is kept from students.
    """

    target: Any
    kwargs: Mapping[str, Any] = field(default_factory=dict)
    side: Any = "left"
    plant: Plant = IDEAL
    things: tuple[Thing, ...] = ()
    seed: int = 0
    q0: Any = None
    rate: float = 200.0
    duration: float | None = None
    settle: float = 0.0
    expected: Any = field(default_factory=dict)
    hidden: bool = False

    def ask(self, function: Callable[..., Any]) -> Log:
        """The run with the function as its controller."""

        def controller(state: Any, target: Any) -> Any:
            return function(state, target, **self.kwargs)

        arm = Arm(self.side, self.plant, self.seed, world=World(things=self.things))
        arm.reset(arm.robot.ready if self.q0 is None else self.q0)
        try:
            return run(arm, self.target, controller, self.rate, self.duration)
        finally:
            arm.world.close()

    def measured(self, answer: Log) -> dict[str, float]:
        """The measures of a run, fields of `metrics.Summary`."""
        return asdict(summary(since(answer, self.settle)))

    def shown(self, name: str) -> str:
        """The run in words."""
        return f"a run of the {self.side} arm ({self.plant.name}) with {name} as its controller"


@dataclass(frozen=True, eq=False)
class Choice:
    """The student's function chooses gains with a runner that has a limited number of tries.

    Attributes:
        trials: The recorded trials of which the runner reports.
        expected: The upper limit of ``worst_mm``.
        unseen: Other trials on which the choice is judged; None takes ``trials`` again.
        judged: On which arm and with which gains it is judged, in words; "" if that is plain.
        budget: How many tries the runner has.
        hidden: Whether it is kept from students.
    """

    trials: Trials
    expected: Any
    unseen: Trials | None = None
    judged: str = ""
    budget: int = 20
    hidden: bool = False

    def ask(self, function: Callable[..., Any]) -> Any:
        """The gains that the function chooses, with a fresh runner."""
        return function(Runner(self.trials, self.budget))

    def measured(self, answer: Any) -> dict[str, float]:
        """The worst error with the chosen gains, in [mm].

        Raises:
            LabkitError: The answer is not a pair of recorded gains.
        """
        try:
            Kp, Kd = answer
        except (TypeError, ValueError):
            raise TypeMismatch("the answer should be two gains, (Kp, Kd)") from None
        return {"worst_mm": (self.unseen or self.trials).worst(Kp, Kd)}

    def shown(self, name: str) -> str:
        """The choice in words."""
        return f"{name}(runner) {self.judged or f'with {self.budget} tries'}"


@dataclass(frozen=True, eq=False)
class Tuned:
    """One closed-loop run with gains that the student's function chose.

    The law is `labkit.control.springs`, which students are given; a law with more terms would be
    the answer to another question.

    Attributes:
        args: Arguments of the function, which returns (kp, kd).
        loop: The run, of which ``kwargs`` and ``expected`` are not used.
        expected: Upper limits of measures of the run, which are fields of `metrics.Summary`.
        hidden: Whether it is kept from students.
    """

    args: tuple[Any, ...]
    loop: Loop
    expected: Any = field(default_factory=dict)
    hidden: bool = False

    def ask(self, function: Callable[..., Any]) -> Log:
        """The run with the gains that the function returns."""
        kp, kd = function(*self.args)
        return self.loop.ask(springs(kp, kd))

    def measured(self, answer: Log) -> dict[str, float]:
        """The measures of a run, fields of `metrics.Summary`."""
        return self.loop.measured(answer)

    def shown(self, name: str) -> str:
        """The run in words."""
        plant = self.loop.plant
        carries = f", {plant.payload:g} kg in its gripper" if plant.payload else ""
        return f"a run of the {self.loop.side} arm ({plant.name}{carries}) with the gains of {name}"


@dataclass(frozen=True, eq=False)
class Chase:
    """One run of a hand that follows a tag, with the student's function as its servo.

    Attributes:
        conveyor: How the tag moves, and how it is seen.
        kwargs: What the servo is given besides time, memory, sightings and hand.
        last: How many sightings it is given; see `Conveyor.follow`.
        expected: Upper limits of measures of the run; see `Followed.measured`.
        hidden: Whether it is kept from students.
    """

    conveyor: Conveyor
    kwargs: Mapping[str, Any]
    last: int = 0
    expected: Any = field(default_factory=dict)
    hidden: bool = False

    def ask(self, function: Callable[..., Any]) -> Followed:
        """The run with the function as its servo."""
        return self.conveyor.follow(function, last=self.last, **self.kwargs)

    def measured(self, answer: Followed) -> dict[str, float]:
        """The measures of a run."""
        return answer.measured()

    def shown(self, name: str) -> str:
        """The run in words."""
        tag = self.conveyor
        moves = f"jumps by {tag.jump:g} m" if tag.jump else f"moves at {tag.speed:g} m/s"
        blind = ", with a blind second" if tag.blind[1] > tag.blind[0] else ""
        return f"a run in which the tag {moves} and is seen {tag.age:g} s late{blind}"


Case = Call | Loop | Choice | Tuned | Chase


@dataclass(frozen=True, eq=False)
class Test:
    """Cases that pass or fail together.

    Attributes:
        name: What it tests, as students read it.
        cases: The cases, public ones first.
        weight: Share of the points; 0 is a gate, without which no other test counts.
        also: The classes of its hidden cases, in words and without their numbers.
        part: The part of the answer that it tests; empty for all parts.
    """

    __test__ = False  # pytest must not collect this class

    name: str
    cases: tuple[Case, ...]
    weight: float = 1.0
    also: str = ""
    part: str = ""


@dataclass(frozen=True)
class Raised:
    """An exception that a function raised in place of an answer.

    Attributes:
        kind: The name of the exception's type.
    """

    kind: str


@dataclass(frozen=True, eq=False)
class Mistake(Misconception):
    """A wrong answer that students really give, recognised by its fingerprint.

    Attributes:
        answers: Its answer to each public call, in order, or `Raised`.
    """

    answers: tuple[Any, ...] = ()


@dataclass(frozen=True, eq=False)
class Term:
    """A term of a law, or one that is taken for it.

    Attributes:
        name: The term as a formula.
        factor: Its factor in the right answer: 1, or 0 if it is only taken for one.
        values: Its numbers at each public call, in order.
    """

    name: str
    factor: float
    values: tuple[Any, ...]


@dataclass(frozen=True, eq=False)
class Question:
    """One function or value that students write, and how it is marked.

    Attributes:
        name: The name of the function or of the value.
        points: Full marks.
        asks: What the function should do, in one sentence.
        judge: Compares answers with the expected ones.
        tests: The tests, in the order in which they are tried.
        withheld: Tools that the answer may not use, such as "labkit.Circle".
        hints: Hints, from the idea to almost the answer.
        mistakes: Known wrong answers.
        core: Whether it belongs to the core path; else it is an extension.
        outcomes: Learning outcomes of which it is evidence, names of `outcomes.OUTCOMES`.
        arguments: Names of the function's arguments.
        terms: The terms of which the right answer is the sum, and those that are taken for them.
    """

    name: str
    points: float
    asks: str
    judge: Judge
    tests: tuple[Test, ...]
    withheld: tuple[str, ...] = ()
    hints: tuple[str, ...] = ()
    mistakes: tuple[Mistake, ...] = ()
    core: bool = True
    outcomes: tuple[str, ...] = ()
    arguments: tuple[str, ...] = ()
    terms: tuple[Term, ...] = ()

    @property
    def calls(self) -> tuple[Call | Choice, ...]:
        """The public calls and choices, on which fingerprints are taken."""
        cases = (case for test in self.tests for case in test.cases)
        return tuple(case for case in cases if isinstance(case, Call | Choice) and not case.hidden)

    @property
    def complete(self) -> bool:
        """Whether the question has all its cases; a student's copy lacks the hidden ones."""
        if any(case.hidden for test in self.tests for case in test.cases):
            return True
        return all(test.cases and not test.also for test in self.tests)

    def public(self) -> Question:
        """The same question without its hidden cases."""
        return self.with_cases(lambda case: None if case.hidden else case)

    def with_cases(self, change: Callable[[Case], Case | None]) -> Question:
        """The same question with each case changed; cases that are changed to None are left out."""
        tests = (replace(t, cases=tuple(filter(None, map(change, t.cases)))) for t in self.tests)
        return replace(self, tests=tuple(tests))


def in_points(points: float) -> str:
    """Points with their unit, such as "1 point" or "2.5 points"."""
    return f"{points:g} point{'' if points == 1 else 's'}"


def in_brief(x: Any, digits: int = 5) -> str:
    """A number, vector or matrix in short notation, such as "[1, 0.5]"."""
    a = np.asarray(x, dtype=float)
    if a.ndim:
        tiny = 1e-9 * max(1.0, float(np.max(np.abs(a), initial=0.0)))
        return f"[{', '.join(in_brief(x, digits) for x in np.where(np.abs(a) < tiny, 0.0, a))}]"
    return f"{float(a) + 0.0:.{digits}g}"  # adding zero removes the sign of -0


def is_shortened(call: str) -> bool:
    """Whether `Call.shown` put short forms for long arguments, so that it cannot be typed."""
    return any(form in call for form in _SHORT_FORMS)


_SHORT_FORMS = (" numbers>", "...")
"""What stands for an array, and for part of any other long value."""


def _short(x: Any) -> str:
    if isinstance(x, np.ndarray):
        return _sized(x) if x.ndim > 1 or x.size > 7 else in_brief(x)
    if isroutine(x):
        return x.__name__
    text = " ".join(repr(x).split())
    if isinstance(x, float):
        return text if len(text) <= 8 else in_brief(x)
    if len(text) <= 48:
        return text
    named = is_dataclass(x) or hasattr(x, "_fields")
    return f"{type(x).__name__}(...)" if named else f"{text[:45]}..."


def _sized(x: Array) -> str:
    return f"<{' x '.join(map(str, x.shape))} numbers>"
