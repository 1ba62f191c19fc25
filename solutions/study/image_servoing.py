r"""Image-based and position-based servoing, with a hand camera whose focal length is wrong.

For a point at (x, y) = (X/Z, Y/Z) the camera's twist (v, w) in its own axes moves the image by
(Chaumette & Hutchinson 2006, eq. 11)

.. math:: \dot s = L\,V_c, \qquad L = \begin{bmatrix} -1/Z & 0 & x/Z & xy & -(1+x^2) & y \\
   0 & -1/Z & y/Z & 1+y^2 & -xy & -x \end{bmatrix}

Image-based: :math:`V_c = \lambda L^+ (s_d - s)`.  Position-based: the same with the error of the
pose estimated from the picture.  Both command the joint speeds :math:`J_c^+ V_c`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from labkit import Model, se3
from labkit.shapes import Array
from labkit.tags.detection import tag_pose
from labkit.tags.drawing import Intrinsics
from labkit.tags.tag import tag_corners

SIZE = 0.1
GAIN, DT, STEPS = 2.0, 0.02, 250
Method = Literal["image", "pose, goal measured", "pose, goal shown"]
METHODS: tuple[Method, ...] = ("image", "pose, goal measured", "pose, goal shown")


@dataclass(frozen=True, eq=False)
class Approach:
    """The run of one method.

    Attributes:
        distance: The distance of the camera from its goal at each step, shape (k,) in [m].
        pixels: Corners in the picture at each step, shape (k, 4, 2) in [px].
        wanted: Corners in the picture at the goal, shape (4, 2) in [px].
    """

    distance: Array
    pixels: Array
    wanted: Array


def interaction(points: Any, depth: float) -> Array:
    """The matrix L, shape (2 n, 6), of points (X/Z, Y/Z), shape (n, 2), at a depth in [m]."""
    x, y = np.asarray(points).T
    zero, z = np.zeros_like(x), np.full_like(x, depth)
    rows = np.stack([
        np.stack([-1 / z, zero, x / z, x * y, -(1 + x**2), y], axis=1),
        np.stack([zero, -1 / z, y / z, 1 + y**2, -x * y, -x], axis=1),
    ], axis=1)  # fmt: skip
    return rows.reshape(-1, 6)


def approach(method: Method, focal_error: float = 0.0, depth: float = 0.25) -> Approach:
    """Bring the camera of the hand to 25 cm in front of a tag, from a place beside and above it.

    Args:
        method: Image-based or position-based; the goal pose of the latter is measured in metres, or
            shown once, that is, computed from a picture at the goal with the same wrong lens.
        focal_error: The relative error by which the robot's focal length is too long.
        depth: The depth of the tag that the image-based method assumes, in [m].
    """
    model = Model("left")
    lens = Intrinsics()
    told = Intrinsics(fx=lens.fx * (1.0 + focal_error), fy=lens.fy * (1.0 + focal_error))
    assert model.robot.T_hand_camera is not None  # Baxter has one
    T_tc = se3.inverse(model.robot.T_hand_tip) @ model.robot.T_hand_camera
    q = np.array(model.robot.ready)
    T_wg = model.pose(q) @ T_tc  # the goal of the camera
    T_mg = se3.pose(  # oblique, because the tilt of a tag seen squarely is ambiguous
        np.diag([1.0, -1.0, -1.0]) @ se3.rotation(np.array([0.5, 0.0, 0.0])),
        np.array([0.0, 0.12, 0.22]),
    )
    T_wm = T_wg @ se3.inverse(T_mg)
    wanted = _corners(se3.inverse(T_mg), lens)
    goal = tag_pose(wanted, told, SIZE) if method == "pose, goal shown" else se3.inverse(T_mg)
    away = se3.pose(se3.rotation(np.array([0.0, 0.0, 0.4])), np.array([0.06, -0.08, 0.1]))
    q = model.inverse_kinematics(away_from(model.pose(q), away), q)
    distance, pixels = [], []
    for _ in range(STEPS):
        T_wc = model.pose(q) @ T_tc
        seen = _corners(se3.inverse(T_wc) @ T_wm, lens)
        distance.append(float(np.linalg.norm(T_wc[:3, 3] - T_wg[:3, 3])))
        pixels.append(seen)
        if method == "image":
            s, s_d = (_plane(p, told) for p in (seen, wanted))
            V = GAIN * np.linalg.pinv(interaction(s, depth)) @ (s_d - s).ravel()
        else:
            T_cm = tag_pose(seen, told, SIZE)
            T_cg = T_cm @ se3.inverse(goal)  # the goal camera in this one
            V = GAIN * np.concatenate([T_cg[:3, 3], se3.rotation_log(T_cg[:3, :3])])
        q = q + DT * _joint_speeds(model, q, T_wc, V)
    return Approach(np.array(distance), np.array(pixels), wanted)


def away_from(T_wt: Array, shift: Array) -> Array:
    """A pose rotated about the tip and shifted, both in the world's axes."""
    T = np.array(T_wt)
    T[:3, :3] = shift[:3, :3] @ T_wt[:3, :3]
    T[:3, 3] += shift[:3, 3]
    return T


def _corners(T_cm: Array, lens: Intrinsics) -> Array:
    return lens.project(tag_corners(SIZE) @ T_cm[:3, :3].T + T_cm[:3, 3])


def _plane(pixels: Array, lens: Intrinsics) -> Array:
    return np.asarray((pixels - (lens.cx, lens.cy)) / (lens.fx, lens.fy))


def _joint_speeds(model: Model, q: Array, T_wc: Array, V: Array) -> Array:
    """The joint speeds that give the camera a twist V, shape (6,), in its own axes."""
    J, R = model.tip_jacobian(q), T_wc[:3, :3]
    arm = T_wc[:3, 3] - model.pose(q)[:3, 3]
    Jc = np.vstack([J[:3] - se3.hat(arm) @ J[3:], J[3:]])
    return np.asarray(np.linalg.pinv(Jc) @ np.concatenate([R @ V[:3], R @ V[3:]]))
