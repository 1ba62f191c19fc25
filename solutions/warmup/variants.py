"""Right answers to notebook 00 in other forms."""

from __future__ import annotations

from typing import Any

import numpy as np

import labkit as lk


def error_list(target: lk.Sample, state: lk.State) -> Any:
    """A list, made in a loop."""
    return [a - b for a, b in zip(target.position, state.q, strict=True)]


def chain_by_parts(T_wt: Any, T_tc: Any, T_cm: Any) -> Any:
    """Rotations and positions on their own."""
    R = T_wt[:3, :3] @ T_tc[:3, :3]
    p = T_wt[:3, 3] + T_wt[:3, :3] @ T_tc[:3, 3] + R @ T_cm[:3, 3]
    return lk.se3.pose(R @ T_cm[:3, :3], p)


def chain_as_lists(T_wt: Any, T_tc: Any, T_cm: Any) -> Any:
    """The other bracket first, returned as lists."""
    return np.linalg.multi_dot([T_wt, T_tc, T_cm]).tolist()


class OrientationError:
    """A callable object that transforms the rotation vector from the tool's axes to the world's."""

    def __call__(self, R_wd: Any, R_wt: Any) -> Any:
        """The vector in the tool's axes, transformed to the world's."""
        return R_wt @ lk.se3.rotation_log(R_wt.T @ R_wd)


def by_quaternion(R_wd: Any, R_wt: Any) -> Any:
    """With scipy's rotations."""
    from scipy.spatial.transform import Rotation

    return (Rotation.from_matrix(R_wd) * Rotation.from_matrix(R_wt).inv()).as_rotvec()
