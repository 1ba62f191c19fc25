"""Attacks, each with its control: it wins undefended, and here it wins nothing, or is told."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from soak.attacks.defended import FULL, HONEST, defended, wins
from soak.attacks.place import place, released
from soak.attacks.sets import ATTACKS, GOALS, SAMPLE
from soak.attacks.undefended import COMMANDS, WINS, undefended

soak = pytest.mark.soak
SETS = {"sample": SAMPLE, "all": ATTACKS}


@pytest.fixture(scope="module")
def _released(tmp_path_factory):
    return released(tmp_path_factory.mktemp("released") / "course")


@pytest.fixture(scope="module", params=["sample", pytest.param("all", marks=soak)])
def graded(request, _released, tmp_path_factory):
    """A class of attackers in this grader, and what their attacks are."""
    attacks = SETS[request.param]
    root = tmp_path_factory.mktemp("defended") / "course"
    with place(root, _released) as here:
        yield SimpleNamespace(attacks=attacks, of=defended(attacks, here))


@pytest.fixture(scope="module", params=["sample", pytest.param("all", marks=soak)])
def won(request, _released, tmp_path_factory):
    """What the same attacks win where nobody keeps them out."""
    attacks = SETS[request.param]
    folder = tmp_path_factory.mktemp("undefended")
    with place(folder / "course", _released) as here:
        yield SimpleNamespace(attacks=attacks, by=undefended(attacks, here, folder / "scratch"))


def test_there_are_enough_attacks():
    """There are at least 150, and some for each goal."""
    assert sum(map(len, GOALS.values())) >= 150
    assert all(len(attacks) >= 10 for attacks in GOALS.values())


def test_each_attack_wins_undefended(won):
    """Each attack gets what it is after in nbgrader's own engine or in one bare process."""
    assert not [n for n, attack in won.attacks.items() if not WINS[attack.wins](won.by[n])]


def test_no_attack_wins_here(graded):
    """Nothing undeserved and untold, nothing secret said, no result too large, nobody without one."""
    found = {name: list(wins(name, attack, graded.of)) for name, attack in graded.attacks.items()}
    assert not {name: what for name, what in found.items() if what}


def test_nobody_else_is_harmed(graded):
    """Whoever did their work among the attackers has full marks in result, export and page."""
    of = graded.of
    assert not of.failed
    assert {who: of.results.get(who, {}).get("score") for who in HONEST} == dict.fromkeys(
        HONEST, FULL
    )
    assert {who: of.marks.get(who) for who in HONEST} == dict.fromkeys(HONEST, str(FULL))
    assert all(f"{FULL:g} of {FULL:g} points" in of.pages.get(who, "") for who in HONEST)
    assert not of.stolen


def test_every_verb_does_its_work(graded):
    """Grade, feedback, export and class-report end well, with a row and a page for each."""
    of = graded.of
    assert of.codes == dict.fromkeys(("grade", "feedback", "export", "class-report"), 0)
    everybody = {*of.attackers, *of.accomplices, *HONEST}
    assert everybody <= of.marks.keys()
    assert everybody <= of.pages.keys()
    assert not COMMANDS.findall(of.printed)


def test_honest_students_are_not_suspected(graded):
    """The report names nobody for a withheld tool who used none."""
    of = graded.of
    accused = [line for line in of.report.splitlines() if "BangBang" in line]
    assert not [
        line for line in accused for who in HONEST if f"{who}:" in line or f"{who} " in line
    ]


def test_nothing_is_left(graded):
    """No process outlives the grader, and nothing was carried out of it."""
    assert not graded.of.left
    assert not graded.of.loot
