r"""Detection: from a picture to the poses of the tags in it.

OpenCV finds the tags and refines their corners as AprilTag does; `edges` makes the corners exact.
A flat square seen from afar looks the same tilted in either of two directions, so there are two
poses to choose from (Collins & Bartoli 2014, "Infinitesimal plane-based pose estimation", IPPE);
the ratio of their errors says how reliable the choice is.

The covariance is that of least squares, :math:`J^+ C J^{+T}`, with J the derivative of the corners'
pixels with respect to a small motion of the tag, and C the corners' covariance from the edges of
the same picture.  A tag whose edges are not seen well, or whose corners differ from those of a
square by more than C explains, is not reported: the pose of a half-hidden tag would be wrong.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

from .. import se3
from ..errors import LabkitError, OutOfRange, TypeMismatch
from ..shapes import Array, as_array, as_number, locked, shown
from .edges import Outline, sharpened
from .intrinsics import Intrinsics
from .tag import PATTERNS, Picture, as_picture, tag_corners

if TYPE_CHECKING:
    from .camera import Camera

_SQUARE = 6.0
"""Largest error of the corners relative to those of a square, in standard deviations."""

_NONE = Intrinsics().distortion

_APRILTAG_OFFSET = 0.5  # OpenCV's AprilTag code counts pixels from their corners


class TagNotFound(LabkitError, LookupError):
    """The tag asked for is not in the picture."""


class DuplicateTag(LabkitError, ValueError):
    """Two tags in the picture have the same number."""


@dataclass(frozen=True, eq=False)
class Detection:
    """One tag in one picture.

    Attributes:
        id: Its number.
        corners: Its corners in the picture, clockwise from the tag's upper left, shape (4, 2) in
            [px].
        noise: Standard deviation of a corner's coordinate, estimated from the edges, in [px].
        T_cm: Pose of the tag in the camera's frame, shape (4, 4).
        error: Root mean square distance between the corners and those of the pose, in [px].
        ratio: How many times worse the other pose fits, at least 1; near 1 the tilt is a guess.
        covariance: Covariance of the position [m] and of the orientation, as a rotation vector
            [rad], in the camera's axes, shape (6, 6).
    """

    id: int
    corners: Array
    noise: float
    T_cm: Array
    error: float
    ratio: float
    covariance: Array


def detect_tags(
    image: Any, camera: Camera | Intrinsics, size: float | Mapping[int, float]
) -> tuple[Detection, ...]:
    """Find the tags in a picture.

    Args:
        image: Grey levels (height, width) or RGB (height, width, 3), uint8.
        camera: The camera that took it, or its intrinsics.
        size: Side of the black square, in [m]; or a mapping from tag numbers to sizes; tags
            with other numbers are ignored.

    Returns:
        The detected tags in the order of their numbers; empty if there are none.

    Raises:
        TypeMismatch: The image is not a picture, or the camera not a camera.
        OutOfRange: A size is not positive.
    """
    grey, lens = as_picture(image), _intrinsics(camera)
    sizes = size if isinstance(size, Mapping) else None
    for one in [size] if sizes is None else sizes.values():
        as_number(one, "size", above=0.0)
    found = _outlines(grey, [] if sizes is None else list(sizes), lens)
    seen = []
    for number, outline in found:
        side = size if sizes is None else sizes.get(number)
        if side is not None:
            seen.append(_detection(number, outline, lens, float(side)))  # type: ignore[arg-type]
    sure = [d for d in seen if d.error <= _SQUARE * d.noise]
    return tuple(sorted(sure, key=lambda d: (d.id, d.error)))


def find_tag(detections: Sequence[Detection], id: int) -> Detection:
    """The detection of the tag with a given number.

    Args:
        detections: Result of `detect_tags`.
        id: Number of the tag.

    Raises:
        TagNotFound: The tag is not among them.
        DuplicateTag: The tag is among them more than once.
    """
    hits = [d for d in detections if d.id == id]
    if not hits:
        others = ", ".join(str(d.id) for d in detections) or "none at all"
        raise TagNotFound(
            f"tag {id} is not in the picture (found: {others}); is it in view, large enough, not "
            "hidden, and of AprilTag 36h11?"
        )
    if len(hits) > 1:
        raise DuplicateTag(
            f"tag {id} is in the picture {len(hits)} times, so its pose is anyone's guess; give "
            "each board a number of its own"
        )
    return hits[0]


def tag_poses(corners: Any, camera: Camera | Intrinsics, size: float) -> list[Array]:
    """The two poses that approximately explain a tag's corners, best first, by IPPE alone.

    Args:
        corners: Pixels, clockwise from the tag's upper left, shape (4, 2).
        camera: The camera, or its intrinsics.
        size: Side of the black square, in [m].

    Returns:
        Two `T_cm`, shape (4, 4) each.

    Raises:
        OutOfRange: No square looks like that from anywhere.
    """
    lens, pixels = _intrinsics(camera), as_array(corners, (4, 2), "corners")
    straight, square = np.array(lens.straightened(pixels)), tag_corners(size)
    for nudge in (0.0, 1e-7):  # OpenCV divides by zero where the corners are an upright square
        seen = straight + np.eye(4, 2) * nudge
        _, turns, places, _ = cv2.solvePnPGeneric(
            square, seen, lens.matrix, None, flags=cv2.SOLVEPNP_IPPE_SQUARE
        )
        if np.isfinite(turns).all():
            break
    if not turns:
        raise OutOfRange(
            f"no square has its corners at the pixels {pixels.tolist()}; are they four different "
            "ones, clockwise from the tag's upper left?"
        )
    poses = [_pose(turn, place) for turn, place in zip(turns, places, strict=True)]
    return sorted(poses, key=lambda T: reprojection_error(T, pixels, lens, size))


def tag_pose(corners: Any, camera: Camera | Intrinsics, size: float) -> Array:
    """The pose that best explains a tag's corners, by IPPE and then least squares.

    Args:
        corners: Pixels, clockwise from the tag's upper left, shape (4, 2).
        camera: The camera, or its intrinsics.
        size: Side of the black square, in [m].

    Returns:
        `T_cm`, shape (4, 4).

    Raises:
        OutOfRange: No square looks like that from anywhere.
    """
    pixels, lens = as_array(corners, (4, 2), "corners"), _intrinsics(camera)
    return _polished(tag_poses(pixels, lens, size)[0], pixels, lens, size)


def reprojection_error(T_cm: Any, corners: Any, camera: Camera | Intrinsics, size: float) -> float:
    """Root mean square distance of a pose's corners from those seen, in [px]; infinite if behind.

    Args:
        T_cm: Pose of the tag in the camera's frame, shape (4, 4).
        corners: Pixels, shape (4, 2).
        camera: The camera, or its intrinsics.
        size: Side of the black square, in [m].
    """
    pixels, T = as_array(corners, (4, 2), "corners"), se3.as_pose(T_cm, "T_cm")
    points = tag_corners(size) @ T[:3, :3].T + T[:3, 3]
    if points[:, 2].min() <= 0.0:
        return float("inf")
    off = _intrinsics(camera).project(points) - pixels
    return float(np.sqrt(np.mean(np.sum(off**2, axis=1))))


def pose_covariance(T_cm: Any, camera: Camera | Intrinsics, size: float, noise: Any) -> Array:
    """Covariance of a pose that results from errors of the corners.

    Args:
        T_cm: Pose of the tag in the camera's frame, shape (4, 4).
        camera: The camera, or its intrinsics.
        size: Side of the black square, in [m].
        noise: Standard deviation of each of the corners' coordinates, in [px], with independent
            errors; or their covariance, x and y in turn, shape (8, 8) in [px^2].

    Returns:
        Shape (6, 6), as `Detection.covariance`.
    """
    lens, T = _intrinsics(camera), se3.as_pose(T_cm, "T_cm")
    arms = tag_corners(size) @ T[:3, :3].T
    turn, place = np.zeros(3), np.array(T[:3, 3])  # a small rotation after the pose's own
    bent = np.array(lens.distortion)
    J = cv2.projectPoints(arms, turn, place, lens.matrix, bent)[1][:, [3, 4, 5, 0, 1, 2]]
    C = noise if np.ndim(noise) else as_number(noise, "noise", above=0.0) ** 2 * np.eye(8)
    back = np.linalg.pinv(J)
    return locked(np.array(back @ as_array(C, (8, 8), "noise") @ back.T))


def _detection(id: int, outline: Outline, lens: Intrinsics, size: float) -> Detection:
    flat, corners = replace(lens, distortion=_NONE), outline.corners
    first, other = tag_poses(corners, flat, size)
    best = _polished(first, corners, flat, size)
    error, first_error, other_error = (
        reprojection_error(T, corners, flat, size) for T in (best, first, other)
    )
    return Detection(
        id=id,
        corners=locked(lens.bent(corners) if any(lens.distortion) else corners),
        noise=float(np.sqrt(outline.covariance.diagonal().mean())),
        T_cm=best,
        error=error,
        ratio=other_error / max(first_error, 1e-9),
        covariance=pose_covariance(best, flat, size, outline.covariance),
    )


def _polished(T_cm: Array, corners: Array, lens: Intrinsics, size: float) -> Array:
    """The pose near ``T_cm`` that fits the pixels best."""
    turn, place = se3.rotation_log(T_cm[:3, :3])[:, None], np.array(T_cm[:3, 3:])
    bent = np.array(lens.distortion)
    return _pose(*cv2.solvePnPRefineLM(tag_corners(size), corners, lens.matrix, bent, turn, place))


def _pose(turn: Any, place: Any) -> Array:
    return locked(se3.pose(se3.rotation(np.ravel(turn)), np.ravel(place)))


def _intrinsics(camera: Any) -> Intrinsics:
    lens = camera if isinstance(camera, Intrinsics) else getattr(camera, "intrinsics", None)
    if not isinstance(lens, Intrinsics):
        raise TypeMismatch(
            f"camera is {shown(camera)}; give the lk.Camera that took the picture, or its "
            "lk.Intrinsics"
        )
    return lens


def _outlines(grey: Picture, wanted: list[int], lens: Intrinsics) -> list[tuple[int, Outline]]:
    """Numbers and outlines.  If one knows what to look for, half of the pixels may be enough."""
    for decimate in (2.0, 0.0) if wanted else (0.0,):
        found = _numbered(grey, decimate)
        fine = [(number, sharpened(grey, corners, lens)) for number, corners in found]
        sharp = [(number, outline) for number, outline in fine if outline is not None]
        if len(sharp) == len(fine) and {number for number, _ in sharp} >= set(wanted):
            break
    return sharp


def _numbered(grey: Picture, decimate: float) -> list[tuple[int, Array]]:
    found, numbers, _ = _detector(decimate).detectMarkers(grey)
    corners = [rough.reshape(4, 2).astype(float) - _APRILTAG_OFFSET for rough in found]
    return list(zip([] if numbers is None else numbers.ravel().tolist(), corners, strict=True))


@cache
def _detector(decimate: float) -> Any:
    settings = cv2.aruco.DetectorParameters()
    settings.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_APRILTAG
    settings.aprilTagQuadDecimate = decimate
    settings.perspectiveRemovePixelPerCell = 8  # reads small and tilted tags that 4 does not
    return cv2.aruco.ArucoDetector(PATTERNS, settings)
