"""The guides: each command that they show is one that works, in the order in which they show it."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import zipfile

import pytest
from book_pages import ROOT
from handmade import put

from labkit.course.authoring.layout import Course
from labkit.grader.gradebook import open_gradebook
from labkit.grader.rules import FILE, read_rules
from labkit.grader.term import PERSONAL_FILES
from solutions.paths import answers
from tests.synthetic.inline import inline

WHY = "why_twice_the_time"
BY_HAND = "(marking-by-hand)="
SHELL = re.compile(rf"```shell\n(.*?)```|^({re.escape(BY_HAND)})$", re.DOTALL | re.MULTILINE)


def shown(page):
    """The commands of a page, line by line, without their comments, and where a person marks."""
    blocks = SHELL.findall((ROOT / f"book/{page}.md").read_text())
    lines = [line for command, label in blocks for line in (command or label).splitlines()]
    return [words for line in lines if (words := shlex.split(line, comments=True))]


def typed(words, folder):
    """Type it, and wait until it is done."""
    module = ["-m", "labkit"] if words[0] == "labkit" else []
    command = [sys.executable, *module, *words[1:]]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True,
                          check=False)  # fmt: skip


def works(words, folder):
    """Type it; labkit's own word for success is exit code 0."""
    done = typed(words, folder)
    assert done.returncode == 0, (words, done.stdout[-1500:], done.stderr[-1500:])
    return done.stdout


def mark_by_hand(course, student, points):
    """Mark the why of notebook 01, as somebody does in formgrader."""
    with open_gradebook(Course(course)) as book:
        grade = book.find_grade(WHY, "01_paths", "01_paths", student)
        assert grade.needs_manual_grade
        grade.manual_score, grade.needs_manual_grade = points, False
        book.db.commit()


@pytest.mark.soak
def test_every_command_of_the_instructors_guide_works(tmp_path):
    """From a clone to a class that is graded and marked by hand, as the page says."""
    course = tmp_path / "course"
    subprocess.run(["git", "clone", "--quiet", ROOT, course], check=True, capture_output=True)
    (course / "downloads").mkdir()
    notebook = json.loads((ROOT / "assignments/01_paths/01_paths.ipynb").read_text())
    for function in (answers.bang_bang, answers.trapezoid, answers.compose):
        put(notebook, function.__name__, inline(function, function.__name__))
    put(notebook, WHY, "The speed doubles, because the same way takes half the time.")
    with zipfile.ZipFile(course / "downloads/moodle.zip", "w") as archive:
        name = "Ada Lovelace_101_assignsubmission_file/01_paths.ipynb"
        archive.writestr(name, json.dumps(notebook))
    people = "First name,Last name,Email address\nAda,Lovelace,ada@uni.org\nBob,Hope,bob@uni.org\n"
    (course / "downloads/participants.csv").write_text(people)
    commands = shown("instructor_guide")
    assert {words[0] for words in commands} == {"labkit", BY_HAND}
    verbs = {words[1] for words in commands if words != [BY_HAND]}
    assert verbs >= {"doctor", "term", "release", "student-zip", "roster", "collect",
                     "grade", "explain", "defence", "feedback", "export",
                     "class-report"}  # fmt: skip
    for words in commands:
        if words == [BY_HAND]:
            assert typed(["labkit", "feedback", "01_paths"], course).returncode == 2
            mark_by_hand(course, "Ada-Lovelace", 1.5)
        else:
            works(words, course)
    assert len(list((course / "results/01_paths").glob("*.json"))) == 1
    assert len(list((course / "feedback").glob("*/01_paths/01_paths.html"))) == 1
    assert len((course / "marks.csv").read_text().splitlines()) == 3
    assert "09_defence" in (course / "term.csv").read_text().splitlines()[0]
    assert (course / "build/course/defence/Ada-Lovelace.html").exists()
    assert "Bob-Hope,Bob,Hope" in (course / "term.csv").read_text()
    assert "Ada,Lovelace,,,ada@uni.org," in (course / "marks.csv").read_text()
    assert (course / "report.md").read_text().strip()
    assert (course / "build/course/bundle/01_paths.json").exists()


def test_the_rules_that_the_guide_shows_can_be_followed(tmp_path):
    """`course.toml` as it is printed is read, in full."""
    text = (ROOT / "book/instructor_guide.md").read_text()
    (rules,) = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    (tmp_path / "course.toml").write_text(rules)
    (tmp_path / "solutions").symlink_to(ROOT / "solutions")
    found = read_rules(Course(tmp_path))
    assert found.due("01_paths").isoformat() == "2026-11-02T22:59:00+00:00"
    assert found.longer("Ada-Lovelace", "01_paths").days == 3


def test_the_privacy_page_names_every_place():
    """Whatever holds a student's name or work is in the table for the officer."""
    text = (ROOT / "privacy.md").read_text()
    for place in (*PERSONAL_FILES, FILE):
        assert f"`{place}" in text, place


def test_every_command_of_the_students_guide_works(tmp_path):
    """A copy of a notebook is run."""
    shutil.copytree(ROOT / "assignments/01_paths", tmp_path, dirs_exist_ok=True)
    commands = [words for words in shown("student_guide") if words[0] == "labkit"]
    for words in commands:
        works(words, tmp_path)
    assert [words[1] for words in commands] == ["submit-check"]


def test_the_pages_name_only_verbs_that_exist():
    """`make` and `labkit` have every verb that the book speaks of."""
    made = subprocess.run(["make", "help"], cwd=ROOT, capture_output=True, text=True, check=True)
    known = set(re.findall(r"^  make (\S+)", made.stdout, re.MULTILINE))
    command = [sys.executable, "-m", "labkit", "--help"]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    ours = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    verbs = set(re.findall(r"^  ([a-z-]+) ", ours.stdout, re.MULTILINE))
    for page in sorted((ROOT / "book").glob("*.md")):
        text = page.read_text()
        assert set(re.findall(r"`make ([a-z0-9-]+)", text)) <= known, page.name
        assert set(re.findall(r"`labkit ([a-z-]+)", text)) <= verbs, page.name
