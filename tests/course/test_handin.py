"""The receipt, what is done so far, and `labkit submit-check`, which runs a copy."""

# ruff: noqa: E501

import json
import os
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from nbformat import v4
from questions import DOUBLE

from labkit import LabkitError
from labkit.__main__ import submit_check as command
from labkit.course import (
    Choose,
    Outcome,
    Prediction,
    hand_in,
    handin,
    progress,
    question_data,
    restore,
)
from labkit.course.handin import receipt, submit_check
from labkit.course.notebook import FILE, PLACEHOLDER, verdict_metadata
from labkit.course.verdict import Verdict
from labkit.errors import UnknownName
from labkit.formats import stamp

NAME = "01_paths"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A notebook as it is handed out, which is also the working directory."""
    source = Path(__file__).parents[2] / "assignments" / NAME
    monkeypatch.chdir(shutil.copytree(source, tmp_path / NAME))
    return tmp_path / NAME


def checked(path, outcome=Outcome.WRONG, earned=0.0):
    """Leave the result of a check in a notebook's file."""
    metadata = verdict_metadata(Verdict("circle", outcome, earned, 4.0))
    data = json.loads(path.read_text())
    for cell in data["cells"]:
        if 'check("circle"' in "".join(cell["source"]):
            cell["outputs"] = [{"output_type": "display_data", "data": {}, "metadata": metadata}]
    path.write_text(json.dumps(data))


@pytest.fixture
def said(folder, capsys):
    """What the last cell prints, in one line."""

    def call(name=NAME):
        hand_in(name)
        return " ".join(capsys.readouterr().out.split())

    return call


def test_a_receipt_needs_the_right_name_a_result_and_nothing_that_ran_since(
    said, folder, monkeypatch
):
    """Whatever is missing is told alone."""
    path = folder / f"{NAME}.ipynb"
    assert said().startswith("receipt: ")
    whole = path.read_text()
    path.write_text(whole.replace("def circle(", "def circles("))
    assert said().startswith("No cell defines circle;") and "receipt" not in said()
    path.write_text(whole + " " * 11_000_000)
    assert "the file has 11 MB" in said() and "receipt" not in said()
    path.write_text(whole)
    assert said("01_path") == "This notebook is 01_paths; write lk.hand_in('01_paths')."
    monkeypatch.setattr(handin, "last_run", lambda: os.stat(path).st_mtime + 1.0)
    assert said() == "Save this notebook (Ctrl+S), then run this cell again."
    monkeypatch.setenv(handin.SILENT, "1")
    assert said() == ""


def test_the_file_that_is_handed_in_is_the_open_one(said, folder, monkeypatch):
    """Of a notebook under another name nothing is said but how to rename it."""
    path, opened = folder / f"{NAME}.ipynb", folder / f"{NAME}-Copy1.ipynb"
    checked(path)
    monkeypatch.setenv("JPY_SESSION_NAME", str(opened))
    assert said().startswith("receipt: ")  # it has been renamed since the kernel started
    opened.write_text(path.read_text())
    assert said().startswith("This notebook is called 01_paths-Copy1.ipynb; rename it")
    opened.unlink()
    path.write_text("{")
    assert "is not a notebook" in said() and "receipt" not in said()
    path.unlink()
    assert "there is no file" in said()


def test_an_empty_cell_leaves_the_receipt_as_it_is():
    """Shift+Enter in the last cell appends an empty cell, and the next autosave keeps it."""
    assert receipt(["a", "b"]) == receipt(["a", "b", "", " \n"]) != receipt(["a", "b", "c"])


def test_points_and_time_left_are_counted_from_saved_files(folder, capsys):
    """A verdict in a saved output earns its points; the others' share of the time is left."""
    progress(folder.parent)
    assert "0.0 of 21 points as tested here, 150 minutes left" in capsys.readouterr().out
    checked(folder / f"{NAME}.ipynb", Outcome.RIGHT, 4.0)
    progress(folder.parent)
    assert "4.0 of 21 points as tested here, 121 minutes left" in capsys.readouterr().out


def test_a_cell_that_is_gone_comes_back(folder, capsys):
    """Outside a notebook it is printed; it is the cell that was handed out."""
    restore("circle")
    text = capsys.readouterr().out
    cells = json.loads((folder / f"{NAME}.ipynb").read_text())["cells"]
    first = text.splitlines()[0]
    assert any("".join(cell["source"]).startswith(first) for cell in cells)
    assert "raise NotImplementedError" in text and "SOLUTION" not in text
    with pytest.raises(UnknownName):
        restore("circles")


SETUP = "import numpy as np\nimport labkit as lk\nfrom labkit.course import check, predict, use"
RIGHT = "def {q}(x): return 2 * x"
CHECK = "check('{q}', {q})"

HARMLESS = {
    "a variable reused below with its value": ["n{k} = 2\ndef {q}(x): return n{k} * x", CHECK, "n{k}, m{k} = 2, 3"],
    "a variable that the answer binds itself": ["def {q}(x):\n    s = 2\n    return s * x", CHECK, "s = 5"],
    "a loop that ends at the same value": ["n{k} = 2\ndef {q}(x): return n{k} * x", CHECK, "for n{k} in range(3): pass"],
    "a guarded global": ["def {q}(x): return (f{k} if 'f{k}' in globals() else 2) * x", CHECK],
    "exec": ["exec('w{k} = 2')\ndef {q}(x): return w{k} * x", CHECK, "exec('w{k} = 2.0')"],
    "an answer made by exec": ["exec('def {q}(x): return 2 * x')", CHECK],
    "a helper above": ["def h{k}(x): return x + x", "def {q}(x): return h{k}(x)", CHECK],
    "a helper defined again alike": ["def h{k}(x): return x + x\ndef {q}(x): return h{k}(x)", CHECK, "def h{k}(x):\n    return 2 * x"],
    "a callback that sets a global to its value": ["g{k} = 2\ndef {q}(x): return g{k} * x", CHECK, "def moved(change):\n    global g{k}\n    g{k} = change\nmoved(2)"],
    "the answer again below": [RIGHT, CHECK, "def {q}(x):\n    return x + x"],
    "no check": [RIGHT],
    "a name of the answer for a number": [RIGHT, CHECK, "{q} = 4.0"],
    "the name of an answer as a loop variable": [RIGHT, CHECK, "for {q} in (1, 2): pass"],
    "the answer wrapped by use": [RIGHT, CHECK, "mine{k} = use('{q}', {q}, lambda x: 0)\nmine{k}(2)"],
    "magics": ["%time u{k} = 2", "def {q}(x): return u{k} * x", CHECK, "%%time\n1 + 1"],
    "a setting that is restored": ["b{k} = 2\ndef {q}(x): return b{k} * x", CHECK, "b{k} = 3\nprint({q}(1))\nb{k} = 2"],
    "an odd object": ["class Odd:\n    def __getattribute__(self, name): raise RuntimeError\nodd{k} = Odd()", RIGHT, CHECK],
}  # fmt: skip
"""Cells that a student may well write, each below `SETUP` and with an answer that is right."""

GAPS = {
    "not defined": (["# nothing"], "no cell defines {q}"),
    "changed below": (["n{k} = 2\ndef {q}(x): return n{k} * x", CHECK, "n{k} = 3"], "{q} is right at its check but not"),
    "changed by a loop": (["n{k} = 2\ndef {q}(x): return n{k} * x", CHECK, "for n{k} in range(9): pass"], "{q} is right at its check but not"),
    "changed by a callback": (["n{k} = 2\ndef {q}(x): return n{k} * x", CHECK, "def moved(v):\n    global n{k}\n    n{k} = v\nmoved(5)"], "{q} is right at its check but not"),
    "defined again below": ([RIGHT, CHECK, "def {q}(x): return x"], "{q} is right at its check but not"),
    "another function checked": (["def other(x): return 2 * x\ndef {q}(x): return x", "check('{q}', other)"], "{q} is right at its check but not"),
    "a memory": (["m{k} = [0]\ndef {q}(x):\n    m{k}[0] += 1\n    return 2 * x + (m{k}[0] > 3)", CHECK], "{q} is right at its check but not"),
    "a syntax error": (["def {q}(x) return 2 * x"], "SyntaxError"),
    "a module of one's own": (["from my_module import two\ndef {q}(x): return two * x"], "my_module'); only the notebook is handed in"),
    "an error in an experiment": ([RIGHT, CHECK, "{q}(1)[0]"], "`{q}(1)[0]` ends with an error"),
    "a withheld tool": (["def {q}(x): return np.multiply(2, x)", CHECK], "{q}: not counted"),
}  # fmt: skip
"""Cells that leave a gap, and what is said of it."""


def notebook(folder, cases, tail=()):
    """The notebook of a question for each case, with its questions beside it."""
    questions, cells = [], [SETUP]
    for k, parts in enumerate(cases):
        questions.append(question_data(replace(DOUBLE, name=f"q{k}")))
        cells += [part.replace("{q}", f"q{k}").replace("{k}", str(k)) for part in parts]
    guess = Prediction("guess", "Which?", Choose({"a": "this", "b": "that"}), "a").question()
    questions.append(question_data(guess))
    data = {**stamp(), "assignment": "sample", "questions": questions, "texts": {"why": "home"}}
    (folder / FILE).write_text(json.dumps(data))
    made = v4.new_notebook(cells=[v4.new_code_cell(x) for x in [*cells, *tail]])
    text = v4.new_markdown_cell("word " * 30, metadata={"nbgrader": {"grade_id": "why"}})
    made.cells.append(text)
    path = folder / "sample.ipynb"
    path.write_text(json.dumps(made))
    return path


GUESS = "guess = predict('guess', 'b')\ncheck('guess', guess)\nlk.hand_in('sample')"


def test_of_what_is_harmless_nothing_is_said(tmp_path):
    """Of none of twenty cells; the file itself stays as it is."""
    path = notebook(tmp_path, HARMLESS.values(), [GUESS])
    before = path.read_bytes()
    found = submit_check(path)
    assert (found.problems, found.notes) == ((), ())
    assert all(verdict.right for verdict in found.verdicts.values())
    assert path.read_bytes() == before and {x.name for x in tmp_path.iterdir()} == {FILE, path.name}


def test_each_gap_is_told(tmp_path):
    """Also of what only the run shows, and of a module that lies beside the notebook."""
    (tmp_path / "my_module.py").write_text("two = 2")
    path = notebook(tmp_path, [cells for cells, _ in GAPS.values()])
    found = submit_check(path.rename(tmp_path / "sample (1).ipynb"))
    text = "\n".join(found.problems)
    for k, (case, (_, says)) in enumerate(GAPS.items()):
        assert says.replace("{q}", f"q{k}").replace("{k}", str(k)) in text, case
    assert "rename it sample.ipynb" in text and "no cell defines guess" in text


def test_what_is_unanswered_is_a_note(tmp_path, monkeypatch, capsys):
    """A stub, a prediction without a letter and an empty text are no gaps; a loop is stopped."""
    stub = "def {q}(x): raise NotImplementedError"
    path = notebook(tmp_path, [[stub]], ["guess = predict('guess', '?')"])
    data = json.loads(path.read_text())
    data["cells"][-1]["source"] = PLACEHOLDER
    path.write_text(json.dumps(data))
    assert command.main([str(path)], standalone_mode=False) == 0
    said = capsys.readouterr().out
    assert "[note] why has 0 words" in said and "[fix]" not in said
    found = submit_check(notebook(tmp_path, [[stub]], ["while True: pass"]), seconds=5.0)
    assert len(found.problems) == 1 and "more than 5 s" in found.problems[0]
    assert Outcome.NOT_ATTEMPTED not in {x and x.outcome for x in found.verdicts.values()}


def test_the_code_of_others_does_not_run(tmp_path, monkeypatch):
    """Below `submitted`, also through a link, and in a file of another user."""
    folder = tmp_path / "submitted" / "ada" / "sample"
    folder.mkdir(parents=True)
    path = notebook(folder, [], [f"open({str(tmp_path / 'ran')!r}, 'w')"])
    (tmp_path / "link").symlink_to(folder)
    mine = notebook(tmp_path, [], [f"open({str(tmp_path / 'ran')!r}, 'w')"])
    for given in (path, tmp_path / "link" / path.name):
        with pytest.raises(LabkitError, match="is not yours"):
            submit_check(given)
    if hasattr(os, "getuid"):
        monkeypatch.setattr(os, "getuid", lambda: 12345)
        with pytest.raises(LabkitError, match="is not yours"):
            submit_check(mine)
    assert not (tmp_path / "ran").exists()
