"""Look-ups beside the loop: rate, delay, losses, waiting; the same again from the same seed."""

import numpy as np
import pytest

import labkit as lk
from labkit import se3
from labkit.errors import ControllerError, OutOfRange
from labkit.tags.stream import Estimate, first_estimate, update

EYE = lk.looking_at((3.0, 3.0, 0.7), (3.0, 3.0, 0.0), up=(1, 0, 0))


@pytest.fixture
def scene():
    with lk.World() as world:
        place = se3.pose(se3.rotation(np.array([0.1, 0.2, 0.3])), np.array([3.02, 2.97, 0.0]))
        yield lk.tags.Board(world, lk.Tag(2), place), lk.Camera(world, EYE)


def polled(lookups, seconds, every=5):
    world, found = lookups.camera.world, []
    for _ in range(round(1000 * seconds / every)):
        found += [(world.t, r) for r in lookups.poll()]
        world.step(every)
    return found


def test_a_look_tells_where_the_tag_is_in_the_world(scene):
    """It is true to 2 mm, and its height is three times as uncertain as its x."""
    board, camera = scene
    (reading,) = lk.TagStream(camera, board.tag, delay=0.0).poll()
    off = se3.pose_error(board.T_wm, reading.T_wm)
    assert np.linalg.norm(off[:3]) < 2e-3
    spread = np.sqrt(np.diag(reading.covariance))
    assert spread[2] > 3 * spread[0], "the camera looks down, so the height is worst"


def test_readings_come_at_the_rate_and_as_late_as_stated(scene):
    """At 10 Hz and 0.1 s late, nine arrive within 1 s, each just when it says so."""
    board, camera = scene
    readings = polled(lk.TagStream(camera, board.tag, rate=10, delay=0.1), 1.0)
    stamps = [r.stamp for _, r in readings]
    np.testing.assert_allclose(stamps, np.arange(9) * 0.1, rtol=0, atol=1e-9)
    for seen_at, reading in readings:
        assert seen_at == pytest.approx(reading.arrived, abs=1e-9)
        assert reading.arrived - reading.stamp == pytest.approx(0.1)


def test_a_late_reading_tells_of_the_moment_of_its_picture(scene):
    """The tag moves 20 mm while the reading is under way; the reading does not know it."""
    board, camera = scene
    start = board.T_wm[:3, 3]
    board.move(
        lk.Trajectory(lk.Line(start, start + np.array([0.2, 0, 0])), lk.Trapezoid(0.2, 0.1, 100.0))
    )
    (_, reading), *_ = polled(lk.TagStream(camera, board.tag, rate=1, delay=0.2), 0.3)
    assert abs(reading.T_wm[0, 3] - start[0]) < 2e-3


def test_losses_are_the_stated_share_and_repeat_with_the_seed(scene):
    """Of 57 pictures 15 % to 45 % are lost for a share of 30 %; another seed loses others."""
    board, camera = scene

    def arrivals(seed):
        lookups = lk.TagStream(camera, board.tag, rate=50, delay=0.05, dropout=0.3, seed=seed)
        times = [t for t, _ in polled(lookups, 1.2, every=10)]
        return np.round(np.array(times) - times[0], 6)

    first, again, other = arrivals(1), arrivals(1), arrivals(2)
    assert 0.15 < 1.0 - len(first) / 57 < 0.45, "57 pictures are old enough to have arrived"
    np.testing.assert_array_equal(first, again)
    assert first.shape != other.shape or (first != other).any()


def test_a_tag_out_of_view_gives_no_reading_and_no_error(scene):
    """After 0.5 s the stream has counted five pictures without the tag."""
    board, camera = scene
    board.place(se3.pose(np.eye(3), np.array([8.0, 8.0, 0.0])))
    lookups = lk.TagStream(camera, board.tag)
    assert polled(lookups, 0.5) == []
    assert lookups.unseen == 5


def test_two_boards_with_one_number_stop_the_run_with_a_sentence(scene):
    """The run ends with the number and how often the picture has it."""
    board, camera = scene
    lk.tags.Board(board.world, lk.Tag(2), se3.pose(np.eye(3), np.array([3.0, 3.2, 0.0])))
    with lk.Arm("left", world=board.world) as arm:
        pose = arm.model.pose(arm.truth().q)

        def follower(t, readings):
            return lk.PoseSample(pose, np.zeros(6), np.zeros(6))

        target = lk.TagTarget(lk.TagStream(camera, board.tag), follower)
        with pytest.raises(ControllerError, match="tag 2 is in the picture 2 times"):
            lk.run(arm, target, lambda s, _: lk.JointVelocity(np.zeros(7)), duration=0.1)


def test_a_follower_counts_its_times_from_the_start_of_the_run(scene):
    """Stamp and arrival begin at 0 though the world has run for 0.3 s."""
    board, camera = scene
    board.world.step(300)
    got = []

    def follower(t, readings):
        got.extend((t, r.stamp, r.arrived) for r in readings)
        return lk.Sample(np.zeros(7), np.zeros(7), np.zeros(7))

    target = lk.TagTarget(lk.TagStream(camera, board.tag, delay=0.05), follower)
    for k in range(40):
        target(k * 0.005)
        board.world.step(5)
    np.testing.assert_allclose(got, [[0.05, 0, 0.05], [0.15, 0.1, 0.15]], rtol=0, atol=1e-9)


def test_dials_out_of_range_are_refused(scene):
    """A rate of 0, a negative delay and a share of 2 are each named."""
    board, camera = scene
    for options, says in (
        ({"rate": 0}, "rate"),
        ({"delay": -1}, "delay"),
        ({"dropout": 2}, "share"),
    ):
        with pytest.raises(OutOfRange, match=says):
            lk.TagStream(camera, board.tag, **options)


def test_a_reading_moves_the_estimate_as_the_information_says():
    """P'^-1 = P^-1 + H^T R^-1 H, and the mean is weighed accordingly."""
    random = np.random.default_rng(2)
    A, B = random.standard_normal((6, 6)), random.standard_normal((3, 3))
    P, R = A @ A.T + np.eye(6), B @ B.T + np.eye(3)
    m, z, H = random.standard_normal(6), random.standard_normal(3), np.eye(3, 6)
    after = update(Estimate(1.0, m, P), z, R)
    information = np.linalg.inv(P) + H.T @ np.linalg.inv(R) @ H
    np.testing.assert_allclose(np.linalg.inv(after.covariance), information, rtol=1e-8)
    weighed = np.linalg.solve(information, np.linalg.inv(P) @ m + H.T @ np.linalg.inv(R) @ z)
    np.testing.assert_allclose(after.mean, weighed, rtol=1e-8)
    assert after.t == 1.0


def test_the_first_reading_says_nothing_about_the_speed():
    """The first speed is zero with the given deviation, and the place is the reading's."""
    first = first_estimate(2.0, [1.0, 2.0, 3.0], 1e-6 * np.eye(3), 0.2)
    np.testing.assert_array_equal(first.mean, [1, 2, 3, 0, 0, 0])
    np.testing.assert_allclose(np.diag(first.covariance), [1e-6] * 3 + [0.04] * 3)
