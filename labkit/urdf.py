"""Reading an arm from a URDF file, lumping fixed links and turning each joint about its z axis."""

from __future__ import annotations

from collections.abc import Iterator
from math import atan2, hypot, pi
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from . import se3
from .errors import LabkitError, UnknownName
from .shapes import Array, as_vector

_Element = ElementTree.Element
ROUNDED = 0.98
"""Least accepted ratio of the two smaller moments of inertia, added up, to the largest one.

The ratio of a real body is at least 1, but files round their numbers, by 0.2 % for an arm of Romeo;
the largest moment is then replaced by the sum of the others."""


def read_urdf(
    file: Any, tip: str, ready: Any, base: str | None, name: str | None
) -> dict[str, Any]:
    """The arguments of `Robot`, read from a URDF file; see `Robot.from_urdf`."""
    path = Path(file)
    root = _parsed(path)
    whole, own = _chain(root, None, tip, path.name), _chain(root, base, tip, path.name)
    chain = [joint for joint in own if joint.get("type") != "fixed"]
    if len(chain) < 2:
        raise LabkitError(
            f"{path.name} has {len(chain)} joints that move {tip!r}; an arm has at least two"
        )
    q = as_vector(ready, len(chain), "ready")
    links = {str(link.get("name")): link for link in root.iter("link")}
    bodies: list[dict[str, Any]] = []
    T = np.eye(4)
    try:
        limits = [_limits(joint, path.name) for joint in chain]
        for joint in whole:
            T = T @ _place(joint)
            if joint in chain:
                turn = _turn(joint, path.name)
                limit, below = limits[len(bodies)], list(_fixed_to(root, joint, turn.T, chain))
                lump = _lump([(links[name], T_bl) for name, T_bl in below], limit, path.name)
                bodies.append({"T_parent": (T @ turn).tolist(), **lump, **limit})
                T = turn.T
    except ValueError as error:
        raise LabkitError(f"a number of {path.name} cannot be read: {error}") from None
    named = str(name or root.get("name") or path.stem)
    return {"name": named, "bodies": bodies, "T_hand_tip": T, "ready": q, "neutral": q}


def _parsed(path: Path) -> _Element:
    try:
        root = ElementTree.parse(path).getroot()
    except OSError as error:
        raise LabkitError(f"{path!s:.200} cannot be read: {error.strerror}") from None
    except ElementTree.ParseError as error:
        raise LabkitError(
            f"{path.name} is not XML ({error}); from a .xacro, the command xacro makes a URDF"
        ) from None
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
    limit = joint.find("limit")
    if limit is None:
        limit = ElementTree.SubElement(joint, "limit")
    if kind == "continuous":
        joint.set("type", "revolute")
        limit.attrib |= {"lower": str(-2.0 * pi), "upper": str(2.0 * pi)}
    lower, upper, speed, effort = (
        float(limit.get(name, 0.0)) for name in ("lower", "upper", "velocity", "effort")
    )
    if not (-np.inf < lower < upper < np.inf and 0.0 < speed < np.inf and 0.0 < effort < np.inf):
        raise LabkitError(
            f"{what} has limits {lower:g} to {upper:g} rad, {speed:g} rad/s and {effort:g} N m; "
            'write, for example, <limit lower="-3" upper="3" velocity="2" effort="50"/>'
        )
    name = joint.get("name")
    return {"joint": name, "lower": lower, "upper": upper, "speed": speed, "effort": effort}


def _numbers(element: _Element | None, name: str) -> Array:
    """Three numbers of an attribute, zeros where it is left out."""
    text = None if element is None else element.get(name)
    return np.array([float(x) for x in (text or "0 0 0").split()])


def _place(element: _Element) -> Array:
    """The pose of an element's <origin>, shape (4, 4)."""
    origin = element.find("origin")
    roll, pitch, yaw = np.diag(_numbers(origin, "rpy"))
    R = se3.rotation(yaw) @ se3.rotation(pitch) @ se3.rotation(roll)
    return se3.pose(R, _numbers(origin, "xyz"))


def _turn(joint: _Element, file: str) -> Array:
    """The rotation, as a pose, that takes the z axis to the joint's axis."""
    axis = joint.find("axis")
    x, y, z = (1.0, 0.0, 0.0) if axis is None else _numbers(axis, "xyz")
    if not (x or y or z):
        raise LabkitError(
            f"joint {joint.get('name')} of {file} has the axis 0 0 0; write the direction about "
            'which it turns, such as <axis xyz="0 0 1"/>'
        )
    sine = hypot(x, y)
    across = np.array([-y, x, 0.0]) / sine if sine else np.array([1.0, 0.0, 0.0])
    return se3.pose(se3.rotation(atan2(sine, z) * across), np.zeros(3))


def _fixed_to(
    root: _Element, joint: _Element, T: Array, chain: list[_Element]
) -> Iterator[tuple[str, Array]]:
    """The link behind a joint and all that is fixed to it, each with its pose, given the first."""
    for end in joint.findall("child"):
        name = str(end.get("link"))
        yield name, T
        for other, parent in _ends(root, "parent"):
            if parent.get("link") == name and other not in chain:
                yield from _fixed_to(root, other, T @ _place(other), chain)


def _lump(parts: list[tuple[_Element, Array]], limit: dict[str, Any], file: str) -> dict[str, Any]:
    """Mass, centre and inertia of links at given poses, as of one body."""
    masses, places, inertias = [0.0], [np.zeros(3)], [np.zeros((3, 3))]
    for link, T in parts:
        for inertial in link.findall("inertial"):
            mass, moments = inertial.find("mass"), inertial.find("inertia")
            at = T @ _place(inertial)
            xx, xy, xz, yy, yz, zz = (
                float("0" if moments is None else moments.get(name, "0"))
                for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
            )
            I = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            masses.append(float("0" if mass is None else mass.get("value", "0")))
            places.append(at[:3, 3])
            inertias.append(at[:3, :3] @ I @ at[:3, :3].T)
    total = sum(masses)
    com = np.average(places, axis=0, weights=masses) if total > 0.0 else np.zeros(3)
    inertia = sum(inertias, np.zeros((3, 3)))
    for m, place in zip(masses, places, strict=True):
        inertia -= m * np.linalg.matrix_power(se3.hat(place - com), 2)
    (a, b, c), axes = np.linalg.eigh(inertia)
    if not (total > 0.0 and a > 0.0 and a + b >= ROUNDED * c):
        raise LabkitError(
            f"joint {limit['joint']} of {file} moves {total:g} kg with moments of inertia {a:.3g}, "
            f"{b:.3g}, {c:.3g} kg m^2, which no body has; correct its links' <inertial>"
        )
    inertia -= max(0.0, c - a - b) * np.outer(axes[:, 2], axes[:, 2])
    return {"mass": total, "com": com.tolist(), "inertia": inertia.tolist()}
