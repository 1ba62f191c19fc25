"""Right answers to notebook 06 in other forms."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from scipy.interpolate import BPoly
from scipy.linalg import expm

from labkit import BangBang, Line, Sample, Trajectory, se3
from labkit.servo import Bend, Memory
from labkit.tags.tag import tag_corners


def pose_by_opencv(candidates: Any, pixels: Any, K: Any, size: float) -> Any:
    """OpenCV projects; a list of two."""
    corners = tag_corners(size)
    found = []
    for T in candidates:
        turn, place = cv2.Rodrigues(T[:3, :3])[0], T[:3, 3]
        image = cv2.projectPoints(corners, turn, place, np.array(K), None)[0][:, 0]
        found.append((np.linalg.norm(image - pixels) / 2.0, T.tolist()))
    error, T = min(found)
    return [T, error]


def step_by_cases(t: float, memory: Memory, sighting: Any, *frames: Any, **o: Any) -> Any:
    """One return, a list, the look first."""
    hand, T_tc, T_mg = frames
    goal, line, began, looked = memory
    if t - looked >= o["every"]:
        looked = t
        if sighting:
            found = hand(sighting[0]) @ (T_tc @ (sighting[1] @ T_mg))
            if np.sum((found - goal)[:3, 3] ** 2) > o["moved"] ** 2:
                path = Line(line(t - began).position, found[:3, 3])
                goal, line, began = found, Trajectory(path, BangBang(o["seconds"])), t
    return [goal, line, began, looked]


def smooth_by_ends(
    t: float, memory: Memory, seen: Any, hand: Any, T_tc: Any, T_mg: Any, **options: Any
) -> Any:
    """The velocity from the first and the last sighting; a rest begins once."""
    ahead, still = options["ahead"], np.zeros(3)
    now = memory.line(t - memory.began)
    if not seen or t - seen[-1][0] > options["patience"]:
        end = getattr(memory.line, "goal", None)
        if end is None or not end.velocity.any():
            return memory
        rest = Sample(now.position + now.velocity * ahead / 2, still, still)
        return Memory(memory.goal, Bend(now, rest, ahead), t, memory.looked)
    goals = [hand(s) @ T_tc @ T_cm @ T_mg for s, T_cm in seen]
    lasts = seen[-1][0] - seen[0][0]
    v = (goals[-1] - goals[0])[:3, 3] / lasts if lasts else still
    goal = goals[-1].copy()
    goal[:3, 3] += (t + ahead - seen[-1][0]) * v
    return Memory(goal, Bend(now, Sample(goal[:3, 3], v, still), ahead), t, seen[-1][0])


def quality_by_loops(estimates: Any, truth: Any) -> Any:
    """Sums written out, returned as a list of two."""
    e = np.stack(
        [
            np.r_[(truth - T)[:3, 3], se3.orientation_error(truth[:3, :3], T[:3, :3])]
            for T in estimates
        ]
    )
    mean = e.sum(axis=0) / len(e)
    return [mean, sum(np.outer(x - mean, x - mean) for x in e) / (len(e) - 1)]


def blend_by_bernstein(t: float, reference: Sample, goal: Sample, duration: float) -> Any:
    """With scipy's polynomials from derivatives."""
    if t >= duration:
        late = t - duration
        still = np.zeros_like(goal.velocity)
        return goal.position + goal.velocity * late, goal.velocity, still
    curve = BPoly.from_derivatives([0.0, duration], [list(reference), list(goal)])
    return curve(t), curve(t, nu=1), curve(t, nu=2)


def predict_by_exponential(mean: Any, covariance: Any, age: float, accel_noise: float) -> Any:
    """Van Loan's matrix exponential."""
    A = np.kron([[0.0, 1.0], [0.0, 0.0]], np.eye(3))
    G = np.kron(np.diag([0.0, accel_noise]), np.eye(3))
    big = expm(np.block([[-A, G], [np.zeros((6, 6)), A.T]]) * age)
    F = big[6:, 6:].T
    return [F @ mean, F @ covariance @ F.T + F @ big[:6, 6:]]
