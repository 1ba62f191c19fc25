"""What a joint motion asks too much is said before the arm moves."""

import warnings

import numpy as np
import pytest

import labkit as lk
from labkit.errors import LabkitWarning, Unreachable

MODEL = lk.Model()
READY = MODEL.robot.ready
TIP = MODEL.pose(READY)[:3, 3]


def line(seconds, way=(0.1, 0.2, 0.1)):
    return lk.Trajectory(lk.Line(TIP, TIP + np.array(way)), lk.Quintic(seconds))


def test_a_motion_within_the_limits_says_nothing():
    """Three seconds for 24 cm bring no warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        MODEL.joint_trajectory(line(3.0), READY)


def test_too_much_speed_is_a_warning_with_the_time_that_would_do():
    """It names the joint, both speeds and a duration; that duration is accepted."""
    with pytest.warns(
        LabkitWarning, match=r"joint left_\w\d should turn at .* but its limit is"
    ) as got:
        MODEL.joint_trajectory(line(0.2), READY)
    enough = float(str(got[0].message).rsplit("takes ", 1)[1].split()[0])
    assert 0.2 < enough < 2.0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        MODEL.joint_trajectory(line(1.01 * enough), READY)


def test_a_path_near_a_singularity_is_a_warning_with_the_manipulability():
    """A path that ends with the elbow almost straight says where and how near."""
    q = READY.copy()
    q[[1, 3, 5]] = -0.3, 0.25, 0.3
    goal = q.copy()
    goal[3] = 0.03
    path = lk.Line(MODEL.pose(q)[:3, 3], MODEL.pose(goal)[:3, 3])
    R = MODEL.pose(q)[:3, :3]
    turned = lk.PosePath(path, R, MODEL.pose(goal)[:3, :3])
    with pytest.warns(LabkitWarning, match=r"at s = \d.* manipulability .* singular value"):
        MODEL.joint_trajectory(lk.Trajectory(turned, lk.Quintic(30.0)), q)


def test_a_path_out_of_the_workspace_is_refused():
    """It names s and the reason."""
    with pytest.raises(Unreachable, match="at s = "):
        MODEL.joint_trajectory(line(3.0, (1.0, 0.0, 0.0)), READY)
