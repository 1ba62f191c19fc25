"""The scene of the planner: the arm, the rest of Baxter and boxes, as simple shapes.

The shapes are approximations.  Rethink's own collision cylinders and boxes stand for the links; the
housings of the arm stick out of them by up to 5 cm (10 cm at the shoulder, which does not move).
Stacks of boxes stand for torso and pedestal, and the other arm rests in its neutral pose
(``make_collision.py``).  MoveIt saw Baxter in the same way.  Pinocchio uses coal for distances.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import coal
import numpy as np
import pinocchio as pin

from labkit.errors import JointLimitExceeded, LabkitError, OutOfRange, TypeMismatch
from labkit.robot import Robot, robot
from labkit.scene import FACE, Table, Wall
from labkit.shapes import Array, as_array, as_number, as_vector, shown

from ..tasks import Side

SHAPES = Path(__file__).with_name("baxter_collision.json")


@dataclass(frozen=True, eq=False)
class Box:
    """An obstacle with edges along the world's axes.

    Attributes:
        name: Its name in messages.
        centre: Its centre in the world, shape (3,) in [m].
        size: Its edges, shape (3,) in [m].
    """

    name: str
    centre: Any
    size: Any

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", as_vector(self.centre, 3, f"{self.name}'s centre"))
        size = as_vector(self.size, 3, f"{self.name}'s size")
        if size.min() <= 0.0:
            raise OutOfRange(f"{self.name}'s size is {size}, its edges must be longer than 0")
        object.__setattr__(self, "size", size)


class PlanningScene:
    """The arm among obstacles, for a planner.

    Attributes:
        robot: Names and limits of the arm.
        obstacles: All things around the arm besides Baxter's own body.
        margin: The least distance between two shapes, in [m].
    """

    def __init__(
        self,
        side: Side = "left",
        obstacles: Iterable[Box | Table | Wall] = (),
        margin: float = 0.01,
    ) -> None:
        """The ``side`` arm, the rest of Baxter, and ``obstacles``.

        Raises:
            UnknownName: Baxter has no such arm.
            TypeMismatch: An obstacle is not solid.
        """
        self.robot: Robot = robot(side)
        self.obstacles = tuple(obstacles)
        self.margin = as_number(margin, "margin", least=0.0)
        self._model = pin.buildModelFromXML(self.robot.urdf())
        self._shapes = pin.GeometryModel()
        data = json.loads(SHAPES.read_text())[side]
        for i, shape in enumerate(data["shapes"]):
            joint = 0 if shape["joint"] == "base" else self._model.getJointId(shape["joint"])
            self._put(f"{shape['name']}/{i}", joint, np.array(shape["T"]), _shape(shape))
        for a, b in data["pairs"]:
            self._shapes.addCollisionPair(pin.CollisionPair(a, b))
        moving = [i for i, shape in enumerate(data["shapes"]) if shape["joint"] not in _FIXED]
        for thing in self.obstacles:
            k = self._put(*_solid(thing))
            for i in moving:
                self._shapes.addCollisionPair(pin.CollisionPair(i, k))
        self._data = self._model.createData()
        self._results = pin.GeometryData(self._shapes)
        for request in self._results.collisionRequests:
            request.security_margin = self.margin

    def _put(self, name: str, joint: int, T: Array, shape: Any) -> int:
        k: int = self._shapes.addGeometryObject(pin.GeometryObject(name, joint, pin.SE3(T), shape))
        return k

    def free(self, q: Any) -> bool:
        """Whether all shapes keep the margin at joint angles ``q``, shape (7,) [rad]."""
        q = as_array(q, (7,), "q")
        hit = pin.computeCollisions(self._model, self._data, self._shapes, self._results, q, True)
        return not hit

    def clearance(self, q: Any) -> tuple[float, str, str]:
        """Find the two nearest shapes that may not touch.

        Args:
            q: Joint angles, shape (7,) in [rad].

        Returns:
            Their distance in [m], negative if they overlap, and their names, first that of the one
            further along the arm.
        """
        q = as_array(q, (7,), "q")
        k = pin.computeDistances(self._model, self._data, self._shapes, self._results, q)
        pair = self._shapes.collisionPairs[k]
        shapes = [self._shapes.geometryObjects[i] for i in (pair.first, pair.second)]
        shapes.sort(key=lambda shape: -shape.parentJoint)
        names = (_plain(shape.name) for shape in shapes)
        return (float(self._results.distanceResults[k].min_distance), *names)  # type: ignore[return-value]

    def require_free(self, q: Any, name: str) -> Array:
        """Read joint angles at which the arm touches nothing and keeps its limits.

        Args:
            q: Joint angles, shape (7,) in [rad].
            name: What a message calls them.

        Returns:
            The joint angles as an array.

        Raises:
            JointLimitExceeded: A joint is outside its range.
            Blocked: Two shapes are too close; the message names them.
        """
        angles: Array = as_array(q, (7,), name)
        low, high = self.robot.lower - 1e-9, self.robot.upper + 1e-9
        if (outside := (angles < low) | (angles > high)).any():
            i = int(outside.argmax())
            raise JointLimitExceeded(
                name, self.robot.joint_names[i], angles[i], self.robot.lower[i], self.robot.upper[i]
            )
        if not self.free(angles):
            raise Blocked(f"{name} {self.why(angles)}")
        return angles

    def why(self, q: Any) -> str:
        """The end of a sentence that names the shapes in contact at ``q``, shape (7,) [rad]."""
        distance, a, b = self.clearance(q)
        if distance > 0.0:
            return (
                f"brings {a} within {1e3 * distance:.0f} mm of {b}, the margin is "
                f"{1e3 * self.margin:.0f} mm; move it away or reduce the margin"
            )
        return f"puts {a} {-1e3 * distance:.0f} mm into {b}; move it away"


class Blocked(LabkitError, ValueError):
    """The arm would hit something at these joint angles or on this path."""


_FIXED = ("base",)


def _solid(thing: Box | Table | Wall) -> tuple[str, int, Array, Any]:
    """An obstacle's name, the fixed joint 0, its pose in the world and its shape."""
    T = np.eye(4)
    if isinstance(thing, Box):
        T[:3, 3] = thing.centre
        return thing.name, 0, T, coal.Box(*thing.size)
    if not isinstance(thing, Table | Wall):
        raise TypeMismatch(f"an obstacle is {shown(thing)}, expected a Box, a Table or a Wall")
    T[2, 3] = -0.5 * FACE  # the face is its upper side
    return type(thing).__name__.lower(), 0, thing.T_wf @ T, coal.Box(*thing.size, FACE)


def _shape(shape: dict[str, Any]) -> Any:
    kind, size = shape["kind"], shape["size"]
    return {"box": coal.Box, "cylinder": coal.Cylinder, "sphere": coal.Sphere}[kind](*size)


def _plain(name: str) -> str:
    """The name of a part without the number of its shape, for messages."""
    return "the " + name.split("/")[0]
