"""What the checks give: to answers, stubs, known mistakes and other right answers."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from courses import rejected_below

import labkit as lk
from labkit.course import Call, Choice, Outcome, fingerprint
from labkit.course.authoring.layout import Course
from labkit.course.calling import called
from labkit.course.marking import mark, recognise

COURSE = Course.here(Path(__file__))
NAMES = [name for name in COURSE.names() if COURSE.problems(name)]
PROBLEMS = [problem for name in NAMES for problem in COURSE.problems(name)]


def runs_the_arm(problem):
    """Whether a question takes more than calls of a function."""
    return any(not isinstance(case, Call | Choice) for t in problem.trials for case in t.public)


each = pytest.mark.parametrize(
    "problem",
    [
        pytest.param(p, id=p.name, marks=pytest.mark.xdist_group(f"marks {p.name}"))
        for p in PROBLEMS
    ],
)
"""All problems; one worker has all tests of a problem, which share what they marked."""


@cache
def question_of(problem, draw):
    """The question with one draw of its hidden cases."""
    return problem.question(draw)


@cache
def verdict_of(problem, draw, answer):
    """What an answer gets; arms move for minutes in it, so no answer is marked twice."""
    return mark(question_of(problem, draw), called(answer))


def stub(*args, **kwargs):
    raise NotImplementedError


@each
def test_the_answer_gets_full_marks(problem):
    """The reference is right, hidden cases included."""
    verdict = verdict_of(problem, 1, problem.answer)
    assert verdict.outcome is Outcome.RIGHT, verdict.tests
    assert verdict.earned == problem.points


@each
def test_the_stub_gets_nothing(problem):
    """A stub counts as not attempted, and a function that gives only zeros earns nothing."""
    question = question_of(problem, 1)
    assert mark(question, stub).outcome is Outcome.NOT_ATTEMPTED
    assert mark(question, stub).earned == 0.0
    for nothing in (lambda *a, **k: None, lambda *a, **k: 0.0):
        assert mark(question, nothing).earned == 0.0


@each
def test_zeros_of_the_right_shape_earn_nothing(problem):
    """A gate stands before the points: the answer's shape, filled with zeros, does not pass it."""
    question = question_of(problem, 1)
    assert mark(question, lambda *a, **k: zeros_like(called(problem.answer)(*a, **k))).earned == 0.0


@each
def test_known_mistakes_are_named(problem):
    """The public cases alone tell each by its name; with hidden ones the first earns little."""
    for wrong in problem.wrong:
        verdict = mark(question_of(problem, 1).public(), called(wrong.function))
        assert verdict.outcome is not Outcome.RIGHT, wrong.name
        assert verdict.mistake is not None and verdict.mistake.name == wrong.name
    most = rejected_below(question_of(problem, 1))
    assert all(verdict_of(problem, 1, w.function).earned < most for w in problem.wrong[:1])


@pytest.mark.soak
@each
def test_known_mistakes_are_rejected(problem):
    """With the hidden cases none has full marks; a slip loses the points of its own part."""
    for wrong in problem.wrong:
        assert verdict_of(problem, 1, wrong.function).earned < problem.points, wrong.name


@each
def test_right_answers_written_otherwise_are_accepted(problem):
    """A list, a class, another formula: what is right earns full marks."""
    for variant in problem.variants:
        verdict = verdict_of(problem, 1, variant)
        assert verdict.outcome is Outcome.RIGHT, (variant, verdict.tests)


@pytest.mark.soak
@each
def test_seeds_agree(problem):
    """Every draw of the hidden cases gives the same marks to the answer and variants.

    A mistake's may differ by a part that it gets right by luck.  Twenty draws of calls; two where
    the arm has to run, which takes long.
    """
    draws = 2 if runs_the_arm(problem) else 20
    for function in (problem.answer, *problem.variants, *(w.function for w in problem.wrong)):
        marks = [verdict_of(problem, draw, function).earned for draw in range(draws)]
        wrong = function in [w.function for w in problem.wrong]
        assert max(marks) - min(marks) <= (problem.points / 2 if wrong else 0)


def zeros_like(answer):
    """The same kind of thing, all zeros."""
    if hasattr(answer, "value"):
        return type(answer)(0.0 * answer.value)
    if isinstance(answer, tuple):
        zeros = [zeros_like(x) for x in answer]
        return type(answer)(*zeros) if hasattr(answer, "_fields") else tuple(zeros)
    return 0.0 * answer


@pytest.mark.parametrize("plain", [False, True])
@pytest.mark.parametrize("name", ["workspace_impedance", "shaped_impedance"])
def test_a_mistake_is_named_whatever_moves_the_elbow_alone(name, plain):
    """Notebook 05 invites to damp the elbow; that must not cost the sentence that helps.

    Behind the plain pseudo-inverse the damper is felt at the tip, which is one more mistake.
    """
    question = question_of(next(p for p in PROBLEMS if p.name == name), 1)

    def damped(law):
        def controller(*args, **gains):
            command = law(*args, **gains)
            if type(command) is not lk.JointTorque:
                return command
            state, model = args[0], next(x for x in args if isinstance(x, lk.Model))
            J, M = model.tip_jacobian(state.q), model.mass_matrix(state.q)
            tau = -0.5 * M @ (state.dq + 0.1)
            felt = J.T @ np.linalg.solve(J @ np.linalg.solve(M, J.T), J @ np.linalg.solve(M, tau))
            felt = np.linalg.pinv(J) @ (J @ tau) if plain else felt
            return lk.JointTorque(command.value + tau - felt)

        return controller

    problem = next(p for p in PROBLEMS if p.name == name)
    for wrong in problem.wrong:
        known, other = (
            recognise(question, list(fingerprint(question, law)))
            for law in (wrong.function, damped(wrong.function))
        )
        assert known and other and known.name == other.name, wrong.name
