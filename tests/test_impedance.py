"""The fit finds the impedance that made the data."""

import numpy as np
import pytest

import labkit as lk
from labkit.errors import OutOfRange, ShapeError
from labkit.impedance import fit_impedance
from solutions.workspace_impedance import WorkspaceImpedance

K = np.array([[300.0, 40.0, 0.0], [40.0, 200.0, -30.0], [0.0, -30.0, 150.0]])
D = np.diag([30.0, 40.0, 50.0])
M = np.diag([4.0, 5.0, 6.0])


def excited(n=4000, dt=1e-3):
    """Displacements of many frequencies and the force that they take, from a stated impedance."""
    t = dt * np.arange(n)
    x, dx, ddx = np.zeros((3, n, 3))
    rng = np.random.default_rng(5)
    for _ in range(4):
        w, a, phase = rng.uniform(1, 15, 3), 0.02 * rng.uniform(0.5, 1, 3), rng.uniform(0, 6, 3)
        angle = w * t[:, None] + phase
        x, dx, ddx = (
            x + a * np.sin(angle),
            dx + a * w * np.cos(angle),
            ddx - a * w * w * np.sin(angle),
        )
    return t, ddx @ M.T + dx @ D.T + x @ K.T + [1.0, -2.0, 3.0], x


def test_a_stated_impedance_is_found_again():
    """Off-diagonal stiffness and a constant force included."""
    fit = fit_impedance(*excited())
    assert fit.stiffness == pytest.approx(K, abs=0.2)
    assert fit.damping == pytest.approx(D, abs=0.05)
    assert fit.inertia == pytest.approx(M, abs=0.01)
    assert fit.offset == pytest.approx([1.0, -2.0, 3.0], abs=0.01)
    assert fit.residual < 0.01


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
    fit = fit_impedance(log.t, force, -lk.metrics.tip_error(log, model)[:, :3])
    assert np.diag(fit.stiffness) == pytest.approx(asked["K"][:3], rel=0.03)
    assert np.diag(fit.damping) == pytest.approx(asked["D"][:3], rel=0.03)
    assert np.diag(fit.inertia) == pytest.approx(M_d[:3], rel=0.15)
    assert fit.stiffness - np.diag(np.diag(fit.stiffness)) == pytest.approx(
        np.zeros((3, 3)), abs=10.0
    )


def test_a_push_in_one_direction_does_not_tell_the_others():
    """A motion that leaves a direction out, or stands still, is refused."""
    t, force, x = excited()
    flat = x * [1.0, 1.0, 0.0]
    with pytest.raises(OutOfRange, match="push along each"):
        fit_impedance(t, force, flat)
    with pytest.raises(OutOfRange, match="push along each"):
        fit_impedance(t, force, 0.0 * x)


@pytest.mark.parametrize(
    ("rows", "stretch", "words"),
    [
        (slice(None, 9), 1.0, "at least ten times"),
        (slice(None, 40), 1.0, "t spans 0.039 s, too little"),
        (slice(None), 0.0, "rise in even steps"),
        (slice(None), -1.0, "rise in even steps"),
        (np.geomspace(1, 3999, 200).astype(int), 1.0, "rise in even steps"),
    ],
)
def test_times_must_be_even_and_longer_than_the_smoothing(rows, stretch, words):
    t, force, x = excited()
    with pytest.raises(OutOfRange, match=words):
        fit_impedance(stretch * t[rows], force[rows], x[rows])


def test_shapes_must_go_together():
    """Force and displacement have a row for each time."""
    t, force, x = excited()
    with pytest.raises(ShapeError, match="force"):
        fit_impedance(t, force[1:], x)
    with pytest.raises(ShapeError, match="displacement"):
        fit_impedance(t, force[:, 0], x[:, 0])
