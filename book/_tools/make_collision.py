"""Make baxter_collision.json of the baseline, the simple shapes of Baxter for a planner.

The file has Rethink's collision shapes (cylinders, spheres, boxes) as packaged in
example-robot-data 6, and the pairs for which MoveIt's Setup Assistant found a check useful (the
SRDF of the same package; BSD-3, see labkit/data/LICENSE-baxter).  There, torso and pedestal are
meshes; here each is a stack of boxes, one around each slice of its mesh.  The other arm stays at
Rethink's neutral pose.

Run: python book/_tools/make_collision.py
"""

from __future__ import annotations

import argparse
import json
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import trimesh
from make_urdf import JOINTS, NEUTRAL, URDF, full_model, rounded

ROOT = Path(__file__).parents[2]
DATA = ROOT / "labkit/data"
SRDF = URDF.parents[1] / "srdf/baxter_manipulation.srdf"
STACKED = {"torso": "base_link_charcoal", "pedestal": "PEDESTAL_black"}
SLICES = 8
# The SRDF has another gripper, so all parts of our gripper are checked like that one.
GRIPPER = ("gripper_base_link", "finger")


def numbers(text: str | None) -> list[float]:
    """The numbers of a URDF attribute."""
    return [float(x) for x in (text or "0 0 0").split()]


def shapes_of(link: ElementTree.Element) -> list[tuple[str, list[float], np.ndarray]]:
    """The kind, size and pose in the link of each simple collision shape."""
    found = []
    for collision in link.findall("collision"):
        origin, geometry = collision.find("origin"), collision.find("geometry")[0]
        placed = {} if origin is None else origin.attrib
        T = np.eye(4)
        T[:3, :3] = pin.rpy.rpyToMatrix(np.array(numbers(placed.get("rpy"))))
        T[:3, 3] = numbers(placed.get("xyz"))
        if geometry.tag == "box":
            found.append(("box", numbers(geometry.get("size")), T))
        elif geometry.tag == "cylinder":
            size = [float(geometry.get("radius")), float(geometry.get("length"))]
            found.append(("cylinder", size, T))
        elif geometry.tag == "sphere" and float(geometry.get("radius")) > 0.01:
            found.append(("sphere", [float(geometry.get("radius"))], T))
    return found


def stack(mesh: str) -> list[tuple[str, list[float], np.ndarray]]:
    """Boxes around the slices of a mesh, in the axes of the base."""
    body = trimesh.load(DATA / "meshes" / f"{mesh}.obj", force="mesh")
    points, _ = trimesh.sample.sample_surface(body, 100_000, seed=0)
    edges = np.linspace(*body.bounds[:, 2], SLICES + 1)
    found = []
    for low, high in pairwise(edges):
        inside = points[(low <= points[:, 2]) & (points[:, 2] <= high)]
        lower = np.append(inside.min(axis=0)[:2], low)
        upper = np.append(inside.max(axis=0)[:2], high)
        T = np.eye(4)
        T[:3, 3] = (lower + upper) / 2.0
        found.append(("box", rounded(np.round(upper - lower, 4)), T))
    return found


def known_as(link: str) -> str:
    """The SRDF's name for a link."""
    if any(part in link for part in GRIPPER) and "hand" not in link:
        side = {"l": "left", "r": "right"}[link[0]]
        return f"{side}_gripper"
    return link


def plain(link: str) -> str:
    """The name for a link in a sentence."""
    if "head" in link:
        return "head"
    words = link.removesuffix("_visual").removesuffix("_link").split("_")
    words[0] = {"l": "left", "r": "right"}.get(words[0], words[0])
    return " ".join(words[:2]) if "gripper" in words else " ".join(words)


def arm(side: str, links: dict[str, Any], apart: set[frozenset[str]]) -> dict[str, Any]:
    """The shapes around one arm, the joint that carries each shape, and the pairs to check."""
    full = full_model()
    other = "right" if side == "left" else "left"
    q = pin.neutral(full)
    for joint, angle in zip(JOINTS, NEUTRAL, strict=True):
        q[full.joints[full.getJointId(f"{other}_{joint}")].idx_q] = angle
    keep = [f"{side}_{j}" for j in JOINTS]
    lock = [i for i in range(1, full.njoints) if full.names[i] not in keep]
    reduced = pin.buildReducedModel(full, lock, q)
    body = {f.name: f for f in reduced.frames if f.type == pin.FrameType.BODY}
    shapes = []
    for link, found in links.items():
        frame = body[link]
        joint = reduced.names[frame.parentJoint] if frame.parentJoint else "base"
        for kind, size, T in found:
            pose = rounded(np.round(frame.placement.homogeneous @ T, 6))
            shapes.append(
                {
                    "link": link,
                    "name": plain(link),
                    "joint": joint,
                    "kind": kind,
                    "size": size,
                    "T": pose,
                }
            )
    pairs = []
    for i, j in combinations(range(len(shapes)), 2):
        a, b = shapes[i], shapes[j]
        same = frozenset((known_as(a["link"]), known_as(b["link"])))
        if a["joint"] != b["joint"] and len(same) == 2 and same not in apart:
            pairs.append([i, j])
    for shape in shapes:
        del shape["link"]
    return {"shapes": shapes, "pairs": pairs}


def main() -> None:
    """Write the file."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    links = {link.get("name"): shapes_of(link) for link in ElementTree.parse(URDF).iter("link")}
    links |= {link: stack(mesh) for link, mesh in STACKED.items()}
    links = {name: found for name, found in links.items() if found}
    disabled = ElementTree.parse(SRDF).iter("disable_collisions")
    apart = {frozenset((d.get("link1"), d.get("link2"))) for d in disabled}
    data = {"source": "example-robot-data 6.0.0, baxter_description (BSD-3); by make_collision.py"}
    data |= {side: arm(side, links, apart) for side in ("left", "right")}
    out = ROOT / "solutions/study/baseline/baxter_collision.json"
    out.write_text(json.dumps(data, separators=(",", ":")) + "\n")
    print(f"{out}: {out.stat().st_size} bytes")


if __name__ == "__main__":
    main()
