"""Any numbers can be drawn."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labkit.grader.drawing import curve, side_by_side

pytestmark = pytest.mark.filterwarnings("error")  # an overflow would reach the terminal
ODD = [0.0, 1e308, -1e308, 5e-324, -5e-324, math.inf, -math.inf, math.nan, 1.0, 1e16]
NUMBERS = st.lists(st.sampled_from(ODD) | st.floats(), max_size=5)
PLACES = {"x", "y", "d"}


def places(picture):
    """Every coordinate in a picture, but for the shapes of marks."""
    root = ET.fromstring(picture)
    marks = {path for defs in root.iter() if defs.tag.endswith("defs") for path in defs.iter()}
    texts = [e.attrib[k] for e in root.iter() if e not in marks for k in PLACES & e.attrib.keys()]
    assert not re.search("nan|inf", " ".join(texts))
    return [float(x) for text in texts for x in re.findall(r"-?[0-9.]+(?:e-?[0-9]+)?", text)]


@settings(max_examples=40)
@given(NUMBERS)
def test_numbers_side_by_side(numbers):
    """All places lie in the picture, whatever the numbers."""
    assert all(-20 <= x <= 480 for x in places(side_by_side(numbers, numbers[::-1], "words")))


@settings(max_examples=40)
@given(NUMBERS, st.none() | st.floats())
def test_a_curve_and_its_limit(numbers, limit):
    """The same over time, with a limit of any size."""
    t = [0.1 * k for k in range(len(numbers))]
    picture = curve(t, numbers, ("time", "error"), "words", limit)
    assert all(-20 <= x <= 480 for x in places(picture))


@pytest.mark.parametrize("size", [1e-299, 1e-15, 0.3, 1.0, 7.0, 1e16, 1e308])
def test_an_axis_has_some_numbers_at_any_size(size):
    """Three to nine of them on both, each a short one."""
    picture = side_by_side([0.0] * 2, [size] * 2, "words")
    found = re.findall(r">([0-9.]+)</text>", picture)
    assert 3 <= len(set(found)) <= 9 and all(len(x) <= 4 for x in found)
