"""The report card: it counts what the checks do, and tells on them."""

from pathlib import Path

import pytest

from labkit.__main__ import main
from labkit.course import Outcome
from labkit.course.authoring import report_card
from labkit.course.authoring.layout import Course
from labkit.course.authoring.refusals import memorised
from labkit.course.authoring.report_card import functions_from, make, markdown, write
from labkit.course.marking import mark
from labkit.errors import LabkitError, UnknownName

COURSE = Course.here(Path(__file__))
FILE = """
MISTAKES = {"joint_error": [lambda target, state: 0.5 * (target.position - state.q)]}
VARIANTS = {"00_warmup/joint_error": [lambda target, state: -(state.q - target.position),
                            lambda target, state: state.q]}
"""

ODD = """
import os, warnings
class Odd:
    def __getattribute__(self, name): raise ZeroDivisionError
class Mute(Exception):
    def __str__(self): raise ZeroDivisionError
def prints(target, state): print("\\x1b[2J" * 10**6); return 0.0
def writes(target, state): os.write(1, b"\\x1b[2J"); return 0.0
def warns(target, state): warnings.warn("\\x1b[2J"); return 0.0
def leaves(target, state): raise GeneratorExit
def is_mute(target, state): raise Mute
def is_odd(target, state): return Odd()
MISTAKES = {"joint_error": [prints, writes, warns, leaves, is_mute, is_odd]}
"""


@pytest.fixture(scope="module")
def card(tmp_path_factory):
    """The card of the warm-up, with answers from outside."""
    file = tmp_path_factory.mktemp("outside") / "answers.py"
    file.write_text(FILE)
    given = [functions_from(file, table) for table in ("MISTAKES", "VARIANTS")]
    return make(COURSE, ["00_warmup"], 5, *given)


def test_it_counts(card):
    """Every mistake is rejected and named, every right answer accepted, draws agree."""
    rows = {row.question: row for row in card.rows}
    for name, row in rows.items():
        assert row.rejected == row.mistakes and row.seeds_agree == card.seeds
        if name != "joint_error":
            assert row.named == row.mistakes and row.accepted == row.variants
            assert not row.failures
            assert row.margin_sigma is None or row.margin_sigma > 3.0


def test_answers_from_outside_count(card):
    """A foreign mistake is rejected, a foreign answer accepted, a wrong one told."""
    row = next(row for row in card.rows if row.question == "joint_error")
    problem = next(p for p in COURSE.problems("00_warmup") if p.name == "joint_error")
    assert row.mistakes == len(problem.wrong) + 1 and row.named == len(problem.wrong)
    assert row.variants == 1 + len(problem.variants) + 2, "though both are called <lambda>"
    assert row.accepted == row.variants - 1
    assert any("a right answer earned only 0" in words for words in row.failures)
    assert any("sigma from the tolerance; at least 3 are needed" in words for words in row.failures)
    assert row.margin_sigma < 0.0, "what claims to be right lies beyond the tolerance"


def test_a_mistake_that_only_hidden_cases_reject_fails():
    """The student's check calls it right, so that its points are lost without a word."""
    problem = next(p for p in COURSE.problems("00_warmup") if p.name == "joint_error")
    learnt = {"joint_error": [memorised(problem.question(5))]}
    (row,) = make(COURSE, ["00_warmup/joint_error"], 5, learnt, draws=2).rows
    assert row.rejected == row.mistakes
    (failure,) = row.failures
    assert failure.endswith("recite: only hidden cases reject it; add a public case that does")


def test_an_answer_nearer_than_three_sigma_fails(tmp_path, monkeypatch, capsys):
    """The least margins are said with their questions, and the command ends with 1."""
    words = ["report-card", "00_warmup/transform_point", "00_warmup/joint_error", "--draws", "2"]
    words += ["--course", str(COURSE.root), "--to", str(tmp_path)]
    assert main(words) == 0
    margins = iter([(3.5, "a"), (2.97, "the answer: seven errors")])
    monkeypatch.setattr(report_card, "least_margin", lambda *_: next(margins))
    assert main(words) == 1
    page = capsys.readouterr().out
    least = "2.97 (00_warmup/joint_error), 3.50 (00_warmup/transform_point)"
    assert f"least margins, in sigma: {least}" in page
    assert "the answer: seven errors: 2.97 sigma from the tolerance; at least 3 are needed" in page


def test_an_answer_from_outside_spoils_nothing_for_the_others():
    """One that changes what it is given is rejected; every other answer has its input whole."""

    def eats(durations, t):
        k = 0
        while len(durations) > 1 and t >= durations[0]:
            t -= durations.pop(0)
            k += 1
        return k, t

    def writes(s, start, centre):
        start[:] = 0.0
        return None

    problems = {p.name: p for p in COURSE.problems("01_paths")}
    for name, function in (("segment_at", eats), ("circle", writes)):
        questions = problems[name].question(1), problems[name].question(2)
        assert all(mark(question, function).earned == 0 for question in questions)
        for answer in (problems[name].answer, *problems[name].variants):
            assert all(mark(q, answer).outcome is Outcome.RIGHT for q in questions)


def test_answers_from_outside_print_nothing_and_end_nothing(tmp_path, capfd):
    """What one writes to a stream is not shown; whatever one raises or gives back is an answer."""
    file = tmp_path / "answers.py"
    file.write_text(ODD)
    rows = make(COURSE, ["00_warmup"], 5, functions_from(file, "MISTAKES"), draws=2).rows
    row = next(row for row in rows if row.question == "joint_error")
    assert row.rejected == row.mistakes > 6
    assert capfd.readouterr() == ("", "")


def test_written(card, tmp_path):
    """Totals are numbers, never infinities, and the page holds a line for each question."""
    table, page = write(card, tmp_path)
    data = card.data()
    assert "Infinity" not in table.read_text() and "NaN" not in table.read_text()
    assert data["mistakes"] == data["rejected"] and data["seeds_agree"] == 20
    assert data["min_margin_sigma"] == min(row.margin_sigma for row in card.rows)
    assert page.read_text() == markdown(card)
    assert all(f"| {row.question} |" in page.read_text() for row in card.rows)


def test_what_cannot_be_read_is_a_sentence(tmp_path):
    """A missing file, a file without the dicts, a question that nobody asks."""
    with pytest.raises(LabkitError, match="does not run: FileNotFoundError"):
        functions_from(tmp_path / "none.py", "MISTAKES")
    (tmp_path / "empty.py").write_text("x = 1\n")
    with pytest.raises(LabkitError, match="no dict VARIANTS"):
        functions_from(tmp_path / "empty.py", "VARIANTS")
    (tmp_path / "cut.py").write_text("MISTAKES = {")
    with pytest.raises(LabkitError, match="does not run: SyntaxError"):
        functions_from(tmp_path / "cut.py", "MISTAKES")
    (tmp_path / "number.py").write_text("MISTAKES = {'joint_error': [1]}")
    with pytest.raises(LabkitError, match="is not a list of functions"):
        functions_from(tmp_path / "number.py", "MISTAKES")
    with pytest.raises(UnknownName):
        make(COURSE, ["00_warmup"], 5, {"treble": [abs]})
    with pytest.raises(UnknownName, match="treble"):
        make(COURSE, ["00_warmup/treble"], 5)
