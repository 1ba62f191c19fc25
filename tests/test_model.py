"""The model: dynamics obey their laws, and nothing ill-shaped reaches the engine."""

import numpy as np
import pytest
from curves import slope_along
from numpy.testing import assert_allclose

import labkit as lk
from labkit.errors import LabkitError, NotFinite, ShapeError

STEP = 1e-6


def test_the_mass_matrix_is_symmetric_and_positive_definite(side, model, states):
    """At 100 random states of each arm it is symmetric to the bit and positive definite."""
    for q, _ in states(side, 100):
        M = model.mass_matrix(q)
        assert (M == M.T).all()
        assert np.linalg.eigvalsh(M)[0] > 0.0


def test_mdot_minus_2c_is_skew(side, model, states):
    """The slope of M along the motion less 2 C is antisymmetric to 1e-7."""
    for q, dq in states(side):
        S = slope_along(model.mass_matrix, q, dq) - 2.0 * model.coriolis(q, dq)
        assert_allclose(S + S.T, np.zeros((7, 7)), rtol=0, atol=1e-7)


def test_gravity_is_the_slope_of_the_potential_energy(side, model, states):
    """The potential energy rises at g(q) dq, to 1e-6 W."""
    for q, dq in states(side):
        assert slope_along(model.potential_energy, q, dq) == pytest.approx(
            model.gravity(q) @ dq, abs=1e-6
        )


def test_the_bias_is_coriolis_and_gravity(side, model, states):
    """The bias is C dq + g, and g alone at rest."""
    for q, dq in states(side):
        assert_allclose(
            model.bias(q, dq), model.coriolis(q, dq) @ dq + model.gravity(q), rtol=0, atol=1e-10
        )
        assert_allclose(model.bias(q, np.zeros(7)), model.gravity(q), rtol=0, atol=1e-12)


def test_the_kinetic_energy_is_half_dq_m_dq(side, model, states):
    """The model's kinetic energy is half dq M dq to twelve digits."""
    for q, dq in states(side):
        energy = 0.5 * dq @ model.mass_matrix(q) @ dq
        assert model.kinetic_energy(q, dq) == pytest.approx(energy, rel=1e-12)


def test_without_torque_energy_is_conserved(side, model, states):
    """dE/dt = dq . (M ddq + C dq + g) = 0 along the equations of motion."""
    for q, dq in states(side):
        ddq = np.linalg.solve(model.mass_matrix(q), -model.bias(q, dq))

        def energy(h, q=q, dq=dq, ddq=ddq):
            x, v = q + h * dq + 0.5 * h * h * ddq, dq + h * ddq
            return model.kinetic_energy(x, v) + model.potential_energy(x)

        rate = (energy(STEP) - energy(-STEP)) / (2 * STEP)
        scale = 1.0 + np.abs(dq @ model.gravity(q))
        assert rate == pytest.approx(0.0, abs=1e-6 * scale)


def test_a_force_at_the_tip_meets_the_operational_inertia(side, model, states):
    """Pushed from rest without gravity, the tip accelerates by Lambda^-1 F."""
    F = np.array([1.0, -2.0, 3.0, 0.1, 0.2, -0.3])
    for q, _ in states(side):
        J = model.tip_jacobian(q)
        ddq = np.linalg.solve(model.mass_matrix(q), J.T @ F)
        L = model.operational_inertia(q)
        assert_allclose(L @ (J @ ddq), F, rtol=0, atol=1e-7)
        assert_allclose(L, L.T, rtol=1e-8, atol=1e-8)


def test_links_sum_up_to_the_mass_matrix_and_gravity(side, model, states):
    """The links' masses, inertias and Jacobians add up to M and g."""
    for q, _ in states(side, 5):
        M, g = np.zeros((7, 7)), np.zeros(7)
        for link in model.links(q):
            J, R = link.com_jacobian, link.T_wl[:3, :3]
            M += link.mass * J[:3].T @ J[:3] + J[3:].T @ R @ link.inertia @ R.T @ J[3:]
            g += link.mass * 9.81 * J[2]
        assert_allclose(M, model.mass_matrix(q), rtol=0, atol=1e-12)
        assert_allclose(g, model.gravity(q), rtol=0, atol=1e-12)


def test_answers_are_the_callers_own(model):
    """A later question does not change an earlier answer."""
    r = model.robot
    for ask in (model.pose, model.tip_jacobian, model.mass_matrix, model.gravity):
        first = ask(r.neutral)
        kept = first.copy()
        ask(r.ready)
        assert (first == kept).all()
    dq = np.ones(7)
    for ask in (model.coriolis, model.bias, model.tip_jacobian_rate):
        first = ask(r.neutral, dq)
        kept = first.copy()
        ask(r.ready, -dq)
        assert (first == kept).all()


BAD = [
    (np.zeros((7, 1)), ShapeError, "q has shape.*ravel"),
    (np.zeros((1, 7)), ShapeError, "q has shape.*ravel"),
    (np.zeros(6), ShapeError, "give 7 numbers, not 6"),
    (np.eye(7), ShapeError, "a matrix came where a vector belongs"),
    ("neutral", LabkitError, "q is 'neutral'"),
    (None, LabkitError, "q is None"),
    (np.full(7, np.nan), NotFinite, "q holds nan at index 0"),
]


@pytest.mark.parametrize(("q", "error", "words"), BAD)
@pytest.mark.parametrize(
    "ask",
    ["pose", "tip_jacobian", "body_jacobian", "spatial_jacobian", "mass_matrix", "gravity",
     "operational_inertia", "potential_energy", "manipulability", "within_limits"],
)  # fmt: skip
def test_bad_angles_never_reach_pinocchio(ask, q, error, words):
    """Each question refuses a wrong shape, a word, None and NaN with a sentence about q."""
    with pytest.raises(error, match=words) as caught:
        getattr(MODEL, ask)(q)
    assert isinstance(caught.value, LabkitError)


MODEL = lk.Model()


@pytest.mark.parametrize("ask", ["coriolis", "bias", "kinetic_energy", "tip_jacobian_rate"])
def test_bad_speeds_never_reach_pinocchio(ask):
    """A column of speeds is refused by name, and lists give what arrays do."""
    with pytest.raises(ShapeError, match="dq has shape"):
        getattr(MODEL, ask)(np.zeros(7), np.zeros((7, 1)))
    assert_allclose(
        getattr(MODEL, ask)([0] * 7, [0.1] * 7), getattr(MODEL, ask)(np.zeros(7), np.full(7, 0.1))
    )
