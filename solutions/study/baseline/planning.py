"""Plan paths: OMPL's RRT-Connect between joint angles, and MoveIt's method for a path of the tip.

Kuffner & LaValle 2000, "RRT-Connect: an efficient approach to single-query path planning".
"""

from __future__ import annotations

from typing import Any

import numpy as np

from labkit.errors import OutOfRange
from labkit.model import Model
from labkit.paths import Spline
from labkit.quiet import quiet
from labkit.shapes import Array, as_array
from labkit.trajectory import Chain, Hold, Path, Sample, Trajectory

from .collision import Blocked, PlanningScene
from .timing import MOVEIT, JointLimits, quickest

with quiet():
    from ompl import base, geometric, util

CHECKS = 20_000
"""How many joint angles the planner tries before it gives up, which takes about a second."""
STEP = 0.02
"""The distance in [rad] between two collision checks along a path."""


class NoWay(Blocked):
    """The planner did not find a path."""


def plan(scene: PlanningScene, start: Any, goal: Any, *, seed: int = 0) -> Spline:
    """Plan a path from ``start`` to ``goal`` that does not touch anything.

    The same seed gives the same path, because the planner's limit is a number of joint angles, not
    a time.

    Args:
        scene: The arm among obstacles.
        start: Joint angles, shape (7,) in [rad].
        goal: Joint angles, shape (7,) in [rad].
        seed: The seed of the planner's random tree.

    Returns:
        A smooth path of joint angles, checked for collisions in steps of `STEP`.

    Raises:
        Blocked: Start or goal would hit something; the message names it.
        JointLimitExceeded: Start or goal is outside the range of a joint.
        NoWay: No path was found; the message says what blocks the straight one.
    """
    start = scene.require_free(start, "start")
    goal = scene.require_free(goal, "goal")
    if np.abs(goal - start).max() < 1e-6:
        raise OutOfRange("start and goal are the same place, so there is no way between them")
    straight = _spline(np.array([start, goal]))
    if first_hit(scene, straight) is None:
        return straight
    corners = _search(scene, start, goal, seed)
    if corners is None:
        s = first_hit(scene, straight) or 0.0
        raise NoWay(
            f"no way found from start to goal after {CHECKS} places; going straight, "
            f"s = {s:.2f} {scene.why(straight(s).position)}; try another seed, another start or a "
            "goal with the elbow elsewhere"
        )
    for density in (1, 2, 4):  # the more points, the closer the smooth curve stays to the corners
        smooth = _spline(corners, density)
        if first_hit(scene, smooth) is None:
            return smooth
    s = first_hit(scene, smooth) or 0.0
    raise NoWay(
        "a way with corners was found, but the smooth curves near it hit something: "
        f"s = {s:.2f} {scene.why(smooth(s).position)}; try another seed"
    )


def first_hit(scene: PlanningScene, path: Path[Sample]) -> float | None:
    """The first s on a path of joint angles at which shapes are too close; None if there is none.

    Args:
        scene: The arm among obstacles.
        path: Samples of shape (7,) in [rad].
    """
    rough = np.array([path(s).position for s in np.linspace(0.0, 1.0, 65)])
    far = np.abs(np.diff(rough, axis=0)).max(axis=1).sum()
    for s in np.linspace(0.0, 1.0, 2 + int(far / STEP)):
        if not scene.free(path(s).position):
            return float(s)
    return None


def along(
    scene: PlanningScene, model: Model, target: Any, q0: Any, limits: JointLimits = MOVEIT
) -> Trajectory | Chain | Hold:
    """A path of the tip, planned as MoveIt's computeCartesianPath does.

    Inverse kinematics gives joint angles along the path, each step is checked for collisions, and
    TOPP-RA computes a new schedule.  The path keeps the geometry of the target but not its timing,
    except that ds/dt never exceeds its largest value in the target.

    Args:
        scene: The arm among obstacles.
        model: The arm's model.
        target: A `Trajectory` of the tip, or a `Chain` of them and of `Hold` (it stops between
            its parts).
        q0: Joint angles at the start, shape (7,) in [rad].
        limits: The limits on joint speeds and accelerations.

    Returns:
        A target of joint angles.

    Raises:
        Unreachable: The tip cannot follow the path.
        Blocked: Something is in the way; the message says what, and where along the path.
    """
    joints = model.joint_trajectory(target, as_array(q0, (7,), "q0"))
    parts = [
        _timed(scene, part, limits)
        for part in (joints.parts if isinstance(joints, Chain) else (joints,))
    ]
    return Chain(parts) if isinstance(joints, Chain) else parts[0]


def _timed(scene: PlanningScene, part: Trajectory | Hold, limits: JointLimits) -> Trajectory | Hold:
    if isinstance(part, Hold):
        scene.require_free(part(0.0).position, "the place to hold")
        return part
    hit = first_hit(scene, part.path)
    if hit is not None:
        raise Blocked(f"the path at s = {hit:.2f} {scene.why(part.path(hit).position)}")
    peak = max(part.scaling(t)[1] for t in np.linspace(0.0, part.duration, 201))
    return quickest(part.path, limits, ds_dt=peak)


def _search(scene: PlanningScene, start: Array, goal: Array, seed: int) -> Array | None:
    """The corners of a path, shape (k, 7), or None if there is none."""
    tried = 0

    def free(state: Any) -> bool:
        nonlocal tried
        tried += 1
        return bool(scene.free(np.array([state[i] for i in range(7)])))

    with quiet():  # OMPL writes to the process's streams
        util.setLogLevel(util.LogLevel.LOG_NONE)
        util.RNG.setSeed(seed + 1)  # with 0 OMPL would take a seed from the clock
        space = base.RealVectorStateSpace(7)
        bounds = base.RealVectorBounds(7)
        for i in range(7):
            bounds.setLow(i, float(scene.robot.lower[i]))
            bounds.setHigh(i, float(scene.robot.upper[i]))
        space.setBounds(bounds)
        setup = geometric.SimpleSetup(space)
        info = setup.getSpaceInformation()
        setup.setStateValidityChecker(free)
        info.setStateValidityCheckingResolution(STEP / space.getMaximumExtent())
        ends = []
        for q in (start, goal):
            state = space.allocState()
            for i in range(7):
                state[i] = float(q[i])
            ends.append(state)
        setup.setStartAndGoalStates(*ends)
        setup.setPlanner(geometric.RRTConnect(info))
        setup.solve(base.PlannerTerminationCondition(lambda: tried > CHECKS))
        if not setup.haveExactSolutionPath():
            return None
        way, simplifier = setup.getSolutionPath(), geometric.PathSimplifier(info)
        simplifier.reduceVertices(way)
        simplifier.collapseCloseVertices(way)
        simplifier.smoothBSpline(way)
        return np.array([[state[i] for i in range(7)] for state in way.getStates()])


def _spline(corners: Array, density: int = 1) -> Spline:
    """The smooth curve through corners and through points on the straight lines between them."""
    away = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    corners = corners[np.concatenate([[True], away > 1e-9])]
    way = np.concatenate([[0.0], np.cumsum(away[away > 1e-9])])
    places = np.linspace(0.0, 1.0, max(12, density * len(corners)))
    return Spline(places, np.array([np.interp(places, way / way[-1], x) for x in corners.T]).T)
