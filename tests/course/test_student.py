"""What a notebook says: check and use."""

import ast
import json
import os
import shutil
import subprocess
import sys
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from questions import DOUBLE, double, square

import labkit as lk
from labkit.course import check, question_data, use
from labkit.course import student as notebook
from labkit.course.marking import mark, not_counted
from labkit.course.notebook import FILE, verdict_in
from labkit.course.serialize import record_data
from labkit.errors import LabkitError, UnknownName
from labkit.formats import stamp
from solutions.paths import answers


def stub(x):
    raise NotImplementedError


@pytest.fixture(autouse=True)
def desk(tmp_path, monkeypatch):
    """A folder with questions in it."""
    questions = [question_data(DOUBLE), question_data(replace(DOUBLE, name="again"))]
    data = {**stamp(), "assignment": "sample", "questions": questions}
    (tmp_path / FILE).write_text(json.dumps(data))
    monkeypatch.chdir(tmp_path)
    notebook._desks.clear()
    return tmp_path


def test_check_prints_and_ends_in_a_float(capfd):
    """The last line's value, which nbgrader reads, is a float, whatever the answer was."""
    for function, points in ((double, 4.0), (square, 0.0), (stub, 0.0), (lambda x: 1 / 0, 0.0)):
        earned = check("double", function)
        assert isinstance(earned, float) and earned == points
        out, err = capfd.readouterr()
        assert out.startswith("double: ") and err == ""


def test_streams_and_warnings_are_caught(capfd):
    """Prints, stderr, C's streams and warnings do not get through; they are told instead."""

    def loud(x):
        print("to stdout")
        print("to stderr", file=sys.stderr)
        warnings.warn("careful", stacklevel=1)
        os.write(2, b"from below\n")
        return 2 * x

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert check("double", loud) == 4.0
    out, err = capfd.readouterr()
    assert err == ""
    assert "your code printed" in out and "to stderr" in out


def test_an_answer_that_leans_on_a_wrong_one_is_told(capsys):
    """Where a function calls another answer that is not right, that one is to be mended first.

    A method of the same name, such as a model's, is not the student's answer.
    """
    answers = {"square": square}
    exec("def double(x):\n    return square(x)\ndef again(x):\n    return double(x)", answers)
    exec("def method(x):\n    return x.double(x)", answers)
    check("double", answers["double"])
    assert "it uses your" not in capsys.readouterr().out
    check("again", answers["again"])
    says = "It uses your double, which is not right yet; correct it first."
    assert says in " ".join(capsys.readouterr().out.split())
    assert notebook.desk().wrong_dependencies("again", answers["again"]) == ("double",)
    assert notebook.desk().wrong_dependencies("again", answers["method"]) == ()
    answers["double"] = double  # corrected, and not checked again: its old verdict is not quoted
    assert notebook.desk().wrong_dependencies("again", answers["again"]) == ()


KERNEL = """
import os
os.chdir({folder!r})
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output
shell = InteractiveShell.instance()
def run(cell):
    with capture_output() as out:
        assert shell.run_cell(cell, store_history=True).success
    return [(o.data["text/plain"].splitlines()[0], o.metadata["labkit"]) for o in out.outputs]
run("import labkit as lk; from labkit.course import check")
"""


def test_in_a_notebook_the_cells_tell_and_the_output_keeps_the_verdict(desk):
    """The answer's text that ran last counts; other cells may use what they like."""
    circle = replace(DOUBLE, name="double", withheld=("labkit.Circle",))
    data = {**stamp(), "assignment": "sample", "questions": [question_data(circle)]}
    (desk / FILE).write_text(json.dumps(data))
    program = KERNEL.format(folder=str(desk)) + (
        "run('%%time\\ndef double(x): return 2 * x or lk.Circle')\n"
        "print(run('check(\"double\", double);'))\n"
        "run('def double(x): return 2 * x\\nring = lk.Circle([1, 0, 0], [0, 0, 0])(0.5)')\n"
        "print(run('check(\"double\", double);'))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=desk
    )
    ((first, kept),), ((second, then),) = map(ast.literal_eval, done.stdout.splitlines())
    assert first.startswith("double: not counted: uses lk.Circle")
    verdict = verdict_in({"metadata": {"labkit": kept}})
    assert verdict == not_counted(circle, ("labkit.Circle",))
    assert second == "double: right on all cases here; 4 points if the instructor's cases agree."
    assert then == stamp() | {"verdict": record_data(mark(circle, lambda x: 2 * x))}


def test_a_loop_without_end_is_told_when_it_is_stopped(capfd):
    """Who interrupts a check hears in which line it was, and the streams work again."""

    def endless(x):
        raise KeyboardInterrupt  # what the button does, wherever the loop is

    with pytest.raises(KeyboardInterrupt, match="double was stopped in the line `raise Keyboard"):
        check("double", endless)
    print("heard again")
    assert capfd.readouterr().out == "heard again\n"


def test_use_takes_yours_only_if_right(capsys):
    """A right function is used, or what wraps it; any other is replaced, with a badge each time."""
    given, wrapped = object(), object()
    assert use("double", double, given) is double
    assert use("double", double, given, yours=wrapped) is wrapped
    assert capsys.readouterr().out == ""
    for function in (stub, square, lambda x: 1 / 0):
        assert use("double", function, given, yours=wrapped) is given
    out = capsys.readouterr().out
    assert out.count("[stand-in] double: yours is replaced here") == 3
    assert out.count("add anyway=True to this use(...)") == 1, "a stub and an error cannot drive"


def test_anyway_takes_yours_only_if_it_runs(capsys):
    """A wrong function drives if it is asked to; one that stops with an error does not."""
    given = object()
    assert use("double", square, given, anyway=True) is square
    assert "[anyway] double" in capsys.readouterr().out
    assert use("double", lambda x: 1 / 0, given, anyway=True) is given
    out = " ".join(capsys.readouterr().out.split())
    assert "(it stopped with an error)" in out


def test_use_remembers_the_check():
    """What `check` found is not tried again; a function that was changed is."""
    calls = []

    def counted(x):
        calls.append(x)
        return 2.0 * x

    check("double", counted)
    tried = len(calls)
    assert use("double", counted, None) is counted and len(calls) == tried
    assert use("double", double, None) is double


def test_the_cure_follows_a_changed_answer_with_the_same_cause(desk, capsys):
    def squared(x):
        return x * x

    def once_more(x):  # a comment changes nothing
        return x**2

    told = []
    for function in (squared, squared, once_more, squared):
        check("double", function)
        told.append("Add x to x." in capsys.readouterr().out)
        notebook._desks.clear()  # as after a restart of the kernel
    assert told == [False, False, True, True]


def test_unknown_questions_are_a_sentence(capsys):
    """A question that is not there is named, beside those that are, without a traceback."""
    assert check("treble", double) == 0.0
    assert "no question 'treble'. The names are double, again." in capsys.readouterr().out
    with pytest.raises(UnknownName, match="'double'"):
        use("t", 1, 2)


def test_a_missing_file_is_a_sentence(tmp_path, monkeypatch):
    """Without the questions beside it, a notebook says where they come from."""
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    with pytest.raises(LabkitError, match=r"no checks\.json in 'elsewhere'.*whole folder"):
        check("double", double)
    for text in ('{"assignment": ', "[]", json.dumps(stamp() | {"assignment": "x"})):
        Path("checks.json").write_text(text, encoding="utf-8")
        with pytest.raises(LabkitError, match=r"only a damaged checks\.json in 'elsewhere'"):
            check("double", double)


@pytest.mark.parametrize("form", [tuple, list, lambda parts: [x.tolist() for x in parts]])
def test_given_cells_get_the_type_of_the_right_answer(tmp_path, monkeypatch, capsys, form):
    """What the check accepts in place of a sample or an array drives the arm like one."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(Path(__file__).parents[2] / "assignments/01_paths/checks.json", tmp_path)
    start, centre = np.array([0.6, 0.1, 0.2]), np.array([0.5, 0.0, 0.3])
    my_circle = use("circle", lambda *args: form(answers.circle(*args)), None)
    path = lk.Trajectory(lambda s: my_circle(s, start, centre), lk.Quintic(2.0))
    right = lk.Trajectory(lk.Circle(start, centre), lk.Quintic(2.0))(0.7)
    assert np.allclose(path(0.7), right) and type(my_circle(0.3, start, centre)) is lk.Sample
    shutil.copy(Path(__file__).parents[2] / "assignments/00_warmup/checks.json", tmp_path)
    notebook._desks.clear()
    my_error = use("joint_error", lambda a, b: (a.position - b.q).tolist(), None)
    state, target = lk.State(0.0, np.zeros(7), np.zeros(7)), lk.Sample(*np.ones((3, 7)))
    assert type(my_error(target, state)) is np.ndarray and capsys.readouterr().out == ""
