"""The last cell prints a receipt only for a file that can be handed in, else one sentence."""

import json
import os
import shutil
from pathlib import Path

import pytest

from labkit.course import Outcome, hand_in, handin, progress, restore
from labkit.course.handin import receipt
from labkit.course.notebook import verdict_metadata
from labkit.course.verdict import Verdict
from labkit.errors import UnknownName

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
    assert "0.0 of 21 points, about 150 minutes left" in capsys.readouterr().out
    checked(folder / f"{NAME}.ipynb", Outcome.RIGHT, 4.0)
    progress(folder.parent)
    assert "4.0 of 21 points, about 121 minutes left" in capsys.readouterr().out


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
