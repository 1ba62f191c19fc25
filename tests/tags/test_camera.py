"""The camera: where its pixels look, what it sees, and what it refuses."""

import cv2
import numpy as np
import pytest
from sights import Block, resized

import labkit as lk
from labkit import se3
from labkit.errors import OutOfRange
from labkit.tags.camera import BACKGROUND
from labkit.tags.drawing import joint_frames

AWAY = lk.looking_at((3.0, 3.0, 1.0), (4.0, 4.0, 1.0))
"""Nothing of the robot is in this camera's view."""


@pytest.fixture
def world():
    with lk.World() as one:
        yield one


def ready_arm(world):
    arm = lk.Arm("left", world=world)
    arm.reset(arm.robot.ready)
    return arm


@pytest.mark.parametrize("axis", [0, 1])
def test_the_renderer_looks_where_the_intrinsics_say(world, axis):
    """A sharp edge moved across the picture covers a pixel when it passes the pixel's middle.

    This measures the renderer's principal point to a few thousandths of a pixel, by bisection, at
    several places of the picture, and without any detector.
    """
    lens = lk.Intrinsics(64, 48, 80.0, 90.0, 30.3, 25.1)
    camera = lk.Camera(world, AWAY, lens, samples=1)
    offsets = []
    for pixel in (5, 20, 31, 42):
        low, high = pixel - 1.0, pixel + 1.0
        for _ in range(11):
            at = 0.5 * (low + high)
            uv = np.array([32.0, 24.0])
            uv[axis] = at
            edge = np.array([(uv[0] - lens.cx) / lens.fx, (uv[1] - lens.cy) / lens.fy, 1.0])
            T_cb = np.eye(4)
            T_cb[:3, 3] = edge
            T_cb[axis, 3] -= 1.0  # the box ends at the edge
            world.shown[:] = [Block((1, 1, 1e-4), (0, 0, 0), camera.T_wc @ T_cb)]
            looked_at = (24, pixel) if axis == 0 else (pixel, 32)
            covered = camera.image()[looked_at][0] < 128
            low, high = (low, at) if covered else (at, high)
        offsets.append(0.5 * (low + high) - pixel)
    np.testing.assert_allclose(offsets, 0.0, rtol=0, atol=4e-3)


def test_points_project_where_they_should():
    """The axis meets pixel (319.5, 239.5), twice the pixels double fx, and behind is refused."""
    lens = lk.Intrinsics()
    np.testing.assert_allclose(lens.project([[0, 0, 2.0]]), [[319.5, 239.5]])
    np.testing.assert_allclose(lens.project([[0.1, -0.2, 1.0]]), [[319.5 + 51.5, 239.5 - 103.0]])
    twice = resized(lens, 2.0)
    assert (twice.width, twice.height, twice.fx) == (1280, 960, 1030.0)
    np.testing.assert_allclose(twice.project([[0, 0, 1.0]]), [[639.5, 479.5]])
    with pytest.raises(OutOfRange, match="behind the camera"):
        lens.project([[0, 0, -1.0]])


def test_looking_at_puts_the_point_in_the_middle_and_up_upwards():
    """The point is on the optical axis in front; a camera that looks along up is refused."""
    T_wc = lk.looking_at((1.0, -1.0, 0.5), (0.5, 0.2, 0.0))
    inside = se3.inverse(T_wc) @ [0.5, 0.2, 0.0, 1.0]
    np.testing.assert_allclose(inside[:2], 0.0, rtol=0, atol=1e-12)
    assert inside[2] > 0.0
    assert T_wc[2, 1] < 0.0, "y goes down in the picture"
    with pytest.raises(OutOfRange, match=r"up=\(1, 0, 0\)"):
        lk.looking_at((0, 0, 1), (0, 0, 0))


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_robot_seen_is_where_the_model_says(side):
    """The gripper's tip by the table of meshes is the model's, at random joint angles."""
    robot, model = lk.robot(side), lk.Model(side)
    random = np.random.default_rng(0)
    for _ in range(20):
        q = random.uniform(robot.lower, robot.upper)
        T = joint_frames({side: q})[f"{side}_w2"] @ robot.T_hand_tip
        np.testing.assert_allclose(T, model.pose(q), rtol=0, atol=1e-4)


def test_the_robot_is_seen_in_its_colours_and_moves(world):
    """Red covers 1 % to 30 % and dark grey 3 % to 50 %; another pose changes above 1 % of it."""
    arm = ready_arm(world)
    camera = lk.Camera(world, lk.looking_at((2.2, 1.0, 0.8), (0.3, 0.2, 0.1)))
    before = camera.image()
    red, green, blue = before.astype(int).transpose(2, 0, 1)
    assert 0.01 < np.mean((red > 80) & (green < 60) & (blue < 60)) < 0.3
    assert 0.03 < np.mean((red < 90) & (abs(red - green) < 15) & (abs(red - blue) < 25)) < 0.5
    assert not before.flags.writeable
    arm.reset(arm.robot.neutral)
    assert np.mean(camera.image() != before) > 0.01


def test_a_picture_changes_nothing_in_the_world():
    """A run with pictures taken in between ends where the same run without ends, to the bit."""
    ends = []
    for looks in (False, True):
        with lk.World() as world:
            arm = ready_arm(world)
            camera = lk.Camera(world, AWAY)
            arm.apply(lk.JointVelocity(np.full(7, 0.1)))
            for _ in range(5):
                world.step(20)
                if looks:
                    camera.image()
            ends.append(arm.truth().q)
    np.testing.assert_array_equal(*ends)


def test_a_tag_image_shows_the_tag_as_the_picture_does(world):
    """Within the paper every pixel is the same; the rest is blank."""
    ready_arm(world)
    lk.World.put(world, lk.Table())
    board = lk.tags.Board(world, lk.Tag(), se3.pose(np.eye(3), np.array([0.75, 0.3, -0.2])))
    camera = lk.Camera(world, lk.looking_at((1.4, 0.0, 0.4), (0.7, 0.3, -0.2)))
    whole, quick = camera.image(), camera.tag_image()
    T_cm = se3.inverse(camera.T_wc) @ board.T_wm
    paper = camera.intrinsics.project(0.9 * board.outline @ T_cm[:3, :3].T + T_cm[:3, 3])
    mask = np.zeros(whole.shape[:2], np.uint8)
    cv2.fillConvexPoly(mask, np.rint(paper).astype(np.int32), 1)
    assert mask.sum() > 1000
    np.testing.assert_array_equal(whole[mask > 0], quick[mask > 0])
    assert np.mean(quick == BACKGROUND) > 0.9
    assert np.mean(whole == BACKGROUND) < 0.7


@pytest.mark.parametrize("how", ["image", "tag_image"])
def test_the_arm_hides_a_tag(world, how):
    """A tag behind the gripper is not found; when the arm is gone, it is."""
    arm = ready_arm(world)
    tip = arm.model.pose(arm.truth().q)[:3, 3]
    eye = tip + np.array([0.5, 0.0, 0.05])
    facing = se3.pose(
        np.column_stack([[0, 1, 0], [0, 0, 1.0], [1, 0, 0]]), tip + np.array([-0.1, 0, 0.01])
    )
    lk.tags.Board(world, lk.Tag(size=0.05), facing)
    camera = lk.Camera(world, lk.looking_at(eye, tip))
    assert lk.detect_tags(getattr(camera, how)(), camera, 0.05) == ()
    arm.reset(arm.robot.neutral - [0.8, 0, 0, 0, 0, 0, 0])
    assert len(lk.detect_tags(getattr(camera, how)(), camera, 0.05)) == 1


def test_noise_is_as_loud_as_stated_and_repeats_with_the_seed(world):
    """Its deviation is 8 grey levels to 1 %; one seed repeats it, another seed changes it."""
    T = AWAY @ se3.pose(np.eye(3), np.array([0, 0, 3.0]))
    world.show(Block((9, 9, 0.1), (0.9, 0.9, 0.9), T))
    clean = lk.Camera(world, AWAY).image().astype(float)
    assert clean.min() > 50 and clean.max() < 205
    first, again, other = (lk.Camera(world, AWAY, noise=8.0, seed=s).image() for s in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert np.mean(first != other) > 0.3
    assert (first - clean).std() == pytest.approx(8.0, rel=0.01)


def test_a_camera_inside_the_robot_sees_its_shell_and_no_tag(world):
    """The picture is what is there: the shell from within, which hides all else."""
    arm = ready_arm(world)
    elbow = joint_frames({"left": arm.truth().q})["left_e1"]
    inside = elbow[:3, 3]
    board = lk.tags.Board(world, lk.Tag(1, 0.2), lk.looking_at(inside + [0.6, 0.1, 0.1], inside))
    camera = lk.Camera(world, lk.looking_at(inside, board.T_wm[:3, 3]))
    assert (camera.image() < BACKGROUND).any(axis=2).mean() > 0.95
    assert not lk.detect_tags(camera.tag_image(), camera, 0.2)


@pytest.mark.parametrize("name", ["width", "fx"])
def test_a_lens_that_cannot_be_is_refused(name):
    """A width and a focal length of zero."""
    with pytest.raises(OutOfRange):
        lk.Intrinsics(**{name: 0})
