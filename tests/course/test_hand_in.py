"""The last cell prints a receipt only for a file that can be handed in, else one sentence."""

import json
import os
import shutil
from pathlib import Path

import pytest

from labkit.course import Outcome, hand_in, handin
from labkit.course.handin import receipt
from labkit.course.notebook import verdict_metadata
from labkit.course.verdict import Verdict

NAME = "01_paths"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A notebook as it is handed out, which is also the working directory."""
    source = Path(__file__).parents[2] / "assignments" / NAME
    monkeypatch.chdir(shutil.copytree(source, tmp_path / NAME))
    return tmp_path / NAME


def checked(path):
    """Leave the result of a check in a notebook's file."""
    metadata = verdict_metadata(Verdict("circle", Outcome.WRONG, 0.0, 4.0))
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
    assert "holds no result of a check" in said() and "receipt" not in said()
    checked(path)
    assert said().startswith("receipt: ")
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
