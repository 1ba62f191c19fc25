"""A motion keeps its numbers, stays small, and speaks of itself truly."""

import json
import re
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from samples import swing

from labkit.errors import LabkitError
from labkit.replay import Motion
from labkit.replay.motion import STEPS, _quaternions, pack, unpack


@given(
    arrays(float, st.tuples(st.integers(1, 60), st.integers(1, 8)), elements=st.floats(-50, 50)),
    st.sampled_from([1e-5, 1e-4, 1e-2]),
)
@settings(deadline=None)
def test_packing_errs_by_half_a_step_at_most(x, step):
    """Packed, written as JSON and read again, numbers are off by half of the step at most."""
    assert np.abs(unpack(json.loads(json.dumps(pack(x, step)))) - x).max() <= step / 2 + 1e-12


def test_json_keeps_every_channel():
    """At 25 Hz each number is off by half a step at most, and the last time is the motion's."""
    motion = swing(ghosts=2)
    read = json.loads(motion.to_json(rate=25))
    times = read["start"] + read["period"] * np.arange(len(unpack(read["q"])))
    assert times[-1] == pytest.approx(motion.t[-1])
    for name, rows in {
        "q": motion.q, "target": motion.target_position,
        "error": motion.error[:, None], "tau": motion.tau,
    }.items():  # fmt: skip
        exact = np.column_stack([np.interp(times, motion.t, c) for c in rows.T])
        assert np.abs(unpack(read[name]) - exact).max() <= STEPS[name] / 2 + 1e-9, name
    assert np.abs(unpack(read["path"]) - motion.path).max() <= STEPS["path"] / 2 + 1e-9
    assert list(read["ghosts"]) == list(motion.ghosts)


@pytest.mark.parametrize("ghosts", [0, 2, 4])
def test_ten_seconds_fit_forty_kilobytes(ghosts):
    """With none, two or four ghosts the JSON has at most 40,000 bytes."""
    assert len(swing(10.0, ghosts=ghosts).to_json().encode()) <= 40_000


def test_alternative_text_says_the_true_numbers():
    """Errors, duration, largest torque and the joint that travels most are the motion's."""
    motion = swing()
    rms, most = (1000 * f(motion.error) for f in (lambda e: np.sqrt(np.mean(e**2)), np.max))
    assert f"{rms:.1f} mm RMS, {most:.1f} mm at most" in motion.alt
    assert "10.0 s" in motion.alt
    assert all(name in motion.alt for name in motion.ghosts)
    torque = float(re.search(r"largest torque is (-?[\d.]+) N m", motion.description)[1])
    assert abs(torque) == pytest.approx(np.abs(motion.tau).max(), abs=0.05)
    joint = np.ptp(motion.q, axis=0).argmax()
    assert (
        f"Joint {('s0', 's1', 'e0', 'e1', 'w0', 'w1', 'w2')[joint]} travels" in motion.description
    )


def test_quaternions_are_the_rotations_without_jumps():
    """They give the rotations, and no component changes by 0.1 between two rows."""
    motion = swing()
    x, y, z, w = q = _quaternions(motion.target_rotation).T
    again = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]).transpose(2, 0, 1)  # fmt: skip
    np.testing.assert_allclose(again, motion.target_rotation, rtol=0, atol=1e-12)
    assert np.abs(np.diff(q, axis=1)).max() < 0.1


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"robot": "up"}, "no arm 'up'"),
        ({"q": np.zeros((5, 6))}, "q has shape"),
        ({"q": np.full((5, 7), np.nan)}, "q holds nan"),
        ({"t": [0.0]}, "t has 1 times, and a motion needs at least two"),
    ],
)
def test_wrong_input_is_named(change, sentence):
    """An unknown arm, six joints, NaN and a single time are each refused by name."""
    good = {"robot": "left", "t": np.linspace(0, 1, 5), "q": np.zeros((5, 7))}
    with pytest.raises(LabkitError, match=sentence):
        Motion(**(good | change))


def test_importing_replay_does_not_import_the_widgets():
    """After the import of labkit.replay, anywidget is not loaded."""
    import subprocess

    code = "import sys; import labkit.replay; print('anywidget' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_what_stays_is_told_in_one_number():
    """A range whose ends are equal is one value, and a joint at rest travels nowhere."""
    still = np.tile([0.641, 0.43, 0.03], (2, 1))
    rest = Motion("left", np.array([0.0, 1.0]), np.zeros((2, 7)), target_position=still)
    assert rest.description.endswith(
        "No joint moves by more than 0.005 rad. The target stays at x = 0.64 m, y = 0.43 m, "
        "z = 0.03 m."
    )
    line = replace(rest, target_position=still + [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]])
    assert "moves within x from 0.64 to 0.74 m, y = 0.43 m, z = 0.03 m." in line.description
