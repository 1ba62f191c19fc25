"""The studies behind the pages "Going deeper"."""

from dataclasses import replace

import numpy as np
import pytest

import labkit as lk
from solutions.study import identification, image_servoing, passivity, redundancy


@pytest.mark.parametrize(("K", "B"), [(300.0, 0.0), (300.0, 50.0), (2000.0, -20.0)])
def test_passivity_takes_half_of_k_t_and_all_of_the_damper(K, B):
    """The general condition of Colgate and Schenkel gives b > K T / 2 + |B|."""
    assert passivity.least_damping(K, B, 0.005) == pytest.approx(0.0025 * K + abs(B), abs=1e-3)


def test_without_a_damper_the_passive_limit_is_the_stable_one():
    """The stiffest stable wall with B = 0 is 2 b / T, to 1 %."""
    assert passivity.stiffest(8.0, 5.0, 0.0, 0.005) == pytest.approx(2.0 * 5.0 / 0.005, rel=0.01)


def test_a_loop_that_is_not_passive_is_stable_at_a_hard_wall():
    """With 5 N s/m, less than passivity asks for, it is stable at 5e5 N/m."""
    assert passivity.least_damping(300.0, 60.0, 0.005) > 5.0
    assert passivity.is_stable(passivity.loop(8.0, 5.0, 300.0, 60.0, 0.005, 5e5))


def test_by_the_image_a_wrong_focal_length_does_no_harm_and_by_the_pose_it_does():
    """At 20 % off, the first ends within 0.5 mm and the second beyond 20 mm."""
    image, pose = (
        image_servoing.approach(method, 0.2).distance[-1]
        for method in ("image", "pose, goal measured")
    )
    assert image < 5e-4 and pose > 0.02


def test_a_posture_brings_the_elbow_back():
    """After two laps the joints are off by more than three times as much without one."""
    model = lk.Model("left")
    q0 = model.robot.ready
    free, held = (np.abs(redundancy.laps(model, q0, 2, k)[-1] - q0).max() for k in (0.0, 2.0))
    assert free > 3.0 * held


def test_the_newer_of_two_commands_makes_friction_too_small():
    """Without noise the mean of both gives the plant's 0.7 to 1 %, the newer one 0.63 at most."""
    quiet = replace(lk.BAXTER, velocity_noise=0.0, lost_ticks=0.0)
    log, model = identification.excite(quiet), lk.Model("left", quiet)
    both, newer = (identification.fit(log, model, between).viscous for between in (True, False))
    assert both == pytest.approx(np.full(7, 0.7), rel=0.01)
    assert newer[:2].max() < 0.63
