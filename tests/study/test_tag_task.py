"""Following a tag as a task."""

import numpy as np
import pytest

import labkit as lk
from solutions.study import tag_task, tasks


@pytest.fixture(scope="module")
def chases():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tag_task, "DURATION", 2.5)
        return [tag_task.followed(seed) for seed in (0, 0, 1)]


def test_the_same_seed_records_the_same_reference(chases):
    """Two references of one seed are equal bit for bit, and another seed's differs."""
    a, b, c = ([x.task.target(t).pose[:3, 3] for t in np.linspace(0, 2.5, 50)] for x in chases)
    np.testing.assert_array_equal(a, b)
    assert np.abs(np.subtract(a, c)).max() > 1e-5, "another seed, other noise"


def test_the_reference_is_smooth_and_starts_at_the_ready_pose(chases):
    """From there on its velocity is the slope of its place, to 0.1 mm/s."""
    target = chases[0].task.target
    np.testing.assert_allclose(target(0.0).pose, tasks.ready_pose(), rtol=0, atol=1e-9)
    h = 1e-4
    for t in np.linspace(0.1, 2.4, 40):
        slope = (target(t + h).pose[:3, 3] - target(t - h).pose[:3, 3]) / (2 * h)
        np.testing.assert_allclose(slope, target(t).twist[:3], rtol=0, atol=1e-4)


def test_the_reference_goes_where_the_tag_goes(chases):
    """From 1 s on its mean distance is below 0.3 of the tag's motion, which exceeds 30 mm."""
    chase = chases[0]
    late = chase.t > 1.0
    tips = np.array([chase.task.target(t).pose[:3, 3] for t in chase.t[late]])
    moved = np.linalg.norm(chase.goal - chase.goal[0], axis=1).max()
    assert moved > 0.03
    assert chase.miss(chase.t[late], tips).mean() < 0.3 * moved
    np.testing.assert_allclose(chase.miss(chase.t, chase.goal), 0.0, rtol=0, atol=1e-12)


def test_its_joint_angles_take_the_tip_along(chases):
    """The pose of the joint angles is the target's to 1e-5 at 30 times."""
    model, task = lk.Model(), chases[0].task
    for t in np.linspace(0.0, 2.5, 30):
        assert np.abs(model.pose_error(task.target(t).pose, task.joints(t).position)).max() < 1e-5
