"""A class of which many are hostile: every honest mark exact, every honest page written."""

from __future__ import annotations

import csv
import io
import json
import os
from contextlib import redirect_stderr, redirect_stdout
from types import SimpleNamespace

import numpy as np
import pytest
from soak.attacks.defended import COMMANDS, MORE, wins_of
from soak.attacks.family import Family
from soak.attacks.place import NAME, full_marks, place
from soak.attacks.sets import ATTACKS

from labkit.__main__ import main
from tests.synthetic import differences, make_class

pytestmark = pytest.mark.xdist_group("hostile class")

WORST = (
    "others: half a character in a comment",
    "others: numbers to the end of the scale",
    "secrets: after a restart, by the clock on the wall",
    "the grader: a comment of a million emoji",
    "the grader: empty lists",
    "the grader: coefficients",
    "the grader: 900 cells that print",
    "the grader: names as long as books",
    "others: kills everybody",
    "others: a cell's name twice",
    "whoever looks: a cell that prints",
    "points: line: deep",
)
"""These come first; the others are drawn."""
SLOW = ("hangs", "answers")
"""Not drawn: each takes a worker's time, or is told and not kept out."""


def _a_folder(path):
    path.mkdir()


def _a_pipe(path):
    os.mkfifo(path)


def _nothing(path):
    path.write_bytes(b"")


def _a_list(path):
    path.write_text("[1, 2, 3]")


def _a_link(path):
    path.symlink_to("/etc/passwd")


def _deep(path):
    path.write_text('{"cells": ' + "[" * 100_000)


def _another_name(path):
    with open(os.fsencode(path.parent) + b"/caf\xe9\x1b[2J.ipynb", "wb") as file:
        file.write(b"{}")


FILES = (_another_name, _a_folder, _a_pipe, _nothing, _a_list, _a_link, _deep)
"""What lies where a notebook belongs."""


@pytest.fixture(scope="module")
def graded(released, tmp_path_factory):
    """A class after all verbs: what they printed, how they ended, what they wrote."""
    count, hostile = 60, 24
    folder = tmp_path_factory.mktemp("hostile")
    with place(folder / "course", released) as here, Family() as family:
        make_class(here.course, NAME, seed=16, count=count - hostile)
        attackers = {}
        for number, name in enumerate(_drawn(hostile - hostile // 8)):
            student = f"student-{number * 3 + 1:03d}-{number}"  # among the others
            here.hand_in(student, here.filled(ATTACKS[name]).planted(here.notebook()))
            attackers[student] = name
        for number in range(hostile // 8):
            student = f"student-{number * 20 + 7:03d}-file"
            (here.course.submitted / student / NAME).mkdir(parents=True)
            FILES[number % len(FILES)](here.course.submitted / student / NAME / f"{NAME}.ipynb")
            attackers[student] = ""
        codes, printed, said = {}, {}, {}
        for verb in ("grade", "feedback", "export", "class-report"):
            codes[verb], printed[verb], said[verb] = _run(verb, here.course)
        yield SimpleNamespace(
            course=here.course,
            attackers=attackers,
            codes=codes,
            printed=printed,
            said=said,
            left=family.left(),
        )


def _drawn(count):
    """So many attacks: the worst, then others, the same in every run."""
    names = [n for n, a in ATTACKS.items() if a.wins not in SLOW and not a.then and n not in WORST]
    chosen = np.random.default_rng(16).permutation(names)[: max(0, count - len(WORST))]
    return [*WORST[:count], *map(str, chosen)]


def _run(verb, course):
    """How a verb ended, what it printed, and what it said beside that."""
    out, err = io.StringIO(), io.StringIO()
    try:
        with redirect_stdout(out), redirect_stderr(err):
            code = main([verb, NAME, *MORE.get(verb, []), "--course", str(course.root)])
    except BaseException as error:
        code = f"{type(error).__name__}: {error}"[:300]
    return code, out.getvalue(), err.getvalue()


def _deserved(course):
    return json.loads((course.root / "build" / "class" / f"{NAME}.json").read_text())


def test_every_honest_mark_is_exact(graded):
    """Question by question, beside any attacker."""
    assert not list(differences(graded.course, NAME))


def test_every_honest_mark_is_exported(graded):
    """The table has a row for each, with what they deserve."""
    rows = {row["student"]: row for row in csv.DictReader(io.StringIO(graded.printed["export"]))}
    deserved = _deserved(graded.course)
    wrong = {
        who: (rows.get(who), about["score"])
        for who, about in deserved.items()
        if who not in rows or float(rows[who]["score"] or "nan") != about["score"]
    }
    assert not wrong


def test_every_honest_page_is_written(graded):
    """Each page says the mark, or why there is none."""
    points = full_marks(graded.course)[1]
    for who, about in _deserved(graded.course).items():
        page = graded.course.root / "feedback" / who / NAME / f"{NAME}.html"
        text = page.read_text()
        assert f"{about['score']:g} of {points:g} points" in text
        assert about["rejected"] == ("could not be graded" in text)


def test_no_attacker_gains(graded):
    """Among many as alone: nothing undeserved, nothing secret, no result too large."""
    won = {
        name: found
        for student, name in graded.attackers.items()
        if name and (found := list(wins_of(graded.course, student, ATTACKS[name])))
    }
    assert not won


def test_a_zero_is_earned(graded):
    """Where there is no result, the table has no number."""
    rows = {
        row["student"]: row["score"]
        for row in csv.DictReader(io.StringIO(graded.printed["export"]))
    }
    results = graded.course.root / "results" / NAME
    missing = [who for who in graded.attackers if not (results / f"{who}.json").exists()]
    assert not [who for who in missing if rows.get(who)]


def test_verbs_end_as_documented(graded):
    """All is done for all others; 1 says that somebody's part failed; nothing is a traceback."""
    assert {code in (0, 1) for code in graded.codes.values()} == {True}, graded.codes
    texts = (*graded.printed.values(), *graded.said.values())
    lines = [line for text in texts for line in text.split("\n")]
    assert not [line for line in lines if "Traceback" in line or COMMANDS.search(line)]


def test_nothing_is_left(graded):
    """No process outlives the class."""
    assert not graded.left
