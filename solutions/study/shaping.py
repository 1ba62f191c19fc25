"""Check the inertia that an impedance controller is to have."""

from __future__ import annotations

from typing import Any

import numpy as np

from labkit.errors import OutOfRange
from labkit.shapes import Array, as_array, as_gains, locked


def as_inertia(x: Any, n: int) -> Array:
    """Read a desired inertia; a number or a vector makes a diagonal matrix.

    Args:
        x: A number, shape (n,) or (n, n); [kg] or [kg m^2].
        n: The number of coordinates.

    Returns:
        Shape (n, n), read-only, symmetric and positive definite.

    Raises:
        OutOfRange: The matrix is not symmetric and positive definite, as every inertia is.
    """
    if np.ndim(x) == 2:
        M_d = np.array(as_array(x, (n, n), "inertia"))
    else:
        M_d = np.diag(as_gains(x, n, "inertia"))
    if np.abs(M_d - M_d.T).max() > 1e-9 * np.abs(M_d).max():
        raise OutOfRange("inertia is not symmetric")
    least = float(np.linalg.eigvalsh(M_d)[0])
    if least <= 0.0:
        raise OutOfRange(f"inertia has the eigenvalue {least:.3g}; all must be greater than 0")
    return locked(M_d)
