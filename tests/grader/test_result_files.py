"""A result file is whole or it is none: read strictly, written at once, cleaned where it enters."""

from __future__ import annotations

import json
import os
import stat

import pytest
from hypothesis import given
from hypothesis import strategies as st
from made import NAME, changed, graded, result_of, saying

from labkit.course.authoring.bundle import Bundle
from labkit.errors import LabkitError
from labkit.formats import FORMAT, stamp
from labkit.grader import files
from labkit.grader.clean import clean_data, clean_line, clean_text, how_many
from labkit.grader.each import Failure
from labkit.grader.files import write
from labkit.grader.marks import current_results
from labkit.grader.results import Result, Results

WRONG = [
    {"hashes": []},
    {"score": "20"},
    {"score": float("nan")},
    {"score": 1e300},
    {"questions": None},
    {"questions": [1]},
    {"seconds": {"all": "1"}},
    {"format": FORMAT + 1},
    {"physics": 99},
]
INNER = ({"earned": -1}, {"name": "../up"}, {"tests": {}}, {"outcome": "perfect"})
TEXTS = (b"", b"{", b"[]", b"null", b'"x"', b"{}", b"[" * 100_000, b'{"score": 1e999}', b"\xff")


def test_what_is_not_a_whole_result_is_none(course):
    """Of damaged text, of a wrong type or of another version; who it is of is named."""
    graded(course, result_of(course, "ada"), result_of(course, "carl"))
    results = Results(course, NAME)
    path = results.path("ada")
    whole = json.loads(path.read_text())
    texts = [json.dumps(whole | change).encode() for change in WRONG]
    for change in INNER:
        data = json.loads(json.dumps(whole))
        data["questions"][0]["verdict"] |= change
        texts.append(json.dumps(data).encode())
    for text in (*texts, *TEXTS):
        path.write_bytes(text)
        assert results.get("ada") is None, text[:200]
        with pytest.raises(LabkitError, match=r"^ada\.json is not a whole result"):
            results.read("ada")
    assert [r.student for r in results] == ["carl"]
    (failed,) = [x for x in current_results(course, NAME) if isinstance(x, Failure)]
    assert str(failed).endswith(f"type: labkit grade {NAME} --student ada")


def test_a_bundle_that_is_not_whole_or_of_another_version_is_refused(course):
    """Nobody is graded by one that has lost its questions."""
    path = course.bundle / f"{NAME}.json"
    data = json.loads(path.read_text())
    old = {key: x for key, x in data.items() if key not in stamp()}
    for text in ("[1]", "{", *map(json.dumps, (stamp(), data | {"questions": []}, old))):
        path.write_text(text)
        with pytest.raises(LabkitError, match=f"labkit release {NAME}$"):
            Bundle.of(course, NAME)


ANY = st.text(alphabet=st.characters(exclude_categories=()), max_size=40)  # lone surrogates too


@given(st.recursive(ANY | st.none() | st.floats(), lambda x: st.lists(x) | st.dictionaries(ANY, x)))
def test_clean_data_can_be_written(data):
    """Any text, as key or value, can be written and moves no cursor."""
    text = json.dumps(clean_data(data), ensure_ascii=False)
    text.encode()
    assert json.dumps(clean_data(clean_data(data)), ensure_ascii=False) == text
    assert "\\u001b" not in text


@given(ANY)
def test_a_clean_line_is_one_short_line(text):
    """Nothing breaks it, and it is no longer than asked for."""
    line = clean_line(text, 20)
    assert len(line.splitlines()) <= 1 and len(line) <= 20
    assert clean_line(line, 20) == line


def test_what_people_write_stays():
    """Accents, emoji, tabs and lines stay; what commands a terminal goes."""
    for text in ("plain\n\ttext", "Zo\u00eb 🤖"):
        assert clean_text(text) == text
    odd = {"\ud800": "\ufffd", "a\r\nb": "a\nb", "\x1b]0;owned\x07": "]0;owned", "a\u202eb": "ab"}
    assert [clean_text(text) for text in odd] == [*odd.values()]
    assert [how_many(n, "student") for n in (0, 1, 2)] == ["0 students", "1 student", "2 students"]


def test_texts_are_safe_once_they_are_read(course):
    """Surrogates, a terminal's commands and turned writing are gone from every field."""
    bad = "a\ud800\x1b[2J\u202eb"
    one = result_of(course, "ada", notes=(bad,), own=({"after": bad, "type": bad, "source": bad},))
    (test, *_) = saying(one.questions[0].verdict, bad).tests
    one = changed(one, verdict={"tests": (test,)}, source=bad, notes=(bad,))
    text = Result.read(one.text()).text()
    assert not [x for x in ("ud800", "u001b", "u202e") if x in text]
    assert text.count(r"a\ufffd[2Jb") == 7


def test_a_file_is_written_whole_or_not_at_all_for_its_owner_alone(tmp_path, monkeypatch):
    """On a full disk the old text stays; what a killed run left is written over."""
    path = tmp_path / "private/a.json"
    write(path, "old")
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700

    def full(_):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched, pytest.raises(OSError, match="No space"):
        patched.setattr(files.os, "fsync", full)
        write(path, "new")
    assert path.read_text() == "old" and os.listdir(path.parent) == ["a.json"]
    path.with_name(".a.json.new").write_text("half of a longer text")
    write(path, "whole")
    assert path.read_text() == "whole" and os.listdir(path.parent) == ["a.json"]
