"""Films of a run."""

import numpy as np
import pytest

import labkit as lk
from labkit.tags.camera import looking_at
from labkit.tags.intrinsics import Intrinsics
from solutions.study import film, tasks

LENS = Intrinsics(width=192, height=144, fx=160.0, fy=160.0)


@pytest.fixture(scope="module")
def log():
    task = tasks.line()
    with lk.Arm(q0=task.q0) as arm:
        return lk.run(arm, task.joints, forward, duration=1.0)


def forward(state, target):
    return lk.JointVelocity(target.velocity)


def test_the_film_shows_the_arm_move_and_where_the_target_went(log):
    """Pictures differ, and the last has the target's colour where the target is seen."""
    first, second, _, last = film.frames(log, 4.0, lens=LENS)
    assert first.shape == (144, 192, 3)
    assert np.abs(last.astype(int) - second).sum() > 10_000, "something moved"
    T_wc = looking_at(film.EYE, film.AT)
    at = lk.metrics.target_poses(log)[log.t <= 0.75][-1][:3, 3]
    seen = T_wc[:3, :3].T @ (at - T_wc[:3, 3])
    u, v = np.round(seen[:2] / seen[2] * 160.0 + (LENS.cx, LENS.cy)).astype(int)
    np.testing.assert_array_equal(last[v, u], (30, 90, 220))


def test_a_film_and_its_poster_are_written(log, tmp_path):
    """Both have 192 x 144 pixels; of a second at 4 Hz the film has four pictures."""
    import imageio.v3 as imageio

    poster = film.film(log, tmp_path / "line.mp4", 4.0, lens=LENS)
    assert imageio.imread(poster).shape == (144, 192, 3)
    assert imageio.imread(tmp_path / "line.mp4").shape == (4, 144, 192, 3)


def test_a_run_without_duration_makes_no_film(log):
    """A log of one row is refused, because it has no duration."""
    from dataclasses import replace

    with pytest.raises(lk.LabkitError, match="this log has no duration"):
        film.frames(replace(log, t=log.t[:1]))
