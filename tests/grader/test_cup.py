"""The cup's board and final: honest, cheating and endless entries, three a day, and the bonus."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from datetime import date

import numpy as np
import pytest
from downloaded import from_moodle
from handmade import hand_in

from labkit import Sample, State
from labkit.__main__ import main
from labkit.course.authoring.layout import CUP, DEFENCE
from labkit.course.baxter_cup import BENCHMARKS, PUBLIC_SEEDS
from labkit.course.own_arm import HANDLES, Arms
from labkit.grader.cup import entries as cup
from labkit.grader.cup.entries import A_DAY, SEEDS, Entry, latest, of_student, play, seeds
from labkit.grader.cup.table import as_text, give_bonus, page
from labkit.grader.grading.worker import TRIES
from labkit.grader.marks.export import of_term
from labkit.grader.marks.table import marks_of
from labkit.grader.nbgrader.gradebook import open_gradebook
from labkit.grader.sandbox.launch import SandboxLost

HONEST = """
import labkit as lk
from labkit.course import cup

def cup_controller(model):
    calls = []
    def controller(state, target):
        calls.append(state)
        return lk.JointVelocity(target.velocity + 3.0 * (target.position - state.q))
    return controller

runs = cup(cup_controller)
"""
COUNTS = HONEST.replace("target.velocity + 3.0", "len(calls) + 0.0")
SLOW = HONEST.replace("target.velocity + 3.0", "50.0 + 0.0")
READS_SEEDS = """
import pathlib
import labkit as lk
from labkit.course import cup

def look(model):
    found = list(pathlib.Path("COURSE").rglob("*"))
    from labkit.grader import cup as cups
    from labkit.course.authoring.layout import Course
    secret = cups.seeds(Course(pathlib.Path("COURSE")), False)
    return lambda state, target: lk.JointVelocity(secret[0] + len(found) + 0.0 * state.q)

cup(look)
"""
ENDLESS = """
from labkit.course import cup

def endless(model):
    def controller(state, target):
        while True:
            pass
    return controller

cup(endless)
"""
TODAY, TOMORROW = date(2026, 11, 22), date(2026, 11, 23)


def notebook(*cells):
    cells = [
        {"cell_type": "code", "id": f"c{k}", "metadata": {}, "source": source, "outputs": [],
         "execution_count": None}
        for k, source in enumerate(cells)
    ]  # fmt: skip
    return {"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}


def enter(course, student, *cells):
    hand_in(course, CUP, student, notebook(*cells))
    (path,) = (course.submitted / student / CUP).glob("*.ipynb")
    return path


def entries(course):
    return [x for path in (course.results / "cup").iterdir() for x in of_student(course, path.stem)]


def final(course, handles):
    """The scores of the final by handle, and the bonus of each student."""
    (course.root / HANDLES).parent.mkdir(parents=True, exist_ok=True)
    (course.root / HANDLES).write_text(Arms(5, handles).text())
    assert main(["export", "--layout", "cup", "--final", "--course", str(course.root)]) == 0
    scores = {handle: entry.score for handle, entry in latest(course, final=True).items()}
    return scores, {x.student: x.lines[0].extra for x in marks_of(course, CUP)}


def begin_term(course, seed):
    course.term.parent.mkdir(exist_ok=True)
    course.term.write_text(f'{{"seed": {seed}}}')


@pytest.fixture
def instant(monkeypatch):
    """Runs of one command, whose score is its largest speed."""

    def run(make, seed, workspace):
        still = np.zeros(7)
        command = make(None)(State(0.0, still, still), Sample(still, still, still))
        return cup.CupRun(seed, float(np.abs(command.value).max()), None)

    monkeypatch.setattr(cup, "cup_run", run)
    monkeypatch.setattr(cup, "motion", lambda *_: None)


@pytest.mark.slow
def test_an_entry_is_run_on_the_term_s_seeds_in_the_sandbox(course, monkeypatch):
    """What the sandbox answers scores what the same law scores here; its replay is on the page."""
    monkeypatch.setattr(cup, "SEEDS", 1)
    enter(course, "ada", HONEST)
    (entry,) = play(course, TODAY, final=False)
    names = {}
    exec(HONEST.replace("runs =", "#"), names)
    (seed,) = seeds(course, final=False)
    assert entry.why == ""
    assert entry.scores == (round(cup.cup_run(names["cup_controller"], seed).score, 2),)
    shown = page(course, latest(course, final=False), final=False)
    assert ">ada</th>" in shown and 'type="application/json"' in shown


def test_no_entry_can_read_the_seeds_or_hold_up_the_others(course, instant, capsys):
    """A search for the secret, an endless loop and a notebook without an entry have no score."""
    begin_term(course, 5)
    reads = READS_SEEDS.replace("COURSE", str(course.root))
    for student, source in [("ada", HONEST), ("bob", ENDLESS), ("cy", reads), ("di", "x = 1")]:
        enter(course, student, source)
    assert main(["export", "--layout", "cup", "--course", str(course.root)]) == 0
    found = {x.student: x for x in entries(course)}
    assert found["ada"].scores == (0.0,) * SEEDS and found["ada"].why == ""
    for student, why in [("bob", "TimeoutError"), ("cy", "labkit"), ("di", "nowhere")]:
        assert why in found[student].why and found[student].beaten == 0
    assert "inf mm  cy; " in capsys.readouterr().out


@pytest.mark.parametrize("times", [TRIES - 1, TRIES])
def test_an_entry_whose_sandbox_is_lost_is_run_again_or_named(
    course, instant, monkeypatch, capsys, times
):
    """It has no score that it did not earn; the others are run, and the next time it is, too."""
    run, lost = cup._run, [SandboxLost("the kernel")] * times

    def losing(new, *rest):
        if new.student == "bob" and lost:
            raise lost.pop()
        return run(new, *rest)

    monkeypatch.setattr(cup, "_run", losing)
    for student in ("ada", "bob", "cy"):
        enter(course, student, HONEST)
    named = times == TRIES
    assert main(["export", "--layout", "cup", "--course", str(course.root)]) == named
    assert ("not run: bob: its sandbox was lost" in capsys.readouterr().err) == named
    assert {x.student for x in entries(course)} == {"ada", "cy"} | (set() if named else {"bob"})
    assert main(["export", "--layout", "cup", "--course", str(course.root)]) == 0
    assert {x.scores for x in entries(course)} == {(0.0,) * SEEDS}
    assert {x.student for x in entries(course)} == {"ada", "bob", "cy"}


def test_an_entry_in_a_folder_with_an_unfit_name_is_named(course, capsys):
    """Nobody who entered is passed over: exit 1, in plain letters."""
    enter(course, "\x1b[2J", HONEST)
    assert main(["export", "--layout", "cup", "--course", str(course.root)]) == 1
    assert "not run: '\\x1b[2J': a folder in submitted/ has this name" in capsys.readouterr().err


def test_a_handle_has_three_runs_a_day_and_each_begins_anew(course, instant):
    """A notebook is run once; the fourth of a day waits for the next; other handles do not."""
    for k in range(A_DAY + 1):
        enter(course, "ada", COUNTS + f"# {k}")
        (entry,) = play(course, TODAY, final=False)
        assert isinstance(entry, Entry) is (k < A_DAY)
        if k < A_DAY:
            assert entry.scores == (1.0,) * SEEDS
            assert list(play(course, TODAY, final=False)) == []
    assert f"ada had {A_DAY} runs today" in str(entry)
    enter(course, "bob", HONEST)
    assert [x.student for x in play(course, TODAY, final=False)] == ["ada", "bob"]
    assert [x.student for x in play(course, TOMORROW, final=False)] == ["ada"]


def test_the_last_hand_in_of_a_handle_counts_whoever_made_it(course, instant):
    """Of a team's two notebooks only the later one runs, whatever the names; and one run before."""
    (course.root / HANDLES).parent.mkdir(parents=True, exist_ok=True)
    (course.root / HANDLES).write_text(Arms(5, {"ada": "team", "zoe": "team"}).text())
    for student, source, when in [("zoe", COUNTS, 1e9), ("ada", HONEST, 2e9)]:
        os.utime(enter(course, student, source), (when, when))
    assert [x.student for x in play(course, TODAY, final=True)] == ["ada"]
    (one,) = latest(course, final=True).values()
    assert (one.student, one.scores) == ("ada", (0.0,) * SEEDS)
    for source, score in [(COUNTS, 1.0), (HONEST, 0.0)]:
        os.utime(enter(course, "ada", source), (2e9, 2e9))
        list(play(course, TODAY, final=True))
        assert latest(course, final=True)["team"].scores == (score,) * SEEDS


def test_a_worksheet_decides_which_of_a_teams_notebooks_is_the_later(course, instant, capsys):
    """In one download both have one time, which is said; Moodle's times end the doubt."""
    (course.root / "list.csv").write_text("name,login,team\nAda Low,ada,kite\nZoe Park,zoe,kite\n")
    typed = ["students", "import", str(course.root / "list.csv"), "--course", str(course.root)]
    assert main(typed) == 0
    people = [
        ((who, number), "x.ipynb", json.dumps(notebook(source)))
        for number, who, source in [(1, "Ada Low", HONEST), (2, "Zoe Park", COUNTS)]
    ]
    download = from_moodle(course.root / "1.zip", people)
    board = ["export", "--layout", "cup", "--course", str(course.root)]
    for words in (["collect", CUP, str(download), *board[-2:]], board):
        capsys.readouterr()
        assert main(words) == 0
        said = capsys.readouterr().err
        assert "the notebook of zoe counts, and ada handed in another at the same time" in said
        assert f"labkit students import WORKSHEET.csv --assignment {CUP}" in said
    rows = ('1,Ada Low,ada,"Sunday, 1 March 2026, 11:30 AM"',
            '2,Zoe Park,zoe,"Sunday, 1 March 2026, 11:20 AM"')  # fmt: skip
    head = "Identifier,Full name,Username,Last modified (submission)\n"
    (course.root / "list.csv").write_text(head + "".join(f"Participant {row}\n" for row in rows))
    assert main([*typed, "--assignment", CUP]) == 0
    capsys.readouterr()
    assert main(board) == 0
    assert "same time" not in capsys.readouterr().err
    assert [x.student for x in latest(course, final=False).values()] == ["ada"]


def test_the_final_takes_over_a_change_of_teams(course, instant, tmp_path):
    """Each gets what the last notebook of their present handle earns, and others lose a bonus.

    What a person typed stays, and an entry that an older labkit stored with its handle is read.
    """
    for student, source, when in [("bob", SLOW, 1e9), ("ada", HONEST, 2e9)]:
        os.utime(enter(course, student, source), (when, when))
    team = dict.fromkeys(["ada", "bob", "cy", "di"], "kite")
    assert final(course, team) == ({"kite": 0.0}, dict.fromkeys(team, 4.0))
    with open_gradebook(course) as book:
        (notebook,) = book.find_submission(CUP, "cy").notebooks
        notebook.grades[0].manual_score, notebook.comments[0].manual_comment = 1.0, "well drawn"
        book.db.commit()
    path = course.results / "cup" / "ada.json"
    path.write_text(json.dumps([x | {"handle": "kite"} for x in json.loads(path.read_text())]))
    scores, bonus = final(course, {"ada": "ada", "bob": "kites", "cy": "cy", "di": "kites"})
    assert scores == {"ada": 0.0, "kites": 50.0}
    assert bonus == {"ada": 4.0, "bob": 2.0, "cy": 0.0, "di": 2.0}
    (line,) = next(x for x in marks_of(course, CUP) if x.student == "cy").lines
    assert (line.score, line.comment) == (1.0, "well drawn")


def test_a_team_keeps_the_bonus_of_a_forgotten_students_notebook(course, instant, capsys):
    """It goes to a mate, as a report does, and earns the same when the final is run again."""
    (course.root / "list.csv").write_text("id,name,team\nada,Ada Low,kite\nbob,Bob Ray,kite\n")
    words = ["--course", str(course.root)]
    assert main(["students", "import", str(course.root / "list.csv"), *words]) == 0
    enter(course, "ada", SLOW)
    assert main(["export", "--layout", "cup", "--final", *words]) == 0
    assert main(["term", "forget", "--student", "ada", "--yes", *words]) == 0
    assert f"moved to bob, with its mark, which is the team's: submitted/ada/{CUP}" in (
        capsys.readouterr().out
    )
    assert not [*course.root.glob("*/ada"), *course.root.glob("results/*/ada.json")]
    assert main(["export", "--layout", "cup", "--final", *words]) == 0
    assert {x.student: x.lines[0].extra for x in marks_of(course, CUP)} == {"bob": 2.0}


def test_the_final_has_other_seeds_and_benchmarks_beaten_are_extra_credit(
    course, instant, tmp_path, capsys
):
    """Board, final and public seeds differ, as terms do; the bonus reaches the term's table."""
    before = {*seeds(course, final=False), *seeds(course, final=True)}
    begin_term(course, 5)
    term = {*seeds(course, final=False), *seeds(course, final=True)}
    assert len(before | term | set(PUBLIC_SEEDS)) == 4 * SEEDS + len(PUBLIC_SEEDS)
    enter(course, "ada", HONEST)
    board = ["export", "--layout", "cup", "--course", str(course.root)]
    assert main([*board, "--final", "--to", str(tmp_path / "final.html")]) == 0
    assert f"written: {tmp_path / 'final.html'}" in capsys.readouterr().out
    (entry,) = latest(course, final=True).values()
    assert latest(course, final=False) == {} and {x.student for x in marks_of(course, CUP)} == {
        "ada"
    }
    slow = replace(entry, student="bob", scores=(50.0,) * SEEDS)
    give_bonus(course, {"ada": entry, "bob": slow})
    assert entry.beaten == len(BENCHMARKS)
    bonus = list(marks_of(course, CUP))
    assert {x.student: (x.score, x.points) for x in bonus} == {"ada": (4.0, 0.0), "bob": (2.0, 0.0)}
    table = of_term({CUP: bonus, "01_paths": [replace(x, points=10.0, raw=5.0) for x in bonus]},
                    {CUP: 0.5, "01_paths": 1.0})  # fmt: skip
    assert [row[-1] for row in table[3:]] == [52.0, 51.0]
    assert "benchmark: joint torque" in "\n".join(as_text({"bob": slow}))


def test_other_verbs_name_the_cups_own(course, capsys):
    """`grade`, `feedback` and an empty table say which verb gives the bonus or the mark."""
    for words in (["grade", CUP], ["feedback", CUP], ["class-report", CUP], ["export", CUP]):
        assert main([*words, "--course", str(course.root)]) == 2
        said = capsys.readouterr().err
        assert "labkit export --layout cup --final" in said and "labkit release" not in said
    assert main(["grade", DEFENCE, "--course", str(course.root)]) == 2
    assert "09_defence is marked by: labkit defence STUDENT --mark" in capsys.readouterr().err
