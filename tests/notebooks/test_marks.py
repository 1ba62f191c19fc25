"""What the checks give: to answers, stubs, known mistakes and other right answers."""

import re
from functools import cache
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

import labkit as lk
from labkit.course import Call, Choice, Loop, Outcome, Tuned, fingerprint
from labkit.course.authoring.layout import Course
from labkit.course.authoring.report_card import rejected_below
from labkit.course.marking import mark, recognise

COURSE = Course.here(Path(__file__))
NAMES = [name for name in COURSE.names() if COURSE.problems(name)]
PROBLEMS = [problem for name in NAMES for problem in COURSE.problems(name)]
SAMPLE = {"open_loop", "joint_velocity_pd", "shaped_impedance"}
"""Of the questions for which the arm runs, those that are tried as often as the others."""
POINTS = dict.fromkeys(NAMES, 20) | {"00_warmup": 10}


def runs_the_arm(problem):
    """Whether a question takes more than calls of a function."""
    return any(not isinstance(case, Call | Choice) for t in problem.trials for case in t.public)


def each(*long):
    """All problems; those for which the arm runs have the marks of what takes long, if not sampled.

    One worker has all tests of a problem, which share what they marked.
    """
    sampled = {p for p in PROBLEMS if not runs_the_arm(p) or p.name in SAMPLE}
    return pytest.mark.parametrize(
        "problem",
        [
            pytest.param(
                p,
                id=p.name,
                marks=[
                    pytest.mark.xdist_group(f"marks {p.name}"),
                    *(() if p in sampled else long),
                ],
            )
            for p in PROBLEMS
        ],
    )


@cache
def question_of(problem, draw):
    """The question with one draw of its hidden cases."""
    return problem.question(draw)


@cache
def verdict_of(problem, draw, answer):
    """What an answer gets; arms move for minutes in it, so no answer is marked twice."""
    return mark(question_of(problem, draw), answer)


def stub(*args, **kwargs):
    raise NotImplementedError


@each()
def test_the_answer_gets_full_marks(problem):
    """The reference is right, hidden cases included."""
    verdict = verdict_of(problem, 1, problem.answer)
    assert verdict.outcome is Outcome.RIGHT, verdict.tests
    assert verdict.earned == problem.points


@each()
def test_the_stub_gets_nothing(problem):
    """A stub counts as not attempted, and a function that gives only zeros earns nothing."""
    question = question_of(problem, 1)
    assert mark(question, stub).outcome is Outcome.NOT_ATTEMPTED
    assert mark(question, stub).earned == 0.0
    for nothing in (lambda *a, **k: None, lambda *a, **k: 0.0):
        assert mark(question, nothing).earned == 0.0


@each()
def test_zeros_of_the_right_shape_earn_nothing(problem):
    """A gate stands before the points: the answer's shape, filled with zeros, does not pass it."""
    question = question_of(problem, 1)
    assert mark(question, lambda *a, **k: zeros_like(problem.answer(*a, **k))).earned == 0.0


@each(pytest.mark.slow)
def test_known_mistakes_are_rejected_and_named(problem):
    """Each earns less than half, or its largest right part, and is called by its name."""
    assert problem.wrong
    most = rejected_below(question_of(problem, 1))
    for wrong in problem.wrong:
        verdict = verdict_of(problem, 1, wrong.function)
        assert verdict.earned < most, wrong.name
        assert verdict.mistake is not None, wrong.name
        assert verdict.mistake.name == wrong.name


@each()
def test_fingerprints_differ(problem):
    """No two mistakes answer the public calls alike, and none as the reference does."""
    question = question_of(problem, 1)
    assert recognise(question, list(fingerprint(question, problem.answer))) is None
    for a, b in combinations(problem.wrong, 2):
        known = [m for m in question.mistakes if m.name == a.name]
        alone = question.__class__(**{**vars(question), "mistakes": tuple(known)})
        assert recognise(alone, list(fingerprint(question, b.function))) is None, (a.name, b.name)


@each()
def test_right_answers_written_otherwise_are_accepted(problem):
    """A list, a class, another formula: what is right earns full marks."""
    for variant in problem.variants:
        verdict = verdict_of(problem, 1, variant)
        assert verdict.outcome is Outcome.RIGHT, (variant, verdict.tests)


@pytest.mark.slow
@each(pytest.mark.soak)
def test_seeds_agree(problem):
    """Every draw of the hidden cases gives the same marks to the answer, mistakes and variants.

    Twenty draws of calls; two where the arm has to run, whose twenty the report card makes.
    """
    draws = 2 if runs_the_arm(problem) else 20
    functions = (problem.answer, *(w.function for w in problem.wrong), *problem.variants)
    marks = {tuple(verdict_of(problem, draw, f).earned for f in functions) for draw in range(draws)}
    assert len(marks) == 1


@pytest.mark.parametrize("name", NAMES)
def test_points_add_up(name):
    """Points are as announced, closed loops carry at most 30 %, enough mistakes are known."""
    problems = COURSE.problems(name)
    assert sum(p.points for p in problems) == POINTS[name]
    loops = 0.0
    for problem in problems:
        whole = sum(trial.weight for trial in problem.trials)
        loops += sum(
            problem.points * trial.weight / whole
            for trial in problem.trials
            if any(isinstance(case, Loop | Tuned) for case in trial.public)
        )
        assert len(problem.hints) == 3
        parts = all(trial.part for trial in problem.trials)  # each earns its own share
        gate = problem.trials[0].weight == 0.0
        assert gate or parts or problem.points <= 2, "the gate comes first"
    assert loops <= 0.3 * POINTS[name]
    assert sum(len(p.wrong) for p in problems) >= 10
    assert sum(len(p.variants) for p in problems) >= 4


@pytest.mark.parametrize("name", NAMES)
def test_no_text_that_is_printed_has_markup(name):
    """Tasks, hints and explanations are printed as they are, so none emphasises a word by *."""
    asked = [*COURSE.problems(name), *COURSE.predictions(name)]
    texts = [text for x in asked for text in (x.asks, *getattr(x, "hints", ()))]
    texts += [wrong.says for problem in COURSE.problems(name) for wrong in problem.wrong]
    for text in texts:
        assert not re.search(r"(?<![\w*])\*\w[^*]*\w\*(?!\w)", text), text


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
