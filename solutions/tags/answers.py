"""Answers of notebook 06 on pictures: corners, pose and quality.  The rest is `following`."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np

from labkit import se3
from labkit.shapes import Array


def tag_corners(size: float) -> Array:
    """The black square's corners in the tag's frame, clockwise from the upper left."""
    h = size / 2.0
    return np.array([[-h, h, 0.0], [h, h, 0.0], [h, -h, 0.0], [-h, -h, 0.0]])


def tag_pose(pixels: Any, K: Any, size: float) -> Array:
    """Pose of the tag in the camera's frame, by the better of IPPE's two answers."""
    h = size / 2.0
    corners = np.array([[-h, h, 0.0], [h, h, 0.0], [h, -h, 0.0], [-h, -h, 0.0]])
    _, turns, places, errors = cv2.solvePnPGeneric(
        corners, np.asarray(pixels, dtype=float), K, None, flags=cv2.SOLVEPNP_IPPE_SQUARE
    )
    best = int(np.argmin(np.ravel(errors)))
    T_cm = np.eye(4)
    T_cm[:3, :3], T_cm[:3, 3] = cv2.Rodrigues(turns[best])[0], np.ravel(places[best])
    return T_cm


def sensor_quality(estimates: Any, truth: Any) -> tuple[Array, Array]:
    """Mean of the error, truth minus estimate, and its covariance about that mean."""
    errors = [
        np.concatenate([truth[:3, 3] - T[:3, 3], se3.rotation_log(truth[:3, :3] @ T[:3, :3].T)])
        for T in estimates
    ]
    return np.mean(errors, axis=0), np.cov(np.array(errors).T)
