"""What students are given: no answers, no grader, nothing left over."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from handmade import ROOT

from labkit.course.authoring.layout import Course
from labkit.course.source import plain
from labkit.grader.student_zip import NOT_FOR_STUDENTS, PICTURE, _start_here, student_zip

pytestmark = pytest.mark.xdist_group("student zip")
HOST = "https://github.com/me/lab"

ALONE = """
import sys
sys.meta_path = [finder for finder in sys.meta_path if "Editable" not in str(finder)]
import labkit as lk
import labkit.course
from labkit.__main__ import main
lk.ready()
main(["--help"])
"""
"""What a student runs, in an environment that also finds this course's own labkit."""


@pytest.fixture(scope="module")
def unpacked(released, tmp_path_factory):
    """The students' zip, unpacked, with its wheel unpacked beside it."""
    folder = tmp_path_factory.mktemp("handout")
    course = Course(shutil.copytree(released.root, folder / "course", symlinks=True))
    for name in ("labkit", "book", ".ci", "pyproject.toml", "README.md", "LICENSE"):
        (course.root / name).symlink_to(ROOT / name)
    stale = course.root / "build" / "lib" / "labkit" / "gone.py"
    stale.parent.mkdir(parents=True)
    stale.write_text("what an earlier build left")
    assert student_zip(course, (), folder / "lab.zip", "book.org", HOST) == ("01_curves",)
    with zipfile.ZipFile(folder / "lab.zip") as archive:
        archive.extractall(folder)
    (wheel,) = (folder / "baxter-lab").glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder / "wheel")
    return folder


@pytest.mark.slow
def test_students_labkit_is_todays_without_the_instructors_half(unpacked):
    """The wheel has each of labkit's modules that git has, but the instructor's, and no other."""
    listed = subprocess.run(
        ["git", "-C", str(ROOT), "ls-files", "labkit"], capture_output=True, text=True, check=True
    )
    wanted = {name for name in listed.stdout.splitlines() if name.endswith(".py")}
    instructors = tuple(f"{folder}/" for folder in NOT_FOR_STUDENTS)
    wanted = {name for name in wanted if not name.startswith(instructors)}
    found = {str(p.relative_to(unpacked / "wheel")) for p in unpacked.glob("wheel/labkit/**/*.py")}
    assert found == wanted


@pytest.mark.slow
def test_students_labkit_works_alone(unpacked):
    """Without the grader the arm moves, and the command has the students' verbs."""
    run = subprocess.run(
        [sys.executable, "-c", ALONE],
        cwd=unpacked / "wheel",
        capture_output=True,
        text=True,
        check=False,
    )
    assert "submit-check" in run.stdout, run.stderr
    assert "class-report" not in run.stdout
    assert "the arm moved" in run.stdout + run.stderr


@pytest.mark.slow
def test_the_zip_holds_what_a_student_needs_and_no_more(unpacked):
    """Notebooks, their checks, a wheel with its versions, and how to begin."""
    top = unpacked / "baxter-lab"
    found = {str(path.relative_to(top)) for path in top.rglob("*") if path.is_file()}
    found = {name for name in found if not name.endswith(".whl")}
    assert found == {
        *("START.html", "README.md", "LICENSE", "start.py", "constraints.txt"),
        *(".devcontainer/devcontainer.json", "binder/postBuild", "binder/runtime.txt"),
        *("assignments/01_curves/01_curves.ipynb", "assignments/01_curves/checks.json"),
        "assignments/START_HERE.ipynb",
    }
    assert not [name for name in found if re.search(r'[:*?"<>|\\]', name)]  # which Windows forbids


@pytest.mark.slow
def test_a_notebook_opens_in_a_browser_and_fetches_what_is_missing(unpacked, tmp_path, monkeypatch):
    """From the repository with the files; where the lab and the checks are, it does nothing."""
    text = (unpacked / "baxter-lab/assignments/01_curves/01_curves.ipynb").read_text()
    links, fetch = ("".join(cell["source"]) for cell in json.loads(text)["cells"][:2])
    place = "me/lab/blob/main/assignments/01_curves/01_curves.ipynb"
    for found in (links, (unpacked / "baxter-lab/START.html").read_text()):
        assert f"https://colab.research.google.com/github/{place}" in found
        assert "https://mybinder.org/v2/gh/me/lab/main?labpath=assignments/" in found
        assert "https://codespaces.new/me/lab" in found
    (wheel,) = unpacked.glob("baxter-lab/*.whl")
    assert f'%pip install --quiet "labkit[notebook] @ {HOST}/raw/main/{wheel.name}"' in fetch
    fetched = []
    monkeypatch.setattr("urllib.request.urlretrieve", lambda *names: fetched.append(names))
    monkeypatch.chdir(tmp_path)
    exec(plain(fetch), {})
    assert fetched == [(f"{HOST}/raw/main/assignments/01_curves/checks.json", "checks.json")]
    Path("checks.json").touch()
    exec(plain(fetch), {})
    assert len(fetched) == 1 and Path.cwd() == tmp_path / "lab/01_curves"


@pytest.mark.slow
def test_the_first_notebook_has_a_picture_the_order_and_the_book_and_runs(unpacked):
    """All that it links to is there; its code shows a live arm."""
    folder = unpacked / "baxter-lab/assignments"
    notebook = json.loads((folder / "START_HERE.ipynb").read_text())
    text = "\n".join("".join(cell["source"]) for cell in notebook["cells"])
    links = re.findall(r"\]\(([^)]*)\)", text)[3:]
    first = "01_curves/01_curves.ipynb"
    assert links == ["attachment:baxter.png", first, "book.org"]
    assert notebook["cells"][0]["attachments"]["baxter.png"]["image/png"]
    assert (folder / links[1]).exists()
    names = {}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            exec(plain("".join(cell["source"])), names)


def test_the_first_notebook_begins_with_a_practice_hand_in(tmp_path):
    """It names the first notebook, and its first prediction, which is worth a point."""
    name = "00_warmup"
    shutil.copytree(ROOT / "assignments" / name, tmp_path / name)
    _start_here(tmp_path, [name], ROOT / PICTURE, None)
    cells = json.loads((tmp_path / "START_HERE.ipynb").read_text())["cells"]
    text = "\n".join("".join(cell["source"]) for cell in cells)
    assert re.findall(r"^1\. Open \[\w+\]\((.*?)\)", text, re.MULTILINE) == [f"{name}/{name}.ipynb"]
    (asked,) = re.findall(r"one point for `(\w+)`", text)
    assert f'predict(\\"{asked}\\"' in (tmp_path / name / f"{name}.ipynb").read_text()
