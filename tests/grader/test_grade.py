"""Which answer of a notebook is taken and what it earns, without a sandbox: cells run here."""

from __future__ import annotations

from types import SimpleNamespace
from typing import ClassVar

import pytest
from handmade import FULL, NAME, QUICK, add, cell_of, put, raw

from labkit.course.calling import NoAnswer
from labkit.course.handin import receipt
from labkit.course.verdict import Kind
from labkit.errors import LabkitError
from labkit.grader import grade as module
from labkit.grader.grade import grade, hashes, rejection
from labkit.grader.plan import plan
from labkit.grader.results import engine
from labkit.grader.sandbox.parse import read
from labkit.grader.sandbox.protocol import Disconnected
from labkit.grader.submission import digest


class Here:
    """A session whose cells run in this process."""

    all: ClassVar[list[Here]] = []

    def __init__(self, sandbox, limits):
        self.steps, self.right, self.spent, self.closed = (), [], 0.25, 0
        self.answers, self.names, self.reports = {}, {}, []
        Here.all.append(self)

    def read(self, data):
        found = read(data)
        if "cells" not in found:
            raise LabkitError(found["rejected"])
        return found["cells"]

    def start(self):
        for step in self.steps:
            mine = {"predict": lambda name, value: value, "use": lambda name, own, given: own}
            try:
                exec(step.source, self.names)
            except Exception as error:
                about = {"kind": type(error).__name__, "error": str(error)}
                self.reports.append({"cell": step.number, **about})
            self.names |= mine
            self.answers |= {x: self.names[x] for x in step.answers if x in self.names}

    def failed(self):
        return tuple(self.reports)

    def close(self):
        self.closed += 1

    def close_question(self):
        pass


class Function:
    """An answer of such a session."""

    def __init__(self, question, session):
        self.question, self.session = question, session

    def __call__(self, *args, **kwargs):
        if self.question.name not in self.session.answers:
            raise NoAnswer("NameError", "NameError: it is not defined")
        answer = self.session.answers[self.question.name]
        return answer(*args, **kwargs) if callable(answer) else answer


@pytest.fixture
def marks(monkeypatch, bundle):
    """Grades a notebook."""
    monkeypatch.setattr(module, "Session", Here)
    monkeypatch.setattr(module, "RemoteFunction", Function)
    sandbox = SimpleNamespace(level="here")
    return lambda notebook, note="": grade(raw(notebook), "ada", bundle, sandbox, QUICK, note)


def about(result):
    return {q.verdict.name: (q.verdict.outcome.value, q.verdict.earned) for q in result.questions}


def notes(result, name):
    return next(q.notes for q in result.questions if q.verdict.name == name)


POINTS = {"bang_bang": 3.0, "circle": 4.0, "length": 2.0, "twice_the_time": 13.0}


def test_what_a_right_notebook_earns(marks, solved, blank, bundle):
    """All of it, the stubs nothing; the result says what it was made from and what it took."""
    result = marks(solved)
    assert about(result) == {name: ("right", points) for name, points in POINTS.items()}
    assert (result.score, result.points, result.rejected, result.notes) == (FULL, FULL, "", ())
    assert (result.assignment, result.student, result.isolation) == (NAME, "ada", "here")
    assert result.seed == bundle.data["seed"] and not result.cells and not result.own
    made = {"submission": digest(raw(solved)), "bundle": bundle.data["hash"], "engine": engine()}
    assert result.hashes == made == hashes(raw(solved), bundle)
    assert result.receipt == receipt(c["source"] for c in read(raw(solved))["cells"])
    assert result.seconds["student"] == 0.25 and 0.0 < result.seconds["all"] < 60.0
    assert (Here.all[-1].right, Here.all[-1].closed) == ([*POINTS], 1)
    nothing = marks(blank, "the file is called x.ipynb")
    assert {*about(nothing).values()} <= {("not attempted", 0.0), ("wrong", 0.0)}
    assert about(nothing)["circle"] == ("not attempted", 0.0)
    assert (nothing.score, nothing.notes) == (0.0, ("the file is called x.ipynb",))
    assert Here.all[-1].right == []


@pytest.mark.parametrize(
    ("source", "outcome", "said"),
    [
        ("# mine\n\n  # comes later", "not attempted", True),
        ("", "not attempted", True),
        ("def cricle(s, start, centre):\n    return s", "error", True),
        ("def circle(s:", "error", True),
        ("%%bash\ncircle=1", "error", True),
        ("circle = 3", "wrong", False),
        ("import labkit as lk\ndef circle(*a):\n    return lk.Circle(*a[1:])(a[0])", "not counted",
         True),
    ],
)  # fmt: skip
def test_a_cell_that_answers_nothing_costs_its_question_alone(marks, solved, source, outcome, said):
    """Emptied, misspelt, broken, with a magic, a value for a function, or with a withheld tool."""
    result = marks(put(solved, "circle", source))
    assert about(result)["circle"] == (outcome, 0.0) and result.score == FULL - 4.0
    assert bool(notes(result, "circle")) == said
    (answer,) = [q for q in result.questions if q.verdict.name == "circle"]
    assert answer.source == source
    assert bool(answer.verdict.withheld) == (outcome == "not counted")


def test_which_answer_is_taken(marks, solved, blank, bundle):
    """The last that is no stub, by its name in any cell; a value only if its own cell has none."""
    answer, stub = cell_of(solved, "circle"), cell_of(blank, "circle")
    solved["cells"].insert(solved["cells"].index(answer) + 1, stub)
    result = marks(solved)
    assert result.score == FULL and not notes(result, "circle")
    wrong = "def circle(s, start, centre):\n    return None"
    add(solved, wrong, at=len(solved["cells"]))
    twice = marks(solved)
    assert about(twice)["circle"] == ("wrong", 0.0) and len(notes(twice, "circle")) == 1
    solved["cells"].remove(answer)
    del solved["cells"][-1]
    elsewhere = add(solved, "".join(answer["source"]), at=3)
    assert marks(elsewhere).score == FULL
    own = "".join(cell_of(solved, "twice_the_time")["source"])
    value = add(put(solved, "twice_the_time", own), "twice_the_time = 9", at=len(solved["cells"]))
    todo = plan(read(raw(value))["cells"], bundle.data["cells"])
    assert todo.source("twice_the_time") == own
    assert not [step for step in todo.steps if step.source == "".join(stub["source"])]


def test_what_is_missing_or_was_never_asked(marks, solved):
    """A deleted cell costs its question; own cells run, are kept where they were, and may fail."""
    solved["cells"].remove(cell_of(solved, "circle"))
    add(solved, "x = 1", at=len(solved["cells"]))
    add(solved, "raise ValueError('no')", at=0)
    result = marks(solved)
    assert about(result)["circle"] == ("error", 0.0) and result.score == FULL - 4.0
    assert [cell["source"] for cell in result.own] == ["raise ValueError('no')", "x = 1"]
    assert result.own[0]["after"] == "" != result.own[1]["after"]
    assert [(x["cell"], x["kind"], x["error"]) for x in result.cells] == [(0, "ValueError", "no")]


def test_walk_cells_run_only_if_an_answer_needs_them(marks, solved):
    """Then in their place, as they were released."""
    marks(solved)
    assert not [step for step in Here.all[-1].steps if "def given_bang_bang" in step.source]
    put(solved, "circle", "def circle(*a):\n    return given_bang_bang(0.0, 1.0)")
    result = marks(solved)
    assert [step for step in Here.all[-1].steps if "def given_bang_bang" in step.source]
    assert about(result)["circle"][0] == "wrong"


@pytest.mark.parametrize("uses", ["bang_bang", "my_bang_bang"])
def test_an_answer_that_uses_a_wrong_one_says_so(marks, solved, uses):
    """Itself or by `use`; a right answer that uses it says nothing."""
    put(solved, "bang_bang", "def bang_bang(t, T): return 0.0, 0.0, 0.0")
    own = "".join(cell_of(solved, "length")["source"])
    put(solved, "length", f"{own}\nother = {uses}")
    put(solved, "circle", f"def circle(*_): return {uses}(0, 1)")
    result = marks(solved)
    (note,) = notes(result, "circle")
    assert "uses your bang_bang, which is not right" in note
    assert not notes(result, "length") and not notes(result, "bang_bang")


def test_two_wrong_ones_are_named_together(marks, solved):
    put(solved, "bang_bang", "def bang_bang(t, T): return 0.0, 0.0, 0.0")
    put(solved, "length", "def length(p): return -1.0")
    put(solved, "circle", "def circle(*_): return bang_bang(0, 1), length")
    (note,) = notes(marks(solved), "circle")
    assert "bang_bang and length, which are not right; correct them first" in note


def test_only_public_cases_open_an_answer_to_others(marks, solved):
    """One that only a hidden case refuses is wrong, and `use` still returns it."""
    own = "".join(cell_of(solved, "bang_bang")["source"])
    calls = f"seen = []\n{own}\nmine = bang_bang\ndef bang_bang(t, T):\n    seen.append(t)\n"
    put(solved, "bang_bang", f"{calls}    return mine(t, T) if len(seen) < 6 else 0.0")
    result = marks(solved)
    assert about(result)["bang_bang"][0] == "wrong" and "bang_bang" in Here.all[-1].right
    assert any(x.hidden for x in result.questions[0].verdict.tests)


def foreign(names):
    return [{"cell_type": "code", "source": "1",
             "metadata": {"nbgrader": {"grade_id": name}}} for name in names]  # fmt: skip


@pytest.mark.parametrize(("others", "refused"), [(4, False), (5, True)])
def test_a_notebook_of_another_assignment_is_rejected(marks, bundle, others, refused):
    """If it has no cell of an answer, and most of its named cells are unknown here."""
    cells = foreign([*(f"{name}-check" for name in POINTS), *(f"x{k}" for k in range(others))])
    result = marks({"nbformat": 4, "cells": cells})
    assert bool(result.rejected) == refused and result.score == 0.0
    assert (result.questions == ()) == refused
    cells += foreign(["length"])
    assert not marks({"nbformat": 4, "cells": cells}).rejected
    assert not marks({"nbformat": 4, "cells": []}).rejected


def test_texts_are_cut_to_what_a_result_may_hold(marks, solved):
    """Answers first, then the rest; the points stay, and a note says so."""
    assert not marks(add(solved, "# " + "x" * 900_000)).notes
    add(solved, "raise ValueError('z' * 3_000_000)")
    result = marks(add(solved, "# " + "y" * 900_000))
    assert result.score == FULL and result.notes[0].endswith("cut short: 2")
    assert len(result.text()) < 2_000_000
    assert "".join(cell_of(solved, "circle")["source"]) in [q.source for q in result.questions]


def test_an_answer_too_odd_to_be_compared_or_drawn_costs_itself(marks, solved, monkeypatch):
    """It is an error, or it has no figure; the others stand."""

    def odd(question, *_):
        if question.name == "circle":
            raise ZeroDivisionError
        return real(question, *_)

    for name in ("mark", "try_public"):
        with monkeypatch.context() as patch:
            real = getattr(module, name)
            patch.setattr(module, name, odd)
            result = marks(solved)
        assert about(result)["circle"] == ("error", 0.0) and result.score == FULL - 4.0
        tests = result.questions[1].verdict.tests
        assert {t.difference.kind for t in tests if t.difference} == {Kind.OTHER}
    put(solved, "circle", "def circle(*_): return 1.0")
    real = module.evidence.numbers
    monkeypatch.setattr(module.evidence, "numbers", odd)
    assert about(marks(solved))["circle"] == ("wrong", 0.0)


def test_the_numbers_of_a_wrong_answer_are_kept(marks, solved):
    result = marks(put(solved, "length", "def length(p): return -1.0"))
    wrong = next(q for q in result.questions if q.verdict.name == "length")
    assert wrong.numbers["given"] == [-1.0] and wrong.runs == ()
    assert all(q.numbers is None for q in result.questions if q.verdict.right)


def test_a_session_that_cannot_start_leaves_errors(marks, solved, monkeypatch):
    def start(self):
        raise Disconnected("it died too often")

    monkeypatch.setattr(Here, "start", start)
    assert {x for x, _ in about(marks(solved)).values()} == {"error"}


def test_a_rejection_has_no_points(bundle):
    result = rejection("no\nfile", "ada", bundle, "here", b"x")
    assert (result.rejected, result.score, result.points) == ("no file", 0.0, FULL)
    assert result.questions == () and result.hashes["submission"] == digest(b"x")
    assert result.isolation == "here"


def test_a_file_that_cannot_be_read_is_rejected(marks):
    """With no points, and its session is closed."""
    result = marks({"nbformat": 3, "cells": []})
    assert result.rejected and result.score == 0.0 and Here.all[-1].closed == 1
