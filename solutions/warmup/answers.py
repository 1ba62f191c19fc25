"""Answers of notebook 00: errors with a sign, frames that cancel, how far a hand is turned."""

from __future__ import annotations

from typing import Any

import numpy as np

import labkit as lk
from labkit.shapes import Array


def joint_error(target: lk.Sample, state: lk.State) -> Array:
    """Target minus actual, joint by joint."""
    return target.position - state.q


def transform_point(T_ab: Any, p_b: Any) -> Array:
    """A point's coordinates in a, from those in b (MLS section 2.3.1)."""
    return np.asarray(T_ab[:3, :3] @ p_b + T_ab[:3, 3])


def inverse_transform(T_ab: Any) -> Array:
    """The pose of a in b, from the pose of b in a (MLS eq. 2.24)."""
    T_ba, R_ba = np.eye(4), T_ab[:3, :3].T
    T_ba[:3, :3], T_ba[:3, 3] = R_ba, -R_ba @ T_ab[:3, 3]
    return T_ba


def orientation_error(R_wd: Any, R_wt: Any) -> Array:
    """The turn, in world axes, from the actual orientation to the one wanted (L&P 11.3.3)."""
    return lk.se3.rotation_log(R_wd @ R_wt.T)
