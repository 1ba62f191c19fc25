r"""Rigid motion: rotations, poses, twists, and the maps between them.

A pose is a 4 x 4 matrix `T_ab` that converts coordinates in b to a, ``p_a = T_ab @ p_b``;
the subscripts cancel.  A twist is (v, w), linear part first, as in Murray, Li & Sastry (MLS).
Formulas: MLS chapter 2; Lynch & Park, *Modern Robotics*, chapter 3.
"""

from __future__ import annotations

from math import atan2, copysign, hypot, pi
from typing import Any

import numpy as np

from .errors import OutOfRange
from .shapes import Array, as_array

_IDENTITY = np.eye(3)


def hat(w: Any) -> Array:
    """The skew matrix with ``hat(w) @ x == cross(w, x)`` (MLS eq. 2.4).

    Args:
        w: Vector, shape (3,).

    Returns:
        Shape (3, 3).
    """
    x, y, z = as_array(w, (3,), "w")
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def vee(S: Any) -> Array:
    """The vector of a skew matrix, the inverse of `hat`.

    Args:
        S: Skew matrix, shape (3, 3); its symmetric part is ignored.

    Returns:
        Shape (3,).
    """
    S = as_array(S, (3, 3), "S")
    return 0.5 * np.array([S[2, 1] - S[1, 2], S[0, 2] - S[2, 0], S[1, 0] - S[0, 1]])


def rotation(phi: Any) -> Array:
    """The rotation by the angle ``|phi|`` about the axis ``phi`` (Rodrigues, MLS eq. 2.14).

    Args:
        phi: Rotation vector, shape (3,) in [rad].

    Returns:
        Shape (3, 3).
    """
    W, turn = hat(phi), float(np.linalg.norm(phi)) / pi
    return _IDENTITY + np.sinc(turn) * W + 0.5 * np.sinc(0.5 * turn) ** 2 * (W @ W)


def rotation_log(R: Any) -> Array:
    r"""The rotation vector of R, the inverse of `rotation`: :math:`\log(R)^\vee`.

    It is read from the `quaternion`, which is well conditioned for all angles; the sign of the axis
    at exactly half a turn is necessarily arbitrary.

    Args:
        R: Rotation matrix, shape (3, 3).

    Returns:
        Shape (3,) in [rad], of length at most pi.

    Raises:
        OutOfRange: R is not a rotation matrix.
    """
    x, y, z, w = quaternion(R)
    sine = hypot(x, y, z)
    return (2.0 * atan2(sine, w) / sine if sine else 2.0) * np.array([x, y, z])


def orientation_error(R_wd: Any, R_wt: Any) -> Array:
    r"""The rotation, in world axes, from the actual orientation to the desired one.

    :math:`e_o = \log(R_{wd} R_{wt}^T)^\vee`, target minus actual in the only sense that rotations
    allow (Lynch & Park, section 11.3.3; Siciliano, section 3.7.3 with the logarithm).

    Args:
        R_wd: Desired orientation in the world, shape (3, 3).
        R_wt: Actual orientation of the tip in the world, shape (3, 3).

    Returns:
        Rotation vector in world axes, shape (3,) in [rad].
    """
    R_wd = as_array(R_wd, (3, 3), "R_wd")
    return rotation_log(R_wd @ as_array(R_wt, (3, 3), "R_wt").T)


def pose_error(T_wd: Any, T_wt: Any) -> Array:
    """Pose error, target minus actual, in world axes.

    Args:
        T_wd: Desired pose, shape (4, 4).
        T_wt: Actual pose of the tip, shape (4, 4).

    Returns:
        Position error [m] and `orientation_error` [rad], shape (6,).
    """
    T_wd, T_wt = as_array(T_wd, (4, 4), "T_wd"), as_array(T_wt, (4, 4), "T_wt")
    e = np.empty(6)
    e[:3] = T_wd[:3, 3] - T_wt[:3, 3]
    e[3:] = rotation_log(T_wd[:3, :3] @ T_wt[:3, :3].T)
    return e


def pose(R: Any, p: Any) -> Array:
    """The pose with rotation ``R``, shape (3, 3), and origin ``p``, shape (3,) in [m].

    Returns:
        Shape (4, 4).
    """
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = as_rotation(R, "R"), as_array(p, (3,), "p")
    return T


def inverse(T_ab: Any) -> Array:
    """The pose `T_ba` of a in b, from the pose of b in a (MLS eq. 2.24).

    Args:
        T_ab: Pose, shape (4, 4).

    Returns:
        Shape (4, 4).
    """
    T_ab = as_array(T_ab, (4, 4), "T_ab")
    T_ba, R_ba = np.eye(4), T_ab[:3, :3].T
    T_ba[:3, :3], T_ba[:3, 3] = R_ba, -R_ba @ T_ab[:3, 3]
    return T_ba


def angle_between(R_a: Any, R_b: Any) -> float:
    """The angle of the rotation from one orientation to the other, in [rad], from 0 to pi."""
    return float(np.linalg.norm(orientation_error(R_a, R_b)))


def quaternion(R: Any) -> Array:
    """The unit quaternion (x, y, z, w) of a rotation matrix, the real part last and not negative.

    Each row below is the quaternion times four times one of its numbers; the largest is taken.

    Args:
        R: Rotation matrix, shape (3, 3).

    Returns:
        Shape (4,).
    """
    (a, b, c), (d, e, f), (g, h, i) = as_rotation(R, "R").tolist()
    rows = (
        (1.0 + a - e - i, b + d, c + g, h - f),
        (b + d, 1.0 - a + e - i, f + h, c - g),
        (c + g, f + h, 1.0 - a - e + i, d - b),
        (h - f, c - g, d - b, 1.0 + a + e + i),
    )
    squares = [row[k] for k, row in enumerate(rows)]
    row = rows[squares.index(max(squares))]
    return np.array(row) / copysign(hypot(*row), row[3])


def as_rotation(x: Any, name: str) -> Array:
    """Read ``x`` as a rotation matrix.

    Args:
        x: Shape (3, 3).
        name: What to call it in the sentence, if it does not fit.

    Returns:
        Shape (3, 3).

    Raises:
        OutOfRange: Its columns are not orthonormal, or its determinant is -1.
    """
    R: Array = as_array(x, (3, 3), name)
    off = abs(R.T @ R - _IDENTITY).max()
    if off > 1e-6:
        raise OutOfRange(
            f"{name} is not a rotation: {name}.T @ {name} differs from the identity by {off:.2g}; "
            "rotations are made by products and se3.rotation, not by sums"
        )
    (a, b, c), (d, e, f), (g, h, i) = R.tolist()
    if a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g) < 0.0:
        raise OutOfRange(f"{name} has determinant -1: it mirrors; two of its columns are swapped")
    return R


def as_pose(x: Any, name: str) -> Array:
    """Read ``x`` as a pose: a rotation, an origin and the row (0, 0, 0, 1).

    Args:
        x: Shape (4, 4).
        name: What to call it in the sentence, if it does not fit.

    Returns:
        Shape (4, 4).

    Raises:
        OutOfRange: ``x`` is not a rigid motion.
    """
    T: Array = as_array(x, (4, 4), name)
    if np.abs(T[3] - (0.0, 0.0, 0.0, 1.0)).max() > 1e-9:
        raise OutOfRange(f"{name}'s last row is {T[3]}, a pose has (0, 0, 0, 1); is it transposed?")
    as_rotation(T[:3, :3], f"{name}[:3, :3]")
    return T
