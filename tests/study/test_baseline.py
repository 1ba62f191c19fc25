"""The built-in method: what it sees, where it goes, how fast, who drives."""

import numpy as np
import pytest

import labkit as lk
from labkit import recordings
from labkit.paths import Line
from solutions.study import tasks
from solutions.study.baseline import (
    HARDWARE,
    MOVEIT,
    RATE,
    Box,
    PathTolerance,
    PlanningScene,
    PositionServer,
    VelocityServer,
    along,
    first_hit,
    plan,
    quickest,
)
from solutions.study.baseline.__main__ import drive

ROBOT = lk.robot("left")
POST = Box("post", (0.62, 0.62, 0.15), (0.08, 0.08, 0.5))


@pytest.fixture(scope="module")
def scene():
    return PlanningScene("left", (lk.Table(), POST))


@pytest.fixture(scope="module")
def ends():
    """Joint angles to the right and to the left of the post."""
    model, R = lk.Model(), tasks.ready_pose()[:3, :3]
    places = ([0.62, 0.42, 0.05], [0.62, 0.85, 0.05])
    return [model.inverse_kinematics(lk.se3.pose(R, p), ROBOT.ready) for p in places]


# What it sees


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_arms_own_poses_touch_nothing(side):
    """Above a table, ready and neutral pose of either arm are free."""
    scene = PlanningScene(side, (lk.Table(),))
    assert scene.free(lk.robot(side).ready) and scene.free(lk.robot(side).neutral)


# Where it goes


def test_the_way_round_a_post_touches_nothing_even_between_the_places_looked_at(scene, ends):
    """At 1,500 places the arm keeps half of the margin, though the straight line hits the post."""
    way = plan(scene, *ends, seed=3)
    assert first_hit(scene, Line(*ends)) is not None, "straight on is the post"
    np.testing.assert_allclose(way(0.0).position, ends[0], rtol=0, atol=1e-9)
    np.testing.assert_allclose(way(1.0).position, ends[1], rtol=0, atol=1e-9)
    least = min(scene.clearance(way(s).position)[0] for s in np.linspace(0, 1, 1500))
    assert least > 0.5 * scene.margin


def test_a_path_of_the_tip_keeps_its_geometry_and_its_largest_speed():
    """The tip is off the line by less than 1e-6 m, and its top speed is the target's to 0.2 %."""
    task, model = tasks.line(), lk.Model()
    way = along(PlanningScene("left", (lk.Table(),)), model, task.target, task.q0, HARDWARE)
    start, goal = (task.target(t).pose[:3, 3] for t in (0.0, task.duration))
    times = np.linspace(0.0, way.duration, 300)
    tips = np.array([model.pose(way(t).position)[:3, 3] for t in times])
    u = (goal - start) / np.linalg.norm(goal - start)
    off = (tips - start) - np.outer((tips - start) @ u, u)
    assert np.abs(off).max() < 1e-6
    speeds = [
        np.linalg.norm(model.tip_jacobian(way(t).position)[:3] @ way(t).velocity) for t in times
    ]
    top = max(np.linalg.norm(task.target(t).twist[:3]) for t in np.linspace(0, task.duration, 500))
    assert max(speeds) == pytest.approx(top, rel=2e-3)


# How fast


def test_on_a_straight_way_the_quickest_schedule_is_the_trapezoid():
    """Toppra against the closed form of Lynch & Park, section 9.2.2, for the joint that binds."""
    step = np.array([0.8, 0.1, -0.2, 0.3, 0.1, 0.0, 0.2])
    found = quickest(Line(ROBOT.ready, ROBOT.ready + step), MOVEIT)
    expected = lk.Trapezoid(0.8, 0.27, 0.5).duration
    assert found.duration == pytest.approx(expected, rel=2e-3)


def test_the_quickest_schedule_keeps_every_limit_and_wastes_none(scene, ends):
    """Time-optimal: at every moment some joint is at a limit of speed or acceleration."""
    found = quickest(plan(scene, *ends, seed=3), HARDWARE)
    times = np.linspace(0.01, 0.99, 400) * found.duration
    samples = [found(t) for t in times]
    v = np.abs([s.velocity for s in samples]) / HARDWARE.speed
    a = np.abs([s.acceleration for s in samples]) / HARDWARE.acceleration
    worst = np.maximum(v.max(axis=1), a.max(axis=1))
    assert worst.max() < 1.01
    assert np.mean(worst > 0.97) > 0.95


# Who drives


def test_the_velocity_server_trails_by_its_targets_speed_over_kp():
    """No feed-forward: on a ramp the error settles at v / kp."""
    speed = 0.05 * np.array([1.0, -1.0, 0.5, 1.0, 0.5, -1.0, 1.0])

    def ramp(t):
        return lk.Sample(ROBOT.ready + speed * t, speed, np.zeros(7))

    with lk.Arm(q0=ROBOT.ready) as arm:
        log = lk.run(arm, ramp, VelocityServer(kp=2.0), rate=RATE, duration=5.0)
    np.testing.assert_allclose(lk.metrics.joint_error(log)[-1], speed / 2.0, rtol=0.01)


@pytest.mark.parametrize("server", [PositionServer(), VelocityServer()])
def test_the_server_gives_up_where_rethinks_does(server):
    """A joint 0.3 rad off its trajectory ends the run of either server; 0.2 rad are allowed."""
    far = ROBOT.ready + 0.3 * np.eye(7)[2]
    with (
        lk.Arm(q0=ROBOT.ready) as arm,
        pytest.raises(lk.LabkitError, match=r"joint 2 is 0\.3 rad from its trajectory.*0\.2"),
    ):
        lk.run(arm, lk.Hold(far, 1.0), server, rate=RATE)
    assert issubclass(PathTolerance, lk.LabkitError)


def test_the_recorded_runs_are_what_the_command_records():
    """Approach and line, driven again, have the angles and targets that ship, to 1e-6."""
    fresh = drive(tasks.line(), PositionServer())
    for name, log in zip(("baseline_approach", "baseline_line"), fresh, strict=True):
        kept = recordings.load(name)
        np.testing.assert_allclose(kept.q, log.q, rtol=0, atol=1e-6)
        np.testing.assert_allclose(kept.target.position, log.target.position, rtol=0, atol=1e-6)
