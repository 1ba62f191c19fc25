"""The loop around a servo: what it hands out, and what it measures."""

import numpy as np
import pytest

from labkit import BangBang, Line, Sample, Trajectory, se3
from labkit.course import Close
from labkit.course.serialize import decode_answer, encode
from labkit.servo import Bend, Conveyor, Hand, Memory

T_TC = se3.pose(se3.rotation([0.1, -0.2, 1.5]), [0.05, 0.02, -0.03])
T_MG = se3.pose(np.diag([1.0, -1.0, -1.0]), [0.02, -0.03, 0.2])


def ends(random):
    return [Sample(*random.normal(size=(3, 3))) for _ in range(2)]


def test_a_bend_meets_both_ends():
    """Position, velocity and acceleration at both; then the goal's velocity goes on."""
    start, goal = ends(np.random.default_rng(0))
    bend = Bend(start, goal, 0.7)
    np.testing.assert_allclose(bend(0.0), start, atol=1e-9)
    np.testing.assert_allclose(bend(0.7 - 1e-9), goal, atol=1e-6)
    np.testing.assert_allclose(bend(1.0).position, goal.position + 0.3 * goal.velocity)


def test_the_hand_of_then_brings_a_sighting_into_the_world():
    """Hand, camera and sighting give the tag's place, if all three are of the picture's time."""
    seen = []

    def servo(t, memory, sighting, hand, T_tc, T_mg):
        if sighting:
            stamp, T_cm = sighting
            seen.append(hand(stamp) @ T_tc @ T_cm - tag.tag(stamp))
        line = Trajectory(Line(hand(0.0)[:3, 3], [0.6, 0.4, 0.3]), BangBang(2.0))
        return memory._replace(line=line)

    tag = Conveyor(age=0.5, noise=0.0, duration=3.0)
    tag.follow(servo, T_TC, T_MG)
    np.testing.assert_allclose(seen, 0.0, atol=1e-9)


@pytest.mark.parametrize("last", [0, 3])
def test_a_blind_second_hides_the_tag(last):
    """One sighting is None meanwhile; of several, the latest ones that showed it stay."""
    seen = {}

    def servo(t, memory, sightings, hand, T_tc, T_mg):
        seen[round(t, 2)] = sightings
        return memory

    Conveyor(age=0.2, blind=(1.0, 2.0), duration=2.5).follow(servo, T_TC, T_MG, last)
    if last:
        assert [stamp for stamp, _ in seen[2.1]] == pytest.approx([0.7, 0.8, 0.9])
    else:
        assert seen[1.1][0] == pytest.approx(0.9)
        assert seen[0.1] is None and seen[1.3] is None and seen[2.3] is not None


def test_a_reference_that_jumps_is_measured():
    """Its largest step in place and speed, and how often it began anew."""

    def servo(t, memory, sighting, hand, T_tc, T_mg):
        still = np.zeros(3)
        rest = Sample(np.array([0.5 + 0.01 * (t > 4.0), 0.3, 0.3]), still, still)
        return Memory(memory.goal, Bend(rest, rest, 1.0), float(t > 4.0), t)

    found = Conveyor(duration=5.0).follow(servo, T_TC, T_MG).measured()
    assert found["place_step_mm"] == pytest.approx(10.0)
    assert found["speed_step"] == pytest.approx(0.0, abs=1e-12)
    assert found["lines"] == 1.0


def test_a_memory_is_plain_data():
    """It arrives whole, and two lines are the same if they move alike."""
    start, goal = ends(np.random.default_rng(1))
    memory = Memory(np.eye(4), Bend(start, goal, 0.7), 1.0, -4.0)
    again = decode_answer(encode(memory))
    assert Close()(again, memory) is None
    assert Close()(memory._replace(line=Bend(start, goal, 0.8)), memory) is not None
    line = Trajectory(Line(start.position, goal.position), BangBang(2.0))
    assert Close()(decode_answer(encode(line)), line) is None
    hand = Hand(np.array([0.0, 1.0]), np.array([[0.0, 0, 0], [1.0, 0, 0]]), np.eye(3))
    np.testing.assert_allclose(hand(0.25)[:3, 3], [0.25, 0.0, 0.0])
