"""A question that is added, or taken away, when submissions are there already."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace

import pytest
from handmade import QUICK, ROOT, hand_in

from labkit.__main__ import main
from labkit.course.authoring.layout import Course
from labkit.course.merge import merge
from labkit.course.notebook import read_cells
from labkit.errors import LabkitError
from labkit.grader.feedback.class_report import report
from labkit.grader.feedback.page import page
from labkit.grader.grading.batch import GradedSubmission, GradeOptions, grade_class
from labkit.grader.grading.results import Results
from labkit.grader.marks.table import mark_of
from labkit.grader.nbgrader.gradebook import open_gradebook, record
from labkit.grader.nbgrader_api import nbgrader_api
from labkit.grader.terms.release import release

pytestmark = [
    pytest.mark.slow,  # whole classes are graded
    pytest.mark.xdist_group("added question"),
]

NAME, LATER = "01_paths", "compose"
SEED = 7


def becomes(course, monkeypatch, *, complete):
    """The course's sources with the later question, or without it."""
    whole = Course(ROOT).notebook_source(NAME).read_text()
    cell = re.search(rf'^# %% question="{LATER}"\n.*?(?=^# %%)', whole, re.MULTILINE | re.DOTALL)
    less = whole.replace(cell.group(), "").replace("24 points", "20 points")
    text = whole if complete else less
    course.notebook_source(NAME).write_text(text)
    problems = Course(ROOT).problems(NAME)
    kept = tuple(p for p in problems if complete or p.name != LATER)
    monkeypatch.setattr(Course, "problems", lambda self, name: kept)


@pytest.fixture(scope="module")
def early(tmp_path_factory):
    """A question less at first; two hand in, are graded, and one gets a mark by hand."""
    root = tmp_path_factory.mktemp("early") / "course"
    shutil.copytree(ROOT / "solutions/paths", root / "solutions/paths")
    shutil.copy(ROOT / "nbgrader_config.py", root)
    course = Course(root)
    with pytest.MonkeyPatch.context() as monkeypatch:
        becomes(course, monkeypatch, complete=False)
        release(course, NAME, SEED)
    for student, folder in (("ada", course.solution), ("bob", course.release)):
        hand_in(course, NAME, student, (folder / NAME / f"{NAME}.ipynb").read_bytes())
    record(course, NAME, graded(course))
    with open_gradebook(course) as book:
        book.find_grade("circle-check", NAME, NAME, "bob").manual_score = 1.5
        book.find_comment("circle", NAME, NAME, "bob").manual_comment = "see me"
        book.db.commit()
    return course


@pytest.fixture
def marked(early, tmp_path, monkeypatch):
    """A copy of that course, and a function that adds the question or takes it away."""
    course = Course(shutil.copytree(early.root, tmp_path / "course"))
    problems = Course.problems

    def become(complete):
        monkeypatch.setattr(Course, "problems", problems)
        becomes(course, monkeypatch, complete=complete)

    return course, become


def graded(course):
    done = grade_class(course, NAME, ["ada", "bob"], GradeOptions(jobs=2, limits=QUICK))
    results = [one.result for one in done if isinstance(one, GradedSubmission)]
    return sorted(results, key=lambda result: result.student)


def marks(course):
    with open_gradebook(course) as book:
        return {
            s.student.id: {g.name: g.score for n in s.notebooks for g in n.grades}
            for s in book.assignment_submissions(NAME)
        }


def test_nbgrader_alone_refuses(marked):
    """What is avoided here: nbgrader's own release stops, and says why."""
    course, become = marked
    become(True)
    shutil.copy(
        ROOT / "assignments" / NAME / f"{NAME}.ipynb", course.source / NAME / f"{NAME}.ipynb"
    )
    result = nbgrader_api(course).generate_assignment(NAME, force=True, create=True)
    assert not result["success"]
    assert "Cannot add or remove cells" in f"{result['log']}{result.get('error')}"


def test_a_mark_by_hand_waits_for_another_look_when_the_full_points_change(marked, monkeypatch):
    """It was given on another scale; it stays, and is named until somebody has seen it."""
    course, become = marked
    with open_gradebook(course) as book:
        book.find_grade("circle-check", NAME, NAME, "bob").needs_manual_grade = False
        book.db.commit()
    text, fewer = course.notebook_source(NAME), Course(ROOT).problems(NAME)
    become(False)
    release(course, NAME, SEED)  # with the same points nothing has to be seen again
    with open_gradebook(course) as book:
        assert not book.find_grade("circle-check", NAME, NAME, "bob").needs_manual_grade
    fewer = tuple(replace(p, points=3) if p.name == "circle" else p for p in fewer)
    monkeypatch.setattr(Course, "problems", lambda *_: tuple(p for p in fewer if p.name != LATER))
    text.write_text(text.read_text().replace("20 points", "19 points"))
    release(course, NAME, SEED)
    with open_gradebook(course) as book:
        assert book.find_grade("circle-check", NAME, NAME, "bob").needs_manual_grade
        assert not book.find_grade("circle-check", NAME, NAME, "ada").needs_manual_grade
    (said,) = record(course, NAME, graded(course))
    assert said == (
        "bob: circle was marked 1.5 by hand, and the answer, its full points or the grader's mark "
        "has changed since; look at it again"
    )
    assert marks(course)["bob"]["circle-check"] == 1.5


def test_a_diff_of_what_was_not_released_is_refused(marked, capsys):
    """Who corrected a test, and whose release was refused, reads no "no mark would change"."""
    course, _ = marked
    source = course.root / "solutions/paths/problems.py"
    source.touch()
    assert main(["grade", NAME, "--course", str(course.root), "--diff"]) == 2
    said = capsys.readouterr()
    assert (
        "problems.py changed after 01_paths was released" in said.err
        and "would change" not in said.out
    )


def test_an_added_question_leaves_other_marks_alone(marked, capsys):
    """The new question counts 0 for those who have handed in, in words; all else stays."""
    course, become = marked
    before = marks(course)
    assert before["bob"]["circle-check"] == 1.5
    assert f"{LATER}-check" not in before["ada"]
    become(True)
    made = release(course, NAME, SEED)
    assert made.questions == 8
    assert f"graded with another release: 2 submissions; type: labkit grade {NAME}" in str(made)
    assert marks(course) == {s: m | {f"{LATER}-check": 0.0} for s, m in before.items()}
    for words in (["--diff"], []):
        assert main(["grade", NAME, "--course", str(course.root), *words]) == 0
    said = capsys.readouterr().out
    assert "0 of 2 marks would change" in said
    assert "full marks were 18 and are 22 now" in said
    assert marks(course) == {s: m | {f"{LATER}-check": 0.0} for s, m in before.items()}
    with open_gradebook(course) as book:
        assert book.find_comment("circle", NAME, NAME, "bob").manual_comment == "see me"
        assert book.find_submission(NAME, "ada").max_score == 24
    for result in Results(course, NAME):
        found = {q.verdict.name: q.verdict for q in result.questions}[LATER]
        assert (found.outcome, found.earned) == ("not attempted", 0.0)
        assert "was added in a later release, and this notebook does not have it" in page(result)
        assert not [q for q in result.questions if q.verdict.name != LATER and q.notes]


def test_an_added_question_counts_once_it_is_handed_in(marked):
    """In the new notebook old answers keep their points, and the new one earns its own."""
    course, become = marked
    become(True)
    release(course, NAME, SEED)
    path = course.release / NAME / f"{NAME}.ipynb"
    new = json.loads(path.read_text())
    mine = read_cells(course.submitted / "ada" / NAME / f"{NAME}.ipynb")
    solved = read_cells(course.solution / NAME / f"{NAME}.ipynb")
    answer = next(c for c in solved if c["metadata"].get("nbgrader", {}).get("grade_id") == LATER)
    hand_in(course, NAME, "ada", new | {"cells": [*merge(mine, read_cells(path)), answer]})
    ada, bob = graded(course)
    assert (ada.score, bob.score) == (22.0, 0.0)


def test_a_second_release_changes_nothing(marked):
    """Releasing once more gives the same bundle; what was added is still known as added."""
    course, become = marked
    become(True)
    release(course, NAME, SEED)
    first = (course.bundle / f"{NAME}.json").read_text()
    assert json.loads(first)["added"] == [LATER]
    release(course, NAME, SEED)
    assert (course.bundle / f"{NAME}.json").read_text() == first


def test_a_question_goes_unless_somebody_marked_it(marked):
    """What was given by hand is never lost: the release refuses before it touches anything."""
    course, become = marked
    become(True)
    release(course, NAME, SEED)
    become(False)
    release(course, NAME, SEED)
    assert f"{LATER}-check" not in marks(course)["ada"]
    become(True)
    release(course, NAME, SEED)
    with open_gradebook(course) as book:
        book.find_grade(f"{LATER}-check", NAME, NAME, "ada").manual_score = 2.0
        book.db.commit()
    whole = {p: p.read_bytes() for p in (course.root / "build").rglob("*") if p.is_file()}
    become(False)
    with pytest.raises(LabkitError, match="give it 0 points"):
        release(course, NAME, SEED)
    assert {p: p.read_bytes() for p in whole} == whole
    assert marks(course)["ada"][f"{LATER}-check"] == 2.0


def test_a_release_that_is_refused_leaves_the_gradebook_alone(marked, monkeypatch):
    """Where an answer cannot be copied, no row is added and no automatic mark is taken away."""
    course, become = marked
    before = marks(course)

    def refused(*args):
        raise LabkitError("keep it whole")

    become(True)
    monkeypatch.setattr("labkit.course.authoring.release.solution_notebook", refused)
    with pytest.raises(LabkitError, match="keep it whole"):
        release(course, NAME, SEED)
    assert marks(course) == before


def test_a_question_without_points_is_reported_as_void(marked):
    """A voided question is in the report, without a mean."""
    course, _ = marked
    (one, *_) = Results(course, NAME)
    questions = tuple(
        replace(q, verdict=replace(q.verdict, points=0.0, earned=0.0)) for q in one.questions
    )
    assert "| voided |" in report(NAME, [mark_of(replace(one, questions=questions))], {}, str)
