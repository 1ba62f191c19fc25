"""A contested mark: the case that decided with its numbers, and what the student may see of it."""

from __future__ import annotations

import copy
import json
import shutil

import pytest
from handmade import hand_in, put

from labkit.__main__ import main
from labkit.course.authoring.layout import Course
from labkit.errors import LabkitError, UnknownName
from labkit.grader.explain import explain

NAME = "01_curves"
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
ANSWERS = {
    "ada": SLIGHTLY_WRONG,
    "bob": "def bang_bang(t, duration):\n    return 0.0, 0.0, 0.0\n",
    "carl": "# later",
    "dan": "",
}


@pytest.fixture(scope="module")
def graded(released, _solved, tmp_path_factory):
    """A class in which each has another bang_bang; Dan's is right."""
    root = tmp_path_factory.mktemp("explain") / "course"
    course = Course(shutil.copytree(released.root, root, symlinks=True))
    for student, answer in ANSWERS.items():
        notebook = copy.deepcopy(_solved)
        hand_in(course, NAME, student, put(notebook, "bang_bang", answer) if answer else notebook)
    assert main(["grade", NAME, "--course", str(course.root)]) == 0
    return course


@pytest.mark.slow
def test_the_hidden_case_that_decided_is_laid_open(graded, capsys):
    """The call, expected and given, the answer, a page for the instructor; the rest is marked."""
    assert main(["explain", NAME, "ada", "bang_bang", "--course", str(graded.root)]) == 0
    out = capsys.readouterr().out
    shown, _, secret = out.partition("do not show it")
    assert "may be shown" in shown and "expected" not in shown
    assert "bang_bang(" in secret and "expected" in secret
    assert "1.01 if duration > 4.2" in out
    page = (graded.build / "explain/ada/bang_bang.html").read_text()
    assert "not for students" in page and " of 3 points.</strong>" in page
    whole = (graded.results / NAME / "ada.json").read_text()
    assert "not for students" not in whole, "nothing of it reaches the result"


@pytest.mark.slow
def test_no_hidden_case_is_promised_where_none_decided(graded):
    """Where a visible case decided it is said; where nothing was attempted, nothing did."""
    bob, carl = (explain(graded, NAME, student, "bang_bang") for student in ("bob", "carl"))
    assert "do not show it" not in bob + carl
    assert "decided this mark" in bob and "decided" not in carl
    assert "bang_bang: not attempted yet" in carl and "# later" in carl


@pytest.mark.slow
def test_a_test_that_changed_after_the_mark_is_told(graded, tmp_path):
    """What the answer would earn now."""
    course = Course(shutil.copytree(graded.root, tmp_path / "course", symlinks=True))
    path = course.bundle / f"{NAME}.json"
    data = json.loads(path.read_text())
    (asked,) = [question for question in data["questions"] if question["name"] == "bang_bang"]
    hidden = asked["tests"]["items"][1]["cases"]["items"][-1]
    hidden["expected"] = [0.0, 0.1, 0.0]  # so that the right answer is wrong
    path.write_text(json.dumps(data | {"hash": "0" * 64}))
    said = " ".join(explain(course, NAME, "dan", "bang_bang").split())
    assert "has changed: now it earns 0 of 3" in said
    assert "The hidden case that decided" not in said


def test_what_cannot_be_explained_is_a_sentence(course):
    """An unknown question and a student who handed in nothing are named."""
    with pytest.raises(UnknownName, match="band_bang"):
        explain(course, NAME, "ada", "band_bang")
    with pytest.raises(LabkitError, match="nothing was handed in for 01_curves"):
        explain(course, NAME, "ada", "bang_bang")
    with pytest.raises(LabkitError, match="a person marks why_slower"):
        explain(course, NAME, "ada", "why_slower")
