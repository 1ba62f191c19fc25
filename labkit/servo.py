"""A hand that follows a tag by the camera it carries: the loop of Algorithm 1 around one function.

The function, a *servo*, turns sightings of the tag into a reference for the tip.  Sightings are
drawn, not rendered: the tag's true pose with noise, which arrives late.  The hand is a point that
follows the reference by a velocity law, so no arm moves and a run of 12 s takes milliseconds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from . import se3
from .paths import BangBang, Line
from .shapes import Array
from .trajectory import Sample, Trajectory

TICK = 0.05
"""Time between two calls of a servo, in [s]."""
GAIN = 4.0
"""How fast the hand closes its error to the reference, in [1/s]."""
SETTLE = 3.0
"""Time after which a run is judged, in [s]."""
FORGOTTEN = 4.0
"""How far back the hand's poses are known, in [s]."""


class Bend(NamedTuple):
    """A motion from one sample to another by a polynomial of fifth order.

    Attributes:
        start: Where it begins, with what velocity and acceleration, shape (n,) each.
        goal: The same at its end, from where it goes on with the goal's velocity.
        duration: How long it lasts, in [s].
    """

    start: Sample
    goal: Sample
    duration: float

    def __call__(self, t: float) -> Sample:
        """The sample at ``t`` seconds after its beginning."""
        if t >= self.duration:
            p, v, a = self.goal
            return Sample(p + (t - self.duration) * v, v, 0.0 * a)
        T, (p, v, a), (p1, v1, a1) = self.duration, self.start, self.goal
        d, w, b = p1 - p - v * T - a * T * T / 2, (v1 - v - a * T) * T, (a1 - a) * T * T
        c3, c4, c5 = 10 * d - 4 * w + b / 2, 7 * w - 15 * d - b, 6 * d - 3 * w + b / 2
        x = t / T
        return Sample(
            p + v * t + a * t * t / 2 + x**3 * (c3 + x * (c4 + x * c5)),
            v + a * t + x**2 * (3 * c3 + x * (4 * c4 + x * 5 * c5)) / T,
            a + x * (6 * c3 + x * (12 * c4 + x * 20 * c5)) / T**2,
        )


Motion = Trajectory | Bend


class Memory(NamedTuple):
    """What a servo remembers from one call to the next.

    Attributes:
        goal: Pose of the tip to which `line` leads, shape (4, 4).
        line: The reference, a function of the seconds since `began`.
        began: When the line began, in [s].
        looked: When the servo last looked, in [s].
    """

    goal: Array
    line: Any
    began: float
    looked: float


@dataclass(frozen=True, eq=False)
class Hand:
    """The tip's pose at the times of the last few seconds.

    Attributes:
        t: Times, shape (n,) in [s].
        p: The tip's places, shape (n, 3) in [m].
        R_wt: Its orientation, shape (3, 3).
    """

    t: Array
    p: Array
    R_wt: Array

    def __call__(self, s: float) -> Array:
        """`T_wt` at time ``s`` [s], shape (4, 4)."""
        T_wt = np.eye(4)
        T_wt[:3, :3] = self.R_wt
        T_wt[:3, 3] = [np.interp(s, self.t, x) for x in np.transpose(self.p)]
        return T_wt


class Followed(NamedTuple):
    """A run of a servo, one row for each tick.

    Attributes:
        t: Times, shape (n,) in [s].
        goal: Where the tip should be, shape (n, 3) in [m].
        reference: Where the servo's line is, shape (n, 3) in [m].
        velocity: Its velocity, shape (n, 3) in [m/s].
        tip: Where the tip is, shape (n, 3) in [m].
        began: When the line at that time began, shape (n,) in [s].
    """

    t: Array
    goal: Array
    reference: Array
    velocity: Array
    tip: Array
    began: Array

    def measured(self) -> dict[str, float]:
        """What a run is judged by; in the first `SETTLE` seconds only new lines count."""
        late = self.t > SETTLE
        miss = 1e3 * np.linalg.norm(self.tip - self.goal, axis=1)
        jumps = np.linalg.norm(np.diff(self.reference[late], axis=0), axis=1)
        kinks = np.linalg.norm(np.diff(self.velocity[late], axis=0), axis=1)
        return {
            "rms_mm": float(np.sqrt(np.mean(miss[late] ** 2))),
            "end_mm": float(np.mean(miss[self.t > self.t[-1] - 1.0])),
            "place_step_mm": 1e3 * float(jumps.max()),
            "speed_step": float(kinks.max()),
            "end_speed": float(np.linalg.norm(self.velocity[-1])),
            "lines": float(np.count_nonzero(np.diff(self.began))),
        }


@dataclass(frozen=True)
class Conveyor:
    """A tag in motion, and how the camera in the hand sees it.

    Attributes:
        speed: The tag's speed along x, in [m/s].
        jump: How far it jumps along y after 6 s, in [m].
        age: How old a sighting is when it arrives, in [s].
        blind: Pictures taken between these times do not show the tag, in [s].
        noise: Standard deviation of a sighting's place, in [m].
        seed: Seed of the noise.
        period: Time between two pictures, in [s].
        duration: Duration of a run, in [s].
    """

    speed: float = 0.03
    jump: float = 0.0
    age: float = 0.1
    blind: tuple[float, float] = (0.0, 0.0)
    noise: float = 1e-3
    seed: int = 0
    period: float = 0.1
    duration: float = 12.0

    def tag(self, t: float) -> Array:
        """The tag's pose at time ``t`` [s], `T_wm`, shape (4, 4)."""
        place = [0.5 + self.speed * t, 0.3 + self.jump * (t > 6.0), 0.1]
        return se3.pose(se3.rotation([0.0, 0.0, 0.3]), place)

    def follow(
        self, servo: Callable[..., Memory], T_tc: Any, T_mg: Any, last: int = 0, **options: Any
    ) -> Followed:
        """Follow the tag with a servo.

        Args:
            servo: ``servo(t, memory, sightings, hand, T_tc, T_mg, **options)``.
            T_tc: Pose of the camera in the tip's frame, shape (4, 4).
            T_mg: The tip's goal in the tag's frame, shape (4, 4).
            last: How many of the latest sightings, each (stamp, T_cm), it is given, oldest first;
                0 gives it the latest picture's sighting alone, or None.
            **options: Other arguments of the servo.
        """
        random = np.random.default_rng(self.seed)
        T_tc, T_mg = np.asarray(T_tc), np.asarray(T_mg)
        goal = self.tag(0.0) @ T_mg
        tip, R = goal[:3, 3], goal[:3, :3]
        memory = Memory(
            se3.pose(R, tip), Trajectory(Line(tip, tip), BangBang(1.0)), 0.0, -FORGOTTEN
        )
        pictures: list[tuple[float, tuple[float, Array] | None]] = []
        known, rows = [(-FORGOTTEN, tip)], []
        every = round(self.period / TICK)
        for k in range(round(self.duration / TICK) + 1):
            t = k * TICK
            when, where = zip(*known, (t, tip), strict=True)
            hand = Hand(np.array(when), np.array(where), R)
            if k % every == 0:
                known = [*known, (t, tip)][-round(FORGOTTEN / self.period) :]
                T_cm = se3.inverse(hand(t) @ T_tc) @ self.tag(t)
                T_cm[:3, 3] += random.normal(0.0, self.noise, 3)
                unseen = self.blind[0] <= t < self.blind[1]
                pictures.append((t, None if unseen else (t, T_cm)))
            here = [x for stamp, x in pictures if stamp + self.age <= t + 1e-9]
            latest = here[-1] if here else None
            seen = tuple(x for x in here if x is not None)[-last:] if last else latest
            memory = Memory(*servo(t, memory, seen, hand, T_tc, T_mg, **options))
            p, v, _ = memory.line(t - memory.began)
            rows.append((t, (self.tag(t) @ T_mg)[:3, 3], p, v, tip, memory.began))
            tip = tip + TICK * (v + GAIN * (p - tip))
        return Followed(*(np.array(column) for column in zip(*rows, strict=True)))
