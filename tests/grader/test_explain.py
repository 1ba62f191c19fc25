"""A contested mark: the case that decided with its numbers, and what the student may see of it."""

from __future__ import annotations

import json

import pytest
from handmade import hand_in, put

from labkit.__main__ import main
from labkit.course.authoring.bundle import Bundle
from labkit.errors import LabkitError, UnknownName
from labkit.grader.explain import explain
from labkit.grader.release import release

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


@pytest.mark.slow
def test_the_hidden_case_that_decided_is_laid_open(course, solved, capsys):
    """The call, expected and given, the answer, a page for the instructor; the rest is marked."""
    hand_in(course, NAME, "ada", put(solved, "bang_bang", SLIGHTLY_WRONG))
    assert main(["grade", NAME, "--course", str(course.root)]) == 0
    capsys.readouterr()
    assert main(["explain", NAME, "ada", "bang_bang", "--course", str(course.root)]) == 0
    out = capsys.readouterr().out
    shown, _, secret = out.partition("do not show it")
    assert "may be shown" in shown and "expected" not in shown
    assert "bang_bang(" in secret and "expected" in secret
    assert "1.01 if duration > 4.2" in out and "ATTENTION" not in out
    page = (course.build / "explain/ada/bang_bang.html").read_text()
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
    assert main(["explain", NAME, "ada", "bang_bang", "--course", str(course.root)]) == 0
    out = capsys.readouterr().out
    assert (
        "The tests that the student has seen decided this mark" in out
        and "do not show it" not in out
    )
    page = (course.build / "explain/ada/bang_bang.html").read_text()
    (points,) = (q.points for q in Bundle.of(course, NAME).questions if q.name == "bang_bang")
    assert f" of {points:g} points.</strong>" in page


@pytest.mark.slow
def test_a_mark_that_was_kept_after_a_test_changed_is_told_as_kept(course, solved, capsys):
    """What the answer would earn now, and what to type if that is to count."""
    words = [NAME, "--course", str(course.root)]
    hand_in(course, NAME, "ada", solved)
    assert main(["grade", *words]) == 0
    path = course.bundle / f"{NAME}.json"
    data = json.loads(path.read_text())
    (first_one,) = [question for question in data["questions"] if question["name"] == "bang_bang"]
    hidden = first_one["tests"]["items"][1]["cases"]["items"][-1]
    hidden["expected"] = [0.0, 0.1, 0.0]  # so that the right answer is wrong
    path.write_text(json.dumps(data | {"hash": "0" * 64}))
    assert main(["grade", *words]) == 0
    assert "kept; --lower lets the mark fall" in capsys.readouterr().out
    assert main(["explain", NAME, "ada", "bang_bang", *words[1:]]) == 0
    said = " ".join(capsys.readouterr().out.split())
    earns = "has changed: now it earns 0 of 3"
    assert f"Since this mark was made, the release or labkit {earns}" in said
    assert "The hidden case that decided" not in said


@pytest.mark.slow
def test_an_answer_that_python_cannot_read_is_shown_with_the_error_at_its_line(
    course, solved, capsys
):
    """The student's text is in the terminal, on the page and in formgrader, once."""
    broken = "def bang_bang(t, duration):\n    return (t / duration\n    print(t)\n"
    hand_in(course, NAME, "ada", put(solved, "bang_bang", broken))
    assert main(["grade", NAME, "--course", str(course.root)]) == 0
    capsys.readouterr()
    assert main(["explain", NAME, "ada", "bang_bang", "--course", str(course.root)]) == 0
    said = capsys.readouterr().out
    assert "    return (t / duration  <-- line 2: '(' was never closed\n    print(t)" in said
    written = course.root / "autograded/ada" / NAME / f"{NAME}.ipynb"
    texts = ["".join(cell["source"]) for cell in json.loads(written.read_text())["cells"]]
    assert sum("return (t / duration" in text for text in texts) == 1


def test_what_cannot_be_explained_is_a_sentence(course):
    """An unknown question and a student who handed in nothing are named."""
    with pytest.raises(UnknownName, match="band_bang"):
        explain(course, NAME, "ada", "band_bang")
    with pytest.raises(LabkitError, match="nothing was handed in for 01_curves; type"):
        explain(course, NAME, "ada", "bang_bang")


@pytest.mark.slow
def test_nothing_is_promised_where_nothing_was_attempted(course, capsys):
    """No case decided it, neither a hidden one nor one that the student has seen."""
    release(course, "02_essays", 7)
    path = course.release / "02_essays/02_essays.ipynb"
    hand_in(course, "02_essays", "ada", path.read_bytes())
    words = ["--course", str(course.root)]
    assert main(["grade", "02_essays", *words]) == 0
    capsys.readouterr()
    assert main(["explain", "02_essays", "ada", "my_payload", *words]) == 0
    said = capsys.readouterr().out
    assert "with any numbers and runs, for you only" in said, "there are none"
    assert "my_payload: not attempted yet" in said and "The answer:\nmy_payload = None" in said
    assert "decided" not in said
