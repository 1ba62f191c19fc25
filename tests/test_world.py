"""The world: its own clock, nothing shared, closed for good."""

import subprocess
import sys

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import labkit as lk
from labkit.errors import Closed


def test_its_clock_counts_physics_steps():
    """1,500 steps of 1 ms are exactly 1.5 s, and 5 of 0.2 ms are 1 ms."""
    with lk.World() as world:
        assert world.t == 0.0
        world.step(1500)
        assert world.t == 1.5
    with lk.World(dt=2e-4) as world:
        world.step(5)
        assert world.t == pytest.approx(1e-3)


def test_two_worlds_share_nothing():
    """While one arm turns by more than 0.05 rad, clock and arm of another world stand still."""
    with lk.Arm() as a, lk.Arm("right") as b:
        before = b.state()
        a.apply(lk.JointVelocity(np.ones(7)))
        a.world.step(100)
        assert b.state().t == 0.0
        assert_array_equal(b.state().q, before.q)
        assert np.abs(a.state().q - a.robot.neutral).max() > 0.05


def test_a_closed_world_says_so_and_closing_twice_is_harmless():
    """Each use of its arm is refused, and the error says to make a new one."""
    arm = lk.Arm()
    arm.close()
    arm.close()
    for use in (arm.state, arm.reset, arm.world.step):
        with pytest.raises(Closed, match="closed; make a new"):
            use()
    with pytest.raises(Closed, match="make a new Arm"):
        arm.apply(lk.JointTorque(np.zeros(7)))
    for disturb, numbers in ((arm.push, np.zeros(3)), (arm.pull, np.zeros(7))):
        with pytest.raises(Closed, match="make a new"):
            disturb(numbers)
    with pytest.raises(Closed, match="make a new"):
        lk.run(arm, lk.Hold(arm.robot.neutral, 0.1), lambda s, x: lk.JointTorque(np.zeros(7)))


def test_closing_one_world_leaves_the_next_one_alone():
    """PyBullet gives the number of a closed world to the next one."""
    first = lk.Arm()
    first.close()
    with lk.Arm() as second:
        with pytest.raises(Closed):
            first.state()
        assert_array_equal(second.state().q, second.robot.neutral)


def test_pybullet_says_nothing_on_either_stream():
    """Banner and warnings go to the process's own streams: only a process of its own shows them."""
    program = (
        "import numpy as np, labkit as lk\n"
        "for side in ('left', 'right'):\n"
        "    with lk.Arm(side, lk.BAXTER) as arm:\n"
        "        q = arm.robot.ready\n"
        "        arm.reset(q)\n"
        "        lk.run(arm, lk.Hold(q, 0.1), lambda s, x: lk.JointPosition(x.position))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=600)
    assert done.returncode == 0, done.stderr
    assert (done.stdout, done.stderr) == (b"", b"")
