"""Paths: exact derivatives, exact ends, lengths that are true."""

import numpy as np
import pytest
from curves import assert_slopes
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose, assert_array_equal

from labkit import Circle, Line, Polyline
from labkit.paths import Spline

points = arrays(np.float64, 3, elements=st.floats(-2.0, 2.0))
fractions = st.floats(0.001, 0.999)
turns = st.floats(-3.0, 3.0).filter(lambda n: abs(n) > 0.01)


def circles():
    return st.tuples(points, points, turns).filter(
        lambda x: np.linalg.norm((x[0] - x[1])[:2]) > 0.01
    )


def measured(path, n=4001):
    p = np.array([path(s).position for s in np.linspace(0.0, 1.0, n)])
    return np.linalg.norm(np.diff(p, axis=0), axis=1).sum()


@given(points, points, fractions)
def test_a_line_has_its_slopes_and_exact_ends(a, b, s):
    """It begins exactly at its start, ends at its goal, and is as long as they are apart."""
    line = Line(a, b)
    assert_slopes(line, s)
    assert_array_equal(line(0.0).position, a)
    assert_allclose(line(1.0).position, b, rtol=0, atol=1e-15)
    assert line.length == pytest.approx(np.linalg.norm(b - a))


@given(circles(), fractions)
def test_a_circle_has_its_slopes(x, s):
    """Its velocity and acceleration in s are the slopes of its position and velocity."""
    assert_slopes(Circle(*x), s, tolerance=1e-5)


@given(circles(), fractions)
def test_a_circle_keeps_its_radius_and_its_height(x, s):
    """Each point is as far from the centre as the start is, at exactly its height."""
    start, centre, turns = x
    p = Circle(start, centre, turns)(s).position
    assert np.linalg.norm((p - centre)[:2]) == pytest.approx(np.linalg.norm((start - centre)[:2]))
    assert p[2] == start[2]


@given(points, points, st.sampled_from([-2, -1, 1, 2, 3]))
def test_a_whole_number_of_turns_returns_exactly(start, centre, turns):
    """Position and velocity at the end are those at the start to the bit."""
    assume(np.linalg.norm((start - centre)[:2]) > 1e-6)
    circle = Circle(start, centre, turns)
    assert_array_equal(circle(1.0).position, circle(0.0).position)
    assert_array_equal(circle(1.0).velocity, circle(0.0).velocity)
    assert_allclose(circle(0.0).position, start, rtol=0, atol=1e-15)


def test_a_circle_goes_counter_clockwise_seen_from_above():
    """A quarter turn from x is at y, and a negative one at -y."""
    assert_allclose(Circle([1, 0, 0], [0, 0, 0])(0.25).position, [0, 1, 0], rtol=0, atol=1e-15)
    assert_allclose(Circle([1, 0, 0], [0, 0, 5], -1)(0.25).position, [0, -1, 0], rtol=0, atol=1e-15)


@given(circles())
def test_a_circles_length_is_the_way_travelled(x):
    """4,001 points along it measure the same length to 1e-4 of it."""
    assert Circle(*x).length == pytest.approx(measured(Circle(*x)), rel=1e-4)


@pytest.mark.parametrize("corners", [[0, 1, 3], [0, 0, 1, 3], [0, 1, 3, 3]])
def test_a_rounding_error_beyond_an_end_of_a_polyline_is_no_jump(corners):
    """At 1e-15 before or after an end it is at that end, corners given twice included."""
    path = Polyline(np.array(corners)[:, None] * [1.0, 0.0, 2.0])
    for end in (0.0, 1.0):
        for s in (end - 1e-15, end + 1e-15):
            assert_allclose(path(s).position, path(end).position, rtol=0, atol=1e-12)


def test_a_polyline_passes_its_corners_in_proportion_to_the_way():
    """A corner after a quarter of its length is at s = 0.25, with the velocity of the next line."""
    path = Polyline([[0, 0, 0], [1, 0, 0], [1, 3, 0]])
    assert path.length == 4.0
    assert_allclose(path(0.25).position, [1, 0, 0])
    assert_allclose(path(0.625).position, [1, 1.5, 0])
    assert_allclose(path(0.1).velocity, [4, 0, 0])
    assert_allclose(path(0.25).velocity, [0, 4, 0])
    assert_allclose(path(1.0).position, [1, 3, 0])
    assert [line.length for line in path.lines] == [1.0, 3.0]


@given(arrays(np.float64, (4, 3), elements=st.floats(-2.0, 2.0)), fractions)
def test_a_polyline_runs_at_one_speed_and_has_its_slopes(corners, s):
    """Between its corners its speed in s is its length everywhere."""
    assume(np.linalg.norm(np.diff(corners, axis=0), axis=1).min() > 0.05)
    path = Polyline(corners)
    assume(np.abs(path._pieces[1] - s).min() > 1e-4)
    assert_slopes(path, s)
    assert np.linalg.norm(path(s).velocity) == pytest.approx(path.length)


@given(fractions)
def test_a_spline_is_smooth_and_passes_its_values(s):
    """Its slopes are right, and eleven values of sin 3s and exp s give all others to 1e-5."""
    grid = np.linspace(0.0, 1.0, 11)
    values = np.stack([np.sin(3 * grid), np.exp(grid)], axis=1)
    spline = Spline(grid, values)
    assert_slopes(spline, s)
    for x, value in zip(grid, values, strict=True):
        assert_allclose(spline(x).position, value, rtol=0, atol=1e-13)
    assert_allclose(spline(s).position, [np.sin(3 * s), np.exp(s)], rtol=0, atol=1e-5)


def test_what_a_path_was_given_may_change_later_without_harm():
    """A line keeps its own copy of the start, which is read-only."""
    start = np.zeros(3)
    line = Line(start, np.ones(3))
    start[0] = 9.0
    assert line.start[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        line.start[0] = 1.0
