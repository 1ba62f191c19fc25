"""A robot arm as a value, with its names, limits, bodies, and the URDF text made from them.

The physics engine and the model both read the text that `Robot.urdf` returns, so they agree.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from functools import cache, cached_property
from html import escape
from importlib.resources import files
from math import atan2, cos, hypot, sin
from typing import Any

import numpy as np

from .errors import JointLimitExceeded, LabkitError, UnknownName
from .plant import IDEAL, Plant
from .shapes import Array, locked

SIDES = ("left", "right")
"""Names of Baxter's arms, reserved for them."""


@dataclass(frozen=True, eq=False, repr=False)
class Robot:
    """A serial arm of n revolute joints on a fixed base.

    `lk.robot("left")` and `lk.robot("right")` are Baxter's arms; `from_urdf` reads any other.

    Attributes:
        name: The name of the arm in logs and in worlds with several arms.
        bodies: The n bodies from the base to the tip, each with its "joint", its pose in the body
            before it at angle zero ("T_parent", the joint turns about its z axis), "mass", "com",
            "inertia" about the centre of mass, and the joint's limits.
        T_hand_tip: Pose of the tip in the last body, shape (4, 4).
        ready: Joint angles at which exercises start, with free space around, shape (n,) in [rad].
        neutral: Default initial joint angles, shape (n,) in [rad].
        T_hand_camera: Pose of the hand camera (z forward, x right in the image) in the last body,
            shape (4, 4); None for a hand without a camera.
    """

    name: str
    bodies: tuple[dict[str, Any], ...]
    T_hand_tip: Array
    ready: Array
    neutral: Array
    T_hand_camera: Array | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "bodies", tuple(self.bodies))
        for name in ("T_hand_tip", "ready", "neutral", "T_hand_camera"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, locked(np.array(getattr(self, name))))

    def __repr__(self) -> str:
        return f"<Robot {self.name!r} with {self.n} joints>"

    @classmethod
    def from_urdf(
        cls,
        file: Any,
        *,
        tip: str = "",
        ready: Any = (),
        base: str | None = None,
        name: str | None = None,
    ) -> Robot:
        """Read an arm from a URDF file with MuJoCo.

        The arm consists of the joints between the base and the tip.  All other joints, such as
        those of wheels, a torso or a gripper, are fixed at zero, and each link is lumped with the
        links fixed to it.  A continuous joint is limited to one turn in each direction.

        Args:
            file: The URDF file; its meshes are not needed.
            tip: The link whose frame is the arm's tip; without it the error lists the links.
            ready: Joint angles at which exercises may start, shape (n,) in [rad], from the base to
                the tip.
            base: The last link that stands still; None takes the root of the file, whose frame is
                the world's in any case.
            name: What to call the arm; None takes the file's own name.

        Returns:
            The robot.

        Raises:
            UnknownName: The file has no link ``tip`` or ``base``.
            LabkitError: There is no such file, it is not a URDF, or the arm has a feature that is
                not supported, such as a prismatic joint; the message says what to do.
            ShapeError: ``ready`` has a different number of joints.
            JointLimitExceeded: ``ready`` is outside the joints' range.
        """
        from .urdf import read_urdf

        made = read_urdf(file, tip, ready, base, name)
        if made["name"] in SIDES:
            raise LabkitError(f"{made['name']!r} is a Baxter's arm; give this robot another name=")
        robot = cls(**made)
        robot.check_range(robot.ready, "ready")
        return robot

    def data(self) -> dict[str, Any]:
        """The robot as plain data, such that ``Robot(**robot.data())`` is the same robot."""
        made = {field.name: getattr(self, field.name) for field in fields(self)}
        return {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in made.items()}

    @property
    def n(self) -> int:
        """The number of joints."""
        return len(self.bodies)

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints, from the base to the tip."""
        return tuple(body["joint"] for body in self.bodies)

    @cached_property
    def lower(self) -> Array:
        """Lower joint limits, shape (n,) in [rad]."""
        return self._each("lower")

    @cached_property
    def upper(self) -> Array:
        """Upper joint limits, shape (n,) in [rad]."""
        return self._each("upper")

    @cached_property
    def speed(self) -> Array:
        """Speed limits, shape (n,) in [rad/s]."""
        return self._each("speed")

    @cached_property
    def effort(self) -> Array:
        """Torque limits, shape (n,) in [N m]."""
        return self._each("effort")

    @cached_property
    def zeros(self) -> Array:
        """A zero for each joint, shape (n,), read-only."""
        return locked(np.zeros(self.n))

    def check_range(self, q: Array, name: str, slack: float = 0.0) -> None:
        """Raise `JointLimitExceeded` if a joint is outside its range.

        Args:
            q: Joint angles, shape (n,) in [rad].
            name: What to call them in the message.
            slack: Tolerance beyond either limit, in [rad].
        """
        outside = (q < self.lower - slack) | (q > self.upper + slack)
        if outside.any():
            i = int(outside.argmax())
            lower, upper = self.lower[i], self.upper[i]
            raise JointLimitExceeded(name, self.joint_names[i], q[i], lower, upper)

    def _each(self, limit: str) -> Array:
        return locked(np.array([body[limit] for body in self.bodies]))

    def inertias(self, payload: float = 0.0) -> list[tuple[float, Array, Array]]:
        """Of each body its mass, its centre, shape (3,), and its inertia about it, shape (3, 3).

        Args:
            payload: A point mass at the tip, in [kg], which the last body holds.
        """
        found = [
            (float(body["mass"]), np.array(body["com"]), np.array(body["inertia"]))
            for body in self.bodies
        ]
        if payload > 0.0:
            found[-1] = _with_point_mass(*found[-1], payload, self.T_hand_tip[:3, 3])
        return found

    def urdf(self, plant: Plant = IDEAL) -> str:
        """The arm as URDF text, with n bodies and the plant's payload but no fixed links.

        Args:
            plant: Its payload is included.

        Returns:
            URDF text; rotors, damping and friction are not in it.
        """
        parts = [f'<robot name="{escape(self.name)}">', '<link name="base"/>']
        parent = "base"
        for body, (mass, com, inertia) in zip(
            self.bodies, self.inertias(plant.payload), strict=True
        ):
            moments, axes = np.linalg.eigh(inertia)  # principal axes, all that PyBullet keeps
            if np.linalg.det(axes) < 0.0:
                axes[:, 0] = -axes[:, 0]
            xx, yy, zz = moments.tolist()
            zz = min(zz, (xx + yy) * (1.0 - 1e-12))  # else MuJoCo may refuse a plate
            name, T = escape(body["joint"]), np.array(body["T_parent"])
            lower, upper, speed, effort = (body[k] for k in ("lower", "upper", "speed", "effort"))
            parts.append(
                f'<link name="{name}_body"><inertial>'
                f'<origin xyz="{_text(com)}" rpy="{_text(_rpy(axes))}"/>'
                f'<mass value="{mass!r}"/>'
                f'<inertia ixx="{xx!r}" iyy="{yy!r}" izz="{zz!r}" '
                'ixy="0" ixz="0" iyz="0"/></inertial></link>'
                f'<joint name="{name}" type="revolute"><parent link="{parent}"/>'
                f'<child link="{name}_body"/><axis xyz="0 0 1"/>'
                f'<origin xyz="{_text(T[:3, 3])}" rpy="{_text(_rpy(T[:3, :3]))}"/>'
                f'<limit lower="{lower!r}" upper="{upper!r}" '
                f'velocity="{speed!r}" effort="{effort!r}"/></joint>'
            )
            parent = f"{name}_body"
        return "\n".join([*parts, "</robot>"])  # PyBullet cuts long lines


@cache
def robot(side: str) -> Robot:
    """One of Baxter's arms; its numbers come from Rethink's URDF, see ``data/LICENSE-baxter``.

    Args:
        side: "left" or "right".

    Raises:
        UnknownName: Baxter has no such arm.
    """
    if side not in SIDES:
        raise UnknownName("arm", side, SIDES)
    data = json.loads((files("labkit") / "data" / "baxter.json").read_text())[side]
    return Robot(name=side, **data)


def as_robot(arm: Robot | str) -> Robot:
    """Return a `Robot` unchanged, and Baxter's arm for a name.

    Raises:
        UnknownName: Baxter has no such arm.
    """
    return arm if isinstance(arm, Robot) else robot(arm)


def _with_point_mass(
    m: float, c: Array, I: Array, extra: float, p: Array
) -> tuple[float, Array, Array]:
    """Mass, centre and inertia about the centre of a body with an extra point mass at p."""
    total = m + extra
    centre = (m * c + extra * p) / total
    for mass, at in ((m, c), (extra, p)):
        d = at - centre
        I = I + mass * ((d @ d) * np.eye(3) - np.outer(d, d))
    return total, centre, I


def _rpy(R: Array) -> Array:
    """URDF's roll, pitch, yaw: R = Rz(yaw) Ry(pitch) Rx(roll).

    Two of Baxter's joints have a pitch of a quarter turn, where roll and yaw share one axis.  There
    any roll will do, because the yaw is computed from what remains after it.
    """
    roll = atan2(R[2, 1], R[2, 2])
    pitch = atan2(-R[2, 0], hypot(R[2, 1], R[2, 2]))
    y = cos(roll) * R[:, 1] - sin(roll) * R[:, 2]  # Rz(yaw) applied to (0, 1, 0)
    return np.array([roll, pitch, atan2(-y[0], y[1])])


def _text(x: Array) -> str:
    return " ".join(repr(float(v)) for v in x)
