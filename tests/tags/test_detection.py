"""Detection: poses against the truth of two independent pictures, and sentences when it fails."""

import cv2
import numpy as np
import pytest
from sights import resized

import labkit as lk
from labkit import se3
from labkit.errors import LabkitError, OutOfRange, TypeMismatch
from labkit.tags.detection import (
    pose_covariance,
    reprojection_error,
    tag_pose,
    tag_poses,
)
from solutions.study.sensing import Setup, random_poses, read
from tests.bench.tags import row

LENS = lk.Intrinsics()


def painted(tag, T_cm, fine=8):
    """A picture of a tag made without PyBullet: its image warped, many times as fine, averaged."""
    lens = resized(LENS, fine)
    half = 0.5 * tag.paper
    paper = np.array([[-half, half, 0], [half, half, 0], [half, -half, 0], [-half, -half, 0]])
    seen = lens.project(paper @ T_cm[:3, :3].T + T_cm[:3, 3])
    image = tag.image(cell=32)
    n = len(image)
    flat = np.array([[0, 0], [n, 0], [n, n], [0, n]]) - 0.5
    H = cv2.getPerspectiveTransform(flat.astype(np.float32), seen.astype(np.float32))
    size = (lens.width, lens.height)
    large = cv2.warpPerspective(image, H, size, flags=cv2.INTER_LINEAR, borderValue=120)
    return cv2.resize(large, (LENS.width, LENS.height), interpolation=cv2.INTER_AREA)


def tilted(tilt, distance=0.7, roll=0.4):
    lean = se3.rotation(np.array([tilt, 0.0, 0.0])) @ se3.rotation(np.array([0.0, 0.0, roll]))
    return se3.pose(np.diag([1.0, -1.0, -1.0]) @ lean, np.array([0.03, -0.02, distance]))


def test_the_pose_in_rendered_pictures_is_the_true_one():
    """All of 30 random tags are found, to 2 mm, and to half a degree where they are tilted."""
    setup = Setup(tag=lk.Tag(5))
    readings = read(setup, random_poses(setup, 30, np.random.default_rng(3)))
    assert readings.found.all()
    assert np.linalg.norm(readings.error[:, :3], axis=1).max() < 2.5e-3
    steep = readings.tilt > np.pi / 12
    assert np.degrees(np.linalg.norm(readings.error[steep, 3:], axis=1)).max() < 0.8


@pytest.mark.parametrize("name", ["light falls 60 %", "gamma 1.4", "blur 2 px", "smear 6 px"])
def test_a_camera_in_bad_light_or_out_of_focus_is_not_blind(name):
    """Every tag that OpenCV finds is found, at most as far off as by its AprilTag refinement."""
    one = row(name, count=5)
    assert one["missed"] == 0 and one["found"] == 5
    assert one["median_mm"] <= (one["opencv"]["median_mm"] or 1.0)
    assert 1.0 < one["nees"] < 20.0


def test_corners_have_no_bias():
    """The corners' mean error over random poses is a few thousandths of a pixel, both ways."""
    setup = Setup()
    readings = read(setup, random_poses(setup, 60, np.random.default_rng(8)))
    np.testing.assert_allclose(readings.corner_error.mean(axis=(0, 1)), 0.0, rtol=0, atol=0.01)


@pytest.mark.parametrize("tilt", [0.0, 0.4, 0.9])
def test_the_pose_in_a_picture_made_without_the_renderer_is_the_true_one(tilt):
    """At 0, 0.4 and 0.9 rad of tilt the tag is found to 1.5 mm and 1 degree."""
    tag, T_cm = lk.Tag(11), tilted(tilt)
    (found,) = lk.detect_tags(painted(tag, T_cm), LENS, 0.1)
    np.testing.assert_allclose(found.T_cm[:3, 3], T_cm[:3, 3], rtol=0, atol=1.5e-3)
    assert np.degrees(se3.angle_between(found.T_cm[:3, :3], T_cm[:3, :3])) < 1.0


def test_the_better_of_the_two_poses_comes_first():
    """At 45 degrees the other pose, leaning the other way, fits many times worse."""
    tag, T_cm = lk.Tag(), tilted(0.8)
    pixels = LENS.project(tag.corners @ T_cm[:3, :3].T + T_cm[:3, 3])
    best, other = tag_poses(pixels, LENS, 0.1)
    np.testing.assert_allclose(best, T_cm, rtol=0, atol=1e-6)
    lean = [se3.inverse(T)[2, 1] for T in (best, other)]
    assert lean[0] * lean[1] < 0.0
    assert reprojection_error(other, pixels, LENS, 0.1) > 1.0
    (found,) = lk.detect_tags(painted(tag, T_cm), LENS, 0.1)
    assert found.error < 0.1


def test_corners_may_be_a_list_and_must_be_those_of_a_square():
    """A list gives the array's pose; four equal corners and crossed ones are refused."""
    pixels = LENS.project(lk.Tag().corners @ tilted(0.8)[:3, :3].T + tilted(0.8)[:3, 3])
    np.testing.assert_array_equal(tag_pose(pixels.tolist(), LENS, 0.1), tag_pose(pixels, LENS, 0.1))
    for none in (np.zeros((4, 2)), [[0, 0], [9, 9], [9, 0], [0, 9]]):
        with pytest.raises(lk.errors.OutOfRange, match="no square has its corners at the pixels"):
            tag_pose(none, LENS, 0.1)


def test_the_covariance_is_what_noise_on_the_corners_does():
    """Against 3000 poses from corners with noise drawn at random."""
    tag, T_cm, noise = lk.Tag(), tilted(0.7), 0.1
    pixels = LENS.project(tag.corners @ T_cm[:3, :3].T + T_cm[:3, 3])
    random = np.random.default_rng(1)
    drawn = [pixels + noise * random.standard_normal((4, 2)) for _ in range(3000)]
    errors = [se3.pose_error(T_cm, tag_pose(p, LENS, 0.1)) for p in drawn]
    expected = pose_covariance(T_cm, LENS, 0.1, noise)
    scale = np.sqrt(np.diag(expected))
    seen = np.cov(np.array(errors).T)
    np.testing.assert_allclose(seen / np.outer(scale, scale), expected / np.outer(scale, scale),
                               rtol=0, atol=0.12)  # fmt: skip


def test_no_tag_in_view_is_an_empty_answer():
    """Detection gives an empty tuple."""
    assert lk.detect_tags(np.full((480, 640), 200, np.uint8), LENS, 0.1) == ()


def test_two_tags_with_one_number_are_both_detected():
    """With one size or one for each number."""
    left, right = (
        painted(lk.Tag(7), se3.pose(tilted(0.3)[:3, :3], np.array([x, 0.0, 0.7])))
        for x in (-0.15, 0.15)
    )
    both = np.hstack([left[:, :320], right[:, 320:]])
    for size in (0.1, {7: 0.1}):
        assert [d.id for d in lk.detect_tags(both, LENS, size)] == [7, 7]


def test_tags_of_other_numbers_are_passed_over_when_sizes_are_named():
    """With a size for 8 alone, a picture of 7 gives nothing."""
    picture = painted(lk.Tag(7), tilted(0.3))
    assert lk.detect_tags(picture, LENS, {8: 0.1}) == ()


def test_a_covered_tag_is_not_found_and_does_no_harm():
    """A tag whose lower part is hidden gives an empty answer and no error."""
    picture = painted(lk.Tag(7), tilted(0.3))
    picture[230:, :] = 60
    assert lk.detect_tags(picture, LENS, 0.1) == ()


@pytest.mark.parametrize(
    ("ask", "error", "says"),
    [
        (lambda im: lk.detect_tags(im, LENS, 0.0), OutOfRange, "size is 0"),
        (lambda im: lk.detect_tags(im, LENS, {3: -1.0}), OutOfRange, "size is -1"),
        (lambda im: lk.detect_tags(im / 255.0, LENS, 0.1), TypeMismatch, "array of uint8"),
        (lambda im: lk.detect_tags(None, LENS, 0.1), TypeMismatch, "image is NoneType"),
        (lambda im: lk.detect_tags(im[..., None], LENS, 0.1), TypeMismatch, "has shape"),
        (lambda im: lk.detect_tags(im[:0], LENS, 0.1), TypeMismatch, "has shape"),
        (lambda im: lk.detect_tags(im, 515.0, 0.1), TypeMismatch, "give the lk.Camera"),
    ],
)
def test_what_cannot_be_used_is_refused_in_a_sentence(ask, error, says):
    """A size that is not positive, and images and lenses of a wrong type or shape, are named."""
    with pytest.raises(error, match=says) as caught:
        ask(np.zeros((480, 640), np.uint8))
    assert isinstance(caught.value, LabkitError)


def test_an_upright_square_has_a_pose_too():
    """Corners without any tilt, on whole pixels, are where OpenCV's own formula divides by zero."""
    lens = LENS
    u, v, half = lens.cx, lens.cy, 22.0
    corners = np.array(
        [[u - half, v - half], [u + half, v - half], [u + half, v + half], [u - half, v + half]]
    )
    for T_cm in tag_poses(corners, lens, 0.1):
        assert np.isfinite(T_cm).all()
        np.testing.assert_allclose(T_cm[2, 3], lens.fx * 0.1 / 44.0, rtol=1e-4)
