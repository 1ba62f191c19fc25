"""Sensing: how good a camera's reading of a tag is, against the truth that a simulation knows.

Errors are target minus actual with the truth as the target: truth minus estimate, position in the
camera's axes, orientation as a rotation vector there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import pi
from typing import Any

import numpy as np

from labkit import Sample, se3
from labkit.errors import OutOfRange, ShapeError
from labkit.shapes import Array, as_number, as_numbers, locked
from labkit.tags.board import Board
from labkit.tags.camera import Camera, looking_at
from labkit.tags.detection import detect_tags
from labkit.tags.intrinsics import Intrinsics
from labkit.tags.tag import Tag
from labkit.world import World

_T_WC = looking_at((3.0, 3.0, 1.0), (4.0, 4.0, 1.0))  # away from the robot, and looking away
_EXPOSURE = 0.1  # [s], of a picture of a tag that moves
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
        blur: Of a lens out of focus, standard deviation in [px].
        smear: How far the tag's middle moves in the picture while the shutter is open, in [px].
        cover: How much of half of the tag's diagonal a hand hides, beginning at a corner.
    """

    tag: Tag = field(default_factory=Tag)
    distance: float = 0.7
    tilt: tuple[float, float] = (0.0, pi / 3)
    intrinsics: Intrinsics = field(default_factory=Intrinsics)
    noise: float = 0.0
    blur: float = 0.0
    smear: float = 0.0
    cover: float = 0.0


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
    sizes, random = {int(setup.tag.id): setup.tag.size}, np.random.default_rng(seed)
    with World() as world:
        camera = Camera(
            world,
            _T_WC,
            setup.intrinsics,
            noise=setup.noise,
            blur=setup.blur,
            exposure=_EXPOSURE if setup.smear else 0.0,
            seed=seed,
        )
        board = Board(world, setup.tag, _T_WC @ poses[0])
        for i, T_cm in enumerate(poses):
            board.place(_T_WC @ T_cm)
            if setup.smear:
                board.move(_sideways(setup, _T_WC @ T_cm, random))
            corners = setup.intrinsics.project(setup.tag.corners @ T_cm[:3, :3].T + T_cm[:3, 3])
            picture = _covered(camera.tag_image(), corners, setup.cover, random)
            found = detect_tags(picture, camera, sizes)
            if len(found) != 1:
                continue
            off[i] = corners - found[0].corners
            estimate[i], covariance[i] = found[0].T_cm, found[0].covariance
            ratio[i], pixels[i] = found[0].ratio, found[0].error
    columns = (poses, estimate, ratio, pixels, off, covariance)
    return Readings(*map(locked, columns))


def _sideways(setup: Setup, T_wm: Array, random: np.random.Generator) -> Callable[[float], Sample]:
    """A tag's motion across the picture, by the smear in the time of the exposure."""
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
    """Whether the errors are as large as the detector says: 3 if its covariance is right.

    Args:
        setup: The experiment.
        count: How many pictures.
        seed: Of poses and noise.

    Returns:
        The share of the pictures in which the tag was reported, and the mean of
        :math:`e^T P^{-1} e` over them, with e the error of the position and P its covariance
        (Bar-Shalom, Li & Kirubarajan, section 5.4.2); not a number if none was reported.
    """
    seen = read(setup, random_poses(setup, count, np.random.default_rng(seed)), seed)
    P, e = seen.covariance[seen.found][:, :3, :3], seen.error[:, :3]
    nees = np.einsum("ni,ni->n", e, np.linalg.solve(P, e[..., None])[..., 0])
    return float(seen.found.mean()), float(nees.mean()) if len(nees) else float("nan")


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
