"""`labkit grade --watch`: what comes in is graded as it comes."""

from __future__ import annotations

import json

import pytest
from handmade import hand_in
from made import NAME, notebook_of, result_of

from labkit.__main__ import main
from labkit.course.authoring.bundle import Bundle
from labkit.course.own_arm import Arms
from labkit.grader.each import Failure
from labkit.grader.grading import batch, worker
from labkit.grader.grading.batch import GradeOptions, watch
from labkit.grader.sandbox.limits import Limits
from labkit.grader.students.arms import give_arms
from labkit.grader.students.roster import Roster, Student
from labkit.grader.submission import Submission


@pytest.fixture
def tasks(monkeypatch):
    """Whom each look has graded, with results made by hand."""
    tasks = []

    def graded(pool, course, bundle, submissions, options):
        tasks.append([x.student for x in submissions])
        return (result_of(course, x.student, data=x.read()[0]) for x in submissions)

    monkeypatch.setattr(batch, "_graded", graded)
    return tasks


def test_each_notebook_is_graded_once_as_it_comes(course, tasks):
    """One that was there and those that come later are graded; so is what is handed in again."""
    hand_in(course, NAME, "ada", notebook_of("ada"))
    queue = watch(course, NAME, GradeOptions(), pause=0.01)
    assert next(queue).result.student == "ada"
    hand_in(course, NAME, "bob", notebook_of("bob"))
    assert next(queue).result.student == "bob"
    hand_in(course, NAME, "ada", notebook_of("another of ada"))
    assert next(queue).result.student == "ada"
    queue.close()
    assert [one for one in tasks if one] == [["ada"], ["bob"], ["ada"]]


def test_a_new_release_grades_everybody_again(course, tasks):
    """Also arms that are given out: what a submission is held against is looked at each time."""
    hand_in(course, NAME, "ada", notebook_of("ada"))
    queue = watch(course, NAME, GradeOptions(), pause=0.01)
    assert next(queue).result.student == "ada"
    bundle = course.bundle / f"{NAME}.json"
    bundle.write_text(json.dumps(json.loads(bundle.read_text()) | {"hash": "0" * 64}))
    hand_in(course, NAME, "bob", notebook_of("bob"))
    assert {next(queue).result.student, next(queue).result.student} == {"ada", "bob"}
    queue.close()
    assert [one for one in tasks if one] == [["ada"], ["ada", "bob"]]


def test_a_failure_is_named_as_it_happens(course, monkeypatch, capsys):
    """While it is watching, and not only after Ctrl-C; so is a folder whose name is not allowed."""
    said = []

    def failing(*_):
        yield Failure("ada", "memory ran out")
        said.append(capsys.readouterr().err)
        raise KeyboardInterrupt

    hand_in(course, NAME, "<b>", notebook_of("b"))
    monkeypatch.setattr(batch, "watch", failing)
    assert main(["grade", NAME, "--watch", "--course", str(course.root)]) == 130
    assert "not graded: '<b>': a folder in submitted/ has this name" in said[0]
    assert "not graded: ada: memory ran out\n" in said[0]
    assert "not graded" not in capsys.readouterr().err


@pytest.mark.parametrize("words", [["--student", "ada"], ["--again"], ["--diff"]])
def test_what_watching_would_ignore_is_refused(course, words, capsys):
    """--student, --again and --diff end with exit code 2 and the advice to leave out --watch."""
    assert main(["grade", NAME, "--watch", *words, "--course", str(course.root)]) == 2
    assert f"for {words[0]} leave out --watch" in capsys.readouterr().err


def test_a_worker_knows_arms_that_are_given_out_later(course, monkeypatch):
    """It keeps the bundle for many submissions, but not with arms of an earlier roster."""
    known = []

    def graded(data, student, bundle, *_):
        known.append(bundle.arms.arm(student))
        return result_of(course, student, data=data)

    monkeypatch.setattr(worker, "grade", graded)
    monkeypatch.setattr(worker, "in_sandbox", lambda do, *_, **__: do(None))
    hand_in(course, NAME, "ada", notebook_of("ada"))
    one, key = Submission.of(course, NAME, "ada"), Bundle.of(course, NAME).data["hash"]
    task = worker.Task(course, one, key, True, Limits())
    for _ in range(2):
        worker._grade(task, task.limits)
        give_arms(course, Roster((Student("ada", "Ada"),)), 7)
    assert known[0] is None and known[1] == Arms.of(course.root).arm("ada")
