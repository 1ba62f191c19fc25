"""Attacks: each wins nothing here, or is told."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from soak.attacks.defended import COMMANDS, HONEST, defended, wins
from soak.attacks.place import full_marks, place
from soak.attacks.sets import ATTACKS

pytestmark = pytest.mark.xdist_group("attacks on others")


@pytest.fixture(scope="module")
def graded(released, tmp_path_factory):
    """A class of attackers in this grader, and what their attacks are."""
    root = tmp_path_factory.mktemp("defended") / "course"
    with place(root, released) as here:
        yield SimpleNamespace(attacks=ATTACKS, of=defended(ATTACKS, here))


def test_no_attack_wins_here(graded):
    """Nothing is undeserved and untold, nothing secret said; all have a result, none too large."""
    found = {name: list(wins(name, attack, graded.of)) for name, attack in graded.attacks.items()}
    assert not {name: what for name, what in found.items() if what}


def test_nobody_else_is_harmed(graded, released):
    """Students who worked among the attackers have full marks in result, export and page."""
    of, (full, points) = graded.of, full_marks(released)
    assert not of.failed
    assert {who: of.results.get(who, {}).get("score") for who in HONEST} == dict.fromkeys(
        HONEST, full
    )
    assert {who: of.marks.get(who) for who in HONEST} == dict.fromkeys(HONEST, str(full))
    assert all(f"{full:g} of {points:g} points" in of.pages.get(who, "") for who in HONEST)
    assert not of.stolen


def test_every_verb_does_its_work(graded):
    """Grade, feedback, export and class-report end well, with a row and a page for each.

    An export says by its exit code that a mark is missing: of texts that wait for a person; and
    grade that a notebook is refused, as an attacker's may be.
    """
    of = graded.of
    waits = "mark by hand, in formgrader" in of.printed
    assert of.codes.pop("grade") in (0, 1)
    assert of.codes == {"feedback": 0, "export": int(waits), "class-report": 0}
    everybody = {*of.attackers, *of.accomplices, *HONEST}
    assert everybody <= of.marks.keys()
    assert everybody <= of.pages.keys()
    assert not COMMANDS.findall(of.printed)


def test_nothing_is_left(graded):
    """No process outlives the grader, and nothing was carried out of it."""
    assert not graded.of.left
    assert not graded.of.loot
