"""Baxter's meshes for the camera: complete, small, in the right colours, quick to draw."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

DATA = Path(__file__).parents[2] / "labkit/data"
TABLE = json.loads((DATA / "baxter_visual.json").read_text())
REST = {"s1": -0.55, "e1": 0.75, "w1": 1.26}


def placed(thing):
    return thing["position"], thing["quaternion"]


def frames(pybullet):
    """Pose of every joint in the base at rest."""
    found = {"base": ([0, 0, 0], [0, 0, 0, 1])}
    for joint in TABLE["joints"]:
        turn = pybullet.getQuaternionFromEuler([0, 0, REST.get(joint["name"].split("_")[-1], 0.0)])
        fixed = pybullet.multiplyTransforms(*found[joint["parent"]], *placed(joint))
        found[joint["name"]] = pybullet.multiplyTransforms(*fixed, [0, 0, 0], turn)
    return found


def test_every_piece_has_its_mesh_and_a_parent():
    """Each parent is a joint or the base; the files are those that are used, and below 6 MB."""
    names = {"base"} | {j["name"] for j in TABLE["joints"]}
    assert {p["parent"] for p in TABLE["pieces"]} <= names
    used = {p["mesh"] for p in TABLE["pieces"]}
    assert used == {f"meshes/{p.name}" for p in (DATA / "meshes").iterdir()}
    assert sum((DATA / name).stat().st_size for name in used) < 6e6


def test_left_and_right_share_their_meshes():
    """The only meshes that one side alone has are those of finger tips."""
    by_side = [
        {p["mesh"] for p in TABLE["pieces"] if p["parent"].startswith(s)} for s in ("left", "right")
    ]
    alone = by_side[0] ^ by_side[1]
    assert all("tip" in name for name in alone), "only the finger tips differ"


def test_the_triangles_drawn_are_few():
    """All pieces together have fewer than 50,000."""
    count = {
        p["mesh"]: len(re.findall("^f ", (DATA / p["mesh"]).read_text(), re.MULTILINE))
        for p in TABLE["pieces"]
    }
    assert sum(count[p["mesh"]] for p in TABLE["pieces"]) < 50_000


@pytest.mark.pybullet
def test_the_camera_sees_a_red_and_dark_robot():
    """In PyBullet's own picture red covers 1 % to 20 % and dark grey 3 % to 40 %."""
    import pybullet

    client = pybullet.connect(pybullet.DIRECT)
    try:
        where = frames(pybullet)
        for piece in TABLE["pieces"]:
            shape = pybullet.createVisualShape(
                pybullet.GEOM_MESH, fileName=str(DATA / piece["mesh"]), rgbaColor=piece["rgba"]
            )
            assert shape >= 0
            pose = pybullet.multiplyTransforms(*where[piece["parent"]], *placed(piece))
            pybullet.createMultiBody(0, -1, shape, *pose)
        view = pybullet.computeViewMatrix([2.4, 1.2, 0.9], [0.2, 0, 0], [0, 0, 1])
        lens = pybullet.computeProjectionMatrixFOV(45, 4 / 3, 0.05, 10)
        *_, pixels, _, _ = pybullet.getCameraImage(
            640, 480, view, lens, shadow=0, renderer=pybullet.ER_TINY_RENDERER
        )
    finally:
        pybullet.disconnect(client)
    red, green, blue = np.reshape(pixels, (480, 640, 4))[..., :3].astype(int).transpose(2, 0, 1)
    share_red = np.mean((red > 80) & (green < 60) & (blue < 60))
    share_dark = np.mean((red < 90) & (abs(red - green) < 15) & (abs(red - blue) < 20))
    assert 0.01 < share_red < 0.2
    assert 0.03 < share_dark < 0.4
