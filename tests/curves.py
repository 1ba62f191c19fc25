"""Tests by central differences that the derivatives of curves are right."""

import numpy as np
from numpy.testing import assert_allclose

from labkit import se3


def slope_along(f, q, dq, step=1e-6):
    """The rate of change of ``f`` while ``q`` moves at ``dq``."""
    return (f(q + step * dq) - f(q - step * dq)) / (2 * step)


def assert_slopes(curve, x, step=1e-5, tolerance=1e-6):
    """Assert that the derivatives in ``curve(x)``, after the value, are the slopes at ``x``."""
    before, here, after = (tuple(map(np.asarray, curve(x + k * step))) for k in (-1, 0, 1))
    for k in (0, 1):
        slope = (after[k] - before[k]) / (2 * step)
        scale = 1.0 + np.abs(here[k + 1]).max()
        assert_allclose(slope, here[k + 1], rtol=0, atol=tolerance * scale)


def assert_pose_slopes(curve, x, step=1e-5, tolerance=1e-6):
    """Assert that twist and dtwist in ``curve(x)``, in world axes, are the slopes at ``x``."""
    (T0, V0, _), (T, V, dV), (T1, V1, _) = (curve(x + k * step) for k in (-1, 0, 1))
    turn = se3.orientation_error(T1[:3, :3], T0[:3, :3])
    slope = np.concatenate([T1[:3, 3] - T0[:3, 3], turn]) / (2 * step)
    assert_allclose(slope, V, rtol=0, atol=tolerance * (1.0 + np.abs(V).max()))
    assert_allclose((V1 - V0) / (2 * step), dV, rtol=0, atol=tolerance * (1.0 + np.abs(dV).max()))
    assert_allclose(T[3], [0, 0, 0, 1])


def assert_at_rest(sample, value):
    """Assert that the sample is at ``value``, without velocity and acceleration."""
    x, dx, ddx = map(np.asarray, sample)
    assert_allclose(x, value, rtol=0, atol=1e-12)
    assert not dx.any()
    assert not ddx.any()
