"""The bench compares like with like."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import labkit as lk
from tests.bench import closed_loop, hand_loop

pytestmark = pytest.mark.pybullet


def test_the_plain_loop_does_the_same_work_bit_for_bit():
    """After 0.5 s it ends at exactly the angles of lk.run, and the arm has moved."""
    target, controller = closed_loop.task()
    client, body = hand_loop.open_arm(lk.robot("left").urdf())
    q = hand_loop.hand_loop(client, body, target, controller, 0.5)
    with lk.Arm() as arm:
        log = lk.run(arm, target, controller, rate=1000, duration=0.5)
    assert_array_equal(q, log.q[-1])
    assert np.abs(q - log.q[0]).max() > 1e-3
