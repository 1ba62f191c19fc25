"""Following a tag, as a task on which controllers can be compared.

The reference that a follower makes from a camera's readings is recorded once for each seed, without
the arm: the camera is fixed beside the table, so what it sees does not depend on the arm.  Every
controller then follows the same reference, and is also judged by the distance of the tip from its
place above the true tag.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from labkit import (
    BAXTER,
    Arm,
    Chain,
    Circle,
    Hold,
    Log,
    Plant,
    PosePath,
    Quintic,
    Trajectory,
    World,
    metrics,
    robot,
    run,
    se3,
)
from labkit.control import Controller
from labkit.paths import Spline
from labkit.shapes import Array
from labkit.tags.camera import Camera, looking_at
from labkit.tags.stream import TagStream, TagTarget
from labkit.tags.tag import Board, Tag

from ..tags.following import TagFollower
from .tasks import Task, ready_pose
from .visual_servoing import SequentialServoing

DURATION = 8.0
"""How long the tag is followed, in [s]."""
RATE = 200.0
"""How often the follower is called while it is recorded, in [Hz]."""
LAP = 6.5
"""The time that the tag takes for its circle, in [s]."""
RADIUS = 0.06
"""The radius of the tag's circle, in [m]."""
OFFSET = np.array([0.0, 0.0, 0.2])
"""The vector from the tag to the goal of the tip, world axes, in [m]."""
NOISE = 2.0
"""The noise of the camera, in grey levels."""


@dataclass(frozen=True)
class Even:
    """A scaling at constant pace, s = t / duration, which does not rest at its ends.

    Attributes:
        duration: The duration in [s].
    """

    duration: float

    def __call__(self, t: float) -> tuple[float, float, float]:
        """s, ds/dt and d2s/dt2 at time ``t`` [s]."""
        return min(max(t / self.duration, 0.0), 1.0), 1.0 / self.duration, 0.0


@dataclass(frozen=True, eq=False)
class Chase:
    """A recorded reference, and the true goal.

    Attributes:
        task: The reference as a task.
        t: Times, shape (n,) in [s].
        goal: The true goal of the tip, shape (n, 3) in [m].
    """

    task: Task
    t: Array
    goal: Array

    def miss(self, t: Any, tips: Any) -> Array:
        """The distance in [m] of tips (k, 3) from their goal at times (k,) [s], shape (k,)."""
        goal = np.column_stack([np.interp(t, self.t, x) for x in self.goal.T])
        return np.asarray(np.linalg.norm(goal - tips, axis=1))


def followed(seed: int) -> Chase:
    """The course's method: ten pictures per second, a filter, and a continuous reference."""
    return _record(seed, 10.0, 0.1, lambda: TagFollower(ready_pose(), OFFSET))


def sequential(seed: int) -> Chase:
    """The report's Algorithm 1: look for a second every 5 s, then follow a line from rest."""
    return _record(seed, 0.2, 1.0, lambda: SequentialServoing(ready_pose(), OFFSET))


def closed_loop(
    seed: int, controller: Controller, follower: Any, *, plant: Plant = BAXTER, **dials: Any
) -> tuple[Log, Array, int]:
    """Follow the tag with the arm in the picture, which may hide it.

    Args:
        seed: The seed of arm, camera and look-ups.
        controller: A controller that follows poses.
        follower: Makes the poses from the readings.
        plant: The plant to drive.
        **dials: Options of the look-ups, as for `TagStream`.

    Returns:
        The run; the distance of the tip from its place above the true tag, shape (N,) in [m]; and
        the number of pictures in which the tag was not found.
    """
    with World() as world:
        board, camera = staged(world, seed)
        arm = Arm("left", plant, seed, q0=robot("left").ready, world=world)
        lookups = TagStream(camera, board.tag, seed=seed, **dials)
        log = run(arm, TagTarget(lookups, follower), controller, rate=RATE, duration=DURATION)
        goal = np.array([board.pose_at(t)[:3, 3] for t in log.t]) + OFFSET
        tips = metrics.tip_poses(log)[:, :3, 3]
    return log, np.asarray(np.linalg.norm(goal - tips, axis=1)), lookups.unseen


def _record(seed: int, rate: float, delay: float, make: Callable[[], Any]) -> Chase:
    times = np.arange(round(DURATION * RATE) + 1) / RATE
    path, goal = np.empty((len(times), 3)), np.empty((len(times), 3))
    with World() as world:
        board, camera = staged(world, seed)
        following = TagTarget(TagStream(camera, board.tag, rate, delay, seed=seed), make())
        for k, t in enumerate(times):
            path[k] = following(float(t)).pose[:3, 3]  # type: ignore[union-attr]
            goal[k] = board.T_wm[:3, 3] + OFFSET
            world.step(round(1.0 / (RATE * world.dt)))
    curve = PosePath(Spline(times / DURATION, path), ready_pose()[:3, :3])
    target = Trajectory(curve, Even(DURATION))
    return Chase(Task("tag", target, robot("left").ready, samples=401), times, goal)


def staged(world: World, seed: int) -> tuple[Board, Camera]:
    """Put a board under the ready tip, which moves once around a circle, and a camera beside it.

    Args:
        world: The world of the board and the camera; the board moves from now on.
        seed: The seed of the camera's noise.
    """
    start = ready_pose()[:3, 3] - OFFSET
    centre = start - (0.0, RADIUS, 0.0)
    board = Board(world, Tag(), se3.pose(np.eye(3), start))
    round_once = Trajectory(Circle(start, centre), Quintic(LAP))
    board.move(Chain([Hold(start, 0.5), round_once, Hold(start, 1.0)]))
    eye = centre + (0.75, -0.1, 0.45)
    return board, Camera(world, looking_at(eye, centre), noise=NOISE, seed=seed)
