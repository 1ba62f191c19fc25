"""A result file is whole or it is none: read strictly, written at once, cleaned where it enters."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from handmade import QUICK, raw
from hypothesis import given
from hypothesis import strategies as st
from made import NAME, graded, result_of, saying
from made import changed as changed_in

import labkit
from labkit.__main__ import main
from labkit.course.authoring.bundle import Bundle
from labkit.errors import LabkitError
from labkit.formats import FORMAT, stamp
from labkit.grader import files as module
from labkit.grader.clean import clean_data
from labkit.grader.each import Failure
from labkit.grader.files import write
from labkit.grader.grade import grade
from labkit.grader.marks import current_results
from labkit.grader.results import Result, Results, engine_files

WRONG = {
    "hashes {}": {"hashes": {}},
    "hashes []": {"hashes": []},
    "a score of text": {"score": "20"},
    "a score of nan": {"score": float("nan")},
    "a score beyond all": {"score": 1e300},
    "another score": {"score": 19.0},
    "no questions": {"questions": []},
    "questions null": {"questions": None},
    "questions of numbers": {"questions": [1]},
    "rejected and marked": {"rejected": "the file is empty"},
    "somebody else's": {"student": "bob"},
    "another assignment's": {"assignment": "02_model"},
    "seconds of text": {"seconds": {"all": "1"}},
}
TEXTS = (
    b"",
    b"{",
    b"[]",
    b"null",
    b'"x"',
    b"{}",
    b"[" * 100_000,
    b"\x00",
    b'{"score": 1e999}',
    b"\xff\xfe",
)


@pytest.fixture
def marked(course):
    graded(course, result_of(course, "ada"), result_of(course, "carl"))
    return course


INNER = ({"earned": -1}, {"earned": 99}, {"name": "../up"}, {"tests": {}}, {"outcome": "perfect"},
         {"name": "circle"})  # fmt: skip


def test_what_is_not_a_whole_result_is_none(marked, capsys):
    """It is read as no result, and every table, page and report names whose it is, exit 1."""
    results = Results(marked, NAME)
    path = results.path("ada")
    whole = path.read_text()
    for change in WRONG.values():
        path.write_text(json.dumps(json.loads(whole) | change))
        assert results.get("ada") is None, change
    for change in (*INNER, {"numbers": [1]}):
        data = json.loads(whole)
        place = data["questions"][0]
        (place if "numbers" in change else place["verdict"]).update(change)
        path.write_text(json.dumps(data))
        assert results.get("ada") is None, change
    assert [r.student for r in results] == ["carl"]
    for words in (["export"], ["feedback"], ["class-report"]):
        assert main([*words, NAME, "--course", str(marked.root)]) == 1
        (line,) = [x for x in capsys.readouterr().err.splitlines() if ": ada: " in x]
        assert "ada.json is damaged; it is " in line
        assert line.endswith(f"type: labkit grade {NAME} --student ada")
    for text in TEXTS:
        path.write_bytes(text)
        assert results.get("ada") is None, text
        with pytest.raises(LabkitError, match=r"ada\.json (is|has)"):
            results.read("ada")


def test_a_notebook_that_only_people_mark_has_a_whole_result(course):
    """Without a question and without points it is read as it was written."""
    report = replace(result_of(course, "ada"), score=0.0, points=0.0, questions=())
    assert Result.read(report.text()) == report


def test_results_of_another_version_are_refused(marked):
    """One of version 0.1, or of a newer labkit, is not read as a result; grading makes it anew."""
    results = Results(marked, NAME)
    data = json.loads(results.path("ada").read_text())
    old = {key: x for key, x in data.items() if key not in stamp()}
    for numbers in ({}, stamp() | {"format": FORMAT + 1}, stamp() | {"physics": 99}):
        results.path("ada").write_text(json.dumps(old | numbers))
        assert results.get("ada") is None
        with pytest.raises(LabkitError, match=r"^ada\.json has (format|physics)"):
            results.read("ada")
    (failed,) = [x for x in current_results(marked, NAME) if isinstance(x, Failure)]
    assert str(failed).endswith(f"type: labkit grade {NAME} --student ada")


def test_a_bundle_of_another_version_is_refused(course):
    """It is released again, as the sentence says."""
    path = course.bundle / f"{NAME}.json"
    data = json.loads(path.read_text())
    path.write_text(json.dumps({key: x for key, x in data.items() if key not in stamp()}))
    with pytest.raises(LabkitError, match=f"labkit release {NAME}$"):
        Bundle.of(course, NAME)


def test_a_bundle_that_is_not_whole_is_refused(course):
    """Nobody is graded by one that has lost its questions."""
    path = course.bundle / f"{NAME}.json"
    lost = json.dumps(json.loads(path.read_text()) | {"questions": []})
    for text in ("[1]", "{", json.dumps(stamp()), lost):
        path.write_text(text)
        with pytest.raises(LabkitError, match=r"json is damaged: .*; restore it"):
            Bundle.of(course, NAME)


def test_a_key_hashes_what_a_worker_loads_and_no_page_or_command():
    """All that can change a mark, but for what shows replays; a word in a page changes none."""
    code = (
        "import sys, labkit.grader.grading.worker; from labkit.grader.sandbox import forkserver\n"
    )
    code += "from labkit.grader.sandbox import runner, stubs, parse\n"
    code += "print(*(m.__file__ for k, m in sys.modules.items() if k.startswith('labkit')))"
    asked = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    root, files = Path(labkit.__file__).parent, set(engine_files())
    loaded = set(map(Path, asked.stdout.split()))
    assert {x for x in loaded - files if "replay" not in x.parts} <= {root / "grader/__init__.py"}
    parts = {x.relative_to(root).parts for x in files}
    assert {x[1] for x in parts if x[0] == "grader" and len(x) == 3} == {"grading", "sandbox"}
    assert ("__main__.py",) not in parts and ("course", "marking.py") in parts


def test_what_is_no_file_is_none(marked):
    """A folder with the name of a result makes room for one, and is kept beside it."""
    results = Results(marked, NAME)
    one = results.get("ada")
    results.path("ada").unlink()
    (results.path("ada") / "x").mkdir(parents=True)
    assert results.get("ada") is None
    results.keep(one)
    assert results.get("ada") == one
    assert (results.folder / "ada.folder/x").is_dir()


ANY = st.text(alphabet=st.characters(exclude_categories=()), max_size=20)  # lone surrogates too


@given(st.recursive(ANY | st.none() | st.floats(), lambda x: st.lists(x) | st.dictionaries(ANY, x)))
def test_clean_data_can_be_written(data):
    """Any text, as key or value, can be written and moves no cursor."""
    text = json.dumps(clean_data(data), ensure_ascii=False)
    text.encode()
    assert json.dumps(clean_data(clean_data(data)), ensure_ascii=False) == text
    assert "\\u001b" not in text


def test_texts_are_safe_once_they_are_read(course):
    """Surrogates, a terminal's commands and turned writing are gone from every field."""
    bad = "a\ud800\x1b[2J\u202eb"
    one = result_of(course, "ada", notes=(bad,), own=({"after": bad, "type": bad, "source": bad},))
    (test, *_) = saying(one.questions[0].verdict, bad).tests
    one = changed_in(one, verdict={"tests": (test,)}, source=bad, notes=(bad,))
    text = Result.read(one.text()).text()
    assert not [x for x in ("ud800", "u001b", "u202e") if x in text]
    assert text.count(r"a\ufffd[2Jb") == 7


@pytest.mark.slow
def test_the_reader_keeps_all_that_the_checker_writes(solved, bundle, sandbox):
    """A field that is written and that the schema does not know would be lost here."""
    one = grade(raw(solved), "ada", bundle, sandbox, QUICK)
    assert json.loads(Result.read(one.text()).text()) == json.loads(one.text())


def test_a_full_disk_leaves_nothing_behind(tmp_path, monkeypatch):
    """The old text stays, whole, and no unfinished file lies beside it."""
    path = tmp_path / "a.json"
    write(path, "old")

    def full(_):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched, pytest.raises(OSError, match="No space"):
        patched.setattr(module.os, "fsync", full)
        write(path, "new")
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.json"]


def test_what_a_killed_run_left_goes_with_the_next(tmp_path):
    """An unfinished file of a process that is no more is removed; one of a live process stays."""
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    live = tmp_path / f".a.json.{os.getppid()}.new"
    for path in (tmp_path / f".a.json.{dead.pid}.new", live):
        path.write_text("half")
    write(tmp_path / "a.json", "whole")
    assert sorted(os.listdir(tmp_path)) == sorted(["a.json", live.name])
