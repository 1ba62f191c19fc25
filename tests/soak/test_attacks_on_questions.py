"""Answers without work: public cases by heart, and the notebook's own stand-ins."""

from __future__ import annotations

import json
import re

import pytest
from soak.attacks.attack import code_cell
from soak.attacks.place import ROOT

from labkit.course.authoring.layout import Course
from labkit.grader.grading.batch import GradedSubmission, GradeOptions, grade_class
from labkit.grader.terms.release import release

pytestmark = pytest.mark.soak
CASES = Course(ROOT).names()

BY_HEART = """
def {name}(*args, **kwargs):
    import json
    from labkit.course import serialize as codec
    def numbers(x):
        if isinstance(x, bool) or x is None or isinstance(x, str): return []
        if isinstance(x, (int, float)): return [float(x)]
        if isinstance(x, dict): return [n for k in sorted(x) for n in numbers(x[k])]
        return [n for inner in x for n in numbers(inner)]
    def asked():
        return numbers([codec.encode(list(args)), codec.encode(dict(kwargs))])
    known = json.loads({known!r})
    mine, best, answer = asked(), None, None
    for one in known:
        theirs = numbers([one["args"], one["kwargs"]])
        off = sum(abs(a - b) for a, b in zip(mine, theirs)) + 1e9 * abs(len(mine) - len(theirs))
        if best is None or off < best: best, answer = off, one["expected"]
    found = codec.decode(answer)
    if {within}: return sum(found[0]) / 2
    return found
"""
"""Gives back what is expected on the public case that is nearest to what is asked."""


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    root = tmp_path_factory.mktemp("questions") / "course"
    root.mkdir()
    (root / "solutions").symlink_to(ROOT / "solutions")
    (root / "nbgrader_config.py").write_text((ROOT / "nbgrader_config.py").read_text())
    return root


@pytest.fixture(scope="module", params=CASES)
def graded(request, root, kept_worker):
    """What both notebooks earn, question by question, and what may be earned without work."""
    course, name = Course(root), request.param
    release(course, name, 7)
    folder = course.release / name
    notebook = (folder / f"{name}.ipynb").read_text()
    questions = json.loads((folder / "checks.json").read_text())["questions"]
    made = {
        "heart": by_heart(json.loads(notebook), questions),
        "stand-in": standing_in(json.loads(notebook)),
    }
    for who, data in made.items():
        (course.submitted / who / name).mkdir(parents=True, exist_ok=True)
        (course.submitted / who / name / f"{name}.ipynb").write_text(json.dumps(data))
    done = list(grade_class(course, name, sorted(made), GradeOptions(jobs=2)))
    assert all(isinstance(one, GradedSubmission) for one in done), done
    return {one.result.student: one.result for one in done}


def by_heart(notebook, questions):
    """Every question of which public calls are known, answered with what they expect."""
    for question in questions:
        calls = [
            c for t in question["tests"]["items"] for c in t["cases"]["items"] if c["$"] == "Call"
        ]
        if calls:
            known = [{key: call[key] for key in ("args", "kwargs", "expected")} for call in calls]
            within = question["judge"]["$"] == "Within"
            source = BY_HEART.format(name=question["name"], known=json.dumps(known), within=within)
            put(notebook, question["name"], source)
    return notebook


def standing_in(notebook):
    """Every question answered by what the notebook takes where there is no answer."""
    text = "\n".join("".join(c["source"]) for c in notebook["cells"] if c["cell_type"] == "code")
    for name, given in re.findall(r'use\(\s*"(\w+)",\s*\w+,\s*([\w.]+)', text):
        put(notebook, name, f"def {name}(*args, **kwargs):\n    return {given}(*args, **kwargs)")
    return notebook


def put(notebook, name, source):
    for k, cell in enumerate(notebook["cells"]):
        about = cell["metadata"].get("nbgrader", {})
        if about.get("grade_id") == name and about.get("solution"):
            notebook["cells"][k] = (
                cell | code_cell(source, cell["id"]) | {"metadata": cell["metadata"]}
            )


def earned(result):
    return {q.verdict.name: q.verdict.earned for q in result.questions if q.verdict.earned}


def test_public_cases_by_heart_earn_nothing(graded):
    """An answer that knows only what everybody is shown has no points."""
    assert not earned(graded["heart"])


def test_public_cases_are_known_by_heart(graded):
    """The control: on public cases alone most of those answers are right."""
    tests = [question.verdict.tests for question in graded["heart"].questions]
    asked = [each for each in tests if any(test.also for test in each)]  # a prediction hides none
    failed = [each for each in asked if any(test.hidden for test in each)]
    assert len(failed) >= len(asked) / 3


def test_stand_ins_earn_nothing(graded):
    """What replaces an answer does not count as one."""
    assert not earned(graded["stand-in"])
