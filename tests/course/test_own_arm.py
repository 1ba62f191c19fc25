"""An arm of one's own: drawn again from the key, opened by its handle, and judged."""

import json
import unicodedata
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import labkit as lk
from labkit.course import (
    PUBLIC_ARMS,
    Close,
    Found,
    Identification,
    Measured,
    Outcome,
    OwnArm,
    commanded,
    mark,
    my_arm,
    own_arm,
    question_data,
    read_question,
)
from labkit.course.authoring.layout import Course
from labkit.course.authoring.problem import Problem, Trial, Wrong, call
from labkit.course.authoring.refusals import GUESSED, guessable, memorised
from labkit.course.calling import LocalFunction, copied
from labkit.course.identification import on_the_public_arm, personalised
from labkit.course.messages import message, sentence
from labkit.course.own_arm import CAUSES, FILE, MOVES, RANGES, Arms, Bug, draw, public_arm
from labkit.errors import LabkitError
from solutions.impedance.predictions import PREDICTIONS

ARMS = [draw("key", f"team {k}") for k in range(4000)]
COURSE = Course.here(Path(__file__))
ASKED = [x for name in COURSE.names() for x in COURSE.predictions(name)]
JUDGES = [x.judge for x in ASKED if isinstance(getattr(x, "judge", None), Measured)]


def test_a_key_draws_the_same_arm_again_and_others_otherwise():
    """One key and one handle give one arm; another of either gives another arm."""
    assert draw("7", "kestrel") == draw("7", "kestrel")
    arms = {draw(str(key), handle).payload for key in range(5) for handle in "abcde"}
    assert len(arms) == 25


@pytest.mark.parametrize("name", RANGES)
def test_numbers_fill_their_range(name):
    """Each tenth of the range has about a tenth of the arms."""
    numbers = [getattr(arm, name) for arm in ARMS]
    found, _ = np.histogram(numbers, 10, RANGES[name])
    assert found.sum() == len(ARMS) and np.all(abs(found - 400) < 80)


@pytest.mark.parametrize("judge", JUDGES)
def test_no_constant_is_right_for_a_quarter_of_the_arms(judge):
    """The best one is right for the share that a release computes, up to chance."""
    numbers = np.sort([judge.expected(arm) for arm in ARMS])
    within = np.searchsorted(numbers, numbers + 2.0 * judge.tolerance) - np.arange(len(ARMS))
    least, most = RANGES[judge.of]
    assert within.max() / len(ARMS) <= GUESSED
    assert within.max() / len(ARMS) == pytest.approx(
        2.0 * judge.tolerance / (most - least), abs=0.02
    )


def test_a_cause_of_a_run_is_guessed_by_one_in_eight():
    """Its time has to be right, too."""
    causes = [arm.bugs[0].cause for arm in ARMS]
    assert max(map(causes.count, CAUSES)) / len(ARMS) < 0.15


def test_a_number_that_a_constant_guesses_is_not_released():
    """The course's own numbers are; with the tolerance of 0.12 kg one constant has 40 %."""
    assert not list(guessable(ASKED))
    wide = Identification("my", "?", Measured("payload", "kg", 0.0, 3.0, 0.12), 0.3, "x", 1.0)
    (said,) = guessable([wide])
    assert said.startswith("my: ") and "40%" in said


def test_a_handle_opens_its_arm_in_any_spelling(tmp_path, monkeypatch):
    """Composed or taken apart, of full width, in capitals: one arm, here and for the grader."""
    given = Arms("7", {"jörg": "die möwen", "zoe": "zoe"})
    (tmp_path / FILE).write_text(given.table())
    monkeypatch.chdir(tmp_path)
    for who in ("jörg", unicodedata.normalize("NFD", "jörg"), "JÖRG", " ｊörg"):
        assert own_arm._own(who) == given.arm(who) == draw("7", "Die Möwen")
    assert own_arm._own("zoe") == given.arm("zoe") != given.arm("jörg")
    assert own_arm._own("DEMO") == public_arm()
    with my_arm("zoe") as mine:
        assert mine.plant.payload == 0.0, "it does not say what it carries"
    with pytest.raises(LabkitError, match="has no arm for 'merlin'"):
        my_arm("merlin")
    assert "zoe" not in given.table(), "the file lists no class"


@pytest.mark.parametrize("text", ["", "[]", "{{", '{"%s": "AAAA"}', '{"%s": 3}', '{"%s": {}}'])
def test_a_damaged_file_of_arms_is_a_sentence(tmp_path, monkeypatch, text):
    """It is named, and where another one comes from."""
    (who,) = json.loads(Arms("7", {"kestrel": "kestrel"}).table())
    (tmp_path / FILE).write_text(text.replace("%s", who))
    monkeypatch.chdir(tmp_path)
    with pytest.raises(LabkitError, match=r"arms\.json is damaged; replace it with the arms\.json"):
        my_arm("kestrel")


def test_a_number_is_judged_against_ones_own_arm():
    """The demonstration's number is right for the demonstration, and for nobody else."""
    demo, other = public_arm(), draw("7", "kestrel")
    judge = Measured("payload", "kg", 0.0, 3.0, 0.01)
    asked = Identification("m", "?", judge, demo.payload, "one number", 1.0).question()
    assert mark(asked, LocalFunction(demo.payload)).outcome is Outcome.RIGHT
    assert mark(personalised(asked, other), LocalFunction(other.payload)).outcome is Outcome.RIGHT
    assert mark(personalised(asked, other), LocalFunction(demo.payload)).earned == 0.0
    assert mark(asked.public(), LocalFunction(other.payload)).outcome is Outcome.RIGHT


def swung(monkeypatch, arm, s1, e1, duration, stiffness=50.0):
    """A run of an arm whose joints s1 and e1 swing by these angles, and how far its tip went."""
    monkeypatch.setattr(own_arm, "_own", lambda handle: arm)
    ready = lk.robot("left").ready
    way = s1 * np.eye(7)[1] + e1 * np.eye(7)[3]

    def swing(t):
        w = 0.5 * np.pi
        s, c = np.sin(w * t), np.cos(w * t)
        return lk.Sample(ready + s * way, w * c * way, -w * w * s * way)

    with my_arm("kestrel") as mine:
        inertia = np.diag(mine.model.mass_matrix(ready))
        law = lk.control.springs(stiffness * inertia, 2.0 * np.sqrt(stiffness) * inertia)
        log = lk.run(mine, swing, law, duration=duration)
        tip = [mine.model.pose(q)[0, 3] for q in (ready, *log.q[::5])]
    return log, max(tip) - tip[0]


def loads(log, q):
    """What s1 and e1 seem to carry, in [kg], with the levers at joint angles q."""
    held = log.command[log.t >= 4.0].mean(axis=0)[[1, 3]]
    return held / (lk.Model("left").tip_jacobian(q)[2, [1, 3]] * 9.81)


def test_two_joints_agree_about_the_load_where_they_really_swing(monkeypatch):
    """The springs give way under it: with the levers of the ready pose each joint finds less."""
    heavy = replace(draw("7", "kestrel"), payload=0.8)
    log, _ = swung(monkeypatch, heavy, 0.12, -0.12, 12.0)
    middle = log.q[log.t >= 4.0].mean(axis=0)
    for q, least, most in ((middle, 0.78, 0.82), (lk.robot("left").ready, 0.6, 0.76)):
        assert (least < loads(log, q)).all() and (loads(log, q) < most).all()


@pytest.mark.parametrize("payload", RANGES["payload"])
@pytest.mark.parametrize("stiction", RANGES["stiction"])
def test_the_swing_of_the_hint_reaches_no_wall(monkeypatch, payload, stiction):
    """With stiff springs, too, the tip moves forwards by less than 3 cm; no wall is so near."""
    arm = replace(draw("7", "kestrel"), payload=payload, stiction=stiction, wall=1.0)
    assert swung(monkeypatch, arm, 0.12, -0.12, 5.0, 400.0)[1] < 0.03 < RANGES["wall"][0]
    asked = next(x for x in PREDICTIONS if x.name == "my_payload")
    assert "by at most 0.12 rad and in opposite directions" in asked.hints[1]


def test_a_tip_that_presses_against_the_wall_spoils_the_load(monkeypatch):
    """Joints that swing forwards together by 0.2 rad press it there, and e1 carries too much."""
    public = public_arm()
    for wall, least, most in ((public.wall, 0.12, 0.3), (1.0, -0.06, 0.06)):
        log, far = swung(monkeypatch, replace(public, wall=wall), 0.2, 0.2, 8.0)
        found = loads(log, log.q[log.t >= 4.0].mean(axis=0))
        assert far > public.wall and least < found[1] - public.payload < most


def test_an_arm_at_rest_does_not_feel_its_load(monkeypatch):
    """Its sensors were zeroed with it, so that they feel the wall alone."""
    heavy = replace(draw("7", "kestrel"), payload=0.8)
    monkeypatch.setattr(own_arm, "_own", lambda handle: heavy)
    with my_arm("kestrel") as mine:
        inertia = np.diag(mine.model.mass_matrix(mine.robot.ready))
        law = lk.control.springs(50.0 * inertia, 14.0 * inertia)
        log = lk.run(mine, lk.Hold(mine.robot.ready, 3.0), law)
        felt = lk.metrics.felt_wrench(log)[log.t > 1.0].mean(axis=0)
        assert abs(felt[2]) < 0.1 * 0.8 * 9.81
        assert np.abs(mine.truth().tau_ext).max() < 0.05


def test_a_bug_is_found_by_its_cause_and_its_time():
    """The wrong cause, or a time that is far off, is not found."""
    arm = draw("7", "kestrel")
    assert len({bug.cause for bug in arm.bugs}) == 3 and len(CAUSES) * len(MOVES) >= 12
    judge = Found(0)
    cause, shows = judge.expected(arm)
    assert judge((cause, shows + 0.1), (cause, shows)) is None
    assert judge((cause, shows + 0.3), (cause, shows)) is not None
    wrong = next(letter for letter in CAUSES if letter != cause)
    found = judge((wrong, shows), (cause, shows))
    assert sentence(found) == f"It should be ({cause!r}, {shows}), not ({wrong!r}, {shows})."


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


def test_a_mistake_shows_after_its_onset():
    """Until the mistake comes in the run is the right one."""
    assert 0.5 <= Bug("b", 0, 0.5, 1).first_visible() < 0.6


def test_a_number_of_ones_own_arm_is_not_called_right_where_the_arm_is_not_known():
    """A check says when the number is judged; one of a wrong form is still wrong."""
    judge = Measured("payload", "kg", 0.0, 3.0, 0.01)
    asked = Identification("m", "?", judge, 0.3, "one number", 3.0).question().public()
    says = str(message(asked, mark(asked, lambda: 1.0)))
    assert says.startswith("m: a possible answer. When it is marked, it earns 3 points if it is")
    assert "right" not in " ".join(says.split()).replace("right for your own arm", "")
    assert "not yet right" in str(message(asked, mark(asked, lambda: 7.0)))


def test_how_near_a_measured_number_has_to_be_is_said_above_its_cell():
    """A student knows when to stop measuring."""
    asked = Identification(
        "m", "?", Measured("payload", "kg", 0.0, 3.0, 0.01), 0.3, "a number", 3.0
    )
    assert "It counts if it is off by at most 0.01 kg." in asked.brief()


def test_only_a_calculation_from_runs_is_warned_of_above_the_cell():
    """A fraction such as 1/33 counts, because the cell is run when it is marked; runs are not."""
    asked = Identification("m", "?", Measured("lag", "s", 0.0, 0.5, 0.01), 0.3, "a number", 3.0)
    assert "do not calculate them from your runs, which are not repeated" in asked.brief()


def test_a_wrong_load_of_the_public_arm_is_asked_about_the_wall():
    """The wall spoils the load alone; a wrong lag has nothing to do with it."""
    for of, asks in (("payload", True), ("lag", False)):
        judge = Measured(of, "x", 0.0, 3.0, 0.001)
        question = Identification("m", "?", judge, 0.3, "a number", 3.0).question().public()
        verdict, _ = on_the_public_arm(question, mark(question, LocalFunction(2.5)), 2.5)
        words = " ".join(str(message(question, verdict)).split())
        assert ("than there; did its tip touch the wall in your run?" in words) == asks
