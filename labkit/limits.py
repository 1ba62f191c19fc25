"""Limits seen beforehand: joint motions that ask for too much speed or come near a singularity."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from .arrays import Array
from .errors import LabkitWarning
from .robot import Robot

NEAR_SINGULAR = 0.03
"""Below this smallest singular value of the tip Jacobian, a pose counts as near a singularity."""

_SAMPLES = 201


def warn_of_speed(trajectory: Any, robot: Robot) -> None:
    """Warn if a joint motion is quicker than the arm.

    Args:
        trajectory: A target of joint angles with a duration.
        robot: Whose limits.

    Warns:
        LabkitWarning: Names the joint, the time, both speeds and the duration that would do.
    """
    t = np.linspace(0.0, trajectory.duration, _SAMPLES)
    share = np.abs([trajectory(x).velocity for x in t]) / robot.speed
    k, i = np.unravel_index(int(share.argmax()), share.shape)
    if share[k, i] > 1.0 + 1e-9:
        warnings.warn(
            f"too fast: at t = {t[k]:.2f} s joint {robot.joint_names[i]} should turn at "
            f"{share[k, i] * robot.speed[i]:.3g} rad/s, its limit is {robot.speed[i]:g}; the arm "
            f"will lag behind unless the motion takes {share[k, i] * trajectory.duration:.3g} s",
            LabkitWarning,
            stacklevel=4,
        )


def warn_of_singularity(s: Array, jacobians: Array) -> None:
    """Warn if a path comes near a singularity.

    Args:
        s: Places along the path, shape (k,).
        jacobians: The tip Jacobian at each, shape (k, 6, 7).

    Warns:
        LabkitWarning: Names the place and the manipulability there.
    """
    sigma = np.linalg.svd(jacobians, compute_uv=False)
    k = int(sigma[:, -1].argmin())
    if sigma[k, -1] < NEAR_SINGULAR:
        warnings.warn(
            f"near a singularity: at s = {s[k]:.2f} the manipulability is {sigma[k].prod():.2g} "
            f"and the smallest singular value {sigma[k, -1]:.2g}, below {NEAR_SINGULAR:g}; expect "
            "high joint speeds, or move the path, or start from another q0",
            LabkitWarning,
            stacklevel=4,
        )
