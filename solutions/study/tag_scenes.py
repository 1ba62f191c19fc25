"""A scene with a board that moves on a circle, an arm above it and a camera beside it."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from labkit import IDEAL, Arm, Log, Plant, Sample, World, metrics, se3
from labkit.shapes import Array
from labkit.tags.camera import Camera, looking_at
from labkit.tags.tag import Board, Tag

RADIUS, SPEED = 0.15, 0.1
"""The radius of the board's circle in [m], and its speed in [m/s]."""


@dataclass(frozen=True, eq=False)
class Scene:
    """The objects of the scene.

    Attributes:
        arm: The arm, at rest above the tag.
        board: The board, which moves on its circle.
        camera: A fixed camera that sees all of the circle.
        T_wt: The pose of the tip at the start, shape (4, 4).
        offset: The vector from the tag to the goal of the tip, world axes, shape (3,) in [m].
    """

    arm: Arm
    board: Board
    camera: Camera
    T_wt: Array
    offset: Array

    def error(self, log: Log) -> Array:
        """The goal of the tip minus its position, shape (N, 3) in [m]."""
        goal = np.array([self.board.pose_at(t)[:3, 3] for t in log.t]) + self.offset
        return np.asarray(goal - metrics.tip_poses(log, self.arm.model)[:, :3, 3])


def circling_board(plant: Plant = IDEAL, noise: float = 0.0, seed: int = 0) -> Scene:
    """The board on its circle, level, 0.2 m below the tip.

    Args:
        plant: The plant of the arm.
        noise: The noise of the camera, in grey levels.
        seed: The seed of the arm and the camera.
    """
    world = World()
    arm = Arm("left", plant, seed, world=world)
    offset = np.array([0.0, 0.0, 0.2])
    above = arm.model.pose(arm.robot.ready)
    centre = above[:3, 3] - offset
    T_wt = np.array(above)
    T_wt[:3, 3] += [0.0, RADIUS, 0.0]
    arm.reset(arm.model.inverse_kinematics(T_wt, arm.robot.ready))

    def round_it_goes(t: float) -> Sample:
        rate = SPEED / RADIUS
        out = np.array([-sin(rate * t), cos(rate * t), 0.0])
        on = np.array([-out[1], out[0], 0.0])
        return Sample(centre + RADIUS * out, SPEED * on, -RADIUS * rate**2 * out)

    board = Board(world, Tag(), se3.pose(np.eye(3), T_wt[:3, 3] - offset))
    board.move(round_it_goes)
    eye = centre + np.array([0.75, -0.1, 0.45])
    camera = Camera(world, looking_at(eye, centre), noise=noise, seed=seed)
    return Scene(arm, board, camera, T_wt, offset)
