"""The report's tasks as compositions."""

import numpy as np
import pytest

import labkit as lk
from solutions.study import tasks

TASKS = [tasks.line(), tasks.circle(), tasks.square()]


@pytest.mark.parametrize("task", TASKS, ids=lambda task: task.name)
def test_position_velocity_and_acceleration_are_continuous(task):
    """Between neighbouring times nothing jumps: second derivative bounded by A_MAX."""
    times = np.linspace(-0.1, task.duration + 0.1, 4001)
    samples = [task.target(t) for t in times]
    p = np.array([s.pose[:3, 3] for s in samples])
    v = np.array([s.twist[:3] for s in samples])
    a = np.array([s.dtwist[:3] for s in samples])
    dt = times[1] - times[0]
    assert np.abs(np.diff(p, axis=0)).max() <= tasks.V_MAX * dt * 1.001
    assert np.abs(np.diff(v, axis=0)).max() <= 1.2 * tasks.A_MAX * dt
    assert np.abs(np.diff(a, axis=0)).max() < 0.02
    np.testing.assert_allclose(np.gradient(p, dt, axis=0)[2:-2], v[2:-2], rtol=0, atol=1e-5)


@pytest.mark.parametrize("task", TASKS, ids=lambda task: task.name)
def test_the_joints_take_the_tip_along_the_task(task):
    """The pose of the joint angles is the target's to 1e-7 at 60 times."""
    model = lk.Model()
    for t in np.linspace(0.0, task.duration, 60):
        assert np.abs(model.pose_error(task.target(t).pose, task.joints(t).position)).max() < 1e-7
    np.testing.assert_allclose(task.joints(0.0).position, task.q0, rtol=0, atol=1e-9)


def test_the_square_visits_current_goals_and_current_again():
    """Between its sides the tip rests in the corners of a square of 0.15 m, the first one last."""
    task = TASKS[2]
    p = task.target(0.0).pose[:3, 3]
    corners = p + np.array([(0, 0, 0), (0.15, 0, 0), (0.15, -0.15, 0), (0, -0.15, 0), (0, 0, 0)])
    for start, corner in zip([*task.target.starts, task.duration], [*corners, p], strict=True):
        sample = task.target(start)
        np.testing.assert_allclose(sample.pose[:3, 3], corner, rtol=0, atol=1e-12)
        np.testing.assert_allclose(sample.twist, 0.0, rtol=0, atol=1e-12)


def test_a_seed_means_one_start_about_a_centimetre_off():
    """Twenty seeds give twenty starts, on average between 3 and 20 mm off the path's."""
    model, task = lk.Model(), TASKS[0]
    np.testing.assert_array_equal(task.start(4), task.start(4))
    p = task.target(0.0).pose[:3, 3]
    off = [np.linalg.norm(model.pose(task.start(seed))[:3, 3] - p) for seed in range(20)]
    assert 0.003 < np.mean(off) < 0.02 and len(set(off)) == 20
