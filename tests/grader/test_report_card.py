"""The report card: it counts what the checks do, and tells on them."""

from dataclasses import replace
from pathlib import Path

import pytest

from labkit.__main__ import main
from labkit.course.authoring.layout import Course
from labkit.course.authoring.refusals import memorised
from labkit.course.authoring.report_card import row, rows, table
from labkit.errors import UnknownName

COURSE = Course.here(Path(__file__))
(PROBLEM,) = (p for p in COURSE.problems("00_warmup") if p.name == "joint_error")
ALL = len(PROBLEM.wrong)


def test_it_counts():
    """Every mistake is rejected and named, every right answer accepted; each has its line."""
    card = list(rows(COURSE, ["00_warmup"], 5, 2))
    for one in card:
        assert one.rejected == one.named == one.mistakes > 0 and one.accepted == one.right > 1
        assert not one.failures and f"| {one.question} |" in table(card)


def test_what_fails_is_told():
    """A mistake with points, one with another's name, and a right answer that is none."""
    first, second, *_ = PROBLEM.wrong
    odd = replace(first, name="odd", function=PROBLEM.answer)
    made = row("00_warmup", replace(PROBLEM, wrong=(odd, second), variants=(abs,)), [5])
    assert (made.rejected, made.named, made.accepted) == (1, 1, 1)
    assert [words.partition(":")[0] for words in made.failures] == ["odd"] * 3 + ["right answer 1"]


def test_a_mistake_that_only_hidden_cases_reject_fails():
    """The student's check calls it right, so that its points are lost without a word."""
    learnt = replace(PROBLEM.wrong[0], function=memorised(PROBLEM.question(5)))
    made = row("00_warmup", replace(PROBLEM, wrong=(learnt,)), [5, 6])
    assert made.rejected == 1
    assert made.failures[-1].endswith("only hidden cases reject it; add a public case that does")


def test_the_command_prints_it(capsys):
    """One question alone; a question that nobody asks is a sentence."""
    assert main(["report-card", "00_warmup/joint_error", "--course", str(COURSE.root)]) == 0
    assert f"| 00_warmup/joint_error | {ALL}/{ALL} | {ALL}/{ALL} | 2/2 |" in capsys.readouterr().out
    with pytest.raises(UnknownName, match="treble"):
        list(rows(COURSE, ["00_warmup/treble"], 5, 1))
