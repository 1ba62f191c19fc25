"""Measure how well a camera reads a tag, compared with the truth, which a simulation knows.

Errors are target minus actual with the truth as the target, that is, truth minus estimate.  The
position and the rotation vector of the orientation are in the camera's axes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from math import pi
from typing import Any

import numpy as np

from labkit import Sample, se3
from labkit.errors import OutOfRange, ShapeError
from labkit.shapes import Array, as_number, as_numbers, locked
from labkit.tags.camera import Camera, looking_at
from labkit.tags.detection import detect_tags
from labkit.tags.drawing import Intrinsics
from labkit.tags.tag import Board, Tag
from labkit.world import World

_T_WC = looking_at((3.0, 3.0, 1.0), (4.0, 4.0, 1.0))  # far from the robot, looking away from it
_EXPOSURE = 0.1  # exposure time of a moving tag, in [s]
_SPREAD = 0.5  # largest distance of a tag from the middle, as a share of the picture


@dataclass(frozen=True)
class Setup:
    """One experiment with a tag in front of a camera.

    Attributes:
        tag: The tag.
        distance: The distance from the camera to the tag, in [m].
        tilt: The range of the angle between the tag's normal and the line of sight, in [rad].
        intrinsics: The lens and the sensor.
        smear: How far the middle of the tag moves in the picture during the exposure, in [px].
        optics: The camera's dials, such as ``{"noise": 2.0, "blur": 1.0}``.
        cover: The share of half of the tag's diagonal that a hand hides, from one corner.
    """

    tag: Tag = field(default_factory=Tag)
    distance: float = 0.7
    tilt: tuple[float, float] = (0.0, pi / 3)
    intrinsics: Intrinsics = field(default_factory=Intrinsics)
    smear: float = 0.0
    optics: dict[str, Any] = field(default_factory=dict)
    cover: float = 0.0


@dataclass(frozen=True, eq=False)
class Readings:
    """Estimates and the truth, one row for each picture; rows without a tag are NaN.

    Attributes:
        truth: The true `T_cm`, shape (n, 4, 4).
        estimate: The estimated `T_cm`, shape (n, 4, 4).
        pixels: The RMS residual of the corners after the fit of the pose, shape (n,) in [px].
        corner_error: True minus found corners, shape (n, 4, 2) in [px].
        covariance: The covariance that the detector expects, shape (n, 6, 6).
    """

    truth: Array
    estimate: Array
    pixels: Array
    corner_error: Array
    covariance: Array

    @property
    def found(self) -> Any:
        """Whether the tag was found in each picture, shape (n,), bool."""
        return np.isfinite(self.pixels)

    @property
    def tilt(self) -> Array:
        """The angle between the tag's normal and the line of sight, shape (n,) in [rad]."""
        normal, ray = self.truth[:, :3, 2], self.truth[:, :3, 3]
        along = np.einsum("ni,ni->n", normal, ray) / np.linalg.norm(ray, axis=1)
        return np.asarray(np.arccos(np.clip(-along, -1.0, 1.0)))

    @property
    def error(self) -> Array:
        """Truth minus estimate in the pictures with a tag, shape (found, 6) in [m] and [rad]."""
        pairs = zip(self.truth[self.found], self.estimate[self.found], strict=True)
        return np.array([se3.pose_error(a, b) for a, b in pairs]).reshape(-1, 6)


def random_poses(setup: Setup, count: int, random: np.random.Generator) -> Array:
    """Random poses `T_cm` of a tag in the picture, with any yaw and the given range of tilt.

    Args:
        setup: The experiment, with distance and tilt.
        count: The number of poses.
        random: The random generator.

    Returns:
        Shape (count, 4, 4).

    Raises:
        OutOfRange: Distance, tilt or count is out of range.
    """
    lens, (low, high) = setup.intrinsics, setup.tilt
    if not 0.0 <= low <= high < pi / 2:
        raise OutOfRange(f"tilt is {setup.tilt} rad; give a range between 0 and pi/2")
    distance = as_number(setup.distance, "distance", above=0.0)
    poses = []
    for _ in range(int(as_number(count, "count", least=1))):
        u, v = random.uniform(-_SPREAD / 2, _SPREAD / 2, 2) * (lens.width, lens.height)
        middle = ((lens.width - 1) / 2 + u - lens.cx, (lens.height - 1) / 2 + v - lens.cy)
        ray = np.array([middle[0] / lens.fx, middle[1] / lens.fy, 1.0])
        facing = looking_at(np.zeros(3), ray, up=(0.0, -1.0, 0.0))[:3, :3] @ np.diag([1, -1, -1.0])
        tilt, about, roll = random.uniform((low, 0, 0), (high, 2 * pi, 2 * pi))
        lean = se3.rotation(tilt * np.array([np.cos(about), np.sin(about), 0.0]))
        turn = se3.rotation(np.array([0.0, 0.0, roll]))
        poses.append(se3.pose(facing @ lean @ turn, distance * ray / np.linalg.norm(ray)))
    return np.array(poses)


def read(setup: Setup, poses: Any, seed: int = 0) -> Readings:
    """Show the tag to the camera at each pose, and detect it.

    Args:
        setup: The experiment; its distance and tilt are those of the poses.
        poses: `T_cm`, shape (n, 4, 4).
        seed: The seed of the image noise.

    Returns:
        The readings.
    """
    poses = _as_poses(poses, "poses")
    n = len(poses)
    estimate, covariance = np.full((n, 4, 4), np.nan), np.full((n, 6, 6), np.nan)
    pixels, off = np.full(n, np.nan), np.full((n, 4, 2), np.nan)
    sizes = {int(setup.tag.id): setup.tag.size}
    for i, picture in enumerate(pictures(setup, poses, seed)):
        found = detect_tags(picture, setup.intrinsics, sizes)
        if len(found) != 1:
            continue
        off[i] = setup.intrinsics.project(_corners(setup, poses[i])) - found[0].corners
        estimate[i], covariance[i] = found[0].T_cm, found[0].covariance
        pixels[i] = found[0].error
    columns = (poses, estimate, pixels, off, covariance)
    return Readings(*map(locked, columns))


def pictures(setup: Setup, poses: Any, seed: int = 0) -> Iterator[Any]:
    """The camera's picture of the tag at each pose, shape (height, width, 3) in RGB order."""
    random = np.random.default_rng(seed)
    with World() as world:
        camera = Camera(
            world,
            _T_WC,
            setup.intrinsics,
            exposure=_EXPOSURE if setup.smear else 0.0,
            seed=seed,
            **setup.optics,
        )
        board = Board(world, setup.tag, _T_WC @ poses[0])
        for T_cm in poses:
            board.place(_T_WC @ T_cm)
            if setup.smear:
                board.move(_sideways(setup, _T_WC @ T_cm, random))
            corners = setup.intrinsics.project(_corners(setup, T_cm))
            yield _covered(camera.tag_image(), corners, setup.cover, random)


def _corners(setup: Setup, T_cm: Array) -> Array:
    return setup.tag.corners @ T_cm[:3, :3].T + T_cm[:3, 3]


def _sideways(setup: Setup, T_wm: Array, random: np.random.Generator) -> Callable[[float], Sample]:
    """The motion of a tag across the picture, by the smear during the exposure."""
    angle = random.uniform(0.0, 2.0 * pi)
    across = _T_WC[:3, :2] @ (np.cos(angle), np.sin(angle))
    speed = setup.smear * setup.distance / setup.intrinsics.fx / _EXPOSURE
    v, at = speed * across, T_wm[:3, 3]
    return lambda t: Sample(at + t * v, v, 0.0 * v)


def _covered(picture: Any, corners: Array, cover: float, random: np.random.Generator) -> Any:
    """The picture with a grey edge over one corner of the tag."""
    if not cover:
        return picture
    middle = corners.mean(axis=0)
    out = corners[random.integers(4)] - middle
    half = np.linalg.norm(out)
    v, u = np.indices(picture.shape[:2])
    hidden = ((u - middle[0]) * out[0] + (v - middle[1]) * out[1]) / half > (1.0 - cover) * half
    return np.where(hidden[..., None], np.uint8(90), picture)


def consistency(setup: Setup, count: int, seed: int = 0) -> tuple[float, float]:
    """Check whether errors are as large as the detector expects; if they are, the mean is 3.

    Args:
        setup: The experiment.
        count: The number of pictures.
        seed: The seed of the poses and the noise.

    Returns:
        The share of the pictures in which the tag was reported, and the mean of
        :math:`e^T P^{-1} e` over them, with e the error of the position and P its covariance
        (Bar-Shalom, Li & Kirubarajan, section 5.4.2); NaN if no tag was reported.
    """
    seen = read(setup, random_poses(setup, count, np.random.default_rng(seed)), seed)
    P, e = seen.covariance[seen.found][:, :3, :3], seen.error[:, :3]
    nees = np.einsum("ni,ni->n", e, np.linalg.solve(P, e[..., None])[..., 0])
    return float(seen.found.mean()), float(nees.mean()) if len(nees) else float("nan")


def _as_poses(x: Any, name: str) -> Array:
    """Read ``x`` as poses, one or more.

    Args:
        x: Shape (n, 4, 4).
        name: What an error message calls them.

    Returns:
        Shape (n, 4, 4); a copy.

    Raises:
        ShapeError: The array is not a stack of poses, or is empty.
        OutOfRange: One of them is not a rigid motion.
    """
    poses = as_numbers(x, name)
    if poses.ndim != 3 or not len(poses):
        raise ShapeError(name, (1, 4, 4), poses.shape)
    for i, T in enumerate(poses):
        se3.as_pose(T, f"{name}[{i}]")
    return poses
