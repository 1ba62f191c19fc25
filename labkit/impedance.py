r"""What an arm feels like: stiffness, damping and inertia estimated from force and displacement.

.. math:: F = M\,\ddot x + D\,\dot x + K\,x + F_0

F is the force on the arm, x where the arm went from its target: actual minus target, the one place
where this sign is natural, for a push along x moves the arm along x.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .arrays import Array, as_array, as_numbers, locked
from .errors import OutOfRange, ShapeError
from .metrics import rms

SMOOTHING = 0.02
"""Half the width of the window through which force and motion pass, in [s]."""


@dataclass(frozen=True, eq=False)
class Impedance:
    """A fitted impedance in n directions.

    Attributes:
        stiffness: K, shape (n, n) in [N/m].
        damping: D, shape (n, n) in [N s/m].
        inertia: M, shape (n, n) in [kg].
        offset: The force at rest in the middle, shape (n,) in [N].
        residual: RMS force that the fit leaves over, in [N].
    """

    stiffness: Array
    damping: Array
    inertia: Array
    offset: Array
    residual: float


def fit_impedance(t: Any, force: Any, displacement: Any) -> Impedance:
    """Fit an impedance to what was pushed and what gave way, by least squares.

    Force and motion pass through the same smoothing first, which a linear equation does not
    notice, so that single ticks of noise or delay do not pass for inertia.

    Args:
        t: Times, evenly spaced, shape (N,) in [s].
        force: On the arm, shape (N, n) in [N].
        displacement: Actual minus target, shape (N, n) in [m].

    Returns:
        The matrices; velocity and acceleration are central differences of the displacement.

    Raises:
        ShapeError: The shapes do not go together.
        OutOfRange: The times are not evenly spaced or span too little, or the motion does not tell
            all of them apart: push in every direction, and let go.
    """
    x = as_numbers(displacement, "displacement")
    if x.ndim != 2:
        raise ShapeError("displacement", (x.size, 3), x.shape)
    N, n = x.shape
    t, F = as_array(t, (N,), "t"), as_array(force, (N, n), "force")
    steps = np.diff(t)
    if N < 10 or steps.min() <= 0.0 or np.ptp(steps) > 1e-6 * steps[0]:
        raise OutOfRange("t must be at least ten times that rise in even steps")
    half = max(1, round(SMOOTHING / steps[0]))
    if 2 * half + 5 > N:
        raise OutOfRange(
            f"t spans {t[-1] - t[0]:.3g} s, too little to fit an impedance to: it takes more than "
            f"{2.0 * SMOOTHING:g} s"
        )
    dx = np.gradient(x, t, axis=0)
    ddx = np.gradient(dx, t, axis=0)
    window = np.bartlett(2 * half + 1)
    window /= window.sum()
    # differences at the ends are one-sided
    F, dx, ddx, x = (
        np.apply_along_axis(np.convolve, 0, y[2:-2], window, "valid") for y in (F, dx, ddx, x)
    )
    A = np.hstack([ddx, dx, x, np.ones((len(x), 1))])
    scale = np.sqrt((A**2).mean(axis=0))
    if not scale.all() or np.linalg.matrix_rank(A / scale, tol=1e-6 * np.sqrt(len(A))) < A.shape[1]:
        raise OutOfRange(
            f"this motion does not tell stiffness, damping and inertia apart in all {n} "
            "directions; push along each of them, then let go"
        )
    fit, *_ = np.linalg.lstsq(A / scale, F, rcond=None)
    left = F - A / scale @ fit
    M, D, K, offset = np.split(locked(fit.T / scale), [n, 2 * n, 3 * n], axis=1)
    return Impedance(stiffness=K, damping=D, inertia=M, offset=offset[:, 0], residual=rms(left))
