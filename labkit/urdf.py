"""Reading an arm from a URDF file by MuJoCo, turning each joint about its z axis."""

from __future__ import annotations

from math import atan2, hypot, inf, pi
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np

from . import se3
from .errors import LabkitError, UnknownName
from .shapes import Array, as_vector


def read_urdf(
    file: Any, tip: str, ready: Any, base: str | None, name: str | None
) -> dict[str, Any]:
    """The arguments of `Robot`, read from a URDF file; see `Robot.from_urdf`."""
    path = Path(file)
    try:
        root = ElementTree.parse(path).getroot()
        model = _compiled(root, base, tip)
        found = [_limits(model, k, root) for k in range(model.njnt)]
    except (OSError, ElementTree.ParseError, ValueError) as error:
        why = " ".join(str(error).split())
        raise LabkitError(f"{path.name} has no arm that labkit can read: {why}") from None
    if len(found) < 2:
        raise LabkitError(
            f"{path.name} has {len(found)} joints that move {tip!r}; an arm has at least two"
        )
    q, back, bodies = as_vector(ready, len(found), "ready"), np.eye(4), []
    for k, limits in enumerate(found):
        turn = _turn(model.jnt_axis[k])
        T_parent = back @ _pose(model.body_pos[k + 1], model.body_quat[k + 1]) @ turn
        back = turn.T
        middle = back @ _pose(model.body_ipos[k + 1], model.body_iquat[k + 1])
        axes = middle[:3, :3]
        about = {"mass": float(model.body_mass[k + 1]), "com": middle[:3, 3].tolist()}
        about["inertia"] = (axes * model.body_inertia[k + 1] @ axes.T).tolist()
        bodies.append({"T_parent": T_parent.tolist(), **about, **limits})
    T_hand_tip = back @ _pose(model.site_pos[0], model.site_quat[0])
    named = str(name or root.get("name") or path.stem)
    return {"name": named, "bodies": bodies, "T_hand_tip": T_hand_tip, "ready": q, "neutral": q}


def _compiled(root: ElementTree.Element, base: str | None, tip: str) -> mujoco.MjModel:
    """The arm between two links: its joints alone, each link lumped with those fixed to it."""
    links = {str(link.get("name")): link for link in root.iter("link")}
    for name in (tip, base):
        if name is not None and name not in links:
            raise UnknownName("link in this file", name, sorted(links))
    for link in links.values():
        link[:] = link.findall("inertial")  # and no meshes
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, "unicode"))
    ends, body = {end.get("link") for end in root.iter("child")}, spec.body(tip)
    first, own = body, set()
    while body.name in ends - {base}:
        own |= {joint.name for joint in body.joints}
        first, body = body, body.parent
    if base in ends and body.name != base:
        raise ValueError(f"there is no chain of joints from {base!r} to the link {tip!r}")
    for other in (*spec.equalities, *(joint for joint in spec.joints if joint.name not in own)):
        spec.delete(other)
    moved = {part.name for part in (first, *first.find_all("body"))}
    for still in (part for part in spec.bodies if part.name not in moved):  # weighs nothing
        still.fullinertia, still.inertia, still.mass = np.full(6, np.nan), np.zeros(3), 0.0
    spec.body(tip).add_site()
    spec.compiler.fusestatic = True
    return spec.compile()


def _limits(model: mujoco.MjModel, k: int, root: ElementTree.Element) -> dict[str, Any]:
    """Name and limits of joint ``k``; one without limits of angle turns once either way."""
    name = model.joint(k).name
    (joint,) = (x for x in root.findall("joint") if x.get("name") == name)
    limit, kind = joint.find("limit"), joint.get("type")
    if kind not in ("revolute", "continuous"):
        raise ValueError(f"joint {name} is {kind}, but an arm here may only have joints that turn")
    lower, upper = model.jnt_range[k].tolist() if kind == "revolute" else (-2.0 * pi, 2.0 * pi)
    speed, effort = (
        0.0 if limit is None else float(limit.get(of, 0.0)) for of in ("velocity", "effort")
    )
    if not (-inf < lower < upper < inf and 0.0 < speed < inf and 0.0 < effort < inf):
        raise ValueError(
            f"joint {name} has limits {lower:g} to {upper:g} rad, {speed:g} rad/s, {effort:g} N m; "
            'write, for example, <limit lower="-3" upper="3" velocity="2" effort="50"/>'
        )
    return {"joint": name, "lower": lower, "upper": upper, "speed": speed, "effort": effort}


def _pose(position: Array, quaternion: Array) -> Array:
    R = np.empty(9)
    mujoco.mju_quat2Mat(R, quaternion)
    return se3.pose(R.reshape(3, 3), position)


def _turn(axis: Array) -> Array:
    """The rotation, as a pose, that takes the z axis to the joint's axis."""
    x, y, z = axis
    sine = hypot(x, y)
    across = np.array([-y, x, 0.0]) / sine if sine else np.array([1.0, 0.0, 0.0])
    return se3.pose(se3.rotation(atan2(sine, z) * across), np.zeros(3))
