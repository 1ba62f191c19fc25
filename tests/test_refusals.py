"""What the lab refuses, and by which error: wrong shapes, types and numbers, and wrong order."""

from dataclasses import replace

import numpy as np
import pytest

import labkit as lk
from labkit import metrics, recordings, se3
from labkit.errors import (
    Closed,
    ControllerError,
    JointLimitExceeded,
    LabkitError,
    NotFinite,
    OutOfRange,
    ShapeError,
    TypeMismatch,
    UnknownName,
)
from labkit.shapes import as_array, as_gains, as_number
from labkit.stability import VelocityJoint, margins

MODEL = lk.Model()
READY, A, B, EYE = MODEL.robot.ready, [0.6, 0.2, 0.1], [0.7, 0.3, 0.2], np.eye(3)
LINE, MIRROR = lk.Line(A, B), np.diag([1.0, 1.0, -1.0])
INTEGRATOR = VelocityJoint(0.0, 0.1)


def follow(state, target):
    return lk.JointPosition(target.position)


STAY = lk.Hold(READY, 0.1)


def run(target=STAY, controller=follow, **given):
    with lk.Arm() as arm:
        lk.run(arm, target, controller, **given)


def act(thing, *sides):
    with lk.World(things=[thing]) as world:
        for side in sides:
            lk.Arm(side, world=world)
        world.step()


def twice():
    with lk.Arm() as arm:
        lk.Arm(world=arm.world)


def closed():
    with lk.World() as world:
        pass
    world.put(lk.Table())


REFUSED = {
    ShapeError: (
        *(lambda x=x: as_array(x, (7,), "q") for x in (
            np.zeros((7, 1)), np.zeros((1, 7)), np.zeros(6), [0.0] * 8, 3.0, np.zeros((7, 7)),
            np.zeros((7, 1)).view(np.matrix))),
        lambda: as_gains([1, 2], 3, "Kp"),
        *(lambda x=x: as_number(x, "v_max") for x in ([1.0, 2.0], [1.0])),
        lambda: se3.as_pose(EYE, "T"), lambda: se3.hat([1.0, 2.0]),
        lambda: se3.pose_error(EYE, np.eye(4)),
        lambda: lk.Line([0, 0, 0], [1, 0]), lambda: lk.Circle([0, 0], [1, 0]),
        lambda: lk.Polyline([[0, 0, 0]]), lambda: lk.Polyline([0, 0, 0]),
        lambda: lk.Trapezoid([1, 2], 1.0, 2.0),
        lambda: lk.PosePath(LINE, np.eye(4)),
        lambda: lk.PosePath(lk.Line([0] * 7, [1] * 7), EYE)(0.0),
        lambda: lk.Hold(np.zeros((7, 1)), 1.0),
        lambda: lk.Wall((0, 0), (0, 0, 1)), lambda: lk.Push((1.0, 0.0)),
        lambda: metrics.settling_time([0, 1], [3, 2, 0.1], 0.5),
        lambda: lk.JointTorque(np.zeros((7, 1))),
        lambda: lk.Arm(plant=replace(lk.BAXTER, stiction=(1.0, 2.0))),
        lambda: MODEL.coriolis(READY, np.zeros((7, 1))), lambda: MODEL.pose(np.zeros(6)),
        lambda: MODEL.tip_wrench(READY, np.zeros(6)),
    ),
    TypeMismatch: (
        *(lambda x=x: as_array(x, (7,), "q") for x in (
            "home", None, [0, 0, 0, 0, 0, 0, "a"], [[1, 2], [3]], np.zeros(7, dtype=complex),
            np.zeros(7, dtype=object), {"s0": 0.0})),
        lambda: as_gains("high", 3, "Kp"), lambda: as_number("2", "v_max"),
        lambda: se3.pose_error(np.eye(4), None), lambda: lk.Line("here", "there"),
        lambda: lk.BangBang("2 s"), lambda: lk.PosePath(LINE, "down"),
        lambda: lk.Trajectory(lambda s: np.zeros(3), lk.Cubic(1.0))(0.5),
        lambda: lk.Trajectory(lambda s: (s, 1.0, 0.0), lk.Cubic(1.0))(0.5),
        lambda: lk.Trajectory(LINE, 2.0), lambda: lk.Trajectory(A, lk.Cubic(1.0)),
        lambda: lk.Trajectory(lk.Cubic(1.0), LINE), lambda: lk.Trajectory(LINE, LINE),
        lambda: lk.Chain([LINE]), lambda: lk.Chain([lk.Hold(A, 1.0), lk.Hold([0.0] * 7, 1.0)]),
        lambda: lk.Chain([lk.Hold(A, 1.0), lk.Hold(se3.pose(EYE, A), 1.0)]),
        lambda: lk.Table(colour="red"), lambda: act(lk.Table), lambda: act("table"),
        lambda: metrics.rms("small"), lambda: lk.JointTorque(0.0), lambda: lk.JointTorque(None),
        lambda: lk.Plant(stiction="high"), lambda: lk.Plant(payload=None), lambda: lk.World("1 ms"),
        lambda: lk.Arm(plant="baxter"), lambda: lk.Arm(seed=-1), lambda: lk.Arm(world=lk.Table()),
        lambda: lk.run(None, LINE, follow), lambda: run(None), lambda: run(controller=None),
        lambda: run(follow, STAY), lambda: run(rate="fast"),
        lambda: MODEL.joint_trajectory(LINE, READY),
        lambda: MODEL.joint_trajectory(lk.Hold(READY, 1.0), READY),
    ),
    NotFinite: (
        lambda: as_array([0, 0, np.inf], (3,), "q"), lambda: as_number(np.nan, "v_max"),
        lambda: se3.pose(EYE, [np.nan, 0, 0]), lambda: lk.Line([0, 0, np.nan], [1, 0, 0]),
        lambda: lk.Quintic(np.nan), lambda: lk.Hold([0, 0, np.nan], 1.0),
        lambda: metrics.rms([1.0, np.nan]), lambda: margins(INTEGRATOR, 1.0, np.nan),
        lambda: lk.JointTorque([np.nan] + [0.0] * 6), lambda: lk.Plant(velocity_noise=np.nan),
        lambda: lk.Plant(state_rate=np.inf), lambda: lk.World(np.nan), lambda: run(rate=np.nan),
        lambda: run(duration=np.inf),
        lambda: MODEL.inverse_kinematics(np.eye(4) * np.nan, READY),
    ),
    OutOfRange: (
        lambda: as_gains([1, 1, -2], 3, "Kp"), lambda: as_number(0.0, "v_max", above=0.0),
        lambda: as_number(-1, "v_max", least=0.0),
        lambda: se3.rotation_log(np.ones((3, 3))), lambda: se3.rotation_log(MIRROR),
        lambda: se3.as_pose(se3.pose(EYE, A).T, "T"),
        lambda: lk.Circle([1, 2, 0], [1, 2, 3]),
        lambda: lk.Polyline([A, A]), lambda: lk.Cubic(-1.0), lambda: lk.Trapezoid(1.0, 0.0, 1.0),
        lambda: lk.Trapezoid(1.0, 1.0, -2.0), lambda: lk.Trapezoid(-1.0, 1.0, 2.0),
        lambda: lk.Quintic.within(1.0, 0.0, 1.0), lambda: lk.PosePath(LINE, EYE, MIRROR),
        lambda: lk.Hold(A, -1.0), lambda: lk.Hold(2.0 * np.eye(4), 1.0), lambda: lk.Chain([]),
        lambda: lk.Chain([lk.Hold(A, 1.0), lk.Hold(np.add(A, 2e-4), 1.0)]),
        lambda: lk.Wall(A, (0, 0, 0)), lambda: lk.Wall(A, (0, 0, 1), stiffness=-1.0),
        lambda: lk.Table(size=(0.0, 1.0)), lambda: lk.Spring(A, stiffness=-5.0),
        lambda: lk.Push(A, duration=0.0), lambda: margins(INTEGRATOR, -1.0),
        lambda: margins(INTEGRATOR, 0.0), lambda: VelocityJoint(0.1, -0.1), lambda: metrics.rms([]),
        lambda: lk.Plant(armature=-0.1), lambda: lk.Plant(payload=-1.0),
        lambda: lk.Plant(lost_ticks=1.5), lambda: lk.Arm(plant=lk.Plant(state_rate=300.0)),
        lambda: lk.World(0.0), lambda: run(rate=300.0), lambda: run(rate=5000.0),
        lambda: run(rate=0.0), lambda: run(duration=-1.0), lambda: run(lambda t: None),
        lambda: recordings.read_trials(recordings.LINE).error(99, 1.0, 0.0),
        lambda: recordings.read_trials(recordings.LINE).error(0, 1e6, 0.0),
        lambda: MODEL.inverse_kinematics(np.diag([1.0, 1, -1, 1]), READY),
    ),
    UnknownName: (
        lambda: lk.Arm("middle"), lambda: lk.Model("Left"), lambda: lk.Arm(lk.BAXTER),
        lambda: recordings.load("bsaeline"),
        lambda: lk.World(engine="bulet"),
    ),
    JointLimitExceeded: (
        lambda: MODEL.within_limits(np.degrees(READY)), lambda: lk.Arm(q0=np.degrees(READY)),
        lambda: MODEL.inverse_kinematics(MODEL.pose(READY), np.degrees(READY)),
    ),
    ControllerError: (
        *(lambda x=x: lk.Arm().apply(x) for x in (None, READY, "stop", lk.JointTorque)),
    ),
    Closed: (closed,),
    LabkitError: (twice,),
}  # fmt: skip


@pytest.mark.parametrize(
    ("error", "call"), [(error, call) for error, calls in REFUSED.items() for call in calls]
)
def test_what_cannot_be_is_refused(error, call):
    """By its own class of error, and in at most 400 characters."""
    with pytest.raises(error) as caught:
        call()
    assert isinstance(caught.value, LabkitError)
    assert len(str(caught.value)) <= 400
