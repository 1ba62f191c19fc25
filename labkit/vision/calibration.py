r"""Calibration: where the camera is, from several views of a tag.

With a tag somewhere on the gripper and a fixed camera, every view i says

.. math:: T_{wt,i}\; T_{tm} = T_{wc}\; T_{cm,i}

and with the camera on the gripper and a fixed tag :math:`T_{wt,i}\,T_{tc} = T_{wm}\,T_{cm,i}^{-1}`:
the same equation A X = Z B.  A closed form (Shah 2013, by Kronecker products) starts it; least
squares polishes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from .. import se3
from ..arrays import Array, locked
from ..errors import LabkitError, ShapeError

_LEVER = 0.1  # metres that count as much as a radian in the polish: the size of the things seen


class SingularViews(LabkitError, ValueError):
    """The views do not determine the camera's place."""


@dataclass(frozen=True, eq=False)
class Calibration:
    """What a calibration found.

    Attributes:
        camera: Fixed camera: `T_wc`.  Camera in the hand: `T_tc`.  Shape (4, 4).
        tag: Fixed camera: `T_tm`, the tag on the gripper.  Camera in the hand: `T_wm`.
            Shape (4, 4).
        residual_mm: What is left over, root mean square over the views, in [mm].
        residual_deg: The same of the orientation, in [degrees].
        views: How many views.
    """

    camera: Array
    tag: Array
    residual_mm: float
    residual_deg: float
    views: int


def calibrate_fixed_camera(T_wt: Any, T_cm: Any) -> Calibration:
    """Find a fixed camera by a tag that the gripper carries, at an unknown place.

    Args:
        T_wt: Pose of the tip at each view, shape (n, 4, 4), at least three.
        T_cm: Pose of the tag in the camera's frame at each view, shape (n, 4, 4).

    Raises:
        SingularViews: There are too few, or the gripper turned about one axis only.
    """
    A, B = _views(T_wt, T_cm)
    X, Z = _solve(A, B)
    return _result(camera=Z, tag=X, misfits=_misfits(A, X, Z, B))


def calibrate_hand_camera(T_wt: Any, T_cm: Any) -> Calibration:
    """Find the camera in the gripper by a tag that lies still, at an unknown place.

    Args:
        T_wt: Pose of the tip at each view, shape (n, 4, 4), at least three.
        T_cm: Pose of the tag in the camera's frame at each view, shape (n, 4, 4).

    Raises:
        SingularViews: There are too few, or the gripper turned about one axis only.
    """
    A, views = _views(T_wt, T_cm)
    B = np.array([se3.inverse(T) for T in views])
    X, Z = _solve(A, B)
    return _result(camera=X, tag=Z, misfits=_misfits(A, X, Z, B))


def _views(T_wt: Any, T_cm: Any) -> tuple[Array, Array]:
    A, B = se3.as_poses(T_wt, "T_wt"), se3.as_poses(T_cm, "T_cm")
    if len(A) != len(B):
        raise ShapeError("T_cm", A.shape, B.shape)
    if len(A) < 3:
        raise SingularViews(
            f"{len(A)} views do not fix a camera; give at least 3, better 10, with the gripper "
            "turned about different axes"
        )
    turns = np.array([se3.rotation_log(T[:3, :3] @ A[0, :3, :3].T) for T in A[1:]])
    spread = np.linalg.svd(turns, compute_uv=False)
    if spread[1] < 0.05 * np.sqrt(len(turns)):
        how = "does not turn" if spread[0] < 0.05 else "turns about one axis only"
        raise SingularViews(
            f"over these {len(A)} views the gripper {how}, so the camera could be anywhere along "
            "it; tilt the gripper by 20 degrees or more about two axes"
        )
    return A, B


def _solve(A: Array, B: Array) -> tuple[Array, Array]:
    """X and Z of A X = Z B."""
    X0, Z0 = _closed_form(A, B)

    def misfits(x: Array) -> Array:
        return _misfits(A, X0 @ se3.exp(x[:6]), Z0 @ se3.exp(x[6:]), B).ravel()

    x = least_squares(misfits, np.zeros(12)).x
    return X0 @ se3.exp(x[:6]), Z0 @ se3.exp(x[6:])


def _closed_form(A: Array, B: Array) -> tuple[Array, Array]:
    """Rotations from the null space of (R_A x I, -I x R_B^T), then places, which are linear."""
    eye = np.eye(3)
    rows = [np.hstack([np.kron(a, eye), -np.kron(eye, b.T)]) for a, b in _turns(A, B)]
    both = np.linalg.svd(np.vstack(rows))[2][-1].reshape(2, 3, 3)
    if np.linalg.det(both[0]) < 0.0:
        both = -both
    R_X, R_Z = (U @ Vt for U, _, Vt in map(np.linalg.svd, both))
    left = np.vstack([np.hstack([a, -eye]) for a, _ in _turns(A, B)])
    right = np.concatenate([R_Z @ b[:3, 3] - a[:3, 3] for a, b in zip(A, B, strict=True)])
    places = np.linalg.lstsq(left, right, rcond=None)[0]
    return se3.pose(R_X, places[:3]), se3.pose(R_Z, places[3:])


def _turns(A: Array, B: Array) -> list[tuple[Array, Array]]:
    return [(a[:3, :3], b[:3, :3]) for a, b in zip(A, B, strict=True)]


def _misfits(A: Array, X: Array, Z: Array, B: Array) -> Array:
    """By how much A X and Z B differ in each view: [m], then [rad] times `_LEVER`, shape (n, 6)."""
    errors = np.array([se3.pose_error(a @ X, Z @ b) for a, b in zip(A, B, strict=True)])
    return np.asarray(errors * np.array([1.0] * 3 + [_LEVER] * 3))


def _result(*, camera: Array, tag: Array, misfits: Array) -> Calibration:
    place, turn = (np.sqrt(np.mean(np.sum(e**2, axis=1))) for e in np.hsplit(misfits, 2))
    return Calibration(
        camera=locked(camera),
        tag=locked(tag),
        residual_mm=float(1e3 * place),
        residual_deg=float(np.degrees(turn / _LEVER)),
        views=len(misfits),
    )
