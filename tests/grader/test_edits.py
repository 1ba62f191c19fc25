"""Mistakes put into somebody's own text: one line changes, and only in a function."""

from __future__ import annotations

import ast
import inspect

import pytest
from handmade import ROOT

from labkit.course.layout import Course
from labkit.grader.defence.edits import edits, shown

LAW = '''import numpy as np

def law(state, target, *, kp, kd):
    """Says what it does,
    in two lines."""
    q = state.q
    e, de = (target.position - q), target.velocity - state.dq  # the errors: ü
    tau = kp * e + kd * de
    tau += model.gravity(q)
    if carried:
        return tau[0] @ R.T
    return max(tau, 0.5 * (q + de))

print(1 - 2)
'''


def test_the_mistakes_that_people_make_are_among_the_edits():
    """A sign, an order, a term, a factor, an index, a condition, a transpose, another function."""
    found = {(edit.line, edit.now.strip()) for edit in edits(LAW)}
    errors = "target.velocity - state.dq  # the errors: ü"
    assert found >= {
        (7, f"e, de = (q - target.position), {errors}"),
        (7, "e, de = (target.position - q), -state.dq  # the errors: ü"),
        (8, "tau = kp * e - kd * de"),
        (8, "tau = kp * e"),
        (8, "tau = e + kd * de"),
        (9, "tau -= model.gravity(q)"),
        (10, "if not carried:"),
        (11, "return tau[-1] @ R.T"),
        (11, "return tau[0] @ R"),
        (12, "return min(tau, 0.5 * (q + de))"),
        (12, "return max(tau, (q + de))"),
    }


def test_an_edit_changes_one_line_of_a_function_and_leaves_python():
    """What stands outside of functions stays, whatever it is."""
    for edit in edits(LAW):
        lines = edit.put_into(LAW).split("\n")
        differ = [k for k, pair in enumerate(zip(LAW.split("\n"), lines, strict=True), 1)
                  if pair[0] != pair[1]]  # fmt: skip
        assert differ == [edit.line]
        assert 6 <= edit.line <= 12
        ast.parse("\n".join(lines))


def test_the_functions_are_shown_without_their_docstrings():
    """Line for line, and nothing of what stands around them."""
    assert shown(LAW) == [3, *range(6, 13)]


@pytest.mark.parametrize("text", ["", "def law(:", "x = 1 + 2", "(" * 300, "%%bash\nls", "\0"])
def test_a_text_without_functions_has_no_edits(text):
    """Nor does one that is not Python."""
    assert edits(text) == [] and shown(text) == []


def test_almost_every_answer_of_the_course_has_a_place_for_a_mistake():
    """Of all questions that ask for a function, at most two have none."""
    course = Course(ROOT)
    texts = [inspect.getsource(p.answer) for name in course.names()[:-1]
             for p in course.problems(name)]  # fmt: skip
    assert sum(not edits(text) for text in texts) <= 2
