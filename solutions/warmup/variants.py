"""Right answers of notebook 00, in another form."""

from __future__ import annotations

from typing import Any

import numpy as np

import labkit as lk


def error_list(target: lk.Sample, state: lk.State) -> Any:
    """A plain list, in a loop."""
    return [a - b for a, b in zip(target.position, state.q, strict=True)]


def point_homogeneous(T_ab: Any, p_b: Any) -> Any:
    """With a one appended."""
    return (T_ab @ np.append(p_b, 1.0))[:3]


def point_by_einsum(T_ab: Any, p_b: Any) -> Any:
    """Sums over columns, a list."""
    return list(np.einsum("ij,j->i", T_ab, [*p_b, 1.0])[:3])


def inverse_by_solving(T_ab: Any) -> Any:
    """Solves T X = I, as for any matrix."""
    return np.linalg.solve(T_ab, np.eye(4))


def inverse_by_blocks(T_ab: Any) -> Any:
    """Put together from blocks."""
    R = np.transpose(T_ab[:3, :3])
    return np.vstack([np.column_stack([R, -R @ T_ab[:3, 3]]), [0, 0, 0, 1]])


class OrientationError:
    """A callable object: the turn in the tool's axes, brought into the world's."""

    def __call__(self, R_wd: Any, R_wt: Any) -> Any:
        """In the tool, then turned."""
        return R_wt @ lk.se3.rotation_log(R_wt.T @ R_wd)


def by_quaternion(R_wd: Any, R_wt: Any) -> Any:
    """With scipy's rotations."""
    from scipy.spatial.transform import Rotation

    return (Rotation.from_matrix(R_wd) * Rotation.from_matrix(R_wt).inv()).as_rotvec()
