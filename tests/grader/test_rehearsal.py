"""A term is played through: from Moodle's download to marks in its worksheet, and it goes on."""

from __future__ import annotations

import csv
import json

import pytest
from courses import copied, synthetic
from handmade import NAME

from labkit.course.authoring.layout import Course
from labkit.errors import LabkitError
from labkit.grader.batch import GradeOptions
from labkit.grader.results import Results
from tests.synthetic import expected_file
from tests.synthetic.__main__ import main
from tests.synthetic.rehearsal import rehearse

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("rehearsal")]  # whole classes are graded

COUNT = 6


@pytest.fixture(scope="module")
def played(tmp_path_factory):
    """A folder in which the first three steps are done, and then, anew, all of them."""
    to = tmp_path_factory.mktemp("rehearsal") / "term"
    source = synthetic(to.with_name("source"))
    steps = rehearse(source, NAME, to, COUNT, GradeOptions(jobs=2))
    first = [next(steps) for _ in range(3)]
    steps.close()
    return Course(to), first, list(rehearse(source, NAME, to, COUNT, GradeOptions(jobs=2)))


def source_of(course):
    return Course(course.root.with_name("source"))


def test_a_term_is_played_through(played):
    """Each step says what it did; every mark is what was deserved."""
    course, first, then = played
    assert [s.split(":")[0] for s in first[2:] + then[1:-1]] == [
        "collected", "graded", "in the gradebook", "feedback", "class report", "exported",
    ]  # fmt: skip
    assert then[-1].startswith("every mark is what was deserved")
    assert len(list(course.root.glob(f"feedback/*/{NAME}/{NAME}.html"))) == COUNT
    assert f"# {NAME}: what the class understood" in (course.root / "report.md").read_text()


def test_it_goes_on_where_it_was_stopped(played):
    """Nothing is released, handed in or collected twice, and nobody graded twice."""
    course, first, then = played
    assert f"{COUNT} of {COUNT} are new" in first[2]
    assert f"0 of {COUNT} are new" in then[0]
    assert f"{COUNT} of {COUNT} anew" in then[1]
    again = list(rehearse(source_of(course), NAME, course.root, COUNT, GradeOptions(jobs=2)))
    assert f"0 of {COUNT} anew" in again[1]


def test_marks_come_back_under_moodles_own_numbers(played):
    """The worksheet has each participant's number from the download, and their mark."""
    course, _, _ = played
    deserved = json.loads(expected_file(course, NAME).read_text())
    with (course.root / "marks-moodle-worksheet.csv").open() as file:
        marks = {r["Identifier"]: (r["Full name"], float(r["Grade"])) for r in csv.DictReader(file)}
    assert set(marks) == {f"Participant {1001 + k}" for k in range(COUNT)}
    assert {name: mark for name, mark in marks.values()} == {
        student: about["score"] for student, about in deserved.items()
    }


def test_a_mark_that_nobody_deserved_is_said(played):
    """A rehearsal that ends with another mark than was deserved has failed."""
    course, _, _ = played
    path = expected_file(course, NAME)
    text = path.read_text()
    data = json.loads(text)
    who = next(s for s, about in data.items() if not about["rejected"])
    data[who]["questions"] = dict.fromkeys(data[who]["questions"], 99.0)
    path.write_text(json.dumps(data))
    with pytest.raises(LabkitError, match="not what was deserved"):
        list(rehearse(source_of(course), NAME, course.root, COUNT, GradeOptions(jobs=2)))
    path.write_text(text)


def test_a_true_course_is_no_stage(tmp_path):
    """Where a course lies, nothing is handed in and nobody's submissions go."""
    course = copied(tmp_path)
    notebook = course.submitted / "ada" / "01_curves" / "01_curves.ipynb"
    notebook.parent.mkdir(parents=True)
    notebook.write_text("work of a week")
    with pytest.raises(LabkitError, match="new or empty"):
        next(rehearse(course, NAME, course.root, COUNT, GradeOptions()))
    assert notebook.exists() and not course.release.exists()


def test_command(played, monkeypatch, capsys):
    """`python -m tests.synthetic --rehearse` does it, and writes nothing into the course."""
    course, _, _ = played
    before = sorted(Results(source_of(course), NAME).folder.glob("*"))
    words = ["--count", str(COUNT), "--course", str(source_of(course).root)]
    words += ["--rehearse", str(course.root)]
    monkeypatch.setattr("sys.argv", ["synthetic", NAME, *words])
    assert main() == 0
    assert "every mark is what was deserved" in capsys.readouterr().out
    assert sorted(Results(source_of(course), NAME).folder.glob("*")) == before
