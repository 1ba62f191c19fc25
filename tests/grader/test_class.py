"""A class: expected marks, the same however it is graded, and whatever is killed meanwhile."""

from __future__ import annotations

import copy
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading

import pytest
from handmade import FULL, QUICK, ROOT, add, hand_in, timeless
from made import handed_in
from processes import below, wait_until_gone

from labkit.__main__ import main
from labkit.course.authoring.layout import Course
from labkit.course.serialize import encode
from labkit.errors import LabkitError
from labkit.grader import batch
from labkit.grader.batch import GradedSubmission, GradeOptions, changes, grade_class
from labkit.grader.class_report import report
from labkit.grader.feedback import page
from labkit.grader.files import locked
from labkit.grader.gradebook import open_gradebook, record
from labkit.grader.marks import mark_of, marks_of
from labkit.grader.release import release
from labkit.grader.results import Results
from labkit.grader.sandbox.launch import Isolation
from labkit.grader.sandbox.limits import Limits
from labkit.grader.submission import students
from tests.synthetic import differences, make_class

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("class")]  # a whole class is graded

NAME = "01_curves"
PART = 8


def grade_all(course, change=True, **how):
    options = GradeOptions(**{"limits": QUICK} | how)
    done = grade_class(course, NAME, students(course, NAME), options, change=change)
    return [one for one in done if isinstance(one, GradedSubmission)]


def verdicts(course):
    return {result.student: timeless(result) for result in Results(course, NAME)}


@pytest.fixture(scope="module")
def _graded(released, tmp_path_factory):
    """The first few of the synthetic class, graded by two workers; never written to again."""
    root = tmp_path_factory.mktemp("graded") / "course"
    course = Course(shutil.copytree(released.root, root, symlinks=True))
    make_class(course, NAME, seed=3, count=PART)
    done = grade_all(course, jobs=2)
    assert len(done) == PART and not list(differences(course, NAME))
    record(course, NAME, [one.result for one in done])
    return course


@pytest.fixture
def graded(_graded, tmp_path):
    """A copy of it, to write to."""
    return Course(shutil.copytree(_graded.root, tmp_path / "graded", symlinks=True))


@pytest.mark.soak
def test_synthetic_class_gets_what_it_deserves(course):
    """Forty submissions of every kind earn, question by question, what they deserve."""
    make_class(course, NAME, seed=1)
    done = grade_all(course, jobs=2, limits=Limits())
    assert len(done) == 40
    assert not list(differences(course, NAME))


@pytest.mark.soak
def test_serial_parallel_and_dask_agree(graded):
    """Verdicts and scores are equal with one worker, with two, and through Dask."""
    from distributed import LocalCluster

    parallel = verdicts(graded)
    grade_all(graded, again=True)
    assert verdicts(graded) == parallel
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        grade_all(graded, dask=cluster.scheduler_address, again=True)
    assert verdicts(graded) == parallel


def test_what_is_done_is_not_done_again(graded, capsys):
    """What has changed, or whose result was lost or half written, is graded; nothing else is."""
    assert main(["grade", NAME, "--course", str(graded.root)]) == 0
    assert capsys.readouterr().out.count("(as before)") == PART
    first, second, *_ = students(graded, NAME)
    path = Results(graded, NAME).path(first)
    path.write_text(path.read_text()[:2000])
    next((graded.submitted / second / NAME).iterdir()).write_bytes(b"{")
    done = {one.result.student: one for one in grade_all(graded)}
    assert {who for who, one in done.items() if one.says != "as before"} == {first, second}
    assert done[second].result.rejected and Results(graded, NAME).get(first) is not None


STOPS = [
    ("SIGTERM", 7),
    pytest.param("SIGINT", 7, marks=pytest.mark.soak),
    pytest.param("SIGKILL", 4, marks=pytest.mark.soak),
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
    with subprocess.Popen(
        [*words, "--course", str(course.root)],
        env=dict(os.environ, PYTHONPATH=str(ROOT)),
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
    done = sorted(grade_all(course), key=lambda one: one.result.student)
    assert [one.says for one in done] == [
        "as before" if student in before else "" for student in ("ada", "bob", "eve")
    ]
    assert {one.result.score for one in done} == {FULL}


def test_what_a_release_moves_is_told_before(graded):
    """--diff changes nothing and names whose mark would fall."""
    before = {r.student: r.score for r in Results(graded, NAME)}
    path = graded.bundle / f"{NAME}.json"
    data = json.loads(path.read_text())
    (first, *_) = data["questions"]
    hidden = first["tests"]["items"][1]["cases"]["items"][-1]
    hidden["expected"] = [0.0, 0.1, 0.0]  # so that the right answer is wrong
    path.write_text(json.dumps(data | {"hash": "0" * 64}))
    moved = grade_all(graded, change=False, jobs=2)
    lose = {m.result.student for m in moved if m.result.score < m.before.score}
    *each, last = changes(moved)
    assert lose and len(each) == len(lose) and last.startswith(f"{len(lose)} of {PART} marks")
    assert {r.student: r.score for r in Results(graded, NAME)} == before
    grade_all(graded, jobs=2)
    assert {r.student: r.score for r in Results(graded, NAME)} == {
        m.result.student: m.result.score for m in moved
    }


def test_manual_grades_and_comments_survive(graded):
    """Grading again changes automatic scores only, in a gradebook that is new, too."""
    done = list(Results(graded, NAME))
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
    (graded.root / "gradebook.db").unlink()
    with pytest.raises(LabkitError, match=f"labkit release {NAME}"):
        record(graded, NAME, done)
    release(graded, NAME, 7)
    assert record(graded, NAME, done) == []


def test_one_writer_and_one_run(graded, capsys):
    """A second writer of the gradebook waits; a second run of an assignment is refused."""
    second = threading.Thread(target=record, args=(graded, NAME, []))
    with open_gradebook(graded):
        second.start()
        second.join(1.0)
        assert second.is_alive()
    second.join(60.0)
    assert not second.is_alive()
    handed_in(graded, "ada")
    with locked(graded.results / NAME / ".running", ""):
        for words in (["grade"], ["grade", "--diff"]):
            assert main([*words, NAME, "--course", str(graded.root)]) == 2
            assert "another run is grading" in capsys.readouterr().err


def test_an_interrupt_is_a_line(graded, capsys, monkeypatch):
    """Who stops the command reads that it stopped, and nothing of Python's."""

    def stopped(*args, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(batch, "grade_class", stopped)
    assert main(["grade", NAME, "--course", str(graded.root)]) == 130
    assert capsys.readouterr().err.strip() == "labkit grade: stopped"


def test_refuses_without_bubblewrap(course, solved, monkeypatch):
    """No bubblewrap: nothing is graded; a user id alone must be typed, and each result says it."""
    hand_in(course, NAME, "ada", solved)
    monkeypatch.setenv("PATH", "/nowhere")
    arguments = ["grade", NAME, "--course", str(course.root)]
    for more in ([], ["--diff"]):
        assert main([*arguments, *more]) == 2
    assert not list(Results(course, NAME))
    code = main([*arguments, "--isolation", "user"])
    found = [(Isolation.of(r.isolation), r.score) for r in Results(course, NAME)]
    assert (code, found) == ((2, []) if os.geteuid() else (0, [(Isolation.USER, FULL)]))
    monkeypatch.undo()
    assert main([*arguments, "--again"]) == 0
    assert [Isolation.of(r.isolation) for r in Results(course, NAME)] == [Isolation.BUBBLEWRAP]


def numbers(data):
    """All long numbers in encoded data, as they are printed."""
    if isinstance(data, float):
        return {repr(data)} if len(repr(data)) > 8 else set()
    inner = data.values() if isinstance(data, dict) else data if isinstance(data, list) else ()
    return {x for part in inner for x in numbers(part)}


def test_feedback_lies_where_nbgrader_looks_and_has_no_hidden_case(graded, bundle):
    """No hidden input stands in any page, though a page says what class of case failed."""
    assert main(["feedback", NAME, "--course", str(graded.root)]) == 0
    pages = [x.read_text() for x in (graded.root / "feedback").glob(f"*/{NAME}/{NAME}.html")]
    cases = [case for q in bundle.questions for test in q.tests for case in test.cases]
    hidden = {x for c in cases if c.hidden for x in numbers(encode(c.args))}
    hidden -= {x for c in cases if not c.hidden for x in numbers(encode(c.args))}
    assert len(pages) == PART and len(hidden) > 8
    assert not [x for x in hidden if x in "".join(pages)]


def test_class_report(graded, capsys):
    """It counts mistakes by name and tests that a hidden case decided, and names nobody."""
    results = list(Results(graded, NAME))
    problems = {p.name: p for p in graded.problems(NAME)}
    text = report(NAME, list(map(mark_of, results)), problems)
    verdicts = [q.verdict for r in results for q in r.questions]
    mistakes = [v.mistake.name for v in verdicts if v.mistake]
    assert mistakes and all(name in text for name in mistakes)
    assert not [r.student for r in results if r.student in text]
    tests = [test for v in verdicts for test in v.tests]
    decided = sum(test.hidden for test in tests)
    assert f"Of {len(tests)} tests, hidden cases decided {decided}." in text
    assert main(["class-report", NAME, "--course", str(graded.root)]) == 0
    told = capsys.readouterr().out
    believed = told.partition("**`twice_the_time`**")[2].partition("\n## ")[0]
    assert sum(map(int, re.findall(r"^- (\d+) x", believed, re.M))) == PART


def test_the_marks_are_those_of_the_results(graded):
    """And a page can be made of each."""
    scores = {r.student: r.score for r in Results(graded, NAME)}
    assert {mark.student: mark.score for mark in marks_of(graded, NAME)} == scores
    assert all(page(mark.result, mark) for mark in marks_of(graded, NAME))
