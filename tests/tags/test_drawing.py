"""The renderer: depths, edges and areas against what geometry says, and one picture everywhere."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from sights import Block, resized

import labkit as lk
from labkit import se3
from labkit.tags.camera import printed
from labkit.tags.drawing import DATA, FAR, NEAR, Surface, Window, box, draw, joined

LENS = lk.Intrinsics(64, 48, 80.0, 90.0, 30.3, 25.1)
WHOLE = Window(0, 0, LENS.width, LENS.height)
FLOOR = Surface(
    9.0 * np.array([[[-1, 0, -1], [1, 0, -1], [1, 0, 1]], [[-1, 0, -1], [1, 0, 1], [-1, 0, 1]]])
    + [0.0, 0.5, 0.0],
    np.ones((2, 3)),
)  # fmt: skip
"""Half a metre below the camera, and behind it too."""
KNOWN = Path(__file__).with_name("picture.png")


@pytest.mark.parametrize("samples", [1, 3])
@pytest.mark.parametrize("window", [WHOLE, Window(20, 24, 30, 17)])
def test_a_floor_that_passes_below_the_camera_has_the_depth_of_its_plane(window, samples):
    """A ray meets it at Z = 0.5 / (Y/Z); what lies behind the camera changes nothing."""
    _, depth = draw(FLOOR, LENS, np.eye(4), window, samples)
    _, down = window.rays(LENS, samples)
    with np.errstate(divide="ignore"):
        expected = np.where(down > 0.0, 0.5 / np.where(down > 0.0, down, 1.0), np.inf)
    seen = (expected > NEAR) & (expected < 8.0)
    assert seen.sum() >= 10
    np.testing.assert_allclose(
        depth[seen], np.tile(expected[seen, None], depth.shape[1]), rtol=1e-4
    )
    assert (depth[down < 0.0] > 0.99 * FAR).all()


def test_a_window_is_a_part_of_the_whole_picture():
    """Whatever part is drawn, its pixels are those of the whole."""
    block = box((0.3, 0.2, 0.1), (0.8, 0.4, 0.2)).moved(
        se3.pose(se3.rotation(np.array([0.4, 0.7, 0.2])), np.array([0.1, 0.05, 1.4]))
    )
    whole, depth = draw(block, LENS, np.eye(4), WHOLE)
    part = Window(13, 9, 31, 22)
    colours, near = draw(block, LENS, np.eye(4), part)
    np.testing.assert_allclose(colours, whole[part.place], rtol=0, atol=1e-6)
    np.testing.assert_allclose(near, depth[part.place], rtol=1e-4)


def test_nearer_surfaces_hide_those_behind_in_any_order():
    """What is drawn first does not matter."""
    near, far = (box((0.2, 0.2, 0.01), (x, 0, 0)).moved(se3.pose(np.eye(3), np.array([0, 0, z])))
                 for x, z in ((0.2, 1.0), (0.9, 2.0)))  # fmt: skip
    pictures = [
        draw(joined(both), LENS, np.eye(4), WHOLE)[0] for both in ((near, far), (far, near))
    ]
    np.testing.assert_array_equal(*pictures)
    assert pictures[0][24, 30, 0] < 0.3


def test_the_paper_covers_as_many_pixels_as_its_outline_encloses():
    """The shares of all pixels add up to the area of the projected square."""
    random = np.random.default_rng(5)
    tag, lens = lk.Tag(3), lk.Intrinsics()
    for _ in range(10):
        turn = se3.rotation(np.array([np.pi, 0, 0]) + random.uniform(-0.6, 0.6, 3))
        place = np.array([*random.uniform(-0.2, 0.2, 2), random.uniform(0.5, 1.5)])
        T = se3.pose(turn, place)
        corners = tag.corners * (tag.paper / tag.size) @ T[:3, :3].T + T[:3, 3]
        outline = lens.project(corners)
        area = cv2.contourArea(outline.astype(np.float32))
        share, white = printed(tag, T, lens, Window(0, 0, lens.width, lens.height), 8)
        assert share.sum() == pytest.approx(area, rel=2e-3)
        assert share.min() >= 0.0 and share.max() <= 1.0
        brute = _everywhere(tag, T, lens)
        off = np.abs(share * white - brute)
        assert off.max() < 0.2 and np.mean(off > 0.08) < 1e-3


def _everywhere(tag, T, lens, n=4):
    """How white each pixel of the picture is, by n^2 points in all of them, on an edge or not."""
    fine = resized(lens, float(n))
    share, white = printed(tag, T, fine, Window(0, 0, fine.width, fine.height), 1)
    return (share * white).reshape(lens.height, n, lens.width, n).mean(axis=(1, 3))


def test_half_of_a_tag_behind_a_block_is_hidden_by_half():
    """The block's colour stands where it is nearer than the paper, and nowhere else."""
    eye = lk.looking_at((3.0, 3.0, 1.0), (4.0, 4.0, 1.0))
    with lk.World() as world:
        lk.tags.Board(
            world, lk.Tag(), eye @ se3.pose(np.diag([1.0, -1, -1]), np.array([0, 0, 0.7]))
        )
        camera = lk.Camera(world, eye)
        free = camera.tag_image()
        world.show(Block((0.5, 0.5, 1e-3), (1, 0, 0), eye @ se3.pose(np.eye(3), [0.5, 0, 0.5])))
        hidden = camera.tag_image()
        left, right = np.s_[200:280, 300:318], np.s_[200:280, 322:340]
        np.testing.assert_array_equal(hidden[left], free[left])
        assert (hidden[right][..., 0] > 100).all() and (hidden[right][..., 1] == 0).all()
        behind = Block((0.5, 0.5, 1e-3), (1, 0, 0), eye @ se3.pose(np.eye(3), [0.5, 0, 0.9]))
        world.shown[-1] = behind
        np.testing.assert_array_equal(camera.tag_image(), free)


def scene():
    """The arm, a table, a wall and two tags, one of them half hidden, in a small picture."""
    with lk.World(things=[lk.Table(), lk.Wall((1.1, 0.6, 0.1), (-1, 0, 0), (0.4, 0.4))]) as world:
        arm = lk.Arm("left", world=world, q0=lk.robot("left").ready)
        tip = arm.model.pose(arm.truth().q)[:3, 3]
        for number, place in enumerate(((0.85, 0.15, -0.2), tip + [0.02, 0.03, -0.1])):
            turn = se3.rotation(np.array([0.0, 0.0, 0.3]))
            lk.tags.Board(world, lk.Tag(number), se3.pose(turn, np.array(place)))
        lens = resized(lk.Intrinsics(), 0.5)
        return lk.Camera(world, lk.looking_at((1.6, -0.2, 0.8), (0.7, 0.2, 0.0)), lens).image()


def test_the_picture_is_the_same_on_every_machine():
    """Within one grey level of the one that is kept here, in all but a thousandth of the pixels."""
    known = cv2.cvtColor(cv2.imread(str(KNOWN)), cv2.COLOR_BGR2RGB).astype(int)
    off = np.abs(scene().astype(int) - known).max(axis=2)
    assert np.mean(off > 1) < 1e-3


def test_every_piece_has_its_mesh_and_a_parent():
    """Each parent is a joint or the base; the files are those that are used, and below 6 MB."""
    table = json.loads((DATA / "baxter_visual.json").read_text())
    names = {"base"} | {j["name"] for j in table["joints"]}
    assert {p["parent"] for p in table["pieces"]} <= names
    used = {p["mesh"] for p in table["pieces"]}
    assert used == {f"meshes/{p.name}" for p in (DATA / "meshes").iterdir()}
    assert sum((DATA / name).stat().st_size for name in used) < 6e6
