"""The demo fails, and says why, where it could not grade or a mark is not what was deserved."""

from __future__ import annotations

import json
from subprocess import CompletedProcess

import demo
import pytest

from labkit.course.verdict import Outcome, Verdict
from labkit.grader.grading.results import Answer, Result, Results


@pytest.fixture
def steps(monkeypatch, tmp_path):
    """What the demo runs, none of it in earnest; by word of the command, how it ends."""
    ends, ran = {}, []

    def run(command, **options):
        words = " ".join(map(str, command))
        ran.append(words)
        code = next((code for word, code in ends.items() if word in words), 0)
        return CompletedProcess(command, code, stdout="[FAIL] bubblewrap: missing")

    monkeypatch.setattr(demo.subprocess, "run", run)
    monkeypatch.setattr(demo, "set_up", lambda: None)
    return ends, ran


def test_a_demo_that_went_well_ends_with_0(steps):
    """Every step is run, the comparison of marks among them."""
    assert demo.main([]) == 0
    for word in (
        "release",
        "tests.synthetic",
        "grade 01_paths",
        "--compare",
        "feedback",
        "build_book",
    ):
        assert any(word in words for words in steps[1])


def test_a_machine_that_cannot_grade_fails_the_demo(steps, capsys):
    """Without a sandbox the book is built, and then the demo fails with what doctor says."""
    ends, ran = steps
    ends["doctor"] = 1
    assert demo.main([]) == 1
    assert "bubblewrap: missing" in capsys.readouterr().err
    assert any("build_book" in words for words in ran)
    assert not any("grade 01_paths" in words for words in ran)


@pytest.mark.parametrize("step", ["grade 01_paths", "--compare", "class-report", "build_book"])
def test_a_step_that_fails_fails_the_demo(step, steps, capsys):
    """Nothing comes after it, and it is named."""
    ends, ran = steps
    ends[step] = 1
    assert demo.main([]) == 1
    assert step in ran[-1]
    assert "failed" in capsys.readouterr().err


def test_a_mark_that_is_not_deserved_is_named(monkeypatch, tmp_path, capsys):
    """A missing result or another mark is said with the student's name; else all is well."""
    monkeypatch.setattr(demo, "DEMO", tmp_path)
    course = demo.Course(tmp_path)
    deserved = {"kind": "perfect", "rejected": False, "questions": {"circle": 4.0}}
    expected = course.build.parent / "class" / "01_paths.json"
    expected.parent.mkdir(parents=True)
    expected.write_text(json.dumps({"ada": deserved}))
    assert demo.main(["--compare"]) == 1
    assert "ada (perfect) has no result" in capsys.readouterr().out
    for earned, code in ((3.0, 1), (4.0, 0)):
        answer = Answer(Verdict("circle", Outcome.WRONG, earned, 4.0))
        result = Result("01_paths", "ada", earned, 4.0, 1, {}, questions=(answer,))
        monkeypatch.setattr(Results, "get", lambda self, student, result=result: result)
        assert demo.main(["--compare"]) == code
