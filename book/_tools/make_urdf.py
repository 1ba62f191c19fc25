"""Make labkit/data/baxter.json, in which each of Baxter's two arms has seven bodies.

Pinocchio combines all links that a moving joint carries (the fixed electronics, the hand, the
gripper with closed fingers) into the body of that joint.  The source is the URDF of Rethink
Robotics as packaged in example-robot-data 6 (BSD-3, see labkit/data/LICENSE-baxter).

Run: python book/_tools/make_urdf.py
"""

from __future__ import annotations

import argparse
import json
import site
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

SHARE = Path(site.getsitepackages()[0]) / "cmeel.prefix" / "share"
URDF = SHARE / "example-robot-data/robots/baxter_description/urdf/baxter.urdf"
OUT = Path(__file__).parents[2] / "labkit/data/baxter.json"
JOINTS = ("s0", "s1", "e0", "e1", "w0", "w1", "w2")

# In the packaged file s1 has 50 N m, less than gravity requires at the neutral pose.  Rethink
# raised it to 100 N m, as the simulated shoulder has no counter-spring (baxter_common, pull request
# 45).
EFFORT = {"s1": 100.0}
# The packaged gripper has placeholders: 0.01 kg m^2 for a finger of 20 g (a radius of gyration near
# a metre), 2e-8 kg m^2 for a base of 300 g.  A box with each part's size and mass replaces them.
BOXES = {
    "gripper_base": (0.08, 0.07, 0.10),
    "finger": (0.01, 0.02, 0.06),
    "tip": (0.01, 0.02, 0.03),
}
NEUTRAL = [0.0, -0.55, 0.0, 0.75, 0.0, 1.26, 0.0]  # Limb.move_to_neutral of Rethink's SDK
# Our own start for the exercises: the gripper points straight down, with 25 cm of room around it.
READY = {
    "left": [-0.5, -1.0, 0.0, 1.7, 0.0, 0.8707963267948966, 0.0],
    "right": [0.5, -1.0, 0.0, 1.7, 0.0, 0.8707963267948966, 0.0],
}


def rounded(x: Any) -> Any:
    """Lists of floats with 15 significant digits and without negative zeros."""
    return (np.array([float(f"{v:.15g}") for v in np.ravel(x)]) + 0.0).reshape(np.shape(x)).tolist()


def box(mass: float, size: tuple[float, float, float]) -> dict[str, float]:
    """The inertia of a solid box, as attributes of a URDF <inertia> element."""
    x, y, z = (s * s for s in size)
    ixx, iyy, izz = (mass / 12.0 * d for d in (y + z, x + z, x + y))
    return {"ixx": ixx, "iyy": iyy, "izz": izz, "ixy": 0, "ixz": 0, "iyz": 0}


def full_model() -> pin.Model:
    """All of Baxter with every fixed link; the gripper's placeholders are replaced."""
    root = ElementTree.parse(URDF).getroot()
    for link in root.iter("link"):
        name, inertial = link.get("name", ""), link.find("inertial")
        kind = next((k for k in ("tip", "finger", "gripper_base") if k in name), None)
        if kind is not None and inertial is not None:
            mass = float(inertial.find("mass").get("value"))
            for axis, value in box(mass, BOXES[kind]).items():
                inertial.find("inertia").set(axis, repr(value))
    return pin.buildModelFromXML(ElementTree.tostring(root, encoding="unicode"))


def arm(full: pin.Model, side: str) -> dict[str, Any]:
    """The seven joints and bodies of one arm, as plain data."""
    keep = [f"{side}_{j}" for j in JOINTS]
    lock = [i for i in range(1, full.njoints) if full.names[i] not in keep]
    reduced = pin.buildReducedModel(full, lock, pin.neutral(full))
    bodies = []
    for i in range(1, reduced.njoints):
        inertia, placement = reduced.inertias[i], reduced.jointPlacements[i]
        name = reduced.names[i]
        effort = EFFORT.get(name.split("_")[1], reduced.upperEffortLimit[i - 1])
        bodies.append(
            {
                "joint": name,
                "T_parent": rounded(placement.homogeneous),
                "mass": rounded(inertia.mass),
                "com": rounded(inertia.lever),
                "inertia": rounded(inertia.inertia),  # about the centre of mass, link axes
                "lower": rounded(reduced.lowerPositionLimit[i - 1]),
                "upper": rounded(reduced.upperPositionLimit[i - 1]),
                "speed": rounded(reduced.upperVelocityLimit[i - 1]),
                "effort": rounded(effort),
            }
        )
    frame = {f.name: f for f in reduced.frames}
    return {
        "bodies": bodies,
        "T_hand_tip": rounded(frame[f"{side}_gripper"].placement.homogeneous),
        "T_hand_camera": rounded(frame[f"{side}_hand_camera_axis_link"].placement.homogeneous),
        "neutral": NEUTRAL,
        "ready": READY[side],
    }


def main() -> None:
    """Write the file."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    full = full_model()
    data = {"source": "example-robot-data 6.0.0, baxter_description/urdf/baxter.urdf (BSD-3)"}
    data |= {side: arm(full, side) for side in ("left", "right")}
    OUT.write_text(json.dumps(data, indent=1) + "\n")
    print(f"{OUT}: {OUT.stat().st_size} bytes")


if __name__ == "__main__":
    main()
