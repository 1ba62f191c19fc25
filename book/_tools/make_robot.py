"""Make Baxter's appearance: small coloured meshes for the camera, one robot file for the viewer.

Each visual mesh of the packaged URDF loses its invisible faces and is split by colour, because the
camera's renderer gives each mesh one colour.  Then it is decimated twice: to a coarse mesh for the
camera and to a finer one for the viewer.  The two arms share their files.  The fingers are closed
and belong to the last link.

Run: python book/_tools/make_robot.py   (about a minute; needs the dev extra)
"""

from __future__ import annotations

import argparse
import base64
import json
import shutil
import site
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import trimesh

SHARE = Path(site.getsitepackages()[0]) / "cmeel.prefix" / "share"
BAXTER = SHARE / "example-robot-data/robots/baxter_description"
DATA = Path(__file__).parents[2] / "labkit/data"
PALETTE = {  # sRGB; black is lighter than in the source so that shapes can be seen
    "red": (0.66, 0.05, 0.07),
    "black": (0.09, 0.09, 0.10),
    "charcoal": (0.20, 0.20, 0.22),
    "grey": (0.62, 0.62, 0.64),
}
# Faces of each mesh for the camera; the viewer's mesh has FINER times this number.
FACES = {
    "PEDESTAL": 2400, "base_link": 2700, "H0": 520, "H1": 520, "S0": 1350, "S1": 980, "E0": 1280,
    "E1": 1200, "W0": 1420, "W1": 1280, "W2": 1050, "electric_gripper_base": 680,
    "extended_narrow": 220, "paddle_tip": 90, "half_round_tip": 120,
}  # fmt: skip
FINER = 1.5
SPECK = 5e-4  # m^2; smaller connected bodies, such as screws and clips, are left out
MARKERS = ("collision_", "hand_accelerometer", "hand_camera", "hand_range")  # no visible body
ARM = ("s0", "s1", "e0", "e1", "w0", "w1", "w2")
JOINTS = ("head_pan", *(f"{side}_{j}" for side in ("left", "right") for j in ARM))


@dataclass(frozen=True)
class Visual:
    """A visual of the robot: its mesh, its colour in the URDF, and where it is attached."""

    mesh: str
    rgba: tuple[float, ...]
    parent: str
    pose: pin.SE3


def main() -> None:
    """Write meshes, the table of pieces, the viewer's robot and the licence."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    urdf = str(BAXTER / "urdf/baxter.urdf")
    model = pin.buildModelFromUrdf(urdf)
    geometry = pin.buildGeomFromUrdf(
        model, urdf, pin.GeometryType.VISUAL, package_dirs=[str(SHARE)]
    )
    shutil.rmtree(DATA / "meshes", ignore_errors=True)
    (DATA / "meshes").mkdir(parents=True)
    meshes: dict[str, dict[str, trimesh.Trimesh]] = {}
    visuals: list[Visual] = []
    for shape in geometry.geometryObjects:
        if not any(m in shape.name for m in MARKERS):
            visuals.append(visual(model, shape))
            if visuals[-1].mesh not in meshes:
                meshes[visuals[-1].mesh] = parts(shape, visuals[-1])
    coarse = {n: {c: thin(m, share(n, p)) for c, m in p.items()} for n, p in meshes.items()}
    fine = {n: {c: thin(m, FINER * share(n, p)) for c, m in p.items()} for n, p in meshes.items()}
    for name, colour, mesh in each(coarse):
        (DATA / f"meshes/{name}_{colour}.obj").write_text(obj(mesh))
    joints, tips = tree(model)
    pieces = [
        {
            "mesh": f"meshes/{v.mesh}_{colour}.obj",
            "rgba": [*PALETTE[colour], 1.0],
            "parent": v.parent,
            "position": rounded(v.pose.translation),
            "quaternion": rounded(pin.Quaternion(v.pose.rotation).coeffs()),
        }
        for v in visuals
        for colour in coarse[v.mesh]
    ]
    note = "poses in the parent joint's moving frame, metres, quaternions x y z w; by make_robot.py"
    table = {"note": note, "joints": joints, "tips": tips, "pieces": pieces}
    (DATA / "baxter_visual.json").write_text(json.dumps(table, indent=1) + "\n")
    (DATA / "viewer").mkdir(exist_ok=True)
    (DATA / "viewer/robot.js").write_text(robot_js(joints, tips, visuals, fine))
    (DATA / "LICENSE-baxter").write_text((BAXTER / "LICENSE").read_text() + CHANGES)
    drawn = sum(len(coarse[v.mesh][c].faces) for v in visuals for c in coarse[v.mesh])
    kept = sum(len(m.faces) for *_, m in each(coarse)), sum(len(m.faces) for *_, m in each(fine))
    size = sum(f.stat().st_size for f in (DATA / "meshes").iterdir()) / 1e6
    robot = (DATA / "viewer/robot.js").stat().st_size / 1e6
    print(f"camera: {len(pieces)} pieces, {drawn} triangles drawn; {kept[0]} kept, {size:.2f} MB")
    print(f"viewer: {kept[1]} triangles kept, {robot:.2f} MB")


CHANGES = """
----------------------------------------------------------------------
What was changed here: from the visual meshes of baxter_description (as packaged in
example-robot-data) the hidden faces were removed, the rest was decimated, split by colour and
written as OBJ and as quantised arrays; colours were snapped to four and the blacks lifted; fingers
are fixed closed.  In the arms' data links are lumped into seven bodies.  See make_robot.py and
make_urdf.py in book/_tools.
"""


def rounded(x: Any, digits: int = 9) -> list[float]:
    """A flat list of rounded floats without negative zeros."""
    return (np.round(np.ravel(x), digits) + 0.0).tolist()


def each(meshes: dict[str, dict[str, trimesh.Trimesh]]) -> Iterator[tuple[str, str, Any]]:
    """Yield each mesh with its name and colour."""
    for name, by_colour in meshes.items():
        for colour, mesh in by_colour.items():
            yield name, colour, mesh


def visual(model: pin.Model, shape: Any) -> Visual:
    """A visual for a shape of the URDF; the prismatic joint of a finger is fixed closed."""
    parent, pose = shape.parentJoint, shape.placement
    while parent and model.names[parent] not in JOINTS:
        pose = model.jointPlacements[parent] * pose
        parent = model.parents[parent]
    path = Path(shape.meshPath)
    name = path.stem if path.suffix else shape.name.removesuffix("_0")
    return Visual(name, tuple(shape.meshColor), "base" if not parent else model.names[parent], pose)


def parts(shape: Any, look: Visual) -> dict[str, trimesh.Trimesh]:
    """The visible faces of a shape, as a mesh for each colour of the palette."""
    if not Path(shape.meshPath).suffix:
        return {nearest(look.rgba[:3]): primitive(shape.geometry)}
    scene = trimesh.load(shape.meshPath, force="scene")
    solids = scene.dump(concatenate=False)
    colours = []
    for solid in solids:
        material = getattr(solid.visual, "material", None)
        main = None if material is None else material.main_color
        rgb = look.rgba[:3] if main is None else np.asarray(main).ravel()[:3] / 255
        colours += [nearest(rgb)] * len(solid.faces)
    whole = trimesh.util.concatenate([trimesh.Trimesh(s.vertices, s.faces) for s in solids])
    whole.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=4)  # stitch the patches
    whole.faces, found = whole.faces[keep := whole.nondegenerate_faces()], np.array(colours)[keep]
    seen, facing = visible(whole)
    body = components(whole)
    inside_out = (np.bincount(body, facing) < 0)[body]
    whole.faces[inside_out] = whole.faces[inside_out][:, ::-1]
    seen &= (np.bincount(body, whole.area_faces) > SPECK)[body]
    return {
        colour: whole.submesh([np.flatnonzero(seen & (found == colour))], append=True)
        for colour in dict.fromkeys(colours)
        if (seen & (found == colour)).any()
    }


def components(mesh: trimesh.Trimesh) -> np.ndarray:
    """For each face, the number of its connected body."""
    count = len(mesh.faces)
    return trimesh.graph.connected_component_labels(mesh.face_adjacency, node_count=count)


def nearest(rgb: Any) -> str:
    """The name of the palette's colour that is nearest to a colour of the source."""
    red, green, _ = rgb
    if red > green + 0.1:
        return "red"
    return "black" if red < 0.05 else "charcoal" if red < 0.35 else "grey"


def primitive(geometry: Any) -> trimesh.Trimesh:
    """A box or a cylinder as triangles."""
    if hasattr(geometry, "halfSide"):
        return trimesh.creation.box(2 * np.ravel(geometry.halfSide))
    return trimesh.creation.cylinder(geometry.radius, 2 * geometry.halfLength, sections=32)


def visible(
    mesh: trimesh.Trimesh, views: int = 64, pixel: float = 0.003
) -> tuple[np.ndarray, np.ndarray]:
    """Find the faces visible from outside, by depth buffers of sampled points from many sides.

    Args:
        mesh: Any triangles, in metres.
        views: Number of directions, which are spread evenly over the sphere.
        pixel: Side of a pixel of the depth buffers, in metres.

    Returns:
        For each face, whether it is visible, and by how much its front is seen more than its back.
    """
    rng = np.random.default_rng(0)
    count = int(np.clip(6 * mesh.area / pixel**2, 2e5, 1.5e6))
    face = rng.choice(len(mesh.faces), count, p=mesh.area_faces / mesh.area)
    face = np.concatenate([face, np.arange(len(mesh.faces))])
    weight = rng.dirichlet(np.ones(3), len(face))
    points = np.einsum("ij,ijk->ik", weight, mesh.triangles[face])
    front = np.zeros(len(mesh.faces))
    seen = np.zeros(len(mesh.faces), bool)
    height = 1 - 2 * (np.arange(views) + 0.5) / views
    angle = np.pi * (1 + 5**0.5) * np.arange(views)
    ring = np.sqrt(1 - height**2)
    for z in np.c_[ring * np.cos(angle), ring * np.sin(angle), height]:
        x = np.cross(z, [0.0, 0, 1] if abs(z[2]) < 0.9 else [1.0, 0, 0])
        frame = np.c_[x / np.linalg.norm(x), np.cross(z, x / np.linalg.norm(x)), z]
        p = points @ frame
        cell = np.floor((p[:, :2] - p[:, :2].min(0)) / pixel).astype(int)
        index = cell[:, 0] * (cell[:, 1].max() + 1) + cell[:, 1]
        top = np.full(index.max() + 1, -np.inf)
        np.maximum.at(top, index, p[:, 2])
        hit = face[p[:, 2] > top[index] - 2 * pixel]
        seen[hit] = True
        np.add.at(front, hit, mesh.face_normals[hit] @ z)
    return seen, front


def share(name: str, by_colour: dict[str, trimesh.Trimesh]) -> float:
    """The fraction of the faces of a mesh to keep."""
    return FACES.get(name, np.inf) / sum(len(m.faces) for m in by_colour.values())


def thin(mesh: trimesh.Trimesh, fraction: float) -> trimesh.Trimesh:
    """Decimate to a fraction of the faces; normals are not smoothed across sharp edges.

    The number of faces of each connected body depends on its area, so that the thread of a small
    wheel does not use up the faces of a large plain tube.
    """
    if np.isfinite(fraction):
        body = components(mesh)
        weight = np.bincount(body, mesh.area_faces) ** 0.6
        budget = fraction * len(mesh.faces) * weight / weight.sum()
        solids = [
            mesh.submesh([np.flatnonzero(body == k)], append=True) for k in range(len(budget))
        ]
        mesh = trimesh.util.concatenate(
            [collapsed(m, n) for m, n in zip(solids, budget, strict=True)]
        )
    mesh.update_faces(mesh.nondegenerate_faces())
    mesh.remove_unreferenced_vertices()
    return trimesh.graph.smooth_shade(mesh, angle=np.radians(38), facet_minarea=None)


def collapsed(solid: trimesh.Trimesh, budget: float) -> trimesh.Trimesh:
    """A connected body reduced to about `budget` faces, with its original size."""
    for keep in (max(12, int(budget)), 2 * max(12, int(budget))):
        if keep >= len(solid.faces):
            return solid
        light = solid.simplify_quadric_decimation(face_count=keep, aggression=4)
        if light.area > 0.8 * solid.area:
            return light
    return light if light.area > 0.5 * solid.area else solid


def obj(mesh: trimesh.Trimesh) -> str:
    """The mesh as Wavefront text with normals, rounded to a tenth of a millimetre."""
    lines = [f"v {x:.4f} {y:.4f} {z:.4f}" for x, y, z in mesh.vertices + 0.0]
    lines += [f"vn {x:.2f} {y:.2f} {z:.2f}" for x, y, z in mesh.vertex_normals + 0.0]
    lines += [f"f {a}//{a} {b}//{b} {c}//{c}" for a, b, c in mesh.faces + 1]
    return "\n".join(lines).replace("-0.0000", "0.0000") + "\n"


def tree(model: pin.Model) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """The moving joints, each after its parent, and the two tool frames.

    Returns:
        Joints with parent, placement and limits, which all turn about their z axis; tips by side.
    """
    joints: list[dict[str, Any]] = []
    for name in JOINTS:
        i = model.getJointId(name)
        joints.append(
            {
                "name": name,
                "parent": "base" if not model.parents[i] else model.names[model.parents[i]],
                "position": rounded(model.jointPlacements[i].translation, 15),
                "quaternion": rounded(
                    pin.Quaternion(model.jointPlacements[i].rotation).coeffs(), 15
                ),
                "lower": float(model.lowerPositionLimit[model.idx_qs[i]]),
                "upper": float(model.upperPositionLimit[model.idx_qs[i]]),
            }
        )
    tips = {}
    for side in ("left", "right"):
        frame = model.frames[model.getFrameId(f"{side}_gripper")]
        tips[side] = {
            "parent": model.names[frame.parentJoint],
            "position": rounded(frame.placement.translation, 15),
            "quaternion": rounded(pin.Quaternion(frame.placement.rotation).coeffs(), 15),
        }
    return joints, tips


def robot_js(joints: Any, tips: Any, visuals: list[Visual], meshes: Any) -> str:
    """The viewer's robot as a classic script, which pages can also load from disk.

    Each mesh has 16-bit positions inside its box, 8-bit normals and 16-bit indices, in base64.
    """
    names = {f"{n}_{c}": k for k, (n, c, _) in enumerate(each(meshes))}
    robot = {
        "joints": joints,
        "tips": tips,
        "palette": PALETTE,
        "meshes": [packed(m) | {"colour": c} for _, c, m in each(meshes)],
        "pieces": [
            {
                "mesh": names[f"{v.mesh}_{c}"],
                "parent": v.parent,
                "position": rounded(v.pose.translation, 6),
                "quaternion": rounded(pin.Quaternion(v.pose.rotation).coeffs(), 6),
            }
            for v in visuals
            for c in meshes[v.mesh]
        ],
    }
    return f"globalThis.labkitRobot={json.dumps(robot, separators=(',', ':'))};\n"


def packed(mesh: trimesh.Trimesh) -> dict[str, Any]:
    """A mesh as base64 arrays."""
    low, size = mesh.bounds[0], np.maximum(np.ptp(mesh.bounds, axis=0), 1e-6)
    position = np.round((mesh.vertices - low) / size * 65535).astype("<u2")
    normal = np.round(mesh.vertex_normals * 127).astype("i1")
    assert len(mesh.vertices) < 65536

    def text(a: np.ndarray) -> str:
        return base64.b64encode(a.tobytes()).decode()

    return {
        "low": rounded(low, 6),
        "size": rounded(size, 6),
        "position": text(position),
        "normal": text(normal),
        "index": text(mesh.faces.astype("<u2")),
    }


if __name__ == "__main__":
    main()
