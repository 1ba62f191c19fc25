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


def orientation_error(R_wd: Any, R_wt: Any) -> Array:
    """The turn, in world axes, from the actual orientation to the one wanted (L&P 11.3.3)."""
    return lk.se3.rotation_log(R_wd @ R_wt.T)
