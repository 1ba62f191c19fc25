"""The last cell prints a receipt only for a file that can be handed in, else one sentence."""

import os

import pytest
from test_before_handing_in import answered, folder, output  # noqa: F401

from labkit.course import Outcome, hand_in, receipt


@pytest.fixture
def said(folder, monkeypatch, capsys):  # noqa: F811
    """What the last cell prints, in one line."""
    monkeypatch.chdir(folder)

    def call(name="01_paths"):
        hand_in(name)
        return " ".join(capsys.readouterr().out.split())

    return call


def test_a_receipt_needs_the_right_name_a_result_and_nothing_that_ran_since(
    said,
    folder,  # noqa: F811
    monkeypatch,
):
    """Whatever is missing is told alone."""
    path = folder / "01_paths.ipynb"
    assert "holds no result of a check" in said() and "receipt" not in said()
    answered(folder, "circle", "def circle(*a): return 1", [output("circle", Outcome.WRONG)])
    assert said().startswith("receipt: ")
    assert said("01_path") == "This notebook is 01_paths; write lk.hand_in('01_paths')."
    monkeypatch.setattr(receipt, "last_run", lambda: os.stat(path).st_mtime + 1.0)
    assert said() == "Save this notebook (Ctrl+S), then run this cell again."
    monkeypatch.setenv("LABKIT_SUBMIT_CHECK", "1")
    assert said() == ""


def test_the_file_that_is_handed_in_is_the_open_one(said, folder, monkeypatch):  # noqa: F811
    """Of a notebook under another name nothing is said but how to rename it."""
    answered(folder, "circle", "def circle(*a): return 1", [output("circle", Outcome.WRONG)])
    opened = folder / "01_paths-Copy1.ipynb"
    monkeypatch.setenv("JPY_SESSION_NAME", str(opened))
    assert said().startswith("receipt: ")  # it has been renamed since the kernel started
    opened.write_text((folder / "01_paths.ipynb").read_text())
    assert said().startswith("This notebook is called 01_paths-Copy1.ipynb; rename it")
    opened.unlink()
    (folder / "01_paths.ipynb").unlink()
    assert "receipt" not in said() and said()
