"""Reading an arm from a URDF file, lumping fixed links and turning each joint about its z axis."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from .errors import LabkitError, TypeMismatch, UnknownName
from .quiet import quiet
from .shapes import as_vector, shown

_Element = ElementTree.Element
ROUNDED = 0.98
"""Least accepted ratio of the two smaller moments of inertia, added up, to the largest one.

The ratio of a real body is at least 1, but files round their numbers, by 0.2 % for an arm of Romeo;
the largest moment is then replaced by the sum of the others."""


def read_urdf(
    file: Any, tip: str, ready: Any, base: str | None, name: str | None
) -> dict[str, Any]:
    """The arguments of `Robot`, read from a URDF file; see `Robot.from_urdf`."""
    try:
        path = Path(file)
    except TypeError:
        raise TypeMismatch(f"file is {shown(file)}, expected the path of a URDF file") from None
    root = _parsed(path)
    name = str(name or root.get("name") or path.stem)
    root.set("name", name)  # Pinocchio requires a name
    chain = [joint for joint in _chain(root, base, tip, path.name) if joint.get("type") != "fixed"]
    limits = [_limits(joint, path.name) for joint in chain]
    if len(chain) < 2:
        many = "one joint that moves" if chain else "no joint that moves"
        raise LabkitError(
            f"{path.name} has {many} the link {tip!r}, and an arm has at least two; take another "
            "tip or base"
        )
    for joint in root.iter("joint"):
        if joint not in chain:
            joint.set("type", "fixed")
    try:
        with quiet():
            model = pin.buildModelFromXML(ElementTree.tostring(root, encoding="unicode"))
    except (ValueError, RuntimeError) as error:
        raise LabkitError(
            f"Pinocchio cannot read {path.name} ({error}); the command check_urdf {path.name} says "
            "what is wrong with it"
        ) from None
    hand = model.frames[model.getFrameId(tip, pin.FrameType.BODY)].placement
    bodies, turn = _bodies(model, limits, path.name)
    q = as_vector(ready, len(bodies), "ready")
    T = (turn.inverse() * hand).homogeneous
    return {"name": name, "bodies": bodies, "T_hand_tip": T, "ready": q, "neutral": q}


def _parsed(path: Path) -> _Element:
    try:
        root = ElementTree.parse(path).getroot()
    except OSError as error:
        raise LabkitError(f"{path!s:.200} cannot be read: {error.strerror}") from None
    except ElementTree.ParseError as error:
        raise LabkitError(
            f"{path.name} is not XML ({error}); from a .xacro, the command xacro makes a URDF"
        ) from None
    if any("xacro" in part.tag for part in root.iter()):
        raise LabkitError(f"{path.name} is a xacro file; the command xacro makes a URDF of it")
    if root.tag != "robot":
        raise LabkitError(f"{path.name} holds a <{root.tag}>, expected the <robot> of a URDF")
    return root


def _chain(root: _Element, base: str | None, tip: str, file: str) -> list[_Element]:
    """The joints from the base, or else from the root of the tree, to the tip."""
    links = {str(link.get("name")) for link in root.iter("link")}
    for name in (tip, base):
        if name is not None and name not in links:
            raise UnknownName(f"link in {file}", name, sorted(links))
    above = {child.get("link"): joint for joint, child in _ends(root, "child")}
    parent = {joint: end.get("link") for joint, end in _ends(root, "parent")}
    found: list[_Element] = []
    link: str | None = tip
    while link != base and (base or link in above):
        joint = above.get(link)
        if joint is None or joint in found or joint not in parent:
            start = repr(base) if base else "a base"
            raise LabkitError(f"{file} has no chain of joints from {start} to the link {tip!r}")
        found.append(joint)
        link = parent[joint]
    return found[::-1]


def _ends(root: _Element, which: str) -> Iterator[tuple[_Element, _Element]]:
    for joint in root.findall("joint"):
        for end in joint.findall(which):
            yield joint, end


def _limits(joint: _Element, file: str) -> dict[str, Any]:
    """Name and limits of a joint of the arm; a continuous joint is made revolute."""
    what, kind = f"joint {joint.get('name')} of {file}", joint.get("type")
    if kind not in ("revolute", "continuous"):
        raise LabkitError(
            f"{what} is {kind}, but an arm here may only have joints that turn; take a base "
            "behind it or a tip before it"
        )
    if joint.find("mimic") is not None:
        raise LabkitError(
            f"{what} mimics another joint, but an arm here has a motor at each joint; take a tip "
            "before it, or remove its <mimic>"
        )
    limit = joint.find("limit")
    if limit is None:
        limit = ElementTree.SubElement(joint, "limit")
    if kind == "continuous":
        joint.set("type", "revolute")
        limit.attrib |= {"lower": str(-2.0 * pi), "upper": str(2.0 * pi)}
    try:
        lower, upper, speed, effort = (
            float(limit.get(name, 0.0)) for name in ("lower", "upper", "velocity", "effort")
        )
    except ValueError as error:
        raise LabkitError(f"a limit of {what} is not a number: {error}") from None
    if not (-np.inf < lower < upper < np.inf and 0.0 < speed < np.inf and 0.0 < effort < np.inf):
        raise LabkitError(
            f"{what} needs limits, and has a range from {lower:g} to {upper:g} rad, {speed:g} "
            f"rad/s and {effort:g} N m; write its own numbers into it, such as "
            '<limit lower="-3" upper="3" velocity="2" effort="50"/>'
        )
    name = joint.get("name")
    return {"joint": name, "lower": lower, "upper": upper, "speed": speed, "effort": effort}


def _bodies(
    model: Any, limits: list[dict[str, Any]], file: str
) -> tuple[list[dict[str, Any]], pin.SE3]:
    """The bodies, in frames with the joint axis as z, and the last such frame in Pinocchio's."""
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    bodies, before = [], pin.SE3.Identity()
    for i, limit in enumerate(limits, start=1):
        axis = pin.getJointJacobian(model, data, i, pin.LOCAL)[3:, i - 1]
        if not axis.any():
            raise LabkitError(
                f"joint {limit['joint']} of {file} has the axis 0 0 0; write the direction about "
                'which it turns, such as <axis xyz="0 0 1"/>'
            )
        to_axis = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), axis)
        turn = pin.SE3(to_axis.matrix(), np.zeros(3))
        body = turn.actInv(model.inertias[i])
        (a, b, c), axes = np.linalg.eigh(body.inertia)
        if not (body.mass > 0.0 and a > 0.0 and a + b >= ROUNDED * c):
            raise LabkitError(
                f"the links that joint {limit['joint']} of {file} moves have a mass of "
                f"{body.mass:g} kg and moments of inertia of {a:.3g}, {b:.3g} and {c:.3g} kg m^2; "
                "each must be greater than 0, and none greater than the sum of the other two: "
                "correct their <inertial>, or write one into a link that has none"
            )
        place = before.inverse() * model.jointPlacements[i] * turn
        bodies.append({
            "joint": limit["joint"],
            "T_parent": place.homogeneous.tolist(),
            "mass": body.mass,
            "com": body.lever.tolist(),
            "inertia": (body.inertia - max(0.0, c - a - b) * np.outer(*axes.T[[2, 2]])).tolist(),
            **limit,
        })  # fmt: skip
        before = turn
    return bodies, before
