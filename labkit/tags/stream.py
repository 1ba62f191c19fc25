r"""Streams of tag readings beside the control loop, with adjustable rate, delay and losses.

Nothing runs in parallel.  The simulation's clock determines when a picture is taken and when its
reading arrives, and all randomness comes from a seed, so a run can be repeated to the last bit.

Several noisy readings become a better one by the update of a Kalman filter (Thrun, Burgard & Fox,
*Probabilistic Robotics*, section 3.2).  The prediction is what students write in notebook 06.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..errors import LabkitError, OutOfRange
from ..shapes import Array, as_array, as_number, as_random, locked
from ..trajectory import AnySample
from .camera import Camera
from .detection import detect_tags
from .tag import Tag


class Reading(NamedTuple):
    """The result of one look-up of a tag.

    Attributes:
        stamp: Time at which the picture was taken, in [s].
        arrived: Time at which the reading could first be used, in [s].
        T_wm: Pose of the tag according to this picture, shape (4, 4).
        covariance: Covariance of its position [m] and orientation [rad], world axes, shape (6, 6).
    """

    stamp: float
    arrived: float
    T_wm: Array
    covariance: Array


class TagStream:
    """Regular look-ups of one tag by one camera.

    Attributes:
        camera: The camera.
        tag: The tag.
        unseen: How many pictures so far arrived without the tag.
    """

    def __init__(
        self,
        camera: Camera,
        tag: Tag,
        rate: float = 10.0,
        delay: float = 0.1,
        *,
        dropout: float = 0.0,
        seed: int = 0,
    ) -> None:
        """Prepare look-ups; the first `poll` takes the first picture.

        Args:
            camera: The camera.
            tag: The tag, with its size.
            rate: Pictures per second, in [Hz].
            delay: Delay from picture to reading, in [s].
            dropout: Share of the readings that never arrive, from 0 to 1.
            seed: Seed of the dropout.
        """
        self.camera, self.tag, self.unseen = camera, tag, 0
        self._period = 1.0 / as_number(rate, "rate", above=0.0)
        self._delay = as_number(delay, "delay", least=0.0)
        self._dropout = as_number(dropout, "dropout", least=0.0)
        if self._dropout > 1.0:
            raise OutOfRange(f"dropout is {dropout:g}; it is a share, from 0 to 1")
        self._random = as_random(seed)
        self._due: float | None = None
        self._under_way: list[tuple[float, Reading | None]] = []

    def poll(self) -> tuple[Reading, ...]:
        """Take a picture if one is due; the readings that arrived since the last call, by stamp.

        Raises:
            LabkitError: The tag is in the picture twice.
        """
        now = self.camera.world.t
        self._due = now if self._due is None else self._due
        if now >= self._due - 1e-9:
            while self._due <= now + 1e-9:
                self._due += self._period
            lost = float(self._random.random()) < self._dropout
            self._under_way.append((now + self._delay, None if lost else self._look(now)))
        here = [reading for arrives, reading in self._under_way if arrives <= now + 1e-9]
        self._under_way = [item for item in self._under_way if item[0] > now + 1e-9]
        return tuple(reading for reading in here if reading is not None)

    def _look(self, now: float) -> Reading | None:
        camera, tag = self.camera, self.tag
        seen = detect_tags(camera.tag_image(), camera, {int(tag.id): tag.size})
        if not seen:
            self.unseen += 1
            return None
        if len(seen) > 1:
            raise LabkitError(
                f"tag {tag.id} is in the picture {len(seen)} times; number them apart"
            )
        (found,), T_wc = seen, camera.T_wc
        turn = np.kron(np.eye(2), T_wc[:3, :3])
        C = locked(turn @ found.covariance @ turn.T)
        return Reading(now, now + self._delay, locked(T_wc @ found.T_cm), C)


class TagTarget:
    """A target for `run` that a follower computes from the readings that have arrived.

    Attributes:
        lookups: The stream of readings.
        follower: A function of the time since the run began and of the readings that arrived since
            the last call, with their times also counted from the start of the run; it returns a
            `Sample` or a `PoseSample`.  It has no access to the world, the camera or the arm.
    """

    def __init__(
        self, lookups: TagStream, follower: Callable[[float, tuple[Reading, ...]], AnySample]
    ) -> None:
        """Join look-ups to a follower."""
        self.lookups, self.follower = lookups, follower
        self.__name__ = getattr(follower, "__name__", type(follower).__name__)

    def __call__(self, t: float) -> AnySample:
        """The follower's sample at time ``t`` [s]."""
        began = self.lookups.camera.world.t - t
        readings = tuple(
            r._replace(stamp=r.stamp - began, arrived=r.arrived - began)
            for r in self.lookups.poll()
        )
        return self.follower(t, readings)


class Estimate(NamedTuple):
    """An estimate of a position and its motion.

    Attributes:
        t: Time of the estimate, in [s].
        mean: Position [m] and velocity [m/s], and acceleration [m/s^2] if it is estimated too,
            shape (6,) or (9,).
        covariance: Covariance of the mean, shape (6, 6) or (9, 9).
    """

    t: float
    mean: Array
    covariance: Array


def first_estimate(t: float, position: Any, noise: Any, *spread: float) -> Estimate:
    """The estimate from a single reading of a position, with an unknown velocity.

    Args:
        t: When the picture was taken, in [s].
        position: The reading, shape (3,) in [m].
        noise: Covariance of the reading, shape (3, 3) in [m^2].
        *spread: Expected standard deviation of the velocity's coordinates, in [m/s], and of the
            acceleration's, in [m/s^2], if it is to be estimated too.
    """
    variances = [as_number(s, "spread", above=0.0) ** 2 for s in spread]
    covariance: Array = np.kron(np.diag([0.0, *variances]), np.eye(3)).astype(float)
    covariance[:3, :3] = as_array(noise, (3, 3), "noise")
    mean = np.concatenate([as_array(position, (3,), "position"), np.zeros(3 * len(spread))])
    return Estimate(t, locked(mean), locked(covariance))


def update(estimate: Estimate, position: Any, noise: Any) -> Estimate:
    r"""Update an estimate with a reading of the position at the same time.

    .. math::

        K &= P H^T (H P H^T + R)^{-1} \\
        m' &= m + K (z - H m) \\
        P' &= (I - KH) P (I - KH)^T + K R K^T

    Args:
        estimate: The estimate so far, predicted to the time of the picture.
        position: The reading z, shape (3,) in [m].
        noise: Covariance R of the reading, shape (3, 3) in [m^2].

    Returns:
        The improved estimate, for the same time.
    """
    z, R = as_array(position, (3,), "position"), as_array(noise, (3, 3), "noise")
    mean, P = estimate.mean, estimate.covariance
    K = np.linalg.solve(P[:3, :3] + R, P[:3, :]).T  # (n, 3); H selects the position
    keep = np.eye(len(mean))
    keep[:, :3] -= K
    covariance = keep @ P @ keep.T + K @ R @ K.T
    return Estimate(
        estimate.t, locked(mean + K @ (z - mean[:3])), locked(0.5 * (covariance + covariance.T))
    )
