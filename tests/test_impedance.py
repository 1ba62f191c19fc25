"""What an arm feels like is what its controller was asked for."""

import numpy as np
import pytest

import labkit as lk
from solutions.study.workspace_impedance import WorkspaceImpedance


def fitted(t, force, x, smoothing=0.02):
    """M, D and K of F = M ddx + D dx + K x + F_0 by least squares.

    Force and motion pass through the same smoothing first, which a linear equation does not
    notice, so that single ticks of delay do not pass for inertia.
    """
    dx = np.gradient(x, t, axis=0)
    ddx = np.gradient(dx, t, axis=0)
    window = np.bartlett(2 * round(smoothing / (t[1] - t[0])) + 1)
    force, ddx, dx, x = (
        np.apply_along_axis(np.convolve, 0, y[2:-2], window / window.sum(), "valid")
        for y in (force, ddx, dx, x)
    )
    A = np.hstack([ddx, dx, x, np.ones((len(x), 1))])
    return np.split(np.linalg.lstsq(A, force, rcond=None)[0].T[:, :9], 3, axis=1)


def test_what_the_arm_feels_like_is_what_its_controller_was_asked_for():
    """The simulated tip shows K and D within 3 %, M_d within 15: the force comes a tick late."""
    asked = {"K": [300.0, 250, 200, 20, 20, 20], "D": [60.0, 55, 50, 4, 4, 4]}
    plant = lk.Plant(armature=lk.BAXTER.armature)  # inertia not far from what is asked for
    model = lk.Model("left", plant)
    ready, M_d = model.robot.ready, [4.0, 5.0, 6.0, 0.1, 0.1, 0.1]
    pushes = [lk.Push(8.0 * np.eye(3)[i], start=0.1 + i, duration=0.4) for i in range(3)]
    with lk.Arm(plant=plant, q0=ready, world=lk.World(things=pushes)) as arm:
        law = WorkspaceImpedance(model, **asked, inertia=M_d)
        log = lk.run(arm, lk.Hold(model.pose(ready), 3.2), law, rate=1000)
    force = lk.metrics.felt_wrench(log, model)[:, :3]
    inertia, damping, stiffness = fitted(log.t, force, -lk.metrics.tip_error(log, model)[:, :3])
    assert np.diag(stiffness) == pytest.approx(asked["K"][:3], rel=0.03)
    assert np.diag(damping) == pytest.approx(asked["D"][:3], rel=0.03)
    assert np.diag(inertia) == pytest.approx(M_d[:3], rel=0.15)
    assert stiffness - np.diag(np.diag(stiffness)) == pytest.approx(np.zeros((3, 3)), abs=10.0)
