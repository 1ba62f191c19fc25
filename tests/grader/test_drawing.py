"""Any numbers can be drawn."""

from __future__ import annotations

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from labkit.grader.drawing import _ticks, curve, side_by_side

ODD = [0.0, 1e308, -1e308, 5e-324, -5e-324, math.inf, -math.inf, math.nan, 1.0, 1e16]
NUMBERS = st.lists(st.sampled_from(ODD) | st.floats(), max_size=5)
PLACES = re.compile(r' (?:x|y|x1|y1|x2|y2|cx|cy)="([^"]*)"|points="([^"]*)"|d="M([^l]*)l')


def places(picture):
    """Every coordinate in a picture."""
    found = (part for match in PLACES.findall(picture) for part in match if part)
    return [float(x) for part in found for x in re.split(r"[ ,]", part)]


@given(NUMBERS)
def test_numbers_side_by_side(numbers):
    """All places lie in the picture, whatever the numbers, and none is nan."""
    picture = side_by_side(numbers, numbers[::-1], "words")
    assert all(-10 <= x <= 470 for x in places(picture))


@given(NUMBERS, st.none() | st.floats())
def test_a_curve_and_its_limit(numbers, limit):
    """The same over time, with a limit of any size."""
    t = [0.1 * k for k in range(len(numbers))]
    picture = curve(t, numbers, ("time", "error"), "words", limit)
    assert all(-10 <= x <= 470 for x in places(picture) if x >= 0 or numbers)


@pytest.mark.parametrize("size", [1e-299, 1e-15, 0.3, 1.0, 7.0, 1e16, 1e308])
def test_ticks_are_round_and_apart(size):
    """Two to seven of them, evenly spread, from one end to the other, at any size."""
    ticks = _ticks((0.0, size), 4)
    assert 2 <= len(ticks) <= 7
    assert ticks[0] == 0.0 and size / 2 <= ticks[-1] <= size * (1 + 1e-9)
    assert len({f"{x:g}" for x in ticks}) == len(ticks)
