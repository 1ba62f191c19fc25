"""A class: expected marks, the same however it is graded, and whatever is killed meanwhile."""

from __future__ import annotations

import copy
import errno
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from handmade import FULL, QUICK, ROOT, add, hand_in, timeless
from processes import below, child, wait_until_gone

from labkit.__main__ import main
from labkit.course.authoring.layout import Course
from labkit.grader import gradebook
from labkit.grader.batch import GradedSubmission, GradeOptions, common_failures, grade_class
from labkit.grader.gradebook import open_gradebook, record
from labkit.grader.marks import marks_of
from labkit.grader.release import release
from labkit.grader.results import Results
from labkit.grader.submission import students
from tests.synthetic import differences, make_class

pytestmark = pytest.mark.slow  # whole classes are graded

NAME = "01_curves"
PART, FEW = 8, 4


def grade_all(course, **how):
    return [
        one
        for one in grade_class(
            course, NAME, students(course, NAME), GradeOptions(limits=QUICK, **how)
        )
        if isinstance(one, GradedSubmission)
    ]


def verdicts(course):
    return {result.student: timeless(result) for result in Results(course, NAME)}


@pytest.fixture
def part(course):
    """A course with the first few of the synthetic class, all of them harmless."""
    make_class(course, NAME, seed=3, count=FEW)
    return course


@pytest.fixture(scope="module")
def _graded(released, tmp_path_factory):
    """The same, graded by two workers and never written to again."""
    root = tmp_path_factory.mktemp("graded") / "course"
    course = Course(shutil.copytree(released.root, root, symlinks=True))
    make_class(course, NAME, seed=3, count=PART)
    assert len(grade_all(course, jobs=2)) == PART
    return course


@pytest.fixture
def graded(_graded, tmp_path):
    """A copy of it, to write to."""
    return Course(shutil.copytree(_graded.root, tmp_path / "graded", symlinks=True))


@pytest.mark.slow
def test_synthetic_class_gets_what_it_deserves(course):
    """Forty submissions of every kind earn, question by question, what they deserve."""
    make_class(course, NAME, seed=1)
    done = grade_all(course, jobs=2)
    assert len(done) == 40
    assert not list(differences(course, NAME))
    record(course, NAME, [one.result for one in done])
    with open_gradebook(course) as book:
        scores = {s.student.id: s.score for s in book.assignment_submissions(NAME)}
    assert scores == {one.result.student: one.result.score for one in done}


@pytest.mark.slow
def test_serial_parallel_and_dask_agree(graded):
    """Verdicts and scores are equal with one worker, with two, and through Dask."""
    from distributed import LocalCluster

    parallel = verdicts(graded)
    assert len(parallel) == PART
    grade_all(graded, again=True)
    assert verdicts(graded) == parallel
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        grade_all(graded, dask=cluster.scheduler_address, again=True)
    assert verdicts(graded) == parallel


def test_resume(graded):
    """What is graded and has not changed is not graded again; what has changed is."""
    assert {one.says for one in grade_all(graded)} == {"as before"}
    who = students(graded, NAME)[0]
    path = graded.submitted / who / NAME
    next(path.iterdir()).write_bytes(b"{")
    assert sum(one.says != "as before" for one in grade_all(graded)) == 1


def test_killed_worker(part):
    """A worker that is killed loses nothing: its submission goes to the next one."""

    def kill_one():
        worker = child(os.getpid(), "spawn_main")
        below(worker, at_least=4)
        os.kill(worker, signal.SIGKILL)

    thread = threading.Thread(target=kill_one)
    thread.start()
    done = grade_all(part)
    thread.join()
    assert len(done) == FEW
    assert not list(differences(part, NAME))


STOPS = [
    ("SIGTERM", 7),
    ("SIGINT", 7),
    ("SIGKILL", 4),
    pytest.param("SIGHUP", 7, marks=pytest.mark.soak),
    pytest.param("SIGTERM", 3, marks=pytest.mark.soak),
    pytest.param("SIGKILL", 7, marks=pytest.mark.soak),
]
"""Signals to the grader, and the number of its processes at the moment when they come."""


@pytest.mark.parametrize(("name", "processes"), STOPS)
def test_a_run_that_is_stopped_leaves_nothing_running_and_loses_nothing(
    name, processes, course, solved
):
    """Whatever ends the grader ends all that it started; the next run keeps what is done."""
    for student in ("ada", "bob", "eve"):
        hand_in(course, NAME, student, solved)
    words = [sys.executable, "-m", "labkit", "grade", NAME, "--jobs", "1"]
    environment = dict(os.environ, PYTHONPATH=str(ROOT))
    with subprocess.Popen(
        [*words, "--course", str(course.root)],
        env=environment,
        stdout=subprocess.PIPE,
        text=True,
        # a shell lets what it starts in the background ignore it
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as run:
        if processes == 7:  # it is at the second submission
            endless = add(add(copy.deepcopy(solved), "while True: pass"), "while True: pass")
            hand_in(course, NAME, "bob", endless)
            assert "ada: 22 of 22" in run.stdout.readline()
        everything = below(run.pid, at_least=processes)
        run.send_signal(getattr(signal, name))
        wait_until_gone(everything)
    before = [result.student for result in Results(course, NAME)]
    assert before == (["ada"] if processes == 7 else [])
    hand_in(course, NAME, "bob", solved)
    done = grade_all(course)
    assert [one.says for one in sorted(done, key=lambda one: one.result.student)] == [
        "as before" if student in before else "" for student in ("ada", "bob", "eve")
    ]
    record(course, NAME, [one.result for one in done])
    with open_gradebook(course) as book:
        assert min(s.score for s in book.assignment_submissions(NAME)) >= FULL


def test_results_outlive_a_crash_while_writing(graded):
    """A half-written result is made again."""
    results = Results(graded, NAME)
    who = students(graded, NAME)[0]
    text = results.path(who).read_text()
    results.path(who).write_text(text[: len(text) // 2])
    assert results.get(who) is None
    grade_all(graded)
    assert results.get(who) is not None


def test_loud_when_many_fail(graded):
    """A test that more than 30 % fail is named."""
    results = list(Results(graded, NAME))
    said = list(common_failures(results * 2))
    assert said
    assert all("fail the test" in sentence for sentence in said)
    assert len(said) <= len({q.verdict.name for r in results for q in r.questions}), (
        "one a question"
    )
    assert not list(common_failures([r for r in results if r.score == r.points] * 5))
    for few, named in zip(common_failures(results * 2, fewest=99), said, strict=True):
        assert few == re.sub(r"^\d+", "<99", named), "no count of a small group"


def test_manual_grades_and_comments_survive(graded):
    """Grading again changes automatic scores only, and says where a hand was at work."""
    done = list(Results(graded, NAME))
    record(graded, NAME, done)
    who = max(done, key=lambda r: r.score)
    with open_gradebook(graded) as book:
        grade = book.find_grade("circle-check", NAME, NAME, who.student)
        grade.manual_score, grade.extra_credit = 1.5, 0.5
        book.find_comment("circle", NAME, NAME, who.student).manual_comment = "see me"
        book.db.commit()
    record(graded, NAME, done)
    with open_gradebook(graded) as book:
        grade = book.find_grade("circle-check", NAME, NAME, who.student)
        assert (grade.manual_score, grade.auto_score, grade.extra_credit) == (1.5, 4.0, 0.5)
        assert book.find_comment("circle", NAME, NAME, who.student).manual_comment == "see me"
        assert book.find_submission(NAME, who.student).score == who.score - 4 + 1.5 + 0.5


def test_a_gradebook_that_is_new_is_told_what_was_released(part, capsys):
    """Where gradebook.db was deleted, a sentence says how it learns of the assignment again."""
    (part.root / "gradebook.db").unlink()
    who = students(part, NAME)[0]
    arguments = ["--student", who, "--course", str(part.root)]
    assert main(["grade", NAME, *arguments]) == 2
    assert f"labkit release {NAME}" in capsys.readouterr().err
    release(part, NAME, 7)
    assert main(["grade", NAME, *arguments]) == 0
    assert "as before" in capsys.readouterr().out


def test_an_interrupt_is_a_line(part, capsys, monkeypatch):
    """Who stops the command reads that it stopped, and nothing of Python's."""

    def stopped(*args, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr("labkit.grader.batch.grade_class", stopped)
    assert main(["grade", NAME, "--course", str(part.root)]) == 130
    assert capsys.readouterr().err == "labkit grade: stopped\n"


def test_scores_are_written_whole_or_not_at_all(graded, monkeypatch):
    """A disk that is full in the middle ends it; each score is the new one or that of before."""
    done = list(Results(graded, NAME))
    record(graded, NAME, [replace(result, questions=()) for result in done])
    rooms = iter([True, True, False])

    def write(*args):
        if not next(rooms):
            raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(gradebook, "write", write)
    with pytest.raises(OSError, match="No space left"):
        record(graded, NAME, done)
    with open_gradebook(graded) as book:
        scores = {s.student.id: s.score for s in book.assignment_submissions(NAME)}
    assert scores == {r.student: r.score if k < 2 else 0.0 for k, r in enumerate(done)}


def test_the_gradebook_has_one_writer(part):
    """Who grades another assignment in another terminal waits, and fails at nothing."""
    second = threading.Thread(target=record, args=(part, NAME, []))
    with open_gradebook(part):
        second.start()
        second.join(2.0)
        assert second.is_alive()
    second.join(20.0)
    assert not second.is_alive()


def test_late_rules_and_timestamps(graded):
    """Times come from the collector's file; an unreadable one is said, and costs nothing."""
    done = sorted(Results(graded, NAME), key=lambda r: -r.score)
    late, odd = done[0].student, done[1].student
    (graded.submitted / late / NAME / "timestamp.txt").write_text("2030-01-01 10:00:00 UTC")
    (graded.submitted / odd / NAME / "timestamp.txt").write_text("yesterday or so")
    with (graded.root / "nbgrader_config.py").open("a") as file:
        file.write('c.LateSubmissionPlugin.penalty_method = "zero"\n')
    with open_gradebook(graded) as book:
        book.update_or_create_assignment(NAME, duedate="2029-01-01 10:00:00 UTC")
    notes = record(graded, NAME, done)
    assert [note for note in notes if odd in note and "is not a time" in note]
    with open_gradebook(graded) as book:
        assert book.find_submission(NAME, late).timestamp.year == 2030
        assert book.find_submission(NAME, odd).timestamp is None
    marks = {row.student: (row.raw, row.score) for row in marks_of(graded, NAME)}
    assert marks[late] == (FULL, 0.0)
    assert all(raw == score for student, (raw, score) in marks.items() if student != late)


def test_command(part, capsys):
    """`labkit grade` prints a line each, and what isolates."""
    assert main(["grade", NAME, "--course", str(part.root)]) == 0
    out = capsys.readouterr().out
    assert out.count("\n[") >= FEW - 1
    assert "isolation: bubblewrap" in out


def test_refuses_without_bubblewrap(part, capsys, monkeypatch):
    """No bubblewrap: nothing is graded, the remedy is printed; unsafe must be typed."""
    folder = Path(sys.executable).parent
    monkeypatch.setenv("PATH", str(folder))
    arguments = ["grade", NAME, "--course", str(part.root)]
    for more in ([], ["--diff"]):
        assert main([*arguments, *more]) == 2
        assert capsys.readouterr().err.count("apt-get install bubblewrap") == 1
    assert not list(Results(part, NAME))
    assert main([*arguments, "--unsafe-no-isolation"]) == 0
    assert {r.isolation for r in Results(part, NAME)} == {
        "none (asked for by --unsafe-no-isolation)"
    }
    monkeypatch.undo()
    assert main(arguments) == 0
    assert all(r.isolation.startswith("bubblewrap") for r in Results(part, NAME))
