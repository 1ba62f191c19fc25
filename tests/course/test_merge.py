"""Merging: no answer and no cell of the student's own is lost."""

import copy
import json
import shutil
from pathlib import Path

import pytest

from labkit import LabkitError
from labkit.__main__ import main
from labkit.course.merge import merge
from labkit.course.notebook import read_cells

ASSIGNMENT = Path(__file__).resolve().parents[2] / "assignments" / "01_paths"


@pytest.fixture
def folder(tmp_path):
    return Path(shutil.copytree(ASSIGNMENT, tmp_path / "01_paths"))


def test_merging_keeps_answers_and_own_cells(folder):
    """A corrected release takes over the answer and the student's own cell, in its place."""
    new = read_cells(folder / "01_paths.ipynb")
    mine = read_cells(folder / "01_paths.ipynb")
    at = next(k for k, c in enumerate(mine) if c["source"].startswith("def witness"))
    mine[at]["source"] = "def witness(theta, duration):\n    return duration / 2"
    mine.insert(
        at + 1, {"cell_type": "code", "metadata": {}, "source": "print('mine')", "outputs": []}
    )
    new[0]["source"] = "# corrected"
    merged = merge(mine, new)
    assert merged[0]["source"] == "# corrected"
    where = next(k for k, c in enumerate(merged) if c["source"].startswith("def witness"))
    assert "duration / 2" in merged[where]["source"]
    assert merged[where + 1]["source"] == "print('mine')"
    assert len(merged) == len(new) + 1


def test_merging_after_a_question_was_added(folder):
    """Where a question was added all ids below it move on; answers and own cells find theirs."""
    new = read_cells(folder / "01_paths.ipynb")
    at = next(k for k, c in enumerate(new) if c["source"].startswith("def compose"))
    mine = [dict(c) for c in new[:at] + new[at + 2 :]]  # its check goes with it
    for k, cell in enumerate(mine):
        cell["id"] = f"01-paths-{k:02d}"
    there = next(k for k, c in enumerate(mine) if c["source"].startswith("def witness"))
    mine[there]["source"] = "def witness(theta, duration):\n    return duration / 2"
    own = {"cell_type": "code", "id": "0badcafe", "metadata": {}, "source": "print('mine')"}
    mine.insert(there + 1, own)
    merged = merge(mine, new)
    where = next(k for k, c in enumerate(merged) if c["source"].startswith("def witness"))
    assert "duration / 2" in merged[where]["source"]
    assert merged[where + 1] == own | {"id": merged[where + 1]["id"]}
    kept = [k for k in range(len(merged)) if k not in (where, where + 1)]
    assert [merged[k] for k in kept] == [
        c for c in new if not c["source"].startswith("def witness")
    ]


def test_merging_keeps_an_answer_whatever_stands_around_it(folder):
    """The stub's line left below an answer, or an empty stub further down, takes nothing away."""
    new = read_cells(folder / "01_paths.ipynb")
    mine = copy.deepcopy(new)
    (cell,) = (c for c in mine if "def witness" in c["source"])
    stub = copy.deepcopy(cell) | {"id": "pasted"}
    cell["source"] = cell["source"].replace("    raise", "    return 2.0\n    raise")
    for place in (mine, [*mine, stub]):
        assert cell["source"] in [c["source"] for c in merge(place, new)]
    cell["source"] = "def witness(theta, duration):\n    return (1.0"
    assert cell["source"] in [c["source"] for c in merge(mine, new)], "though Python cannot read it"


def test_a_stub_below_a_magic_is_still_a_stub(folder):
    """A magic above an empty stub is no answer; above an answer it goes with it."""
    new = read_cells(folder / "01_paths.ipynb")
    mine = copy.deepcopy(new)
    (cell,) = (c for c in mine if "def witness" in c["source"])
    cell["source"] = f"%%time\n{cell['source']}"
    assert merge(mine, new) == new
    cell["source"] = "%%time\ndef witness(theta, duration):\n    return 1"
    assert cell["source"] in [c["source"] for c in merge(mine, new)]


@pytest.mark.parametrize("new", [[], [{"cell_type": "code", "metadata": {}, "source": "x"}]])
def test_what_is_no_release_is_a_sentence(folder, new):
    with pytest.raises(LabkitError, match="the new notebook is not a release"):
        merge(read_cells(folder / "01_paths.ipynb"), new)


def test_text_that_no_file_can_hold_is_merged_all_the_same(folder, tmp_path):
    """A lone surrogate in an answer becomes a question mark; nothing is lost beside it."""
    path = folder / "01_paths.ipynb"
    data = json.loads(path.read_text())
    for cell in data["cells"]:
        if "def witness" in "".join(cell["source"]):
            cell["source"] = "def witness(theta, duration):\n    return 1  # \ud800"
    mine = tmp_path / "mine.ipynb"
    mine.write_text(json.dumps(data))
    assert main(["merge", str(mine), str(path), "--to", str(tmp_path / "merged.ipynb")]) == 0
    merged = (tmp_path / "merged.ipynb").read_text(encoding="utf-8")
    assert "return 1  # ?" in merged


def test_merging_an_untouched_notebook_gives_the_new_release(folder):
    """Without any work of the student's, the merge is the new release."""
    cells = read_cells(folder / "01_paths.ipynb")
    assert merge(cells, cells) == cells
