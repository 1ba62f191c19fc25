"""Hidden cases of notebook 05."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

import labkit as lk
from labkit.course import Call, Loop, OwnArm
from labkit.course.authoring.problem import call
from labkit.course.question import Case

Random = np.random.Generator


def _model(random: Random) -> lk.Model:
    return lk.Model(random.choice(["left", "right"]), lk.Plant(armature=0.05))


def _angles(random: Random, model: lk.Model) -> Any:
    return model.robot.ready + random.uniform(-0.35, 0.35, 7)


def six_joints(random: Random) -> Iterator[Call]:
    """One joint locked."""
    model = _model(random)
    q, keep = _angles(random, model), np.delete(np.arange(7), 2)
    yield call(model.mass_matrix(q)[np.ix_(keep, keep)], model.tip_jacobian(q)[:, keep])


def seven_joints(random: Random) -> Iterator[Call]:
    """Any pose, of both arms."""
    for _ in range(3):
        model = _model(random)
        q = _angles(random, model)
        yield call(model.mass_matrix(q), model.tip_jacobian(q))


def positions_only(random: Random) -> Iterator[Call]:
    """The three rows of the position alone."""
    model = _model(random)
    q = _angles(random, model)
    yield call(model.mass_matrix(q), model.tip_jacobian(q)[:3])


def _tip(
    random: Random,
    *,
    shift: float = 0.0,
    turn: float = 0.0,
    speed: float = 0.0,
    twist: float = 0.0,
    ddx: float = 0.0,
) -> tuple[lk.Model, lk.State, lk.PoseSample]:
    """A state, and a target at a given distance from its tip."""
    model = _model(random)
    q, dq = _angles(random, model), speed * random.uniform(-1.0, 1.0, 7)
    T = model.pose(q)
    R = lk.se3.rotation(turn * random.choice([-1.0, 1.0], 3) * random.uniform(0.5, 1.0, 3))
    T_wd = lk.se3.pose(R @ T[:3, :3], T[:3, 3] + shift * random.uniform(-1.0, 1.0, 3))
    dV = ddx * random.uniform(-1.0, 1.0, 6)
    V = twist * random.uniform(-1.0, 1.0, 6)
    return model, lk.State(0.7, q, dq), lk.PoseSample(T_wd, V, dV)


def _gains(random: Random) -> dict[str, Any]:
    K = np.concatenate([random.uniform(50.0, 800.0, 3), random.uniform(5.0, 40.0, 3)])
    D = np.concatenate([random.uniform(5.0, 80.0, 3), random.uniform(0.5, 5.0, 3)])
    return {"stiffness": K, "damping": D}


def _law(random: Random, **what: float) -> Call:
    model, state, target = _tip(random, **what)
    gains = _gains(random)
    push = np.array([10.0] * 3 + [0.5] * 3) * random.uniform(-1.0, 1.0, 6)
    felt = model.tip_jacobian(state.q).T @ push
    return call(lk.State(state.t, state.q, state.dq, felt), target, model, **gains)


def off_in_position(random: Random) -> Iterator[Call]:
    """At rest, off in position."""
    for _ in range(2):
        yield _law(random, shift=0.05)


def off_in_orientation(random: Random) -> Iterator[Call]:
    """At rest, turned off its target."""
    for _ in range(3):
        yield _law(random, turn=0.3)


def moving_tip(random: Random) -> Iterator[Call]:
    """A moving arm, a target that stands still."""
    for _ in range(3):
        yield _law(random, speed=1.0)


def leading_target(random: Random) -> Iterator[Call]:
    """A target that moves and speeds up, the arm still at rest."""
    for _ in range(3):
        yield _law(random, twist=0.5, ddx=2.0)


def everything_at_the_tip(random: Random) -> Iterator[Call]:
    """All of these at the same time."""
    for _ in range(4):
        yield _law(random, shift=0.05, turn=0.3, speed=1.0, twist=0.5, ddx=2.0)


def pushed_arms(random: Random) -> Iterator[Case]:
    """Runs from an offset and under a push, also with the other arm."""
    side: Any = random.choice(["left", "right"])
    plant = lk.Plant(armature=0.05, viscous=0.7)
    model = lk.Model(side, plant)
    force = 8.0 * random.choice([-1.0, 1.0], 3) * random.uniform(0.5, 1.0, 3)
    yield Loop(
        lk.Hold(model.pose(model.robot.ready), 2.0),
        {
            "model": model,
            "stiffness": np.array([300.0] * 3 + [20.0] * 3),
            "damping": np.array([35.0, 35.0, 70.0, 4.0, 4.0, 2.0]),
        },
        side,
        plant,
        (lk.Push(force),),
        q0=model.robot.ready + 0.05 * random.choice([-1.0, 1.0], 7),
        settle=1.2,
        expected={"max_mm": 1e3 * float(np.linalg.norm(force)) / 300.0 + 10.0},
    )


def _shaped(random: Random, *, times: float, wrench: float, moving: bool) -> Call:
    """A case with M_d as ``times`` the arm's own inertia; 0 takes another M_d."""
    what = {"speed": 1.0, "twist": 0.5, "ddx": 2.0} if moving else {}
    model, state, target = _tip(random, shift=0.05, turn=0.2, **what)
    inertia = times * model.operational_inertia(state.q)
    if not times:
        inertia = np.diag([*random.uniform(2.0, 8.0, 3), *random.uniform(0.1, 0.4, 3)])
    F = wrench * random.uniform(-1.0, 1.0, 6)
    return call(state, target, F, model, inertia=inertia, **_gains(random))


def untouched(random: Random) -> Iterator[Call]:
    """Arms that nobody pushes."""
    yield _shaped(random, times=0.0, wrench=0.0, moving=False)


def as_heavy_as_it_is(random: Random) -> Iterator[Call]:
    """Pushed arms that keep their own inertia."""
    for _ in range(2):
        yield _shaped(random, times=1.0, wrench=10.0, moving=False)


def twice_as_heavy(random: Random) -> Iterator[Call]:
    """Pushed arms with a larger and a smaller inertia."""
    for times in (2.0, 0.5):
        yield _shaped(random, times=times, wrench=10.0, moving=False)


def everything_shaped(random: Random) -> Iterator[Call]:
    """Arms with any inertia, pushed, off their target and moving."""
    for _ in range(4):
        yield _shaped(random, times=0.0, wrench=10.0, moving=True)


def springs(random: Random) -> Iterator[Call]:
    """Beside a target at rest."""
    for _ in range(2):
        yield _law(random, shift=0.05, turn=0.3)


def moving_springs(random: Random) -> Iterator[Call]:
    """The arm moves beside a target that rests."""
    for _ in range(3):
        yield _law(random, shift=0.05, turn=0.3, speed=1.0)


def let_go(random: Random) -> Iterator[Case]:
    """Runs from beside a target that rests, also with the other arm."""
    side: Any = random.choice(["left", "right"])
    yield held(side, 0.04 * random.choice([-1.0, 1.0], 7))


def held(side: Any, off: Any) -> Loop:
    """A run from beside a target that rests."""
    plant = lk.Plant(armature=0.05, viscous=0.7)
    model = lk.Model(side, plant)
    gains = {
        "stiffness": np.array([300.0] * 3 + [20.0] * 3),
        "damping": np.array([35.0, 35.0, 70.0, 4.0, 4.0, 2.0]),
    }
    ready = model.robot.ready
    target = lk.Hold(model.pose(ready), 2.0)
    limits = {"max_mm": 8.0}
    return Loop(
        target, {"model": model, **gains}, side, plant, q0=ready + off, settle=1.5, expected=limits
    )


def joint_springs(random: Random) -> Iterator[Call]:
    """Other poses and springs, of both arms."""
    for _ in range(3):
        model = _model(random)
        J = model.tip_jacobian(_angles(random, model))
        yield call(J, _gains(random)["stiffness"], float(random.uniform(1.0, 20.0)))


def other_arms(random: Random) -> Iterator[Call]:
    """Two arms that nobody has seen."""
    yield from (call(OwnArm.drawn(random)) for _ in range(2))
