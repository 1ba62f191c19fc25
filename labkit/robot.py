"""A robot arm as numbers: names, limits, bodies, and the URDF text made from them.

Plant and model are both built from the text that `Robot.urdf` writes, so they agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, hypot, sin
from typing import Any, Literal

import numpy as np

from .plant import IDEAL, Plant
from .shapes import Array

DOF = 7
"""Joints of one arm."""

Side = Literal["left", "right"]


@dataclass(frozen=True, eq=False)
class Robot:
    """One of Baxter's arms, as numbers.

    Attributes:
        side: "left" or "right".
        joint_names: Seven names from shoulder to wrist.
        lower: Lower joint limits, shape (7,) in [rad].
        upper: Upper joint limits, shape (7,) in [rad].
        speed: Speed limits, shape (7,) in [rad/s].
        effort: Torque limits, shape (7,) in [N m].
        neutral: Rethink's neutral pose, shape (7,) in [rad].
        ready: Gripper straight down with room all around, where the exercises start, shape (7,)
            in [rad].
        T_hand_tip: The gripper's tip in the last body, shape (4, 4).
        T_hand_camera: The hand camera (z forward, x right of the image) there, shape (4, 4).
        bodies: The seven bodies as they stand in the data file.
    """

    side: Side
    joint_names: tuple[str, ...]
    lower: Array
    upper: Array
    speed: Array
    effort: Array
    neutral: Array
    ready: Array
    T_hand_tip: Array
    T_hand_camera: Array
    bodies: tuple[dict[str, Any], ...]

    def urdf(self, plant: Plant = IDEAL) -> str:
        """The arm as seven bodies without fixed links, with the plant's payload.

        Args:
            plant: Its payload is built in.

        Returns:
            URDF text; rotors, damping and friction are not in it, they belong to the joints.
        """
        parts = [f'<robot name="baxter_{self.side}_arm">', '<link name="base"/>']
        parent = "base"
        for i, body in enumerate(self.bodies):
            mass, com, inertia = body["mass"], np.array(body["com"]), np.array(body["inertia"])
            if i == 6 and plant.payload > 0.0:
                mass, com, inertia = _with_point_mass(
                    mass, com, inertia, plant.payload, self.T_hand_tip[:3, 3]
                )
            moments, axes = np.linalg.eigh(inertia)  # principal axes: PyBullet keeps only those
            if np.linalg.det(axes) < 0.0:
                axes[:, 0] = -axes[:, 0]
            xx, yy, zz = moments.tolist()
            name, T = body["joint"], np.array(body["T_parent"])
            lower, upper, speed, effort = (body[k] for k in ("lower", "upper", "speed", "effort"))
            parts.append(
                f'<link name="{name}_body"><inertial>'
                f'<origin xyz="{_text(com)}" rpy="{_text(_rpy(axes))}"/>'
                f'<mass value="{float(mass)!r}"/>'
                f'<inertia ixx="{xx!r}" iyy="{yy!r}" izz="{zz!r}" '
                'ixy="0" ixz="0" iyz="0"/></inertial></link>'
                f'<joint name="{name}" type="revolute"><parent link="{parent}"/>'
                f'<child link="{name}_body"/><axis xyz="0 0 1"/>'
                f'<origin xyz="{_text(T[:3, 3])}" rpy="{_text(_rpy(T[:3, :3]))}"/>'
                f'<limit lower="{lower!r}" upper="{upper!r}" '
                f'velocity="{speed!r}" effort="{effort!r}"/></joint>'
            )
            parent = f"{name}_body"
        return "".join([*parts, "</robot>"])


def _with_point_mass(m: float, c: Array, I: Array, extra: float, p: Array) -> tuple[Any, ...]:
    """Mass, centre and inertia about the centre, after a point mass at p joins the body."""
    total = m + extra
    centre = (m * c + extra * p) / total
    for mass, at in ((m, c), (extra, p)):
        d = at - centre
        I = I + mass * ((d @ d) * np.eye(3) - np.outer(d, d))
    return total, centre, I


def _rpy(R: Array) -> Array:
    """URDF's roll, pitch, yaw: R = Rz(yaw) Ry(pitch) Rx(roll).

    Two of Baxter's joints have a pitch of a quarter turn, where roll and yaw turn about one axis:
    whatever roll is read there, the yaw is read from what it leaves.
    """
    roll = atan2(R[2, 1], R[2, 2])
    pitch = atan2(-R[2, 0], hypot(R[2, 1], R[2, 2]))
    y = cos(roll) * R[:, 1] - sin(roll) * R[:, 2]  # Rz(yaw) applied to (0, 1, 0)
    return np.array([roll, pitch, atan2(-y[0], y[1])])


def _text(x: Array) -> str:
    return " ".join(repr(float(v)) for v in x)
