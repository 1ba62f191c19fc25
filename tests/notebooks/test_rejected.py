"""Wrong answers that once earned full marks, were called right in public or by another one's name.

They were written by somebody who knew the students' notebooks alone, and stand here as they were.
"""

from pathlib import Path

import control
import numpy as np
import pytest
from courses import rejected_below

import labkit as lk
from labkit.course import Outcome
from labkit.course.authoring.layout import Course
from labkit.course.marking import mark
from labkit.course.messages import message
from solutions.comparison.hidden import (
    FAR,
    LINE_LIMIT,
    ON_THE_LINE,
    RESERVE,
    UNSEEN,
    UNSEEN_LIMIT,
    stiffer,
)

COURSE = Course.here(Path(__file__))
PROBLEMS = {f"{name[:2]} {p.name}": p for name in COURSE.names() for p in COURSE.problems(name)}


def springs(zeta):
    def choose_gains(model):
        w, m = 2 * np.pi * 1.9, np.diag(model.mass_matrix(model.robot.ready))
        return w**2 * m, 2 * zeta * w * m

    return choose_gains


def from_the_notebook(model):
    return 80.0, 12.0


def from_the_notebooks_other_cell(model):
    m = np.diag(model.mass_matrix(model.robot.ready))
    return 50.0 * m, 14.0 * m


def three_coordinates(t, reference, goal, duration):
    whole = PROBLEMS["06 blend"].answer(t, reference, goal, duration)
    return lk.Sample(*np.vstack(whole)[:, :3])


def plain_function(kp, lag, delay):
    return lambda s: kp / (lag * s + 1) / s * np.exp(-s * delay)


def loop(order, unit=1.0):
    def open_loop(kp, lag, delay):
        late = control.tf(*control.pade(delay / unit, order)) if delay else 1
        return control.tf([kp], [lag, 1, 0]) * late

    return open_loop


def lowest(seeds, grid, share=1.0):
    def recipe(runner):
        tried = {Kp: max(runner(Kp, 0.0, seed) for seed in seeds) for Kp in grid}
        return share * min(tried, key=lambda Kp: tried[Kp]), 0.0

    return recipe


GRID = (14.0, 22.0, 34.0, 50.0)
ONLY_ON_THE_LINE = lowest((0,), np.geomspace(8.0, 80.0, 18))
"""Its gains hold on the line, and with 1.8 times Kp: that they do not elsewhere is the lesson."""
REJECTED = [
    ("04 choose_gains", springs(0.1), None),
    ("04 choose_gains", springs(0.0), "no damping"),
    ("04 choose_gains", from_the_notebook, "the same gains in every joint"),
    ("04 choose_gains", from_the_notebooks_other_cell, None),
    ("06 blend", three_coordinates, None),
    ("07 open_loop", plain_function, None),
    ("07 open_loop", loop(1), "a delay of first order"),
    ("07 open_loop", loop(4, unit=1e3), "almost no delay"),
    *(
        ("07 recipe", lowest(seeds, GRID), "the lowest error of all seeds, and no step back")
        for seeds in ((0,), (0, 1), range(5))
    ),
    ("07 recipe", ONLY_ON_THE_LINE, None),
    ("07 recipe", lowest(range(5), GRID, 0.9), None),
    ("07 recipe", lambda runner: (20.0, 1.0), None),
    ("07 recipe", lambda runner: (40.0, 0.6), None),
    ("07 recipe", lambda runner: (8, 0), None),
]


@pytest.mark.parametrize(
    ("question", "answer", "name"),
    REJECTED,
    ids=[f"{question}: {name or f.__name__}" for question, f, name in REJECTED],
)
def test_it_is_rejected_and_called_by_its_own_name(question, answer, name):
    """The check rejects it too; it earns less than half, or its largest part; its name is right."""
    asked = PROBLEMS[question].question(2019)
    assert mark(asked.public(), answer).right == (answer is ONLY_ON_THE_LINE)
    verdict = mark(asked, answer)
    assert verdict.earned < rejected_below(asked), verdict.tests
    assert (verdict.mistake.name if verdict.mistake else None) == name


def test_a_delay_of_second_order_is_right():
    """Up to 25 rad/s and 30 ms it is off by 3e-4, where 2e-2 is the tolerance."""
    problem = PROBLEMS["07 open_loop"]
    s = 25j
    num, den = control.pade(0.03, 2)
    off = abs(np.polyval(num, s) / np.polyval(den, s) / np.exp(-0.03 * s) - 1.0)
    assert off < 5e-4 < problem.judge.rtol
    assert mark(problem.question(2019), loop(2)).outcome is Outcome.RIGHT


@pytest.mark.parametrize(
    ("Kp", "where"),
    [
        (5.0, "on the first arm, with the chosen Kp"),
        (60.0, "on the first arm, with 1.8 times the chosen Kp"),
        (20.0, "on the second, slower arm, with the chosen Kp"),
        (14.0, "on the second, slower arm, with 1.8 times the chosen Kp"),
    ],
)
def test_a_choice_of_gains_is_told_on_which_arm_and_with_which_gain_it_fails(Kp, where):
    """The arm may be the slower one, and the gain a multiple, where the runner gave a small one."""
    asked = PROBLEMS["07 recipe"].question(2019).public()
    words = " ".join(str(message(asked, mark(asked, lambda runner: (Kp, 0.0)))).split())
    assert f"; the limit is 3.05 mm. This was recipe(runner) {where}. [failed]" in words
    assert "Where it fails" not in words


def test_no_typed_gains_pass_the_check():
    """A pair that suits the line of one arm fails on that of the other, and the check shows it."""
    cases = PROBLEMS["07 recipe"].trials[0].public
    most = min(case.unseen.Kp[-2] for case in cases)
    assert not [
        (Kp, Kd)
        for Kp in np.geomspace(2.0, most, 100)
        for Kd in np.linspace(0.0, 1.0, 11)
        if all(case.measured((Kp, Kd))["worst_mm"] <= LINE_LIMIT for case in cases)
    ]


def test_no_gains_that_hold_elsewhere_fail_on_the_line():
    """Gains that pass all of the instructor's cases pass the check, too."""
    line, unseen = ([stiffer(t, x) for x in xs] for t, xs in (
        (ON_THE_LINE, (1.0, FAR)), (UNSEEN, (1.0, RESERVE)),
    ))  # fmt: skip
    for Kp in np.geomspace(2.0, 55.0, 100):
        for Kd in np.linspace(0.0, 1.0, 11):
            if all(trials.worst(Kp, Kd) <= UNSEEN_LIMIT for trials in unseen):
                assert all(trials.worst(Kp, Kd) <= LINE_LIMIT for trials in line), (Kp, Kd)


@pytest.mark.parametrize(("Kp", "Kd"), [(37.5, 0.0), (45.0, 0.5)])
def test_gains_without_a_reserve_hold_elsewhere_but_fail_the_check(Kp, Kd):
    """They hold elsewhere as they are, but on the line they fail with 1.8 times their Kp.

    They fail the instructor's cases with a reserve, too.
    """
    assert UNSEEN.worst(Kp, Kd) <= UNSEEN_LIMIT < stiffer(UNSEEN, RESERVE).worst(Kp, Kd)
    assert stiffer(ON_THE_LINE, FAR).worst(Kp, Kd) > LINE_LIMIT


def test_beyond_the_recorded_runs_the_error_is_infinite():
    """No arm is lost in the runs on which gains are judged; the check says what is missing."""
    for trials in (ON_THE_LINE, UNSEEN):
        assert np.isfinite([trials.array(k) for k in range(len(trials.cases))]).all()
    slower = stiffer(ON_THE_LINE, 4.0)
    assert slower.error(0, 25.0, 0.0) == ON_THE_LINE.error(0, 100.0, 0.0)
    assert slower.error(0, 25.1, 0.0) == np.inf
    asked = PROBLEMS["07 recipe"].question(2019).public()
    words = " ".join(str(message(asked, mark(asked, lambda runner: (60.0, 0.0)))).split())
    assert "is infinite, because no error was recorded for gains as large as these;" in words


def test_no_typed_gains_serve_both_arms():
    """Without asking the runner no pair of gains passes, whatever arm the seed draws."""
    for slow in (3.6, 3.8):
        unseen = [stiffer(UNSEEN, x) for x in (1.0, RESERVE, slow, slow * RESERVE)]
        most = min(trials.Kp[-2] for trials in unseen)
        assert not [
            (Kp, Kd)
            for Kp in np.geomspace(2.0, most, 40)
            for Kd in np.linspace(0.0, 1.0, 6)
            if all(trials.worst(Kp, Kd) <= UNSEEN_LIMIT for trials in unseen)
        ]
