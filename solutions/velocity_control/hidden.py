"""Hidden cases of notebook 03."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

import labkit as lk
from labkit.course import Call, Loop, OwnArm
from labkit.course.authoring.problem import call

Random = np.random.Generator
MODEL = lk.Model("left")
READY = MODEL.robot.ready
REST = np.zeros(7)
STRETCHED = np.array([-0.3, -0.4, 0.1, 0.06, 0.2, 0.5, 0.0])
"""Joint angles with an almost straight elbow, near a singularity."""


def state(q: Any, dq: Any = REST) -> lk.State:
    """The joints at the angles q."""
    return lk.State(0.7, np.array(q, dtype=float), np.array(dq, dtype=float))


def sample(q: Any, dq: Any = REST, ddq: Any = REST) -> lk.Sample:
    """A target of joint angles."""
    position, velocity, acceleration = (np.array(x, dtype=float) for x in (q, dq, ddq))
    return lk.Sample(position, velocity, acceleration)


def pose_sample(q: Any, shift: Any = (0, 0, 0), turn: Any = (0, 0, 0), twist: Any = None) -> Any:
    """A target pose: that of the tip at q, shifted in [m] and turned about tool axes in [rad]."""
    T = MODEL.pose(q)
    T_wd = lk.se3.pose(T[:3, :3] @ lk.se3.rotation(turn), T[:3, 3] + shift)
    return lk.PoseSample(T_wd, np.zeros(6) if twist is None else np.array(twist), np.zeros(6))


def near(random: Random) -> Any:
    """Joint angles near the ready pose."""
    return READY + random.uniform(-0.3, 0.3, 7)


def joint_offsets(random: Random) -> Iterator[Call]:
    """Offsets of all joints, everything at rest."""
    for kp in random.uniform(1.0, 8.0, 2):
        yield call(state(near(random)), sample(near(random)), kp=kp, kd=0.0)


def joint_speeds(random: Random) -> Iterator[Call]:
    """A moving joint that is at its target."""
    for _ in range(2):
        q = near(random)
        yield call(
            state(q, random.uniform(-0.5, 0.5, 7)), sample(q), kp=3.0, kd=random.uniform(0.1, 0.8)
        )


def joint_targets(random: Random) -> Iterator[Call]:
    """Moving targets, a gain for each joint."""
    for _ in range(3):
        yield call(
            state(near(random), random.uniform(-0.5, 0.5, 7)),
            sample(near(random), *random.uniform(-0.5, 0.5, (2, 7))),
            kp=random.uniform(1.0, 8.0, 7),
            kd=random.uniform(0.1, 0.8, 7),
        )


def joint_run(start: Any, way: Any) -> Loop:
    """A run after a moving target from a wrong start, with over half a second to recover."""
    target = lk.Trajectory(lk.Line(READY, READY + way), lk.Quintic(2.5))
    return Loop(
        target,
        {"kp": 4.0, "kd": 0.3},
        q0=READY + start,
        settle=2.0,
        expected={"max_mm": 4.0, "max_deg": 0.6},
    )


def joint_runs(random: Random) -> Iterator[Loop]:
    """Another start and another motion."""
    yield joint_run(random.uniform(-0.1, 0.1, 7), 0.5 * np.array([1, -0.6, 0.3, 1, 0.4, -0.5, 0.8]))


def runs_of_the_figure(random: Random) -> Iterator[Call]:
    """The runs whose letters are not told."""
    for run in ("H", "P", "tilt"):
        yield call(run)


def other_arms(random: Random) -> Iterator[Call]:
    """Two arms that nobody has seen."""
    for _ in range(2):
        yield call(OwnArm.drawn(random))


def rates(random: Random) -> Iterator[Call]:
    """Other gains."""
    for _ in range(3):
        yield call(random.uniform(0.5, 9.0), random.uniform(0.2, 4.0))


def rates_without_d(random: Random) -> Iterator[Call]:
    """Other gains, kd = 0."""
    yield call(random.uniform(0.5, 9.0), 0.0)


def inverses_plain(random: Random) -> Iterator[Call]:
    """Other poses, no damping."""
    yield call(MODEL.tip_jacobian(near(random)), 0.0)


def inverses_stretched(random: Random) -> Iterator[Call]:
    """Other poses with the elbow almost straight."""
    q = STRETCHED + random.uniform(-0.03, 0.03, 7)
    yield call(MODEL.tip_jacobian(q), random.uniform(2e-3, 5e-3))


def inverses(random: Random) -> Iterator[Call]:
    """Any poses and dampings."""
    for q in (near(random), STRETCHED + random.uniform(-0.03, 0.03, 7)):
        yield call(MODEL.tip_jacobian(q), random.uniform(1e-3, 1e-2))


def pose_shifts(random: Random) -> Iterator[Call]:
    """Other offsets of position."""
    q = near(random)
    yield call(state(q), pose_sample(q, random.uniform(-0.05, 0.05, 3)), MODEL, kp=2.0, damping=0.0)


def pose_turns(random: Random) -> Iterator[Call]:
    """Roll, pitch and yaw offsets, one by one, at other poses."""
    for axis in np.eye(3):
        q = near(random)
        x = pose_sample(q, turn=random.choice((-1, 1)) * random.uniform(0.05, 0.3) * axis)
        yield call(state(q), x, MODEL, kp=random.uniform(1.0, 5.0, 6), damping=0.003)
    q = near(random)
    x = pose_sample(q, turn=random.uniform(1.9, 2.6) * np.eye(3)[random.integers(3)])
    yield call(state(q), x, MODEL, kp=2.0, damping=0.003)


def pose_moves(random: Random) -> Iterator[Call]:
    """Other twists, off the target and turned from it by a little or by over 90 degrees."""
    for off, least, most in ((0.0, 0.0, 0.0), (0.03, 0.0, 0.3), (0.03, 1.2, 1.4)):
        q = near(random)
        turn = random.uniform(least, most, 3) * random.choice((-1.0, 1.0), 3)
        x = pose_sample(q, off * random.uniform(-1.0, 1.0, 3), turn, random.uniform(-0.2, 0.2, 6))
        yield call(state(q, random.uniform(-0.5, 0.5, 7)), x, MODEL, kp=3.0, damping=0.004)


def pose_stretched(random: Random) -> Iterator[Call]:
    """Other stretched poses."""
    q = STRETCHED + random.uniform(-0.03, 0.03, 7)
    x = pose_sample(q, random.uniform(-0.03, 0.03, 3))
    dq = random.uniform(-0.5, 0.5, 7)
    yield call(state(q, dq), x, MODEL, kp=2.0, damping=random.uniform(0.002, 0.005))


def pose_run(shift: Any, turn: Any) -> Loop:
    """A run along a circle, turning, from a shifted and tilted start, with time to recover."""
    T = MODEL.pose(READY)
    circle = lk.Circle(T[:3, 3], T[:3, 3] + [0.0, -0.1, 0.0])
    goal = T[:3, :3] @ lk.se3.rotation([0.4, -0.3, 0.5])
    tilted = lk.se3.pose(T[:3, :3] @ lk.se3.rotation(turn), T[:3, 3] + shift)
    return Loop(
        lk.Trajectory(lk.PosePath(circle, T[:3, :3], goal), lk.Quintic(4.0)),
        {"model": MODEL, "kp": 4.0, "damping": 1e-5},
        q0=MODEL.inverse_kinematics(tilted, READY),
        settle=1.5,
        expected={"max_mm": 2.0, "max_deg": 0.5},
    )


def pose_runs(random: Random) -> Iterator[Loop]:
    """Another start."""
    yield pose_run(random.uniform(-0.03, 0.03, 3), random.choice((-0.15, 0.15), 3))


def postures(random: Random) -> Iterator[Call]:
    """Any poses and wishes."""
    for _ in range(4):
        yield call(MODEL.tip_jacobian(near(random)), random.uniform(-1.0, 1.0, 7))


def postures_orthonormal(random: Random) -> Iterator[Call]:
    """Other such matrices."""
    J = np.linalg.qr(random.standard_normal((7, 6)))[0].T
    yield call(J, random.uniform(-1.0, 1.0, 7))
