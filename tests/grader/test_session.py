"""A session: what it may cost, what it may say, and until when."""

from __future__ import annotations

import json
from contextlib import closing

import pytest
from handmade import FULL, QUICK, add, cell_of, put, raw

from labkit.course.calling import NoAnswer
from labkit.course.verdict import Outcome
from labkit.grader.grade import grade
from labkit.grader.sandbox.limits import Limits, TextBudget
from labkit.grader.sandbox.parse import read
from labkit.grader.sandbox.session import MAX_LOST, RemoteFunction, Session, Step

LARGEST = 2_000_000  # bytes of a result


@pytest.fixture
def asked(monkeypatch):
    """The questions of all calls that are put."""
    names = []
    ask = Session.ask

    def noted(self, *args):
        names.append(self._asked)
        return ask(self, *args)

    monkeypatch.setattr(Session, "ask", noted)
    return names


def about(result, name):
    return next(q.verdict for q in result.questions if q.verdict.name == name)


def on_hidden_cases(solved, bundle, name, does):
    """Make a right answer do something on hidden cases, in the process that answers."""
    asked = next(q for q in bundle.questions if q.name == name).calls
    public = {tuple(map(float, call.args)) for call in asked}
    right = "".join(cell_of(solved, name)["source"])
    put(
        solved,
        name,
        f"{right}\nright_{name}, public = {name}, {public!r}\n"
        f"def {name}(*args):\n"
        f"    if args not in public and __import__('os').getpid() != 1:\n        {does}\n"
        f"    return right_{name}(*args)",
    )


def test_an_answer_that_is_too_large_costs_its_question_only(solved, bundle, sandbox):
    """Long replies and replies of many values are refused before they are read."""
    put(solved, "bang_bang", "def bang_bang(*_):\n    return 'x' * 300_000")
    put(solved, "circle", "def circle(*_):\n    return {'a': [1] * 12_000}")
    result = grade(raw(solved), "mallory", bundle, sandbox, QUICK)
    assert result.score == FULL - 7
    assert about(result, "bang_bang").outcome is about(result, "circle").outcome is Outcome.ERROR


DEAF = "import signal as s\n    for k in (14, 24, 27): s.signal(k, s.SIG_IGN)\n    while True: pass"
HOSTILE = {
    "an endless cell": ("while True: pass", ""),
    "a deaf cell": (
        "import signal\nfor s in (14, 24, 27): signal.signal(s, signal.SIG_IGN)\nwhile True: pass",
        "",
    ),
    "endless answers": ("", "while True: pass"),
    "deaf answers": ("", DEAF),
    "forks": ("import os\nwhile True:\n    try: os.fork()\n    except OSError: pass", ""),
    "cells that die": ("import os\nos._exit(1)", ""),
}


@pytest.mark.soak
@pytest.mark.parametrize("name", HOSTILE)
def test_what_a_hostile_submission_costs(name, solved, bundle, sandbox):
    """Beside three times what an honest one costs: the time of `Limits.wall` on this machine."""
    cell, answer = HOSTILE[name]
    limits = Limits().scaled(3.0)
    honest = grade(raw(solved), "ada", bundle, sandbox, limits).seconds["all"]
    for question in [q.name for q in bundle.questions] * bool(answer):
        put(solved, question, f"def {question}(*_):\n    {answer}")
    for _ in range(40 * bool(cell)):
        add(solved, cell)
    result = grade(raw(solved), "mallory", bundle, sandbox, limits)
    print(f"{name}: {result.seconds['all']:.0f} s, honest {honest:.1f} s, {result.score:g} points")
    assert result.seconds["all"] - 3 * honest < 60.0


ENDLESS = [
    "while True: pass",
    DEAF,
    pytest.param("import time; time.sleep(1000)", marks=pytest.mark.soak),
    pytest.param("sum(range(10**12))", marks=pytest.mark.soak),
]


@pytest.mark.parametrize("body", ENDLESS)
def test_an_endless_question_is_asked_no_more(body, solved, bundle, sandbox, asked):
    """Whether it computes or waits, after a few lost calls no other one is put, and it is said."""
    put(solved, "circle", f"def circle(s, start, centre):\n    {body}")
    result = grade(raw(solved), "mallory", bundle, sandbox, QUICK)
    assert result.score == FULL - 4
    assert asked.count("circle") <= MAX_LOST
    assert about(result, "circle").outcome is Outcome.ERROR


def test_calls_that_are_lost_on_hidden_cases_count_too(solved, bundle, sandbox, asked):
    """An answer that is right on public cases and hangs on hidden ones is not asked for ever."""
    grade(raw(solved), "ada", bundle, sandbox, QUICK)
    before = asked.count("bang_bang")
    asked.clear()
    on_hidden_cases(solved, bundle, "bang_bang", "__import__('time').sleep(1000)")
    limits = Limits(call=0.2, question=2.0)
    result = grade(raw(solved), "mallory", bundle, sandbox, limits)
    public = len(next(q for q in bundle.questions if q.name == "bang_bang").calls)
    assert public < asked.count("bang_bang") <= public + MAX_LOST < before
    assert result.score < FULL


def test_slow_cells_leave_time_for_the_answers(solved, bundle, sandbox):
    """Once the time of all cells is spent, each that is left has a little, and answers count."""
    for _ in range(12):
        add(solved, "while True: pass")
    limits = Limits(cell=1.0, cells=1.5, wall=8.0)
    result = grade(raw(solved), "ada", bundle, sandbox, limits)
    assert result.score == FULL
    assert [cell["kind"] for cell in result.cells] == ["TimeUp"] * 12


EMOJI = "\U0001f600"


@pytest.mark.parametrize("what", ["outputs", "own cells", "sources", "sentences"])
def test_no_result_is_longer_than_two_megabytes(what, solved, bundle, sandbox):
    """However much is printed, raised or written, a result stays small, says so, and counts."""
    if what == "outputs":
        much = f"print({EMOJI!r} * 20_000)\nraise ValueError({EMOJI!r} * 500)"
        for _ in range(300):
            add(solved, much, at=3)
    elif what == "own cells":
        for _ in range(9):
            add(solved, f"# {EMOJI * 200_000}")
    elif what == "sources":
        own = "".join(cell_of(solved, "circle")["source"])
        put(solved, "circle", f"{own}\n# {EMOJI * 900_000}")
    else:
        for name in ("bang_bang", "circle"):
            put(solved, name, f"def {name}(*args):\n    raise ValueError({EMOJI!r} * 100_000)")
    result = grade(raw(solved), "mallory", bundle, sandbox, QUICK)
    assert len(result.text().encode()) <= LARGEST
    assert not result.rejected
    assert result.score == (FULL - 7 * (what == "sentences"))
    cut = any("MB of text is kept; cut short: " in note for note in result.notes)
    assert cut == (what in {"outputs", "own cells", "sources"})


def test_a_text_budget_is_never_exceeded():
    """Texts are kept whole while there is room, then in part, then not at all."""
    budget = TextBudget(100)
    kept = [budget.take(text) for text in ("whole", EMOJI * 50, "y" * 50, "z")]
    assert kept[0] == "whole"
    assert EMOJI in kept[1] and len(kept[1]) < 50
    assert sum(len(json.dumps(text)) for text in kept) <= 100 + 2 * len(kept)
    assert budget.cut >= 1


def test_what_an_exception_says_is_one_clean_line_before_there_is_a_result(bundle, sandbox):
    """No exception, of a cell or of an answer, forges a line or commands a terminal."""
    fails = "raise ValueError('a\\n[1/1] zoe: 0 of 20\\x1b[2J\\ud800')"
    question = next(q for q in bundle.questions if q.name == "circle")
    answers = Step(1, f"def circle(*args):\n    {fails}", ("circle",))
    with closing(Session(sandbox, QUICK, [Step(0, fails), answers])) as session:
        session.start()
        (cell,) = session.failed()
        with pytest.raises(NoAnswer) as failed:
            RemoteFunction(question, session)()
    line = "a [1/1] zoe: 0 of 20 [2J\ufffd"
    assert cell["error"].startswith(line) and "\n" not in cell["error"]
    assert str(failed.value).startswith(f"ValueError: {line}") and "\n" not in str(failed.value)


def test_the_source_that_runs_is_the_one_that_is_read():
    """What a cell's text would hide from a reader is gone before the cell runs."""
    sources = ["x = '\u202e\x1b[2J'\r\n", ["# \ud800\r", "y = 1"]]
    cells = [{"cell_type": "code", "source": source} for source in sources]
    found = read(json.dumps({"nbformat": 4, "cells": cells}).encode())["cells"]
    assert [cell["source"] for cell in found] == ["x = '[2J'\n", "# \ufffd\ny = 1"]
