"""Merging: no answer and no cell of the student's own is lost."""

import copy
import json
import shutil
from pathlib import Path

import pytest

from labkit import LabkitError
from labkit.__main__ import main
from labkit.course.merge import KEPT_TEXT, merge
from labkit.course.notebook import is_edited, kind, read_cells, released

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


@pytest.mark.parametrize("lost", [False, True])
def test_merging_keeps_a_text_that_lost_its_name_or_was_doubled(folder, lost):
    """A why is taken over as it is marked: by its id without metadata, and from all its cells."""
    new, mine = (read_cells(folder / "01_paths.ipynb") for _ in range(2))
    (why,) = (cell for cell in mine if kind(cell) == "why")
    mine.append({**why, "id": "0badcafe"})
    why["source"], why["metadata"] = "Gravity pulls.", {} if lost else why["metadata"]
    mine = mine[:-1] if lost else mine
    (merged,) = (cell for cell in merge(mine, new) if kind(cell) == "why")
    assert merged["source"] == "Gravity pulls."


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


def test_an_answer_that_another_cell_replaced_stays_as_a_comment(folder):
    """Only the last of two answers counts, and the one before it is not lost."""
    new = read_cells(folder / "01_paths.ipynb")
    mine = copy.deepcopy(new)
    at = next(k for k, c in enumerate(mine) if c["source"].startswith("def witness"))
    stub = mine[at]
    good, last = (f"def witness(theta, duration):\n    return {x}" for x in ("duration", None))
    mine[at : at + 1] = [dict(stub, source=good), dict(stub, source=last), stub]
    merged = merge(mine, new)
    assert merged[at]["source"] == last
    assert merged[at + 1]["source"].startswith(f"# {KEPT_TEXT}\n# def witness(theta, duration)")
    assert merged[: at + 1] + merged[at + 2 :] == [*new[:at], merged[at], *new[at + 1 :]]


def test_a_stub_below_a_magic_is_still_a_stub(folder):
    """A magic above an empty stub does not make an answer; above an answer it goes with it."""
    new = read_cells(folder / "01_paths.ipynb")
    mine = copy.deepcopy(new)
    (cell,) = (c for c in mine if "def witness" in c["source"])
    cell["source"] = f"%%time\n{cell['source']}"
    assert merge(mine, new) == new
    cell["source"] = "%%time\ndef witness(theta, duration):\n    return 1"
    assert cell["source"] in [c["source"] for c in merge(mine, new)]


@pytest.mark.parametrize("new", [[], [{"cell_type": "code", "metadata": {}, "source": "x"}]])
def test_what_is_no_release_is_a_sentence(folder, new):
    """A new notebook without cells, or without a release's ids, is refused."""
    with pytest.raises(LabkitError, match="the new notebook is not a release"):
        merge(read_cells(folder / "01_paths.ipynb"), new)


def test_the_release_given_in_place_of_the_students_notebook_is_refused(folder):
    """Swapped, they would give the old notebook back; a release that was begun is still one."""
    mine, new = (read_cells(folder / "01_paths.ipynb") for _ in range(2))
    for cell in mine:
        if "def witness" in cell["source"]:
            cell["source"] = "def witness(theta, duration):\n    return 1.0"
    with pytest.raises(LabkitError, match="has answers, and yours has none; give the notebook in"):
        merge(new, mine)
    for cell in new:
        if "def compose" in cell["source"]:
            cell["source"] = "def compose(*given):\n    return 2.0"
    assert any("return 1.0" in cell["source"] for cell in merge(mine, new))


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


def test_merging_says_to_copy_the_tests_of_the_new_release(folder, tmp_path, capsys):
    """With the old file the checks go on with its tests and points; one that agrees may stay."""
    mine, new = folder / "01_paths.ipynb", tmp_path / "new" / "01_paths.ipynb"
    shutil.copytree(folder, new.parent)

    def said(to):
        assert main(["merge", str(mine), str(new), "--to", str(tmp_path / to)]) == 0
        return capsys.readouterr().out

    assert "checks.json" not in said("same.ipynb")
    with new.with_name("checks.json").open("a") as checks:
        checks.write("\n")
    copy = f"copy {new.parent / 'checks.json'} over {folder / 'checks.json'} as well, and restart"
    assert copy in said("corrected.ipynb")
    (folder / "checks.json").unlink()
    assert copy in said("missing.ipynb")
    new.with_name("checks.json").unlink()
    assert "checks.json" not in said("alone.ipynb")


def test_merging_an_untouched_notebook_gives_the_new_release(folder):
    """Without any work of the student's, the merge is the new release."""
    cells = read_cells(folder / "01_paths.ipynb")
    assert merge(cells, cells) == cells


VELOCITY = ASSIGNMENT.parent / "03_velocity_control/03_velocity_control.ipynb"


def walk(cells, begins):
    """The cell whose text begins so."""
    return next(cell for cell in cells if cell["source"].startswith(begins))


def test_a_given_cell_that_the_student_changed_stays_as_they_wrote_it():
    """With HANDLE = "zoe" again "demo" the arm would be the public one."""
    new = read_cells(VELOCITY)
    mine = copy.deepcopy(new)
    cell = walk(mine, 'HANDLE = "demo"')
    cell["source"] = cell["source"].replace("demo", "zoe")
    brief = walk(mine, "**Your turn: `decay_rate`")
    brief["source"] += "\n\nAsk Ada about this."
    new[0]["source"] += "\n\nCorrected."
    moved = new[:3] + [dict(new[3], source="added", metadata={"lab": "walk"})] + new[3:]
    for release in (new, [dict(c, id=f"03-velocity-control-{k}") for k, c in enumerate(moved)]):
        merged = merge(mine, release)
        assert len(merged) == len(release)
        changed = [(a, b) for a, b in zip(release, merged, strict=True) if a != b]
        assert [b["source"] for _, b in changed] == [brief["source"], cell["source"]]


def test_what_student_and_release_changed_stands_beside(tmp_path, capsys):
    """The release's cell runs; the student's text is below it as a comment, and merge says so."""
    paths = {}
    for name, was, now in (("mine", '"demo"', '"zoe"'), ("new", "(HANDLE)", "(HANDLE, 1)")):
        data = json.loads(VELOCITY.read_text())
        cell = next(c for c in data["cells"] if c["source"][0].startswith("HANDLE ="))
        cell["source"] = "".join(cell["source"]).replace(was, now)
        if name == "new":
            cell["metadata"]["released"] = "0123456789ab"
        paths[name] = tmp_path / f"{name}.ipynb"
        paths[name].write_text(json.dumps(data))
    to = tmp_path / "merged.ipynb"
    assert main(["merge", str(paths["mine"]), str(paths["new"]), "--to", str(to)]) == 0
    assert KEPT_TEXT in capsys.readouterr().out
    merged, new = read_cells(to), read_cells(paths["new"])
    at = merged.index(walk(merged, 'HANDLE = "demo"'))
    assert "my_arm(HANDLE, 1)" in merged[at]["source"]
    assert merged[at + 1]["source"].startswith(f'# {KEPT_TEXT}\n# HANDLE = "zoe"  # in a course')
    assert [*merged[: at + 1], *merged[at + 2 :]] == new


def test_of_an_older_notebook_no_change_is_lost():
    """Where no hash tells who changed a cell, both texts are there."""
    new = read_cells(VELOCITY)
    mine = copy.deepcopy(new)
    for cell in mine:
        cell["metadata"].pop("released", None)
    cell = walk(mine, 'HANDLE = "demo"')
    cell["source"] = 'HANDLE = "zoe"'
    walk(mine, "# ").update(source="A note of mine.")
    merged = merge(mine, new)
    added = [c["source"] for c in merged if c not in new]
    assert added == [f"> {KEPT_TEXT}\n> A note of mine.", f'# {KEPT_TEXT}\n# HANDLE = "zoe"']


def test_a_copy_that_was_pasted_and_changed_is_the_students_own():
    """A pasted cell has the hash of what was copied, and an id of its own."""
    new = read_cells(VELOCITY)
    pasted = dict(walk(new, 'HANDLE = "demo"'), id="0badcafe", source='HANDLE = "zoe"')
    merged = merge([*new, pasted], new)
    assert [c for c in merged if c not in new] == [pasted | {"id": "own-0000"}]


@pytest.mark.parametrize("path", sorted(ASSIGNMENT.parent.glob("*/*.ipynb")), ids=lambda p: p.stem)
def test_no_cell_of_a_release_is_changed(path):
    """Each hash is that of the text beside it."""
    cells = read_cells(path)
    assert any(map(released, cells)) and not any(map(is_edited, cells))
