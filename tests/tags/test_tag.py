"""Tags to print, and boards that carry them."""

import cv2
import numpy as np
import pytest

import labkit as lk
from labkit import se3
from labkit.errors import OutOfRange, ShapeError, TypeMismatch
from labkit.tags.tag import tag_corners


def test_the_printed_image_reads_as_its_number():
    """An independent detector reads the tag's number off its image."""
    kind = cv2.aruco.DICT_APRILTAG_36h11
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(kind))
    for number in (0, 7, 249):
        picture = np.pad(lk.Tag(number, 0.1).image(), 20, constant_values=90)
        _, ids, _ = detector.detectMarkers(picture)
        assert ids.ravel().tolist() == [number]


def test_the_border_is_white_and_a_cell_wide():
    """One cell of white surrounds black edges, and the paper is 10/8 of the tag."""
    picture = lk.Tag(3).image(cell=10)
    inside = picture[10:-10, 10:-10]
    assert picture.sum(dtype=int) - inside.sum(dtype=int) == 255 * (100**2 - 80**2)
    assert not inside[:10].any() and not inside[:, -10:].any()
    assert lk.Tag(3).paper == pytest.approx(0.125)


def test_corners_go_clockwise_for_who_looks_at_the_tag():
    """From the upper left; z comes out of the paper, so clockwise is a negative turn about z."""
    corners = tag_corners(0.2)
    np.testing.assert_array_equal(corners[0], [-0.1, 0.1, 0.0])
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        assert np.linalg.norm(b - a) == pytest.approx(0.2)
        assert np.cross(a, b)[2] < 0.0


@pytest.mark.parametrize("wrong", [{"size": 0.0}, {"id": 587}])
def test_a_tag_that_cannot_be_is_refused(wrong):
    """A size of 0, and a number that the family has not."""
    with pytest.raises(OutOfRange):
        lk.Tag(**wrong)


def turned(angle, place=(0.7, 0.0, 0.0)):
    return se3.pose(se3.rotation(np.array([0.0, 0.0, angle])), np.array(place))


def test_a_board_stays_is_moved_by_hand_and_moves_on_a_trajectory():
    """It is halfway at half of the time and stays at the end, in the orientation it had."""
    with lk.World() as world:
        board = lk.tags.Board(world, lk.Tag(), turned(0.3))
        world.step(100)
        np.testing.assert_array_equal(board.T_wm, turned(0.3))
        board.place(turned(0.5))
        np.testing.assert_array_equal(board.T_wm, turned(0.5))
        path = lk.Line([0.7, 0, 0], [0.9, 0, 0])
        board.move(lk.Trajectory(path, lk.Quintic(0.2)))
        world.step(100)
        np.testing.assert_allclose(board.T_wm[:3, 3], [0.8, 0, 0], rtol=0, atol=1e-12)
        np.testing.assert_array_equal(board.T_wm[:3, :3], turned(0.5)[:3, :3])
        world.step(500)
        np.testing.assert_allclose(board.T_wm[:3, 3], [0.9, 0, 0], rtol=0, atol=1e-12)


def test_a_board_follows_a_trajectory_of_poses():
    """At half of the time it is halfway, and turned by half of the angle."""
    with lk.World() as world:
        board = lk.tags.Board(world, lk.Tag(), turned(0.0))
        line = lk.Line([0.7, 0, 0], [0.7, 0.2, 0])
        path = lk.PosePath(line, np.eye(3), turned(1.0)[:3, :3])
        board.move(lk.Trajectory(path, lk.Cubic(1.0)))
        world.step(500)
        np.testing.assert_allclose(board.T_wm, turned(0.5, (0.7, 0.1, 0.0)), rtol=0, atol=1e-12)


def test_several_boards_are_seen_at_once():
    """Each with its own number, place and size."""
    with lk.World() as world:
        down = np.diag([1.0, -1.0, -1.0])
        for number, x, size in ((4, 2.9, 0.1), (9, 3.1, 0.06)):
            lk.tags.Board(world, lk.Tag(number, size), turned(0.0, (x, 3.0, 0.0)))
        camera = lk.Camera(world, se3.pose(down, np.array([3.0, 3.0, 0.7])))
        seen = lk.detect_tags(camera.image(), camera, {4: 0.1, 9: 0.06})
        assert [d.id for d in seen] == [4, 9]
        for found, x in zip(seen, (2.9, 3.1), strict=True):
            place = (camera.T_wc @ found.T_cm)[:3, 3]
            np.testing.assert_allclose(place, [x, 3.0, 0.0], rtol=0, atol=2e-3)


def test_only_poses_and_points_move_a_board():
    """Joint angles, a pose itself, and a number for the tag are refused."""
    with lk.World() as world:
        board = lk.tags.Board(world, lk.Tag(), turned(0.0))
        with pytest.raises(ShapeError):
            board.move(lk.Hold(np.zeros(7), 1.0))
        with pytest.raises(TypeMismatch):
            board.move(turned(0.0))
        with pytest.raises(TypeMismatch):
            lk.tags.Board(world, 5, turned(0.0))
