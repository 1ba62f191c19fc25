"""Nobody is taken for somebody else, whatever they call themselves or their files."""

from __future__ import annotations

import csv
import io
import json
import re

import pytest
from soak.attacks.identity import ADA, IMPOSTORS, MOODLE, write_zip
from soak.attacks.place import NAME, full_marks, handed_out, solved_code
from soak.attacks.undefended import COMMANDS

from labkit.__main__ import main

pytestmark = pytest.mark.usefixtures("kept_worker")
GATE = (
    "a number in the file's name",
    "another's folder in the exchange",
    "the folder's own name",
    "commands for the terminal",
)
CASES = [
    pytest.param(name, marks=() if name in GATE else pytest.mark.soak, id=name)
    for name in IMPOSTORS
]
FIRST = {
    "moodle": f"Ada Lovelace_{ADA}{MOODLE}{NAME}.ipynb",
    "canvas": f"lovelaceada_{ADA}_900_{NAME}.ipynb",
}
TWIN = f"Ada Lovelace_43{MOODLE}{NAME}.ipynb"


def work(course, who, *, solved):
    """A notebook that is known by its bytes."""
    notebook = solved_code(course) if solved else handed_out(course)
    kept = [c for c in notebook["cells"] if c["metadata"]["lab"] in ("answer", "check")]
    return json.dumps(notebook | {"cells": kept, "metadata": {"who": who}}).encode()


def collect_first(course, impostor, ada, twin, tmp_path, capsys):
    """What was collected before Eve came."""
    if impostor.system == "exchange":
        folder = course.submitted / "ada" / NAME
        folder.mkdir(parents=True)
        (folder / f"{NAME}.ipynb").write_bytes(ada)
        (folder / "timestamp.txt").write_text("2026-01-01 00:00:00 UTC")
        return
    files = {FIRST[impostor.system]: ada} | ({TWIN: twin} if impostor.twin else {})
    assert (
        labkit(course, capsys, "collect", NAME, str(write_zip(tmp_path / "1.zip", files)))[0] == 0
    )


def labkit(course, capsys, *words):
    """One verb: how it ended, and what it printed."""
    capsys.readouterr()
    try:
        code = main([*words, "--course", str(course.root)])
    except SystemExit as end:
        code = end.code
    out = capsys.readouterr()
    return code, out.out + out.err


def second(course, impostor, ada, eve, tmp_path):
    """The download, or the exchange, in which Eve's file lies."""
    if impostor.system != "exchange":
        files = {FIRST[impostor.system]: ada} | dict.fromkeys(impostor.names, eve)
        return write_zip(tmp_path / "2.zip", files)
    inbound = tmp_path / "inbound"
    for name in impostor.names:
        (inbound / name).mkdir(parents=True)
        if impostor.put is None:
            (inbound / name / f"{NAME}.ipynb").write_bytes(eve)
        else:
            impostor.put(inbound / name, course.root)
    return inbound


def places(course, data):
    """Where a file lies among what is graded."""
    return {p for p in course.submitted.rglob("*.ipynb") if p.read_bytes() == data}


def kept(course, data):
    """Whether a file is anywhere in the course."""
    return any(p.is_file() and p.read_bytes() == data for p in course.root.rglob("*"))


@pytest.mark.parametrize("name", CASES)
def test_nobody_is_taken_for_another(course, tmp_path, capsys, name):
    """Ada's work stays hers, her number has one row with her mark, and all that came is kept."""
    impostor = IMPOSTORS[name]
    ada, twin, eve = (work(course, x, solved=x == "ada") for x in ("ada", "twin", "eve"))
    assert impostor.believed(), "a reader that believes it is led astray"
    collect_first(course, impostor, ada, twin, tmp_path, capsys)
    before = {data: places(course, data) for data in (ada, twin)}
    around = sorted(tmp_path.iterdir())
    source = second(course, impostor, ada, eve, tmp_path)
    code, printed = labkit(course, capsys, "collect", NAME, str(source))
    assert code in (0, 1, 2)
    assert "Traceback" not in printed
    assert not COMMANDS.search(printed)
    assert not re.search(
        r"^Ada-Lovelace: 01_paths.ipynb: taken", printed.partition("x.ipynb")[2], re.M
    )
    assert {data: places(course, data) for data in (ada, twin)} == before
    assert kept(course, ada)
    assert sorted(tmp_path.iterdir()) == sorted({*around, source})
    assert not [p for p in places(course, eve) if impostor.system == "exchange" and _is_ada(p)]
    assert len({p.parent for p in places(course, eve)} & {p.parent for p in before[twin]}) == 0
    assert not [p for p in course.submitted.rglob("*") if p.is_symlink()]
    assert not [p for p in course.submitted.rglob("*.ipynb") if p.stat().st_nlink > 1]
    _marks(course, impostor, capsys)


def _is_ada(path):
    return path.parts[-3].strip().casefold() == "ada"


def _marks(course, impostor, capsys):
    """Who has which mark in the table that goes back."""
    assert labkit(course, capsys, "grade", NAME)[0] in (0, 1)
    layout = {"moodle": "moodle-worksheet", "canvas": "canvas"}.get(impostor.system, "questions")
    code, table = labkit(course, capsys, "export", NAME, "--layout", layout)
    assert code in (0, 1)
    rows = list(csv.DictReader(io.StringIO(table)))
    column, number = {
        "moodle": ("Identifier", f"Participant {ADA}"),
        "canvas": ("ID", str(ADA)),
        "exchange": ("student", "ada"),
    }[impostor.system]
    mine = [row for row in rows if row[column] == number]
    assert len(mine) == 1
    assert str(full_marks(course)[0]) in mine[0].values()


def test_a_name_taken_over_in_another_assignment_is_not_believed(course, tmp_path, capsys):
    """Eve, who calls herself Ada Lovelace when Ada hands nothing in, does not become Ada."""
    ada, eve = work(course, "ada", solved=True), work(course, "eve", solved=False)
    first = write_zip(tmp_path / "1.zip", {FIRST["moodle"]: ada})
    assert labkit(course, capsys, "collect", NAME, str(first))[0] == 0
    other = write_zip(tmp_path / "2.zip", {f"Ada Lovelace_77{MOODLE}02_model.ipynb": eve})
    code, printed = labkit(course, capsys, "collect", "02_model", str(other))
    (folder,) = {p.parts[-3] for p in places(course, ada)}
    taken = {p.parts[-3] for p in places(course, eve)}
    assert folder not in taken or code != 0 or re.search(r"42\b.*77|77\b.*42", printed, re.S)
