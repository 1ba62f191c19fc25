"""A notebook says whose function moves the arm: the student's or a stand-in."""

import re
import sys
from functools import partial
from pathlib import Path

import pytest

import labkit

sys.path.insert(0, str(Path(__file__).parent))
from student import COURSE, desk, run_here, solved

WRONG = """
def workspace_impedance(state, target, model, *, stiffness, damping):
    return lk.JointTorque(np.full(7, 0.5))
"""


@pytest.fixture
def named(monkeypatch):
    """The names of laws that a notebook hands to `lk.live`, and those of arms in its replays."""
    live, motion_of, laws_of_live, labels = labkit.live, labkit.replay.motion_of, [], []

    def named_live(arm, target, laws, **dials):
        laws_of_live.extend(laws)
        return live(arm, target, laws, **dials)

    def named_motion(log, *args, **options):
        motion = motion_of(log, *args, **options)
        labels.append(motion.label)
        return motion

    monkeypatch.setattr(labkit, "live", named_live)
    monkeypatch.setattr(labkit.replay, "motion_of", named_motion)
    return laws_of_live, labels


@pytest.mark.parametrize(
    ("name", "stand_ins"),
    [("03_velocity_control", 1), ("04_torque_control", 2), ("05_impedance", 1), ("06_tags", 1)],
)
def test_the_live_arm_names_a_stand_in(name, stand_ins, tmp_path, monkeypatch, named):
    """As handed out, each law of the student's is called a stand-in; solved, none is."""
    laws, labels = named
    run_here(name, {}, tmp_path, monkeypatch)
    assert sum("stand-in" in law for law in laws) == stand_ins
    laws.clear()
    labels.clear()
    run_here(name, solved(name), tmp_path, monkeypatch)
    assert not [law for law in laws + labels if "stand-in" in law]


@pytest.mark.parametrize("name", ["02_model", "04_torque_control", "05_impedance"])
def test_no_result_of_a_stand_in_is_called_yours(name, tmp_path, monkeypatch, named):
    """Whoever has predicted, but solved nothing, reads "yours" or "your ..." of no result."""
    parts = {p.name: p.solved() for p in COURSE.predictions(name)}
    sheet = run_here(name, parts, tmp_path, monkeypatch)
    said = [line for line in sheet.printed.splitlines() if not line.startswith("[")]
    words = "\n".join(said + named[1])
    assert not re.search(r"\byours\b|\byour\s(g|gains|springs|impedance)\b", words, re.IGNORECASE)


def test_a_wrong_law_that_loses_the_arm_is_shown_as_the_students(tmp_path, monkeypatch, named):
    """Driven with anyway=True, it leaves its own run, up to where it lost the arm."""
    run = labkit.run

    def lose(arm, target, controller, *args):
        log = run(arm, target, controller, *args)
        if controller.__name__ == "your impedance" and target.duration == 3.5:  # under the push
            error = labkit.errors.Diverged(f"{controller.__name__} lost the arm")
            error.log = log
            raise error
        return log

    monkeypatch.setattr(labkit, "run", lose)
    monkeypatch.setattr("labkit.course.use", partial(desk.use, anyway=True))
    sheet = run_here("05_impedance", {"workspace_impedance": WRONG}, tmp_path, monkeypatch)
    assert "your impedance lost the arm, and is shown here" in sheet.printed
    assert "your impedance" in named[1]
