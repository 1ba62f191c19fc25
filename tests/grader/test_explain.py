"""A contested mark: the case that decided with its numbers, and what the student may see of it."""

from __future__ import annotations

import json

import pytest
from handmade import hand_in, put

from labkit.__main__ import main
from labkit.course.bundle import Bundle
from labkit.errors import LabkitError, UnknownName
from labkit.grader.feedback.explain import explain

NAME = "01_paths"
SLIGHTLY_WRONG = """def bang_bang(t, duration):
    if t <= 0 or t >= duration:
        return float(t > 0), 0.0, 0.0
    if t < duration / 2:
        s, ds, dds = 2 * (t / duration) ** 2, 4 * t / duration**2, 4 / duration**2
    else:
        r = duration - t
        s, ds, dds = 1 - 2 * (r / duration) ** 2, 4 * r / duration**2, -4 / duration**2
    return s, ds, dds * (1.01 if duration > 4.2 else 1.0)
"""


@pytest.mark.slow
def test_the_hidden_case_that_decided_is_laid_open(course, solved, capsys):
    """The call, expected and given, the answer and a page for the teacher; the rest is marked."""
    hand_in(course, NAME, "ada", put(solved, "bang_bang", SLIGHTLY_WRONG))
    assert main(["grade", NAME, "--course", str(course.root)]) == 0
    capsys.readouterr()
    assert main(["explain", "ada", "bang_bang", "--course", str(course.root)]) == 0
    out = capsys.readouterr().out
    shown, _, secret = out.partition("do not show it")
    assert "may be shown" in shown and "expected" not in shown
    assert "bang_bang(" in secret and "expected" in secret
    assert "1.01 if duration > 4.2" in out and "ATTENTION" not in out
    page = (course.build / "explain/ada-bang_bang.html").read_text()
    assert "not for students" in page
    whole = json.loads((course.results / NAME / "ada.json").read_text())
    assert "not for students" not in json.dumps(whole), "nothing of it reaches the result"


@pytest.mark.slow
def test_where_a_visible_case_decided_it_is_said(course, solved, capsys):
    """No hidden case is promised, and the page's head has the points of this question alone."""
    wrong = "def bang_bang(t, duration):\n    return 0.0, 0.0, 0.0\n"
    hand_in(course, NAME, "ada", put(solved, "bang_bang", wrong))
    assert main(["grade", NAME, "--course", str(course.root)]) == 0
    capsys.readouterr()
    assert main(["explain", "ada", "bang_bang", "--course", str(course.root)]) == 0
    out = capsys.readouterr().out
    assert (
        "The tests that the student has seen decided this mark" in out
        and "do not show it" not in out
    )
    page = (course.build / "explain/ada-bang_bang.html").read_text()
    (points,) = (q.points for q in Bundle.of(course, NAME).questions if q.name == "bang_bang")
    assert f" of {points:g} points.</strong>" in page


def test_what_cannot_be_explained_is_a_sentence(course):
    """A question that is none, a student who handed in nothing."""
    with pytest.raises(UnknownName, match="band_bang"):
        explain(course, "ada", "band_bang")
    with pytest.raises(LabkitError, match="nothing was handed in for 01_paths; type"):
        explain(course, "ada", "bang_bang")
