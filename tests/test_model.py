"""The model: dynamics obey their laws, and nothing ill-shaped reaches the engine."""

import numpy as np
import pytest
from curves import slope_along
from numpy.testing import assert_allclose

import labkit as lk
from labkit import se3

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


MODEL = lk.Model()


def test_inverse_dynamics_is_the_equation_of_motion(side, model, states, random):
    """M ddq + C dq + g."""
    for q, dq in states(side, 40):
        ddq = random.uniform(-5.0, 5.0, 7)
        tau = model.mass_matrix(q) @ ddq + model.coriolis(q, dq) @ dq + model.gravity(q)
        assert_allclose(model.inverse_dynamics(q, dq, ddq), tau, rtol=0, atol=1e-9)


def test_a_wrench_is_found_again_from_its_joint_torques(side, model, states):
    """tip_wrench(q, J^T F) is F, away from singularities."""
    for q, dq in states(side, 40):
        if model.nearness_to_singularity(q) > 0.02:
            F = dq[:6]
            assert_allclose(model.tip_wrench(q, model.tip_jacobian(q).T @ F), F, rtol=0, atol=1e-8)


def test_a_pose_error_is_target_minus_actual(side, model, states):
    """Following the error from the actual pose, turning in world axes, reaches the target."""
    for q, dq in states(side, 40):
        T_wt, T_wd = model.pose(q), model.pose(q + 0.2 * dq)
        e = model.pose_error(T_wd, q)
        assert_allclose(T_wt[:3, 3] + e[:3], T_wd[:3, 3], rtol=0, atol=1e-9)
        assert_allclose(se3.rotation(e[3:]) @ T_wt[:3, :3], T_wd[:3, :3], rtol=0, atol=1e-9)
