"""Following a tag: predictor, blend, and the closed loop after a circling board."""

import numpy as np
import pytest

import labkit as lk
from labkit.tags.stream import Reading
from solutions.study.tag_scenes import RADIUS, SPEED, circling_board
from solutions.study.visual_servoing import SequentialServoing
from solutions.study.workspace_velocity import WorkspaceVelocityPD
from solutions.tags.following import TagFollower, carry_forward

GENTLE = SPEED**2 / RADIUS  # what the board itself needs, in [m/s^2]


def sample(*rows):
    return lk.Sample(*(np.array(row, dtype=float) for row in rows))


def test_two_half_steps_of_prediction_are_one_whole_step():
    """Mean and covariance after 0.1 s and 0.2 s are those after 0.3 s."""
    random = np.random.default_rng(0)
    m, A = random.standard_normal(6), random.standard_normal((6, 6))
    whole = carry_forward(m, A @ A.T, 0.3, 0.7)
    half = carry_forward(*carry_forward(m, A @ A.T, 0.1, 0.7), 0.2, 0.7)
    for a, b in zip(whole, half, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-12)


def test_the_age_of_a_picture_counts():
    """At 0.1 m/s and 100 ms the tag is 10 mm further."""
    mean, _ = carry_forward([0, 0, 0, 0.1, 0, 0], np.eye(6), 0.1, 0.0)
    np.testing.assert_allclose(mean, [0.01, 0, 0, 0.1, 0, 0])


@pytest.mark.parametrize(("lost", "least"), [(0.0, 5.0), (0.3, 10.0)])
def test_a_tag_on_a_circle_is_followed_whichever_readings_are_lost(lost, least):
    """60 mm at up to 0.11 m/s, readings 0.1 s old: 5 mm RMS, 10 mm with 30 % lost, gently."""
    goal = lk.Trajectory(lk.Circle([0.06, 0, 0], [0, 0, 0]), lk.Quintic(6.5))
    times = np.arange(0.0, 8.0, 0.01)
    for seed in range(5):
        random, off = np.random.default_rng(seed), []
        guide = TagFollower(lk.se3.pose(np.eye(3), goal(0.0).position), np.zeros(3))
        for k, t in enumerate(times):
            stamp, readings = t - 0.1, ()
            if k % 10 == 0 and stamp >= 0.0 and random.random() >= lost:
                seen = goal(stamp).position + 2e-4 * random.standard_normal(3)
                T = lk.se3.pose(np.eye(3), seen)
                readings = (Reading(stamp, t, T, 4e-8 * np.eye(6)),)
            here = guide(t, readings)
            off.append(here.pose[:3, 3] - goal(t).position)
            assert np.linalg.norm(here.dtwist[:3]) <= 1.01 * guide.acceleration
        assert 1e3 * lk.metrics.rms(np.array(off)[times >= 2.0]) < least


class Watched(TagFollower):
    """A follower that writes down by how much each update makes its reference jump."""

    def __post_init__(self):
        super().__post_init__()
        self.jumps = []

    def __call__(self, t, readings):
        before = self._reference(t)
        sample = super().__call__(t, readings)
        after = (sample.pose[:3, 3], sample.twist[:3])
        self.jumps.append(max(np.abs(x - y).max() for x, y in zip(before, after, strict=False)))
        return sample


def followed(duration, plant=lk.IDEAL, noise=0.0, follower=Watched, **dials):
    scene = circling_board(plant, noise)
    lookups = lk.TagStream(scene.camera, scene.board.tag, **{"rate": 10, "delay": 0.1} | dials)
    guide = follower(scene.T_wt, scene.offset)
    controller = WorkspaceVelocityPD(scene.arm.model)
    log = lk.run(scene.arm, lk.TagTarget(lookups, guide), controller, duration=duration)
    error = np.linalg.norm(scene.error(log), axis=1)
    scene.arm.close()
    return log, error, guide, lookups


@pytest.mark.slow
def test_a_circling_board_is_followed_within_two_millimetres():
    """0.15 m and 0.1 m/s for 20 s, 10 Hz, 100 ms late: within 2 mm, gently once caught up."""
    log, error, guide, lookups = followed(20.0)
    settled = log.t >= 5.0
    rms = 1e3 * np.sqrt(np.mean(error[settled] ** 2))
    acceleration = np.linalg.norm(log.target.dtwist[:, :3], axis=1)
    peak = acceleration[settled].max()
    print(f"RMS {rms:.2f} mm, peak {peak / GENTLE:.2f} v^2/R, jump {max(guide.jumps):.1e}")
    assert lookups.unseen <= 0.02 * 200, "of 10 pictures a second for 20 s"
    assert rms <= 2.0
    assert peak <= 3.0 * GENTLE and acceleration.max() <= guide.acceleration
    assert max(guide.jumps) <= 1e-9


def test_a_tag_lost_for_two_seconds_is_coasted_after_held_and_found_again():
    """The reference comes to rest within a second of the last picture, no jump, no limit passed."""

    class Blind(Watched):
        def __call__(self, t, readings):
            return super().__call__(t, [r for r in readings if not 4.0 <= r.stamp < 6.0])

    log, error, guide, _ = followed(12.0, follower=Blind)
    speed = np.linalg.norm(log.target.twist[:, :3], axis=1)
    assert speed[(log.t > 3.0) & (log.t < 4.0)].min() > 0.05
    assert speed[(log.t > 5.5) & (log.t < 6.05)].max() < 1e-9, "holds"
    assert error[log.t > 10.0].max() < 0.015, "recovers"
    assert max(guide.jumps) <= 1e-9
    robot = lk.robot("left")
    assert (log.q >= robot.lower).all() and (log.q <= robot.upper).all()
    assert (np.abs(log.dq) <= robot.speed).all() and not log.saturated.any()


def test_algorithm_1_jumps_and_lags_where_the_continuous_reference_does_not():
    """Looking every 5 s, each answer 1.2 s late, each line from rest."""
    scene = circling_board()
    lookups = lk.TagStream(scene.camera, scene.board.tag, rate=0.2, delay=1.2)
    servoing = SequentialServoing(scene.T_wt, scene.offset)
    controller = WorkspaceVelocityPD(scene.arm.model)
    log = lk.run(scene.arm, lk.TagTarget(lookups, servoing), controller, duration=12.0)
    error = np.linalg.norm(scene.error(log), axis=1)
    scene.arm.close()
    assert 1e3 * np.sqrt(np.mean(error[log.t >= 5.0] ** 2)) > 100.0
