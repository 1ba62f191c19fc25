"""Mistakes put into somebody's own text: one line changes, and only in a function."""

from __future__ import annotations

import ast
import inspect

import pytest
from handmade import ROOT

from labkit.course.authoring.layout import Course
from labkit.grader.defence import MOST, edits

LAW = '''import numpy as np

def law(state, target, *, kp, kd):
    """Says what it does,
    in two lines."""
    q = state.q
    e, de = (target.position-q), target.velocity - state.dq  # the errors: ü
    tau = (kp*e +
           kd*de)
    tau += model.gravity(q)
    if carried:
        return tau[0] @ R.T
    return max(tau, 0.5 * (q + de))

print(1 - 2)
'''
COURSE = Course(ROOT)
ANSWERS = [p.answer for name in COURSE.names()[:-1] for p in COURSE.problems(name)]


def test_the_mistakes_that_people_make_are_among_the_edits():
    """A sign, a term, a factor, an index, a comparison, a transpose, another function."""
    found = {(edit.at, edit.now.strip()) for edit in edits(LAW)}
    assert found >= {
        (3, "e, de = (target.position + q, target.velocity - state.dq)"),
        (4, "tau = kp * e - kd * de"),
        (4, "tau = kp * e"),
        (4, "tau = e + kd * de"),
        (5, "tau -= model.gravity(q)"),
        (7, "return tau[-1] @ R.T"),
        (7, "return tau[0] @ R"),
        (8, "return min(tau, 0.5 * (q + de))"),
        (8, "return max(tau, q + de)"),
    }


@pytest.mark.parametrize(("text", "now"), [("a[:3]", "a[3:]"), ("-a[i]", "a[i]"),
                                           ("not a", "a"), ("a <= i", "a >= i")])  # fmt: skip
def test_a_mistake_with_an_index_a_sign_or_a_comparison(text, now):
    """The other half of a vector, a sign or a not that is left out, a comparison reversed."""
    found = edits(f"def f(a, i):\n    return {text}")
    assert f"return {now}" in [edit.now.strip() for edit in found]


@pytest.mark.parametrize("text", [LAW, *map(inspect.getsource, ANSWERS)])
def test_an_edit_changes_one_line_and_leaves_python(text):
    """What stands outside of functions stays; so does each other line, without docstrings."""
    for edit in edits(text):
        assert edit.now != edit.was and ast.parse(edit.cell)
        assert '"""' not in "".join(edit.lines)
        assert "print(1 - 2)" in edit.cell or text != LAW


@pytest.mark.parametrize("text", ["", "def law(:", "x = 1 + 2", "(" * 300, "%%bash\nls", "\0"])
def test_a_text_without_functions_has_no_edits(text):
    """Nor does one that is not Python."""
    assert edits(text) == []


def test_nearly_every_answer_of_the_course_has_a_place_for_a_mistake():
    """So the functions that a student writes can be asked about."""
    assert sum(not edits(inspect.getsource(answer)) for answer in ANSWERS) < len(ANSWERS) / 20


def test_a_function_as_long_as_the_limit_allows_keeps_nobody_busy():
    """Every mistake is written out whole, so their number is bounded."""
    assert len(edits(f"def f(a):\n    return [{'a + a, ' * 1000}]")) <= MOST
