"""Time scalings: slopes, rest outside, limits kept."""

import numpy as np
import pytest
from curves import assert_slopes
from hypothesis import assume, given
from hypothesis import strategies as st

from labkit import BangBang, Circle, Cubic, Quintic, Trapezoid

PROFILES = (BangBang, Cubic, Quintic)
durations = st.floats(0.1, 20.0)
fractions = st.floats(0.01, 0.99)
lengths, speeds = st.floats(1e-4, 10.0), st.floats(0.05, 4.0)
scalings = st.one_of(
    st.builds(lambda kind, T: kind(T), st.sampled_from(PROFILES), durations),
    st.builds(Trapezoid, lengths, speeds, speeds),
)


def corners(s):
    """Where the acceleration jumps."""
    if isinstance(s, Trapezoid):
        ramp = s.peak_speed / s.a_max
        return [0.0, ramp, s.duration - ramp, s.duration]
    return [0.0, s.duration / 2, s.duration]


@given(scalings, fractions)
def test_speed_and_acceleration_are_the_slopes(s, x):
    """Away from where the acceleration jumps, each profile's derivatives are its slopes."""
    T = s.duration
    assume(all(abs(x * T - c) > 1e-4 * T for c in corners(s)))
    assert_slopes(s, x * T, step=1e-5 * T)


@given(scalings, st.floats(0.0, 1e6))
def test_before_the_start_and_from_the_end_on_it_is_at_rest(s, t):
    """It is exactly 0 before and exactly 1 after, with no speed and no acceleration."""
    assert s(-1e-9 - t) == (0.0, 0.0, 0.0)
    assert s(s.duration + t) == (1.0, 0.0, 0.0)


@given(scalings)
def test_it_starts_at_0_ends_at_1_and_both_at_rest(s):
    """It begins exactly so, and just before its end it is there to 1e-8 with a speed near zero."""
    T = s.duration
    assert s(0.0)[:2] == (0.0, 0.0)
    near = s(T * (1 - 1e-12))
    assert near[0] == pytest.approx(1.0, abs=1e-8)
    assert near[1] * T == pytest.approx(0.0, abs=1e-6)


@given(scalings)
def test_it_never_goes_back(s):
    """At 301 times it never falls, its speed is never negative, and it never exceeds 1."""
    values = np.array([s(t) for t in np.linspace(0.0, s.duration, 301)])
    assert (np.diff(values[:, 0]) >= -1e-15).all()
    assert (values[:, 1] >= 0.0).all()
    assert values[:, 0].max() <= 1.0


@given(scalings, fractions)
def test_it_is_as_quick_after_as_before_the_middle(s, x):
    """What is done at x is left at 1 - x, and the speeds there are equal."""
    T = s.duration
    a, b = s(x * T), s((1.0 - x) * T)
    assert a[0] + b[0] == pytest.approx(1.0, abs=1e-9)
    assert a[1] * T == pytest.approx(b[1] * T, abs=1e-7)


@pytest.mark.parametrize("kind", PROFILES)
def test_a_duration_of_zero_is_already_there_and_never_nan(kind):
    """From t = 0 on it is 1 at rest, and no distance within limits takes no time."""
    s = kind(0.0)
    assert s(0.0) == s(1.0) == (1.0, 0.0, 0.0)
    assert s(-1.0) == (0.0, 0.0, 0.0)
    assert kind.within(0.0, 1.0, 1.0).duration == 0.0


def test_no_distance_takes_the_trapezoid_no_time():
    """Its duration is 0, and at t = 0 it is 1 at rest."""
    s = Trapezoid(0.0, 1.0, 1.0)
    assert s.duration == 0.0
    assert s(0.0) == (1.0, 0.0, 0.0)


@pytest.mark.parametrize("kind", PROFILES)
def test_the_peaks_are_what_they_are_said_to_be(kind):
    """The largest speed and acceleration over 1 s are the two constants of its class."""
    rows = np.array([kind(1.0)(t) for t in np.linspace(0.0, 1.0 - 1e-12, 20001)])
    assert rows[:, 1].max() == pytest.approx(kind.PEAK_SPEED, rel=1e-6)
    assert np.abs(rows[:, 2]).max() == pytest.approx(kind.PEAK_ACCELERATION, rel=1e-6)


@given(st.sampled_from(PROFILES), lengths, speeds, speeds)
def test_the_quickest_within_limits_touches_one_and_passes_none(kind, d, v, a):
    """Speed or acceleration, whichever is nearer to its limit, meets it to 1e-4."""
    s = kind.within(d, v, a)
    rows = np.array([s(t) for t in np.linspace(0.0, s.duration * (1 - 1e-12), 2001)])
    fast, hard = d * rows[:, 1].max() / v, d * np.abs(rows[:, 2]).max() / a
    assert max(fast, hard) <= 1.0 + 1e-9
    assert max(fast, hard) >= 1.0 - 1e-4


@given(lengths, speeds, speeds)
def test_the_trapezoid_keeps_its_limits_and_is_the_quickest_that_does(d, v, a):
    """It passes neither limit, and no other profile within them takes less time."""
    s = Trapezoid(d, v, a)
    rows = np.array([s(t) for t in np.linspace(0.0, s.duration * (1 - 1e-12), 1001)])
    assert d * rows[:, 1].max() <= v * (1 + 1e-9)
    assert d * np.abs(rows[:, 2]).max() <= a * (1 + 1e-9)
    for kind in PROFILES:
        assert s.duration <= kind.within(d, v, a).duration * (1 + 1e-9)


@given(lengths, speeds, speeds)
def test_a_way_too_short_to_cruise_is_a_triangle(d, v, a):
    """Below v^2/a it peaks at sqrt(d a) and lasts as long as bang-bang; above, it peaks at v."""
    s = Trapezoid(d, v, a)
    if d < v * v / a:
        assert s.peak_speed == pytest.approx(np.sqrt(d * a))
        assert s.duration == pytest.approx(BangBang.within(d, 1e9, a).duration)
    else:
        assert s.peak_speed == v


def test_a_scaling_is_a_value():
    """Equal kind and duration are equal with equal hashes, and the duration cannot be changed."""
    assert Cubic(2.0) == Cubic(2)
    assert hash(Cubic(2.0)) == hash(Cubic(2.0))
    assert Cubic(2.0) != Quintic(2.0)
    with pytest.raises(AttributeError):
        Cubic(2.0).duration = 3.0


def test_numbers_of_any_kind_are_kept_as_floats():
    """An array without a dimension, such as the sum of one, is a number too."""
    one = np.array(1)
    kept = vars(Trapezoid(one, one, 2)), {"turns": Circle([1, 0, 0], [0, 0, 0], one).turns}
    assert {type(x) for values in kept for x in values.values()} == {float}
