"""Right answers to notebook 00 in other forms."""

from __future__ import annotations

from typing import Any

import numpy as np

import labkit as lk


def error_list(target: lk.Sample, state: lk.State) -> Any:
    """A list, made in a loop."""
    return [a - b for a, b in zip(target.position, state.q, strict=True)]


def point_homogeneous(T_ab: Any, p_b: Any) -> Any:
    """A product with the homogeneous vector."""
    return (T_ab @ np.append(p_b, 1.0))[:3]


def point_by_einsum(T_ab: Any, p_b: Any) -> Any:
    """A sum over columns, returned as a list."""
    return list(np.einsum("ij,j->i", T_ab, [*p_b, 1.0])[:3])


class OrientationError:
    """A callable object that transforms the rotation vector from the tool's axes to the world's."""

    def __call__(self, R_wd: Any, R_wt: Any) -> Any:
        """The vector in the tool's axes, transformed to the world's."""
        return R_wt @ lk.se3.rotation_log(R_wt.T @ R_wd)


def by_quaternion(R_wd: Any, R_wt: Any) -> Any:
    """With scipy's rotations."""
    from scipy.spatial.transform import Rotation

    return (Rotation.from_matrix(R_wd) * Rotation.from_matrix(R_wt).inv()).as_rotvec()
