"""The built-in method: what it sees, where it goes, how fast, who drives."""

import json
import subprocess
import sys
from importlib.resources import files

import numpy as np
import pytest

import labkit as lk
from labkit import recordings
from labkit.errors import ShapeError, TypeMismatch
from labkit.paths import Line
from solutions.study import tasks
from solutions.study.baseline import (
    HARDWARE,
    MOVEIT,
    RATE,
    Blocked,
    Box,
    JointLimits,
    NoWay,
    PathTolerance,
    PlanningScene,
    PositionServer,
    Schedule,
    VelocityServer,
    along,
    first_hit,
    plan,
    planning,
    quickest,
)
from solutions.study.baseline.__main__ import drive
from solutions.study.baseline.collision import SHAPES

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


def test_the_arms_pictures_stick_out_of_its_simple_shapes_no_further_than_stated():
    """Vertices of the meshes, which come from other files, with the arm stretched out."""
    data = files("labkit") / "data"
    shapes = json.loads(SHAPES.read_text())["left"]["shapes"]
    T_wl = {b["joint"]: k.T_wl for b, k in zip(ROBOT.bodies, links_at_zero(), strict=True)}
    solid = [{**s, "T": T_wl[s["joint"]] @ np.array(s["T"])} for s in shapes if s["joint"] in T_wl]
    worst = {}
    for piece in json.loads((data / "baxter_visual.json").read_text())["pieces"]:
        if piece["parent"] not in T_wl:
            continue
        lines = (data / piece["mesh"]).read_text().splitlines()
        points = np.array([line.split()[1:4] for line in lines if line.startswith("v ")], float)
        *v, w = piece["quaternion"]
        R = np.eye(3) + 2.0 * (w * lk.se3.hat(v) + lk.se3.hat(v) @ lk.se3.hat(v))
        T = T_wl[piece["parent"]]
        world = (points @ R.T + piece["position"]) @ T[:3, :3].T + T[:3, 3]
        off = np.min([distance(s, world) for s in solid], axis=0).max()
        worst[piece["parent"]] = max(off, worst.get(piece["parent"], 0.0))
    assert len(worst) == 7
    assert 0.08 < worst.pop("left_s0") < 0.10
    assert 0.04 < max(worst.values()) < 0.05


def links_at_zero():
    return lk.Model().links(np.zeros(7))


def distance(shape, points):
    """How far points are outside a shape, 0 inside."""
    T = np.array(shape["T"])
    p = (points - T[:3, 3]) @ T[:3, :3]
    if shape["kind"] == "box":
        return np.linalg.norm(np.maximum(np.abs(p) - np.array(shape["size"]) / 2, 0), axis=1)
    radius, length = shape["size"]
    off = np.stack([np.hypot(p[:, 0], p[:, 1]) - radius, np.abs(p[:, 2]) - length / 2])
    return np.linalg.norm(np.maximum(off, 0), axis=0)


def test_the_distance_to_a_table_grows_as_the_table_sinks():
    """The gripper is nearest to it, and 10 mm lower it is 10 mm further away."""
    near, far = (PlanningScene("left", (lk.Table(height=h),)) for h in (-0.05, -0.06))
    (a, arm, table), (b, _, _) = near.clearance(ROBOT.ready), far.clearance(ROBOT.ready)
    assert (arm, table) == ("the left gripper", "the table")
    assert b - a == pytest.approx(0.01, abs=1e-6)


def test_blocked_places_are_named_with_what_touches_what(scene):
    """A start in the torso, a goal beyond a joint's range and a flat box are refused in words."""
    folded = np.array([0.4, 0.8, -0.4, 2.5, 0.0, 0.0, 0.7])
    with pytest.raises(Blocked, match=r"start puts the left gripper \d+ mm into the torso;"):
        plan(scene, folded, ROBOT.ready)
    q = np.array(ROBOT.ready)
    q[3] = 3.0
    with pytest.raises(lk.errors.JointLimitExceeded, match="goal: joint left_e1"):
        plan(scene, ROBOT.neutral, q)
    with pytest.raises(lk.LabkitError, match="post's size"):
        Box("post", (0, 0, 0), (0, 1, 1))


def test_what_is_no_obstacle_or_no_place_of_the_joints_is_a_sentence(scene):
    """A spring, six angles and a path of points are refused; lists of seven are not."""
    with pytest.raises(TypeMismatch, match="expected a Box, a Table or a Wall"):
        PlanningScene("left", (lk.Spring([0.6, 0.2, 0.1], 300.0),))
    for q in (np.zeros(6), [0.0] * 6):
        with pytest.raises(ShapeError, match="q has shape"):
            scene.free(q)
    assert scene.free(list(ROBOT.ready)) == scene.free(ROBOT.ready)
    with pytest.raises(ShapeError, match="the path's position has shape"):
        quickest(Line([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]))


# Where it goes


def test_the_way_round_a_post_touches_nothing_even_between_the_places_looked_at(scene, ends):
    """At 1,500 places the arm keeps half of the margin, though the straight line hits the post."""
    way = plan(scene, *ends, seed=3)
    assert first_hit(scene, Line(*ends)) is not None, "straight on is the post"
    np.testing.assert_allclose(way(0.0).position, ends[0], rtol=0, atol=1e-9)
    np.testing.assert_allclose(way(1.0).position, ends[1], rtol=0, atol=1e-9)
    least = min(scene.clearance(way(s).position)[0] for s in np.linspace(0, 1, 1500))
    assert least > 0.5 * scene.margin


def test_the_same_seed_gives_the_same_way(scene, ends, capfd):
    """It is the same bit for bit, another seed's differs, and the planner prints nothing."""
    a, b, c = (plan(scene, *ends, seed=seed) for seed in (5, 5, 6))
    np.testing.assert_array_equal(a.values, b.values)
    assert a.values.shape != c.values.shape or np.abs(a.values - c.values).max() > 1e-3
    assert capfd.readouterr() == ("", ""), "the planner keeps quiet"


def test_no_way_is_a_sentence_that_names_the_hindrance(scene, ends, monkeypatch):
    """After the three places that it may try, it says where the straight line meets the post."""
    monkeypatch.setattr(planning, "CHECKS", 3)
    with pytest.raises(NoWay, match=r"after 3 places; going straight, s = 0\.\d\d .* the post"):
        plan(scene, *ends)


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


def test_a_path_through_an_obstacle_says_where_and_what():
    """The sentence names s, the gripper and the board that it would come too near to."""
    task = tasks.line()
    board = Box("board", task.target(0.0).pose[:3, 3] + (0.05, -0.075, 0.05), (0.04, 0.04, 0.04))
    with pytest.raises(
        Blocked, match=r"the path at s = 0\.\d\d brings the left gripper .* of the board"
    ):
        along(PlanningScene("left", (board,)), lk.Model(), task.target, task.q0)


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


def test_a_schedule_is_its_own_slope():
    """Its speed is the slope of s over time, and outside its duration it is at rest."""
    s = np.linspace(0, 1, 30)
    schedule = Schedule(s, np.sin(np.pi * s) + 0.2 * s * (1 - s))
    h = 1e-6
    for t in np.linspace(0.05, 0.95, 50) * schedule.duration:
        (a, _, _), (_, ds, _), (b, _, _) = (schedule(x) for x in (t - h, t, t + h))
        assert (b - a) / (2 * h) == pytest.approx(ds, rel=1e-6)
    assert schedule(schedule.duration) == (1.0, 0.0, 0.0) and schedule(-1.0) == (0.0, 0.0, 0.0)


def test_bad_limits_and_schedules_are_sentences():
    """A joint without speed and a schedule that never moves are refused."""
    with pytest.raises(lk.LabkitError, match="speed is 0 at a joint"):
        JointLimits(np.zeros(7), np.ones(7))
    with pytest.raises(lk.LabkitError, match=r"stands still at s = 0\.000"):
        Schedule([0.0, 0.5, 1.0], [0.0, 0.0, 0.0])


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


def test_without_the_extra_a_sentence_tells_what_to_install():
    """Where toppra is missing, the import fails with the pip command for it."""
    code = "import sys; sys.modules['toppra'] = None\nimport solutions.study.baseline"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert 'the baseline needs toppra, which is not installed: pip install "labkit[book]"' in (
        done.stderr
    )
