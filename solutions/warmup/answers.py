"""Answers of notebook 00: errors with a sign, frames that cancel, how far a hand is turned."""

from __future__ import annotations

from typing import Any

import numpy as np

import labkit as lk
from labkit.shapes import Array


def joint_error(target: lk.Sample, state: lk.State) -> Array:
    """Target minus actual, joint by joint."""
    return target.position - state.q


def tag_in_world(T_wt: Any, T_tc: Any, T_cm: Any) -> Array:
    """The tag's pose in the world: neighbouring letters cancel (MLS section 2.3.2)."""
    return np.asarray(T_wt @ T_tc @ T_cm)


def orientation_error(R_wd: Any, R_wt: Any) -> Array:
    """The turn, in world axes, from the actual orientation to the one wanted (L&P 11.3.3)."""
    return lk.se3.rotation_log(R_wd @ R_wt.T)
