r"""Motion: paths, time scalings and their composition, as functions that return samples.

A *path* is geometry, a curve in s from 0 to 1.  A *time scaling* is s(t).  A *trajectory* is
their composition, differentiated by the chain rule (Lynch & Park, *Modern Robotics*, section 9.1).
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np

from . import se3
from .errors import OutOfRange, TypeMismatch
from .shapes import Array, as_array, as_number, as_numbers, locked, shown


class Sample(NamedTuple):
    """The value and two derivatives of a curve of points, or of joint angles, at one place.

    Attributes:
        position: Value, shape (n,) in [m] or [rad].
        velocity: First derivative, shape (n,).
        acceleration: Second derivative, shape (n,).
    """

    position: Array
    velocity: Array
    acceleration: Array


class PoseSample(NamedTuple):
    """The value and two derivatives of a curve of tip poses at one place, in world axes.

    Attributes:
        pose: Pose of the tip in the world, `T_wt`, shape (4, 4).
        twist: Velocity of the tip's origin and angular velocity (v, w), world axes, shape (6,).
        dtwist: Derivative of the twist, shape (6,).
    """

    pose: Array
    twist: Array
    dtwist: Array


Sample.__array_ufunc__ = PoseSample.__array_ufunc__ = None  # type: ignore[attr-defined]
# NumPy would take these tuples for arrays.

AnySample = Sample | PoseSample

_S = TypeVar("_S", bound=AnySample)
Path = Callable[[float], _S]
"""A curve in s from 0 to 1, whose samples have derivatives with respect to s."""


class TimeScaling(Protocol):
    """A function s(t) that rises from 0 to 1 over `duration` seconds and is at rest outside."""

    @property
    def duration(self) -> float:
        """How long it lasts, in [s]."""

    def __call__(self, t: float) -> tuple[float, float, float]:
        """s, ds/dt and d2s/dt2 at time ``t`` [s]."""


Target = Callable[[float], AnySample]
"""Any function that `run` can follow, of the time since the run began, in [s]."""


@dataclass(frozen=True)
class Trajectory:
    """A path followed on a schedule; before its start and after its end it is at rest.

    Attributes:
        path: Curve in s.
        scaling: s(t).
    """

    path: Path[Any]
    scaling: TimeScaling

    def __post_init__(self) -> None:
        _check_path(self.path)
        if not callable(self.scaling) or not hasattr(self.scaling, "duration"):
            raise TypeMismatch(
                f"scaling is {shown(self.scaling)}; it must be a function of t with a duration"
            )

    @property
    def duration(self) -> float:
        """How long it lasts, in [s]."""
        return self.scaling.duration

    def __call__(self, t: float) -> Any:
        """The motion at time ``t`` [s], by the chain rule, as a sample of the path's type.

        Raises:
            TypeMismatch: The scaling or the path returned something unexpected.
        """
        at_t = self.scaling(t)
        try:
            s, ds, dds = at_t
        except (TypeError, ValueError):
            raise TypeMismatch(
                f"the scaling returned {shown(at_t)}, expected three numbers: s, ds/dt and d2s/dt2"
            ) from None
        at_s = self.path(s)
        if not isinstance(at_s, AnySample):
            raise TypeMismatch(
                f"the path returned {shown(at_s)}, expected lk.Sample(position, velocity, "
                "acceleration), with derivatives with respect to s, or an lk.PoseSample"
            )
        x, dx, ddx = at_s
        return type(at_s)(x, dx * ds, ddx * (ds * ds) + dx * dds)


def _check_path(path: Any) -> None:
    if not callable(path):
        raise TypeMismatch(f"path is {shown(path)}; a path is a function of s")
    if hasattr(path, "duration"):
        raise TypeMismatch(f"path is {shown(path)}, a function of t; a path is one of s")


LARGEST_JUMP = 1e-4
"""The largest jump of a number from one part of a `Chain` to the next, in [m] or [rad].

Places that are typed with four decimals pass, and a real arm misses its target by more.
"""


class Chain:
    """Trajectories one after another.

    Each must begin where the one before ends.  Where two meet, the later one counts.  The chain is
    also smooth in velocity if each begins and ends at rest; nothing checks this.

    Attributes:
        parts: The trajectories, in order; a chain among them is replaced by its own parts.
        starts: Starting time of each, in [s].
    """

    def __init__(self, parts: Iterable[Any]) -> None:
        """Join ``parts``, each with a `duration`, end to end.

        Raises:
            OutOfRange: There are no parts, or one does not begin where the one before ends.
            TypeMismatch: A part has no duration, or its samples are unlike those of the one before.
        """
        self.parts: tuple[Any, ...] = ()
        for part in parts:
            if not hasattr(part, "duration"):
                raise TypeMismatch(f"a part of the Chain is {shown(part)}, which has no duration")
            self.parts += part.parts if isinstance(part, Chain) else (part,)
        if not self.parts:
            raise OutOfRange("a Chain needs at least one trajectory")
        for number, (before, after) in enumerate(pairwise(self.parts), 1):
            _check_joint(number, before(before.duration), after(0.0))
        *self.starts, self.duration = accumulate((p.duration for p in self.parts), initial=0.0)

    def __call__(self, t: float) -> Any:
        """The motion at time ``t`` [s]."""
        i = max(0, bisect_right(self.starts, t) - 1)
        return self.parts[i](t - self.starts[i])


def _check_joint(number: int, end: Any, start: Any) -> None:
    """Refuse a part of a chain that does not begin where the part before, ``number``, ends."""
    one_kind = isinstance(end, AnySample) and type(start) is type(end)
    if not one_kind or np.shape(start[0]) != np.shape(end[0]):
        raise TypeMismatch(
            f"part {number + 1} of the Chain begins with {shown(start)}, and part {number} ends "
            f"with {shown(end)}; return lk.Sample of one size from both, or lk.PoseSample"
        )
    if not (jump := float(np.abs(start[0] - end[0]).max())) <= LARGEST_JUMP:
        raise OutOfRange(
            f"part {number + 1} of the Chain begins {jump:.3g} from where part {number} ends, and "
            f"at most {LARGEST_JUMP:g} is allowed; put a trajectory between the two"
        )


@dataclass(frozen=True, eq=False)
class PosePath:
    """A path of points with an orientation, either fixed or turning evenly from R_wt to R_goal.

    The rotation is the shortest one, at a constant rate in s (the geodesic of SO(3), Lynch & Park,
    section 9.2.1).

    Attributes:
        path: Path of the tip's origin, samples of shape (3,) in [m].
        R_wt: Orientation of the tip at s = 0, shape (3, 3).
        R_goal: Orientation at s = 1, shape (3, 3); None keeps `R_wt`.
    """

    path: Path[Sample]
    R_wt: Array
    R_goal: Array | None = None

    def __post_init__(self) -> None:
        _check_path(self.path)
        for name in ("R_wt", "R_goal"):
            R = getattr(self, name)
            if R is not None or name == "R_wt":
                object.__setattr__(self, name, locked(np.array(se3.as_rotation(R, name))))

    @cached_property
    def _turn(self) -> Array:
        """The whole rotation as a rotation vector, world axes, [rad]."""
        if self.R_goal is None:
            return locked(np.zeros(3))
        return locked(se3.orientation_error(self.R_goal, self.R_wt))

    def __call__(self, s: float) -> PoseSample:
        """Pose and its derivatives with respect to s."""
        p, dp, ddp = self.path(s)
        p = as_array(p, (3,), "position")
        T, twist, dtwist = np.eye(4), np.zeros(6), np.zeros(6)
        T[:3, :3] = self.R_wt if self.R_goal is None else se3.rotation(s * self._turn) @ self.R_wt
        T[:3, 3], twist[:3], twist[3:], dtwist[:3] = p, dp, self._turn, ddp
        return PoseSample(T, twist, dtwist)


class Hold:
    """A target that never moves.

    Attributes:
        duration: How long, in [s].
    """

    def __init__(self, place: Any, duration: float) -> None:
        """Hold a place.

        Args:
            place: Joint angles, shape (n,) in [rad], a point, shape (3,) in [m], or a pose, (4, 4).
            duration: How long, in [s].
        """
        self.duration = as_number(duration, "duration", least=0.0)
        x = locked(as_numbers(place, "place"))
        still = locked(np.zeros(6 if x.ndim == 2 else x.size))
        self._sample: AnySample
        if x.shape == (4, 4):
            self._sample = PoseSample(se3.as_pose(x, "place"), still, still)
        else:
            self._sample = Sample(as_array(x, (x.size,), "place"), still, still)

    def __call__(self, t: float) -> Any:
        """The same sample, whatever the time."""
        return self._sample
