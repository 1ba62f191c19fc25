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
from labkit.grader.rules import FILE, read_rules
from labkit.grader.term import PERSONAL_FILES
from solutions.paths import answers
from tests.synthetic.inline import inline

CLASS = {"Ada": ("bang_bang", "compose"), "Bob": ("circle",), "Cho": (), "Dee": ("bang_bang",)}
"""Four students, and the functions of notebook 01 that each has right."""


def shown(page):
    """The commands of a page, line by line, without their comments."""
    blocks = re.findall(r"```shell\n(.*?)```", (ROOT / f"book/{page}.md").read_text(), re.DOTALL)
    return [shlex.split(x, comments=True) for block in blocks for x in block.splitlines()]


def works(words, folder):
    """Type it; labkit's own word for success is exit code 0."""
    command = [sys.executable, "-m", *words]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True,
                          check=False)  # fmt: skip
    assert done.returncode == 0, (words, done.stdout[-1500:], done.stderr[-1500:])


@pytest.mark.soak
def test_the_term_on_one_page_can_be_played(tmp_path):
    """A class of four, from a clone to marks for Moodle, and then whatever else *run* shows."""
    course = tmp_path / "course"
    subprocess.run(["git", "clone", "--quiet", ROOT, course], check=True, capture_output=True)
    rows = [f"{name},Ng,{name.lower()}@uni.org,Student" for name in CLASS]
    rows[0] = "Ada,Lovelace,ada@uni.org,Student"
    head = "First name,Last name,Email address,Roles"
    table = "\n".join([head, *rows, "Eve,Old,eve@uni.org,Teacher"])
    (course / "participants.csv").write_text(table)
    blank = (ROOT / "assignments/01_paths/01_paths.ipynb").read_text()
    with zipfile.ZipFile(course / "moodle.zip", "w") as archive:
        for k, (name, right) in enumerate(CLASS.items()):
            notebook = json.loads(blank)
            for function in right:
                put(notebook, function, inline(getattr(answers, function), function))
            last = "Lovelace" if name == "Ada" else "Ng"
            path = f"{name} {last}_{101 + k}_assignsubmission_file/01_paths.ipynb"
            archive.writestr(path, json.dumps(notebook))
    page = [words for words in shown("instructor_guide") if words[0] != "make"]
    assert len(page) <= 12
    for words in page + shown("instructors/run") + shown("instructors/reference"):
        works(words, course)
    (bundle,) = (course / "dist").glob("*.zip")
    assert zipfile.is_zipfile(bundle)
    assert (course / "marks.csv").read_text().count("@uni.org") == len(CLASS)
    assert len(list((course / "results/01_paths").glob("*.json"))) == len(CLASS)
    assert len(list((course / "feedback").glob("*/01_paths/01_paths.html"))) == len(CLASS)
    assert (course / "build/course/defence/Ada-Lovelace.html").exists()


def test_the_rules_that_the_guide_shows_can_be_followed(tmp_path):
    """`course.toml` as it is printed is read, in full."""
    text = (ROOT / "book/instructors/reference.md").read_text()
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
    for page in sorted([*(ROOT / "book").glob("*.md"), *(ROOT / "book/instructors").glob("*.md")]):
        text = page.read_text()
        assert set(re.findall(r"`make ([a-z0-9-]+)", text)) <= known, page.name
        assert set(re.findall(r"`labkit ([a-z-]+)", text)) <= verbs, page.name
