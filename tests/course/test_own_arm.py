"""An arm of one's own, faulty runs, and functions that measure them."""

import json
import unicodedata
from dataclasses import replace

import numpy as np
import pytest

import labkit as lk
from labkit.course import (
    PUBLIC_ARMS,
    PUBLIC_BUGS,
    Bug,
    Close,
    OwnArm,
    commanded,
    mark,
    my_arm,
    my_bug,
    question_data,
    read_question,
)
from labkit.course.authoring.problem import Problem, Trial, Wrong, call
from labkit.course.authoring.refusals import memorised
from labkit.course.calling import LocalFunction, copied
from labkit.course.own_arm import CAUSES, RANGES
from labkit.errors import OutOfRange


def test_an_arm_follows_from_the_name_alone():
    """Composed or taken apart, in capitals: one arm, and another for another name, all in range."""
    spellings = ("jörg", unicodedata.normalize("NFD", "jörg"), "JÖRG", " ｊörg")
    found = [my_arm(name).world.things[0].point[0] for name in (*spellings, "zoe", "demo")]
    assert len(set(found[:4])) == 1 and len(set(found[3:])) == 3
    random = np.random.default_rng(0)
    arms = [OwnArm.drawn(random) for _ in range(400)]
    for name, (least, most) in RANGES.items():
        numbers = [getattr(arm, name) for arm in arms]
        assert least <= min(numbers) < least + 0.05 * (most - least)
        assert most >= max(numbers) > most - 0.05 * (most - least)


def test_an_arm_at_rest_does_not_tell_what_it_is():
    """It reports Baxter's numbers, and its sensors were zeroed with the load."""
    with replace(PUBLIC_ARMS[0], payload=0.8).made() as mine:
        assert (mine.plant.payload, mine.plant.velocity_lag) == (0.0, lk.BAXTER.velocity_lag)
        inertia = np.diag(mine.model.mass_matrix(mine.robot.ready))
        law = lk.control.springs(50.0 * inertia, 14.0 * inertia)
        log = lk.run(mine, lk.Hold(mine.robot.ready, 3.0), law)
        felt = lk.metrics.felt_wrench(log)[log.t > 1.0].mean(axis=0)
        assert abs(felt[2]) < 0.1 * 0.8 * 9.81
        assert np.abs(mine.truth().tau_ext).max() < 0.05


def test_everybody_has_three_runs_with_different_causes():
    """They follow from the name; the public ones are those of demo."""
    assert np.array_equal(my_bug(1).q, PUBLIC_BUGS[0].made().q)
    assert not np.array_equal(my_bug(1, "ada").q, my_bug(2, "ada").q)
    assert np.array_equal(my_bug(3, "ada").q, my_bug(3, "ADA").q)
    with pytest.raises(OutOfRange):
        my_bug(0)


def lag_of(arm):
    """The time constant of the motors, from a step of the speed of one joint."""
    log = lk.run(
        arm, lk.Hold(arm.robot.ready, 1.0), lambda *_: lk.JointVelocity(0.4 * np.eye(7)[0])
    )
    return float(np.mean((log.t - (log.q - log.q[0])[:, 0] / 0.4)[log.t > 0.5]))


def test_a_function_that_measures_is_tried_on_arms_that_it_has_not_seen():
    """A question holds the numbers of its arms; each call makes the arm anew."""
    trial = Trial(
        "two public arms",
        tuple(map(call, PUBLIC_ARMS)),
        lambda random: [call(OwnArm.drawn(random)) for _ in range(2)],
    )
    judge = Close(rtol=0.0, atol=0.005)
    twice = Wrong("twice", "It is twice the lag.", lambda arm: 2.0 * lag_of(arm))
    problem = Problem(
        "lag_of", 3.0, "?", lag_of, (trial,), judge, wrong=(twice,), expected=lambda arm: arm.lag
    )
    question = read_question(json.loads(json.dumps(question_data(problem.question(7)))))
    assert mark(question, LocalFunction(lag_of)).right
    assert mark(question, LocalFunction(twice.function)).mistake.name == "twice"
    typed = mark(question, memorised(question))
    assert typed.earned == 0.0 and typed.tests[0].hidden


def test_the_cause_of_a_run_is_the_mistake_that_commands_what_it_shows():
    """For each cause, the torques of its own law are those of the second half of the run."""
    for k, cause in enumerate(CAUSES):
        log = copied(Bug(cause, k % 3, 0.5, k))
        late = log.t > 0.6
        off = {x: np.abs(log.command - commanded(log, x))[late].max() for x in CAUSES}
        assert off[cause] < 1e-9 and min(y for x, y in off.items() if x != cause) > 0.1
