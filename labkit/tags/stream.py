"""Streams of tag readings beside the control loop, with adjustable rate, delay and losses.

Nothing runs in parallel.  The simulation's clock determines when a picture is taken and when its
reading arrives, and all randomness comes from a seed, so a run can be repeated to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from .. import se3
from ..errors import OutOfRange
from ..shapes import Array, as_number, as_random, locked
from ..trajectory import AnySample
from .camera import Camera
from .detection import TagNotFound, detect_tags, find_tag
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
        jitter: float = 0.0,
        dropout: float = 0.0,
        blind: Iterable[tuple[float, float]] = (),
        seed: int = 0,
        T_wc: Any = None,
    ) -> None:
        """Prepare look-ups; the first `poll` takes the first picture.

        Args:
            camera: The camera.
            tag: The tag, with its size.
            rate: Pictures per second, in [Hz].
            delay: Delay from picture to reading, in [s].
            jitter: Largest additional random delay, in [s].
            dropout: Share of the readings that never arrive, from 0 to 1.
            blind: Intervals (from, to) in which no picture shows the tag, in [s] since the first.
            seed: Seed of jitter and dropout.
            T_wc: Pose at which the robot believes the camera to be, shape (4, 4); None means
                `Camera.reported_T_wc`.
        """
        self.camera, self.tag, self.unseen = camera, tag, 0
        self._period = 1.0 / as_number(rate, "rate", above=0.0)
        self._delay = as_number(delay, "delay", least=0.0)
        self._jitter = as_number(jitter, "jitter", least=0.0)
        self._dropout = as_number(dropout, "dropout", least=0.0)
        if self._dropout > 1.0:
            raise OutOfRange(f"dropout is {dropout:g}; it is a share, from 0 to 1")
        self._blind = tuple((float(a), float(b)) for a, b in blind)
        self._random = as_random(seed)
        self._believed = None if T_wc is None else locked(np.array(se3.as_pose(T_wc, "T_wc")))
        self._due: float | None = None
        self._under_way: list[tuple[float, Reading | None]] = []

    @property
    def busy(self) -> bool:
        """Whether the reading of a picture taken earlier has not arrived yet."""
        return bool(self._under_way)

    def poll(self) -> tuple[Reading, ...]:
        """Take a picture if one is due; the readings that arrived since the last call, by stamp.

        Raises:
            DuplicateTag: The tag is in the picture twice.
        """
        now = self.camera.world.t
        if self._due is None:
            self._due = self._first = now
        if now >= self._due - 1e-9:
            while self._due <= now + 1e-9:
                self._due += self._period
            arrives = now + self._delay + self._jitter * float(self._random.random())
            lost = float(self._random.random()) < self._dropout
            self._under_way.append((arrives, self._look(now, arrives, lost)))
        here = [reading for arrives, reading in self._under_way if arrives <= now + 1e-9]
        self._under_way = [item for item in self._under_way if item[0] > now + 1e-9]
        return tuple(sorted((r for r in here if r is not None), key=lambda r: r.stamp))

    def _look(self, now: float, arrives: float, lost: bool) -> Reading | None:
        if lost:
            return None
        try:
            if not any(a <= now - self._first < b for a, b in self._blind):
                return detect_once(self.camera, self.tag, self._believed, arrives - now)
        except TagNotFound:
            pass
        self.unseen += 1
        return None


def detect_once(camera: Camera, tag: Tag, T_wc: Any = None, age: float = 0.0) -> Reading:
    """Look up a tag once.

    Args:
        camera: The camera.
        tag: The tag, with its size.
        T_wc: Believed pose of the camera, shape (4, 4); None means `Camera.reported_T_wc`.
        age: Age of the reading at the time of its use, in [s].

    Raises:
        TagNotFound: The tag is not in the picture.
        DuplicateTag: The tag is in the picture more than once.
    """
    now = camera.world.t
    T_wc = camera.reported_T_wc if T_wc is None else se3.as_pose(T_wc, "T_wc")
    seen = detect_tags(camera.tag_image(), camera, {int(tag.id): tag.size})
    found = find_tag(seen, tag.id)
    turn = np.kron(np.eye(2), T_wc[:3, :3])
    return Reading(
        stamp=now,
        arrived=now + age,
        T_wm=locked(T_wc @ found.T_cm),
        covariance=locked(turn @ found.covariance @ turn.T),
    )


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
