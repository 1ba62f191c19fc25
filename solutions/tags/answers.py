"""Answers of notebook 06 on pictures and on the servo.  The rest is `following`."""

from __future__ import annotations

from typing import Any

import numpy as np

from labkit import BangBang, Line, Sample, Trajectory, se3
from labkit.servo import Bend, Memory
from labkit.shapes import Array


def tag_pose(candidates: Any, pixels: Any, K: Any, size: float) -> tuple[Array, float]:
    """The candidate whose corners project nearest to the pixels, and how near, RMS in [px]."""
    h = size / 2.0
    corners = np.array([[-h, h, 0.0], [h, h, 0.0], [h, -h, 0.0], [-h, -h, 0.0]])
    errors = []
    for T in candidates:
        image = (corners @ T[:3, :3].T + T[:3, 3]) @ K.T
        off = image[:, :2] / image[:, 2:] - pixels
        errors.append(np.sqrt(np.mean(np.sum(off**2, axis=1))))
    best = int(np.argmin(errors))
    return candidates[best], float(errors[best])


def sensor_quality(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """Mean of the error, truth minus estimate, and its covariance about that mean."""
    errors = [
        np.concatenate([truth[:3, 3] - T[:3, 3], se3.rotation_log(truth[:3, :3] @ T[:3, :3].T)])
        for T in estimates
    ]
    return np.mean(errors, axis=0), np.cov(np.array(errors).T)


def servo_step(
    t: float,
    memory: Memory,
    sighting: Any,
    hand: Any,
    T_tc: Any,
    T_mg: Any,
    *,
    every: float,
    moved: float,
    seconds: float,
) -> Memory:
    """Algorithm 1: look now and then; if the goal has moved, take a new line to it."""
    if t - memory.looked < every:
        return memory
    memory = memory._replace(looked=t)
    if sighting is None:
        return memory
    stamp, T_cm = sighting
    goal = hand(stamp) @ T_tc @ T_cm @ T_mg
    if np.linalg.norm(goal[:3, 3] - memory.goal[:3, 3]) <= moved:
        return memory
    here = memory.line(t - memory.began).position
    line = Trajectory(Line(here, goal[:3, 3]), BangBang(seconds))
    return Memory(goal, line, t, t)


def servo_smooth(
    t: float,
    memory: Memory,
    sightings: Any,
    hand: Any,
    T_tc: Any,
    T_mg: Any,
    *,
    ahead: float,
    patience: float,
) -> Memory:
    """Bend the reference towards where the goal will be; without news, come to rest."""
    now, still = memory.line(t - memory.began), np.zeros(3)
    if not sightings or t - sightings[-1][0] > patience:
        rest = Sample(now.position + 0.5 * ahead * now.velocity, still, still)
        return memory._replace(line=Bend(now, rest, ahead), began=t)
    goals = np.array([hand(stamp) @ T_tc @ T_cm @ T_mg for stamp, T_cm in sightings])
    age = np.array([stamp for stamp, _ in sightings]) - t
    velocity, place = still, goals[-1, :3, 3]
    if len(goals) > 1:
        velocity, place = np.polyfit(age, goals[:, :3, 3], 1)  # at t
    goal = np.array(goals[-1])
    goal[:3, 3] = place + ahead * velocity
    return Memory(goal, Bend(now, Sample(goal[:3, 3], velocity, still), ahead), t, t)
