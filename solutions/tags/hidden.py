"""Hidden cases of notebook 06."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np

from labkit import BangBang, Line, Sample, Trajectory, se3
from labkit.course import Call, Chase
from labkit.course.authoring.problem import call
from labkit.servo import Bend, Conveyor, Hand, Memory
from labkit.shapes import Array
from labkit.tags.tag import tag_corners

Random = np.random.Generator
K = np.array([[515.0, 0.0, 319.5], [0.0, 515.0, 239.5], [0.0, 0.0, 1.0]])


def seen(distance: float, tilt: float, azimuth: float, spin: float, x: float = 0.0) -> Array:
    """The pose `T_cm` of a tag in front of the camera, which it faces except for a tilt."""
    facing = np.diag([1.0, -1.0, -1.0])  # the tag's z looks back at the camera
    axis = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    R = se3.rotation(tilt * axis) @ facing @ se3.rotation(np.array([0.0, 0.0, spin]))
    return se3.pose(R, np.array([x, 0.1 * x, distance]))


def pixels_of(T_cm: Array, size: float) -> Array:
    """The pixels of its corners, shape (4, 2) in [px]."""
    points = tag_corners(size) @ T_cm[:3, :3].T + T_cm[:3, 3]
    image = points @ K.T
    return np.asarray(image[:, :2] / image[:, 2:])


def candidates(random: Random, T_cm: Array, size: float) -> tuple[Any, ...]:
    """The arguments of tag_pose for a tag seen with a little noise, its candidates in no order."""
    pixels = pixels_of(T_cm, size) + random.normal(0.0, 0.2, (4, 2))
    _, turns, places, _ = cv2.solvePnPGeneric(
        tag_corners(size), pixels, K, None, flags=cv2.SOLVEPNP_IPPE_SQUARE
    )
    both = [se3.pose(cv2.Rodrigues(r)[0], np.ravel(p)) for r, p in zip(turns, places, strict=True)]
    return np.array(both)[random.permutation(2)], pixels, K, size


def tilted(random: Random) -> Iterator[Call]:
    """Tags near and far, in both orders of the candidates."""
    for tilt in random.uniform(0.5, 1.0, 6):
        azimuth, spin = random.uniform(-3.0, 3.0, 2)
        T = seen(random.uniform(0.4, 1.0), tilt, azimuth, spin, x=0.1)
        yield call(*candidates(random, T, random.uniform(0.08, 0.2)))


def scattered(
    random: Random, count: int, bias: Any, spread: float, T: Array | None = None
) -> tuple[Array, Array]:
    """Estimates with an offset and a spread, and the truth."""
    truth = seen(0.7, 0.3, 0.5, 0.2) if T is None else T
    estimates = []
    for noise in random.normal(0.0, spread, (count, 6)):
        e = np.asarray(bias) + noise
        R = se3.rotation(-e[3:]) @ truth[:3, :3]
        estimates.append(se3.pose(R, truth[:3, 3] - e[:3]))
    return np.array(estimates), truth


def offsets(random: Random) -> Iterator[Call]:
    """Offsets with little noise."""
    yield call(*scattered(random, 8, random.uniform(-0.01, 0.01, 6), 1e-4))


def noises(random: Random) -> Iterator[Call]:
    """Noise with little offset, and both."""
    yield call(*scattered(random, 9, np.zeros(6), 0.003))
    yield call(*scattered(random, 12, random.uniform(-0.02, 0.02, 6), 0.004))


def _sample(random: Random, speed: float, push: float, n: int = 3) -> Sample:
    return Sample(
        random.uniform(-0.5, 0.5, n),
        random.uniform(-speed, speed, n),
        random.uniform(-push, push, n),
    )


def blends_from_rest(random: Random) -> Iterator[Call]:
    """Blends from rest to rest in one second."""
    a, b = _sample(random, 0.0, 0.0), _sample(random, 0.0, 0.0)
    for t in random.uniform(0.1, 0.9, 3):
        yield call(float(t), a, b, 1.0)


def _both_in_motion(random: Random) -> Iterator[tuple[Sample, Sample, float]]:
    """Start, goal and duration for a point, seven joints and a number; goals steady or turning."""
    for T in random.uniform(0.3, 3.0, 3):
        a, b = _sample(random, 0.3, 0.5), _sample(random, 0.3, 0.0)
        yield a, b, float(T)
        yield a, b._replace(acceleration=random.uniform(-0.5, 0.5, 3)), float(T)
    for n in (7, 1):
        yield _sample(random, 0.3, 0.5, n), _sample(random, 0.3, 0.5, n), 1.0


def blends_in_motion(random: Random) -> Iterator[Call]:
    """Blends of other durations with motion at both ends."""
    for a, b, T in _both_in_motion(random):
        for x in random.uniform(0.1, 0.9, 2):  # not 1, as at the end itself both are right
            yield call(float(x * T), a, b, T)
        if not b.acceleration.any():
            yield from (call(x * T, a, b, T) for x in (0.0, 1.0))


def blends_after_the_end(random: Random) -> Iterator[Call]:
    """The same blends after their end."""
    for a, b, T in _both_in_motion(random):
        yield call(1.5 * T, a, b, T)


def believed(random: Random) -> tuple[Array, Array]:
    """A mean and a covariance."""
    A = random.normal(0.0, 0.05, (6, 6))
    return random.uniform(-0.3, 0.3, 6), A @ A.T + 1e-4 * np.eye(6)


def ages(random: Random) -> Iterator[Call]:
    """Other ages and noises."""
    for age in random.uniform(0.02, 0.6, 4):
        yield call(*believed(random), float(age), float(random.uniform(0.001, 0.1)))


def no_age(random: Random) -> Iterator[Call]:
    """An age of zero, which changes nothing."""
    yield call(*believed(random), 0.0, 0.01)


def _pose(random: Random, size: float = 0.3) -> Array:
    return se3.pose(se3.rotation(random.uniform(-1.0, 1.0, 3)), random.uniform(-size, size, 3))


def _moving_hand(random: Random, t: float, at: Any, speed: float) -> Hand:
    """A hand that comes to ``at`` at time t along a straight line."""
    times = np.linspace(t - 4.0, t, 3)
    v = speed * random.uniform(0.5, 1.0, 3) * random.choice([-1.0, 1.0], 3)
    return Hand(times, at + np.outer(times - t, v), _pose(random)[:3, :3])


def looking(
    random: Random, wait: float = 1.2, shift: float = 0.1, seen: bool = True, plain: bool = False
) -> Call:
    """A call of servo_step while the old line is under way.

    Args:
        random: The generator.
        wait: How long ago it last looked, in [s].
        shift: How far the goal has moved, in [m].
        seen: Whether the picture shows the tag.
        plain: Whether the camera is at the tip, the goal in the tag, and the hand at rest.
    """
    t, age = float(random.uniform(6.0, 9.0)), float(random.uniform(0.1, 0.4))
    goal = _pose(random)
    line = Trajectory(Line(random.uniform(-0.3, 0.3, 3), goal[:3, 3]), BangBang(2.0))
    began = t - (5.0 if plain else 1.5 * wait)
    memory = Memory(goal, line, began, t - wait)
    hand = _moving_hand(random, t, line(t - began).position, 0.0 if plain else 0.2)
    T_tc, T_mg = (np.eye(4), np.eye(4)) if plain else (_pose(random, 0.1), _pose(random))
    turned = np.zeros(3) if plain else random.uniform(-0.1, 0.1, 3)
    new = se3.pose(se3.rotation(turned) @ goal[:3, :3], goal[:3, 3])
    new[:3, 3] += shift * random.choice([-0.6, 0.8, 0.0], 3, replace=False)
    sighting = (t - age, se3.inverse(hand(t - age) @ T_tc) @ new @ se3.inverse(T_mg))
    options = {"every": 1.0, "moved": 0.005, "seconds": 2.0}
    return call(t, memory, sighting if seen else None, hand, T_tc, T_mg, **options)


def first_looks(random: Random) -> Iterator[Call]:
    """Looks without any turns."""
    yield looking(random, plain=True)


def looks(random: Random) -> Iterator[Call]:
    """Other poses, hands and lines."""
    yield from (looking(random) for _ in range(3))


def occasions(random: Random) -> Iterator[Call]:
    """Before and after it is due, for steps beside the threshold, with and without a tag."""
    for wait, shift, seen in OCCASIONS:
        yield looking(random, wait, shift, seen)


OCCASIONS = (
    (0.9, 0.1, True), (1.1, 0.004, True), (1.1, 0.006, True), (1.1, 0.1, False), (0.5, 0.1, False)
)  # fmt: skip
_CAMERA = se3.pose(se3.rotation([0.1, -0.2, 1.5]), [0.05, 0.02, -0.03])
_ABOVE = se3.pose(np.diag([1.0, -1.0, -1.0]) @ se3.rotation([0.0, 0.0, 0.2]), [0.02, -0.03, 0.2])


def chase(limits: dict[str, float], last: int = 0, **tag: Any) -> Chase:
    """A run of a servo, with limits of its measures."""
    options = {"ahead": 0.6, "patience": 1.8} if last else OF_STEP
    return Chase(Conveyor(**tag), {"T_tc": _CAMERA, "T_mg": _ABOVE, **options}, last, limits)


OF_STEP = {"every": 1.0, "moved": 0.005, "seconds": 2.0}
WHOLE = {"rms_mm": 95.0, "place_step_mm": 5.0}  # over ten seeds 79 and 3.5; from the old goal 18
SMOOTH = {"rms_mm": 6.0, "place_step_mm": 5.0, "speed_step": 0.02}  # 3.5, 2.8 and 0.008
JUMP = {"end_mm": 10.0, "place_step_mm": 60.0}  # 3.3 and 30
LAST = 8


def belts(random: Random) -> Iterator[Chase]:
    """Other speeds, and a tag at rest."""
    yield chase(WHOLE, speed=float(random.uniform(0.02, 0.035)), seed=int(random.integers(99)))
    yield chase({"lines": 2.0}, speed=0.0, seed=int(random.integers(99)))


def bending(
    random: Random, age: float = 0.4, speed: float = 0.05, stale: float = 0.0, plain: bool = False
) -> Call:
    """A call of servo_smooth while the reference moves, with sightings of a tag that moves evenly.

    Args:
        random: The generator.
        age: Age of the newest sighting, in [s].
        speed: Of the tag, in [m/s].
        stale: How much older than that the sightings are, in [s].
        plain: Whether the camera is at the tip, the goal in the tag, and all at rest.
    """
    t, still = float(random.uniform(6.0, 9.0)), np.zeros(3)
    place = random.uniform(-0.3, 0.3, 3)
    calm = 0.0 if plain else 1.0
    start, end = (Sample(x.position, calm * x.velocity, still) for x in
                  (_sample(random, 0.1, 0.0), _sample(random, 0.1, 0.0)))  # fmt: skip
    began = t - (5.0 if plain else 0.3)
    line = Bend(start, end, 0.6)
    now = line(t - began)
    hand = _moving_hand(random, t, now.position, 0.2 * calm)
    T_tc, T_mg = (np.eye(4), np.eye(4)) if plain else (_pose(random, 0.1), _pose(random))
    v, turn = speed * calm * random.choice([-1.0, 1.0], 3), _pose(random)[:3, :3]
    sightings = []
    for ago in (0.35, 0.3, 0.1, 0.0):
        stamp = t - age - stale - ago
        goal = se3.pose(turn, place + (stamp - t) * v)
        T_cm = se3.inverse(hand(stamp) @ T_tc) @ goal @ se3.inverse(T_mg)
        sightings.append((stamp, T_cm))
    memory = Memory(_pose(random), line, began, t - 0.02)
    options = {"ahead": 0.6, "patience": 1.8}
    return call(t, memory, tuple(sightings), hand, T_tc, T_mg, **options)


def bends(random: Random) -> Iterator[Call]:
    """Nothing moves yet."""
    yield bending(random, plain=True)


def smooth(random: Random) -> Iterator[Call | Chase]:
    """Other poses and motions, fresh sightings; other belts and jumps."""
    yield from (bending(random, 0.0) for _ in range(2))
    seed = int(random.integers(99))
    yield chase(SMOOTH, LAST, speed=float(random.uniform(0.02, 0.035)), seed=seed)
    yield chase(JUMP, LAST, speed=0.0, jump=0.1, age=0.5, seed=seed)


def late(random: Random) -> Iterator[Call | Chase]:
    """The same, seen late."""
    yield from (bending(random, float(random.uniform(0.3, 0.6))) for _ in range(2))
    speed, seed = float(random.uniform(0.025, 0.035)), int(random.integers(99))
    yield chase(SMOOTH, LAST, age=0.5, speed=speed, seed=seed)


def blind(random: Random) -> Iterator[Call | Chase]:
    """Sightings that stop for a while, or for good."""
    yield bending(random, stale=float(random.uniform(1.6, 1.9)))
    seed = int(random.integers(99))
    yield chase(SMOOTH, LAST, age=0.5, blind=(6.0, 7.0), seed=seed)
    yield chase(GONE, LAST, age=0.5, blind=(6.0, 99.0), seed=seed)


GONE = {"speed_step": 0.02, "end_speed": 0.003}
