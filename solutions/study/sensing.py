"""Sensing: how good a camera's reading of a tag is, against the truth that a simulation knows.

Errors are target minus actual with the truth as the target: truth minus estimate, position in the
camera's axes, orientation as a rotation vector there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from math import pi
from typing import Any

import numpy as np

from labkit import se3
from labkit.errors import OutOfRange, ShapeError, UnknownName
from labkit.shapes import Array, as_number, as_numbers, locked
from labkit.tags.board import Board
from labkit.tags.camera import Camera, looking_at
from labkit.tags.detection import detect_tags
from labkit.tags.intrinsics import Intrinsics
from labkit.tags.tag import Tag
from labkit.world import World

_T_WC = looking_at((3.0, 3.0, 1.0), (4.0, 4.0, 1.0))  # away from the robot, and looking away
_SPREAD = 0.5  # how far from the middle of the picture a tag may be, as a share of the picture


@dataclass(frozen=True)
class Setup:
    """One experiment: a tag before a camera.

    Attributes:
        tag: The tag.
        distance: From the camera to the tag, in [m].
        tilt: Range of the angle between the tag's normal and the ray on which it is seen, in [rad].
        intrinsics: Lens and sensor.
        noise: Of each colour of each pixel, standard deviation in grey levels.
    """

    tag: Tag = field(default_factory=Tag)
    distance: float = 0.7
    tilt: tuple[float, float] = (0.0, pi / 3)
    intrinsics: Intrinsics = field(default_factory=Intrinsics)
    noise: float = 0.0


@dataclass(frozen=True, eq=False)
class Readings:
    """Estimates beside the truth, one row for each picture; rows without a tag are NaN.

    Attributes:
        truth: `T_cm` as it was, shape (n, 4, 4).
        estimate: `T_cm` as it was read, shape (n, 4, 4).
        ratio: How many times worse the other of the two poses fits, shape (n,).
        pixels: What is left between corners and pose, root mean square, shape (n,) in [px].
        corner_error: True minus found corners, shape (n, 4, 2) in [px].
        covariance: What the detector itself expects, shape (n, 6, 6).
    """

    truth: Array
    estimate: Array
    ratio: Array
    pixels: Array
    corner_error: Array
    covariance: Array

    @property
    def found(self) -> Any:
        """In which pictures the tag was found, shape (n,), bool."""
        return np.isfinite(self.pixels)

    @property
    def tilt(self) -> Array:
        """Angle between the tag's normal and the ray on which it is seen, shape (n,) in [rad]."""
        normal, ray = self.truth[:, :3, 2], self.truth[:, :3, 3]
        along = np.einsum("ni,ni->n", normal, ray) / np.linalg.norm(ray, axis=1)
        return np.asarray(np.arccos(np.clip(-along, -1.0, 1.0)))

    @property
    def error(self) -> Array:
        """Truth minus estimate of the pictures with a tag, shape (found, 6): [m], then [rad]."""
        pairs = zip(self.truth[self.found], self.estimate[self.found], strict=True)
        return np.array([se3.pose_error(a, b) for a, b in pairs]).reshape(-1, 6)


@dataclass(frozen=True, eq=False)
class Quality:
    """A sensor in a few numbers.

    Attributes:
        found: Share of the pictures in which the tag was found.
        bias: Mean error, shape (6,): [m], then [rad], camera axes.
        covariance: Of the error about its mean, shape (6, 6).
        count: From how many readings.
    """

    found: float
    bias: Array
    covariance: Array
    count: int

    @property
    def spread(self) -> Array:
        """Standard deviation of each coordinate, shape (6,)."""
        return np.sqrt(np.diag(self.covariance))


def quality(readings: Readings) -> Quality:
    """Bias and spread, which averaging over many readings tells apart: it cures only the spread."""
    error = readings.error
    if len(error) < 2:
        nothing = np.full(6, np.nan)
        return Quality(float(readings.found.mean()), nothing, np.full((6, 6), np.nan), len(error))
    return Quality(
        found=float(readings.found.mean()),
        bias=locked(error.mean(axis=0)),
        covariance=locked(np.cov(error.T)),
        count=len(error),
    )


def random_poses(setup: Setup, count: int, random: np.random.Generator) -> Array:
    """Poses `T_cm` of a tag somewhere in the picture, turned any way within the range of tilt.

    Args:
        setup: Distance, tilt and the rest.
        count: How many.
        random: Where the chances come from.

    Returns:
        Shape (count, 4, 4).

    Raises:
        OutOfRange: There is no such distance, tilt or count.
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
        seed: Of the image noise.

    Returns:
        The readings.
    """
    poses = _as_poses(poses, "poses")
    n = len(poses)
    estimate, covariance = np.full((n, 4, 4), np.nan), np.full((n, 6, 6), np.nan)
    ratio, pixels, off = np.full(n, np.nan), np.full(n, np.nan), np.full((n, 4, 2), np.nan)
    sizes = {int(setup.tag.id): setup.tag.size}
    with World() as world:
        camera = Camera(world, _T_WC, setup.intrinsics, noise=setup.noise, seed=seed)
        board = Board(world, setup.tag, _T_WC @ poses[0])
        for i, T_cm in enumerate(poses):
            board.place(_T_WC @ T_cm)
            found = detect_tags(camera.tag_image(), camera, sizes, setup.tag.dictionary)
            if len(found) != 1:
                continue
            corners = setup.tag.corners @ T_cm[:3, :3].T + T_cm[:3, 3]
            off[i] = setup.intrinsics.project(corners) - found[0].corners
            estimate[i], covariance[i] = found[0].T_cm, found[0].covariance
            ratio[i], pixels[i] = found[0].ratio, found[0].error
    columns = (poses, estimate, ratio, pixels, off, covariance)
    return Readings(*map(locked, columns))


_TURNED: dict[str, Callable[[Setup, float], Setup]] = {
    "distance": lambda setup, x: replace(setup, distance=x),
    "tilt": lambda setup, x: replace(setup, tilt=(x, x)),
    "resolution": lambda setup, x: replace(setup, intrinsics=setup.intrinsics.resized(x)),
    "noise": lambda setup, x: replace(setup, noise=x),
    "size": lambda setup, x: replace(setup, tag=replace(setup.tag, size=x)),
}
DIALS = tuple(_TURNED)
"""What `sweep` can turn."""


def sweep(
    dial: str, values: Iterable[float], setup: Setup | None = None, count: int = 40, seed: int = 0
) -> Mapping[float, Quality]:
    """The sensor's quality as one thing changes and the rest stays.

    Args:
        dial: One of `DIALS`: distance [m]; tilt [rad]; resolution, as a factor on the pixels along
            each side; noise, in grey levels; size of the tag [m].
        values: Where to set it.
        setup: The rest.
        count: Pictures for each value.
        seed: Of poses and noise.

    Returns:
        A quality for each value, in order.

    Raises:
        UnknownName: No such dial.
    """
    if dial not in DIALS:
        raise UnknownName("dial", dial, DIALS)
    results = {}
    for value in values:
        turned = _TURNED[dial](setup or Setup(), float(value))
        poses = random_poses(turned, count, np.random.default_rng(seed))
        results[float(value)] = quality(read(turned, poses, seed))
    return results


def _as_poses(x: Any, name: str) -> Array:
    """Read ``x`` as poses, one or more.

    Args:
        x: Shape (n, 4, 4).
        name: What to call them in the sentence, if they do not fit.

    Returns:
        Shape (n, 4, 4); a copy.

    Raises:
        ShapeError: They are not a stack of poses, or there are none.
        OutOfRange: One is not a rigid motion.
    """
    poses = as_numbers(x, name)
    if poses.ndim != 3 or not len(poses):
        raise ShapeError(name, (1, 4, 4), poses.shape)
    for i, T in enumerate(poses):
        se3.as_pose(T, f"{name}[{i}]")
    return poses
