"""Trajectories, chains, pose paths and holds: every velocity is a slope, every end at rest."""

import numpy as np
import pytest
from curves import assert_at_rest, assert_pose_slopes, assert_slopes
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose

from labkit import (
    BangBang,
    Chain,
    Circle,
    Cubic,
    Hold,
    Line,
    PosePath,
    PoseSample,
    Quintic,
    Sample,
    Trajectory,
    Trapezoid,
    se3,
)
from labkit.errors import OutOfRange

A, B, C = [0.6, 0.2, 0.1], [0.5, -0.2, 0.3], [0.4, 0.0, 0.0]


def lost(s):
    return Sample(*np.full((3, 3), np.nan))


PATHS = {"line": Line(A, B), "circle": Circle(A, C)}
SCALINGS = (BangBang(2.0), Cubic(2.0), Quintic(2.0), Trapezoid(1.0, 0.8, 1.6))
turns = arrays(np.float64, 3, elements=st.floats(-1.7, 1.7))
paths, scalings = st.sampled_from(list(PATHS.values())), st.sampled_from(SCALINGS)
fractions = st.floats(0.01, 0.99)
CORNERS = (0.5, 2.0 * 0.25, 0.5 / 1.75, 1.25 / 1.75)  # where an acceleration jumps


@given(paths, scalings, fractions)
def test_a_trajectorys_velocity_and_acceleration_are_its_slopes(path, scaling, x):
    """For lines and circles in four profiles, away from where an acceleration jumps."""
    assume(all(abs(x - c) > 1e-3 for c in CORNERS))
    assert_slopes(Trajectory(path, scaling), x * scaling.duration)


@given(paths, scalings, st.floats(0.0, 1e3))
def test_before_the_start_and_after_the_end_a_trajectory_rests(path, scaling, t):
    """It is at the path's start before, at its end after, and neither moves nor speeds up."""
    trajectory = Trajectory(path, scaling)
    assert_at_rest(trajectory(-1e-9 - t), path(0.0).position)
    assert_at_rest(trajectory(scaling.duration + t), path(1.0).position)


def test_no_distance_in_no_time_is_the_place_itself():
    """A line without length in a profile without duration is at rest there at every time."""
    there = Trajectory(Line(A, A), Trapezoid(0.0, 1.0, 1.0))
    assert there.duration == 0.0
    for t in (-1.0, 0.0, 1.0):
        assert_at_rest(there(t), A)


def test_a_target_written_by_a_student_works_as_path_and_as_scaling():
    """With a function as path and a class as scaling, the derivatives are still slopes."""

    class Ramp:
        duration = 2.0

        def __call__(self, t):
            return t / 2.0, 0.5, 0.0

    def parabola(s):
        return Sample(np.array([s, s * s]), np.array([1, 2 * s]), np.array([0, 2.0]))

    assert_slopes(Trajectory(parabola, Ramp()), 0.7)


def chain():
    parts = [Trajectory(Line(A, B), Quintic(1.0)), Trajectory(Line(B, C), Trapezoid(0.5, 1, 2))]
    return Chain([*parts, Hold(C, 0.5)])


def test_a_chain_starts_each_part_when_the_one_before_has_ended():
    """Parts of 1 s, 1 s and 0.5 s start at 0, 1 and 2 s, and the chain rests outside."""
    c = chain()
    assert c.starts == [0.0, 1.0, 2.0]
    assert c.duration == 2.5
    assert_at_rest(c(-1.0), A)
    assert_allclose(c(1.0).position, B, rtol=0, atol=1e-15)
    assert_allclose(c(2.0).position, C, rtol=0, atol=1e-15)
    assert_at_rest(c(9.0), C)


@given(st.floats(0.01, 2.4))
def test_a_chains_velocity_and_acceleration_are_its_slopes(t):
    """They are at any time but those at which an acceleration jumps."""
    assume(all(abs(t - x) > 1e-3 for x in (1.0, 1.5, 2.0)))
    assert_slopes(chain(), t)


def test_a_part_that_begins_elsewhere_is_numbered():
    """The second of two, from 1 on."""
    with pytest.raises(OutOfRange, match=r"^part 2 .* part 1 "):
        Chain([Hold(A, 1.0), Hold(B, 1.0)])


def test_a_chain_is_continuous_in_position_and_velocity_at_its_joints():
    """Neither jumps between 1 ns before a part's start and the start itself."""
    c = chain()
    for t in c.starts[1:]:
        before, after = c(t - 1e-9), c(t)
        assert_allclose(before.position, after.position, rtol=0, atol=1e-8)
        assert_allclose(before.velocity, after.velocity, rtol=0, atol=1e-7)


def test_chains_nest_and_parts_without_duration_are_passed_over():
    """Parts of 1 s, 0 s and, in a chain of its own, 1 s last 2 s and rest where they meet."""
    still = Trajectory(Line(B, B), Cubic(0.0))
    c = Chain([Trajectory(Line(A, B), Cubic(1.0)), still, Chain([Hold(B, 1.0)])])
    assert c.duration == 2.0
    assert_at_rest(c(1.0), B)


@given(paths, turns, turns, fractions)
def test_a_pose_paths_twist_is_the_slope_of_its_pose(path, a, b, s):
    """In s, between any two orientations; and the twist's rate is the slope of the twist."""
    pose_path = PosePath(path, se3.rotation(a), se3.rotation(b))
    assert_pose_slopes(pose_path, s, tolerance=1e-5)


@given(scalings, turns, turns, fractions)
def test_a_pose_trajectorys_twist_is_the_slope_of_its_pose(scaling, a, b, x):
    """In time, where no acceleration jumps; and the twist's rate is the slope of the twist."""
    assume(all(abs(x - c) > 1e-3 for c in CORNERS))
    trajectory = Trajectory(PosePath(Line(A, B), se3.rotation(a), se3.rotation(b)), scaling)
    assert_pose_slopes(trajectory, x * scaling.duration, tolerance=1e-5)


@given(turns, turns)
def test_a_pose_path_turns_evenly_from_its_first_to_its_last_orientation(a, b):
    """It has both at its ends, and a quarter of the turn at s = 0.25."""
    R_wt, R_goal = se3.rotation(a), se3.rotation(b)
    path = PosePath(Line(A, B), R_wt, R_goal)
    assert_allclose(path(0.0).pose[:3, :3], R_wt, rtol=0, atol=1e-14)
    assert_allclose(path(1.0).pose[:3, :3], R_goal, rtol=0, atol=1e-8)
    whole = se3.angle_between(R_wt, R_goal)
    assert se3.angle_between(R_wt, path(0.25).pose[:3, :3]) == pytest.approx(whole / 4, abs=1e-7)


def test_a_pose_path_without_goal_keeps_its_orientation():
    """Its orientation is the first one at every s, and its angular velocity is zero."""
    R = se3.rotation([0.1, 0.2, 0.3])
    for s in (0.0, 0.4, 1.0):
        T, twist, _ = PosePath(Line(A, B), R)(s)
        assert_allclose(T[:3, :3], R)
        assert not twist[3:].any()


def test_a_pose_trajectory_rests_before_and_after():
    """It is at the first pose before its start and at the last one after its end."""
    trajectory = Trajectory(PosePath(Line(A, B), np.eye(3), se3.rotation([0, 0, 1.0])), Cubic(2.0))
    assert_at_rest(trajectory(-1.0), se3.pose(np.eye(3), A))
    assert_at_rest(trajectory(3.0), se3.pose(se3.rotation([0, 0, 1.0]), B))


@pytest.mark.parametrize("place", [np.zeros(7), A, se3.pose(np.eye(3), A)])
def test_a_hold_holds_angles_a_point_or_a_pose(place):
    """At every time the place is the one given, as a sample or, for a matrix, as a pose sample."""
    hold = Hold(place, 2.0)
    assert hold.duration == 2.0
    assert isinstance(hold(0.0), PoseSample if np.ndim(place) == 2 else Sample)
    assert hold(0.0)[1].shape == ((6,) if np.ndim(place) == 2 else np.shape(place))
    for t in (-1.0, 0.0, 5.0):
        assert_at_rest(hold(t), place)
