"""nbgrader's own tools on these notebooks: autograde and validate."""

import shutil
from pathlib import Path

import nbformat
import pytest
from courses import copied
from handmade import nbgrader
from plain_nbgrader import grade_with_nbgrader, pack_hidden

from labkit.course.authoring.layout import Course
from labkit.course.authoring.release import inlined
from labkit.grader.release import release

pytestmark = pytest.mark.xdist_group("nbgrader marks")

COURSE = Course.here(Path(__file__))
NAME = "00_warmup"


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """The course elsewhere, with three submissions: solved, untouched, and half of it."""
    course = copied(tmp_path_factory.mktemp("course"))
    release(course, NAME, 3)
    pack_hidden(course, NAME)
    problems = {problem.name: problem for problem in course.problems(NAME)}
    for student, known in (
        ("ada", set()),
        ("ben", set()),
        ("cleo", {"joint_error", "orientation_error"}),
    ):
        folder = course.submitted / student / NAME
        shutil.copytree((course.solution if student == "ada" else course.release) / NAME, folder)
        notebook = nbformat.read(folder / f"{NAME}.ipynb", as_version=4)
        for cell in notebook.cells:
            name = cell.metadata.get("nbgrader", {}).get("grade_id")
            if cell.metadata["lab"] == "answer" and name in known:
                cell.source = inlined(problems[name])
        nbformat.write(notebook, folder / f"{NAME}.ipynb")
    return course


@pytest.mark.slow
@pytest.mark.parametrize(("student", "score"), [("ada", 9.0), ("ben", 0.0), ("cleo", 6.0)])
def test_autograde(course, student, score):
    """Full marks for the answers, none for the release, and each question for itself."""
    assert grade_with_nbgrader(course, NAME, student) == score


@pytest.mark.slow
@pytest.mark.parametrize(("student", "word"), [("ada", "Success"), ("cleo", "Partial credit")])
def test_validate(course, student, word):
    """Validate tells only whether all is well; the reasons are in the notebook itself."""
    _, said = nbgrader(course.submitted / student / NAME, "validate", f"{NAME}.ipynb")
    assert word in said


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["source", "solution"])
def test_what_a_release_leaves_validates_as_it_lies(course, kind):
    """The first check that nbgrader offers passes on the source and on the solved notebook."""
    _, said = nbgrader(getattr(course, kind) / NAME, "validate", f"{NAME}.ipynb")
    assert "Success" in said, said[-1500:]


def test_nbgraders_own_autograde_refuses(tmp_path):
    """By its command and its button: it would run students' code in its own process."""
    course = copied(tmp_path)
    release(course, NAME, 3)
    folder = course.submitted / "ada" / NAME
    shutil.copytree(course.solution / NAME, folder)
    code, said = nbgrader(course.root, "autograde", NAME, "--create")
    assert code and f"labkit grade {NAME}" in said
    assert not (course.root / "autograded/ada" / NAME / f"{NAME}.ipynb").exists()
