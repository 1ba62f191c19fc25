"""The isolated engine: verdicts, limits, repairs, and that nothing depends on who else is there."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from handmade import FULL, NAME, QUICK, add, cell_of, put, raw, timeless

from labkit.course import Call, Loop, question_data, read_question
from labkit.course.authoring.bundle import Bundle
from labkit.course.judges import Close
from labkit.course.marking import mark
from labkit.course.messages import why
from labkit.course.question import Question, Test
from labkit.course.verdict import Outcome
from labkit.grader.grade import grade


def verdict(result, name):
    return next(q.verdict for q in result.questions if q.verdict.name == name)


def earned(result):
    return {q.verdict.name: q.verdict.earned for q in result.questions}


@pytest.fixture
def marks(bundle, sandbox):
    """Grades a notebook."""
    return lambda notebook: grade(raw(notebook), "ada", bundle, sandbox, QUICK)


def test_full_marks_and_none(marks, solved, blank):
    """The answers earn everything, the stubs nothing, and a stub is no error."""
    assert marks(solved).score == FULL
    result = marks(blank)
    assert result.score == 0
    assert {q.verdict.outcome for q in result.questions} == {"not attempted"}


def test_same_verdicts_as_in_the_notebook(marks, blank, released, bundle):
    """Each known mistake is told by the same words here as by `mark` in one process."""
    from tests.synthetic.inline import inline

    problems = {p.name: p for p in released.problems(NAME)}
    questions = {q["name"]: read_question(q) for q in bundle.data["questions"]}
    for k in range(2):
        for name, problem in problems.items():
            wrong = problem.wrong[k % len(problem.wrong)].function
            put(blank, name, inline(wrong, name))
        result = marks(blank)
        for name, problem in problems.items():
            here = mark(questions[name], problem.wrong[k % len(problem.wrong)].function)
            assert next(q.verdict for q in result.questions if q.verdict.name == name) == here


def test_noise_costs_nothing(marks, solved):
    """Prints, warnings and C streams in cells and functions leave full marks."""
    noise = "import os, sys, warnings\nprint('x'); print('y', file=sys.stderr)\n"
    noise += "warnings.warn('z'); os.write(2, b'w')"
    cell = cell_of(solved, "circle")
    add(solved, noise)
    cell["source"] = f"{noise}\n{''.join(cell['source'])}"
    assert marks(solved).score == FULL


def test_an_answer_may_lean_on_cells_of_any_kind(marks, solved):
    """Helpers in own cells and in walk-through cells, above and below, are there when needed."""
    own = "".join(cell_of(solved, "circle")["source"]).replace("def circle", "def mine")
    put(solved, "circle", "def circle(*a):\n    return same(mine)(*a)")
    add(solved, own, at=2)
    add(solved, "def same(x):\n    return x", at=len(solved["cells"]))
    assert marks(solved).score == FULL
    put(solved, "circle", "def circle(*a):\n    return given_bang_bang(0.0, 1.0)")
    assert "NameError" not in why(verdict(marks(solved), "circle").tests[0])


YOURS = """
def given_half(): raise AssertionError
half = use("bang_bang", bang_bang, {given}, yours=lambda: bang_bang(1.0, 2.0)[0])
"""


@pytest.mark.parametrize(
    ("answer", "given", "points"),
    [
        (None, "given_half", 4),  # one's own is right: it is used, as it was wrapped
        ("def bang_bang(t, duration): return 0.0, 0.0, 0.0", "lambda: 0.5", 4),  # wrong: what is given
        ("def bang_bang(t, duration): return 0.5, 0.0, 0.0", "lambda: 1.0", 0),
    ],
)  # fmt: skip
def test_an_answer_leans_on_what_use_chose_in_the_notebook(marks, solved, answer, given, points):
    """`use` means the same here: one's own function where that is right, else the one given."""
    if answer:
        put(solved, "bang_bang", answer)
    at = solved["cells"].index(cell_of(solved, "bang_bang")) + 1
    add(solved, YOURS.format(given=given), at)
    own = "".join(cell_of(solved, "circle")["source"])
    put(
        solved,
        "circle",
        f"{own}\nmine = circle\ndef circle(s, *a): return mine(s + half() - 0.5, *a)",
    )
    assert earned(marks(solved))["circle"] == points


def test_state_survives_between_calls_but_not_between_questions(marks, solved):
    """A function may remember; another question does not see it."""
    own = "".join(cell_of(solved, "circle")["source"])
    put(solved, "circle", f"seen = []\n{own}\nmine = circle\ndef circle(*a):\n    seen.append(1)\n"
        "    return mine(*a) if len(seen) < 40 else 0.0")  # fmt: skip
    assert earned(marks(solved))["circle"] == 4


@pytest.mark.parametrize(
    ("bodies", "says"),
    [
        (
            ("import os; os._exit(1)", "import ctypes; ctypes.string_at(0)"),
            ("its process ended",) * 2,
        ),
        (("while True: pass", "return bytearray(10**10)"), ("within 1 s", "MemoryError")),
        (
            ("import sys; sys.exit()", "return undefined"),
            ("SystemExit", "'undefined' is not defined"),
        ),
    ],
)
def test_one_question_lost(marks, solved, bodies, says):
    """Whatever happens to one question, it says so, and the others keep their points."""
    names = ("bang_bang", "circle")
    for name, body in zip(names, bodies, strict=True):
        put(solved, name, f"def {name}(*_):\n    {body}")
    result = marks(solved)
    assert result.score == FULL - 7
    for name, words in zip(names, says, strict=True):
        assert verdict(result, name).outcome is Outcome.ERROR
        assert words in why(verdict(result, name).tests[0])


def test_a_deadly_cell_is_left_out(marks, solved):
    """A cell that ends the process costs nothing else, and is named."""
    result = marks(add(solved, "import os\nos._exit(1)"))
    assert result.score == FULL
    assert [c["error"] for c in result.cells] == ["it ended the process"]


def test_hidden_cases_stay_hidden(marks, solved):
    """What a result says of a hidden case is its class, nothing more."""
    own = "".join(cell_of(solved, "bang_bang")["source"])
    put(solved, "bang_bang", f"seen = []\n{own}\nmine = bang_bang\ndef bang_bang(t, T):\n"
        "    seen.append(t)\n    if len(seen) > 5: raise type('T' + str(t), (Exception,), {})\n"
        "    return mine(t, T)")  # fmt: skip
    (hidden,) = [x for x in verdict(marks(solved), "bang_bang").tests if x.hidden]
    assert why(hidden).endswith((")", "a hidden case"))


def test_big_pictures_are_welcome(bundle, sandbox, solved):
    """Thirty megabytes of outputs are no reason to refuse."""
    walk = next(c for c in solved["cells"] if c["cell_type"] == "code")
    data = {"image/png": "A" * (30 * 2**20)}
    walk["outputs"] = [{"output_type": "display_data", "metadata": {}, "data": data}]
    assert grade(raw(solved), "ada", bundle, sandbox, QUICK).score == FULL


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"{",
        pytest.param(b"[" * 100_000, id="deep"),
        b"[]",
        b'{"cells": [], "nbformat": 3}',
        b'{"cells": "x", "nbformat": 4}',
        json.dumps({"cells": [{}] * 1001, "nbformat": 4}).encode(),
        json.dumps({"cells": [{"source": "x" * 2_100_000}], "nbformat": 4}).encode(),
    ],
)
def test_rejected_in_one_sentence(data, bundle, sandbox):
    """A file that is no notebook ends in a result with one sentence."""
    result = grade(data, "ada", bundle, sandbox, QUICK)
    assert result.score == 0 and result.rejected and "\n" not in result.rejected


ODD = (
    None, 1, {"source": {}}, {"source": [1]}, {"cell_type": "code"},
    *({"cell_type": "code", "source": x} for x in ("\ud800", "(" * 500, "x = '\0'")),
    {"cell_type": "code", "source": "1", "metadata": [1], "id": 5},
)  # fmt: skip


def test_odd_cells_harm_nobody(marks, solved):
    """A cell of any form is passed over."""
    solved["cells"][1:1] = ODD
    assert marks(solved).score == FULL


@pytest.mark.parametrize(
    "magics", [("%%time", "%%prun -q"), ("%%capture x --no-stderr", "\n%%time\n%%capture")]
)
def test_a_magic_that_runs_its_cell_costs_nothing(marks, solved, magics):
    """An answer below %%time or its like is there in the notebook, and so it is here."""
    for name, magic in zip(("bang_bang", "circle"), magics, strict=True):
        put(solved, name, f"{magic}\n{''.join(cell_of(solved, name)['source'])}")
    assert marks(solved).score == FULL


def test_a_mark_does_not_depend_on_what_cannot_be_shown(marks, solved):
    """Surrogates, marks of direction, escapes and old line ends cost nothing and are not kept."""
    for cell in solved["cells"]:
        if cell["metadata"]["lab"] == "answer":
            text = "".join(cell["source"]).replace("\n", "\r\n")
            cell["source"] = f"# \ud800 \u202e \x1b[2J\r{text}\r\n\x0cx = '\\ud800'\r\n"
            cell["metadata"]["nbgrader"]["solution"] = "\udfff"
    add(solved, "\ud83d = 1\n# \u2066 \u2028")
    result = marks(solved)
    assert result.score == FULL
    sources = [q.source for q in result.questions] + [own["source"] for own in result.own]
    assert all("x = '\\ud800'" in source for source in sources[:-1])
    for text in sources:
        text.encode("utf-8")
        assert not set(text) & set("\r\x0c\x1b\u202e\u2066\u2028")


def test_the_arm_stays_with_the_checker(bundle, sandbox, blank):
    """In a closed loop the sandbox maps observation to command, and gives the same measures as
    a function in one process."""  # noqa: D205, D209
    import labkit as lk

    target = lk.Trajectory(lk.Line(np.zeros(7), 0.1 * np.ones(7)), lk.Quintic(0.5))
    loop = Loop(target, kwargs={"gain": 2.0}, q0=np.zeros(7) + 0.01,
                expected={"joint_rms_rad": 1.0}, hidden=True)  # fmt: skip
    question = Question("follow", 4.0, "Follow.", Close(), (Test("it follows", (loop,)),))
    source = ("import labkit as lk\ndef follow(state, target, gain):\n"
              "    return lk.JointVelocity(target.velocity + gain * (target.position - state.q))")  # fmt: skip
    names: dict[str, object] = {}
    exec(source, names)
    here = loop.measured(loop.ask(names["follow"]))
    measure = next(iter(here))
    limits = {measure: here[measure] * (1 + 1e-9)}
    for share, points in ((1.0, 4.0), (0.999, 0.0)):
        tight = Loop(**(vars(loop) | {"expected": {measure: limits[measure] * share}}))
        asked = Question("follow", 4.0, "Follow.", Close(), (Test("it follows", (tight,)),))
        data = bundle.data | {"questions": [question_data(asked)], "cells": [
            {"id": "x", "type": "code", "kind": "answer", "grade_id": "follow", "source": ""}]}  # fmt: skip
        notebook = {"nbformat": 4, "cells": [{"cell_type": "code", "id": "x", "source": source}]}
        result = grade(raw(notebook), "ada", Bundle(data), sandbox, QUICK)
        assert result.score == points, result.questions
        assert result.questions[0].runs == (), "a hidden run is not for his eyes"
    tests = (Test("it follows", (replace(tight, hidden=False),)),)
    shown = Bundle(data | {"questions": [question_data(replace(question, tests=tests))]})
    seen = [grade(raw(notebook), "ada", shown, sandbox, QUICK) for _ in range(2)]
    (run,) = seen[0].questions[0].runs
    assert run["measures"][measure] == pytest.approx(here[measure], rel=1e-5)
    assert run["motion"]
    assert timeless(seen[0]) == timeless(seen[1]), "the same run again, to the last digit"
    assert question.calls == ()
    assert isinstance(Call((1,)), Call)
