"""A motion keeps its numbers, stays small, and speaks of itself truly."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from samples import swing

from labkit.errors import LabkitError
from labkit.replay import Motion
from labkit.replay.motion import _quaternions, pack, unpack


@given(
    arrays(float, st.tuples(st.integers(1, 60), st.integers(1, 8)), elements=st.floats(-50, 50)),
    st.sampled_from([1e-5, 1e-4, 1e-2]),
)
@settings(deadline=None)
def test_packing_errs_by_half_a_step_at_most(x, step):
    """Packed, written as JSON and read again, numbers are off by half of the step at most."""
    assert np.abs(unpack(json.loads(json.dumps(pack(x, step)))) - x).max() <= step / 2 + 1e-12


@pytest.mark.parametrize("ghosts", [0, 2, 4])
def test_ten_seconds_fit_forty_kilobytes(ghosts):
    """With none, two or four ghosts the JSON has at most 40,000 bytes."""
    assert len(swing(10.0, ghosts=ghosts).to_json().encode()) <= 40_000


def test_alternative_text_says_the_true_numbers():
    """Errors, duration, largest torque and the other arms are the motion's."""
    motion = swing()
    rms, most = (1000 * f(motion.error) for f in (lambda e: np.sqrt(np.mean(e**2)), np.max))
    torque = np.abs(motion.tau).max()
    for said in (f"{rms:.1f} mm RMS, {most:.1f} mm", "10.0 s", f"{torque:.1f} N m", *motion.ghosts):
        assert said in motion.alt


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


@pytest.mark.parametrize("change", [{"q": np.zeros((5, 6))}, {"t": [0.0]}, {"robot": "up"}])
def test_wrong_input_is_refused(change):
    """Six joints, a single time, and an unknown arm."""
    with pytest.raises(LabkitError):
        Motion(**({"robot": "left", "t": np.linspace(0, 1, 5), "q": np.zeros((5, 7))} | change))
