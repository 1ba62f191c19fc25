r"""Detection: from a picture to the poses of the tags in it.

OpenCV finds the tags; if one is missing, or there is none, once more in the doubled picture, and
then by the edge of their paper, which counts where the ground is brighter than the paper;
`fitting` makes the corners exact.
A flat square seen from afar looks the same tilted in either of two directions, so there are two
poses to choose from (Collins & Bartoli 2014, "Infinitesimal plane-based pose estimation", IPPE);
the ratio of their errors says how reliable the choice is.

The covariance is that of least squares, :math:`J^+ C J^{+T}`, with J the derivative of the corners'
pixels with respect to a small motion of the tag, and C the corners' covariance from
the same picture.  Where the pattern cannot be fitted, OpenCV's corners stay, with their own, larger
errors; where the corners are not those of a square, C is larger, as a lens's error mostly fits one.
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
from .fitting import Outline, fitted
from .intrinsics import Intrinsics
from .tag import CELLS, PATTERNS, Picture, as_picture, tag_corners

if TYPE_CHECKING:
    from .camera import Camera

_LOOKS = ((1, 0), (2, 0), (2, 1))  # how much larger, and cells of white paper that count
_NONE = Intrinsics().distortion
_INSIDE = 0.6  # [px] from the outermost dark pixels, which OpenCV gives, to the corner
_ROUGH = 0.6  # [px]; how exact those are
_HIDDEN = 32.0  # by which a wrong lens moves corners more than it shows, in squares


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
        noise: Standard deviation of a corner's coordinate, estimated from the picture, in [px].
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

    A closer look, for small tags, is taken while a tag of ``size`` is missing or none is found.

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
    return tuple(sorted(seen, key=lambda d: (d.id, d.error)))


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
    noise = float(np.sqrt(outline.covariance.diagonal().mean()))
    unlike = _HIDDEN * max(0.0, error**2 - 3.0 * noise**2)  # a square, as if the lens were wrong
    return Detection(
        id=id,
        corners=locked(lens.bent(corners) if any(lens.distortion) else corners),
        noise=noise,
        T_cm=best,
        error=error,
        ratio=other_error / max(first_error, 1e-9),
        covariance=pose_covariance(best, flat, size, outline.covariance + unlike * np.eye(8)),
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
    """Numbers and outlines; the second look, closer, is for tags that the first did not see."""
    found: list[tuple[int, Outline]] = []
    rough: list[tuple[int, Outline]] = []
    for look in _LOOKS:
        for number, corners in _numbered(grey, *look, lens):
            if _new(corners, found):
                outline = fitted(grey, corners, number, lens)
                if outline is not None and look != _LOOKS[0]:  # from corners that are rougher
                    outline = fitted(grey, outline.corners, number, lens)
                if outline is not None:
                    found.append((number, outline))
                elif look == _LOOKS[0]:
                    rough.append((number, Outline(corners, _ROUGH**2 * np.eye(8))))
        if found and {number for number, _ in found} >= set(wanted):
            break
    return found + [one for one in rough if _new(one[1].corners, found)]


def _new(corners: Array, found: list[tuple[int, Outline]]) -> bool:
    """Whether no tag was found there yet."""
    middle, near = corners.mean(axis=0), 0.3 * np.ptp(corners, axis=0).max()
    return all(np.linalg.norm(o.corners.mean(axis=0) - middle) > near for _, o in found)


def _numbered(grey: Picture, zoom: int, ring: int, lens: Intrinsics) -> list[tuple[int, Array]]:
    """Numbers and straightened corners by OpenCV; with a ring, from the edge of the paper."""
    size = (zoom * grey.shape[1], zoom * grey.shape[0])
    large = grey if zoom == 1 else cv2.resize(grey, size, interpolation=cv2.INTER_CUBIC)
    found, numbers, _ = _detector(zoom, ring).detectMarkers(large)
    pairs = []
    for number, corners in zip([] if numbers is None else numbers.ravel(), found, strict=True):
        seen = (corners.reshape(4, 2).astype(float) + 0.5) / zoom - 0.5
        out = seen - seen.mean(axis=0)
        seen += _INSIDE / zoom * out / np.linalg.norm(out, axis=1, keepdims=True)
        paper, square = (tag_corners(CELLS + n)[None, :, :2] for n in (2 * ring, 0))
        H = cv2.getPerspectiveTransform(paper.astype(np.float32), seen.astype(np.float32))
        pairs.append((int(number), lens.straightened(cv2.perspectiveTransform(square, H)[0])))
    return pairs


@cache
def _detector(zoom: int, ring: int) -> Any:
    settings = cv2.aruco.DetectorParameters()
    settings.markerBorderBits += ring
    settings.maxErroneousBitsInBorderRate += ring  # the ring is white
    if zoom + ring > 1:  # what it reads wrong does not look like the tag, and `fitted` says so
        settings.perspectiveRemovePixelPerCell = 8
        settings.errorCorrectionRate = 1.0
    return cv2.aruco.ArucoDetector(PATTERNS, settings)
