"""What the README shows is what happens."""

import json
import re
import subprocess
from importlib.util import find_spec
from pathlib import Path

import modules
import pytest

import labkit
from labkit.course.authoring.layout import Course
from labkit.course.marking import mark
from labkit.course.messages import message
from labkit.course.student import Desk

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()
PAGES = [
    ROOT / name
    for name in (
        "README.md",
        "CONTRIBUTING.md",
        "CHANGELOG.md",
        "book/architecture.md",
        "solutions/README.md",
        "labkit/README.md",
        "labkit/grader/README.md",
    )
]
each = pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))


def test_the_example_runs_and_tracks(capsys):
    """The ten lines run as they stand and follow the circle within centimetres."""
    (code,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    names = {}
    exec(code, names)
    assert "RMS" in capsys.readouterr().out
    assert names["lk"].metrics.summary(names["log"]).max_mm < 30.0


def test_the_message_shown_is_what_the_check_says():
    """The student's answer gets the message below it, in its order; … leaves lines out."""
    (shown,) = re.findall(r"```text\n(.*?)```", README, re.DOTALL)
    code, said = shown.split("\n\n")
    names = {"lk": labkit}
    exec(code, names)
    desk = Desk.beside(ROOT / "assignments/03_velocity_control")
    question = desk.question("joint_velocity_pd")
    told = iter(str(message(question, mark(question, names[question.name]))).splitlines())
    for line in said.splitlines():
        assert line == "  …" or line in told, line


def points():
    """Points of each released notebook, by the metadata that nbgrader reads."""
    found = {}
    for path in sorted((ROOT / "assignments").glob("*/*.ipynb")):
        cells = [
            cell["metadata"].get("nbgrader", {}) for cell in json.loads(path.read_text())["cells"]
        ]
        found[path.stem] = sum(cell["points"] for cell in cells if cell.get("grade"))
    return found


def test_the_points_of_the_readme_are_those_of_the_notebooks():
    """README counts the points that the released notebooks give."""
    found = points()
    (told,) = re.findall(r"(\d+) for the notebooks, (\d+) for the report", README)
    report = found.pop("08_report")
    assert [float(x) for x in told] == [sum(found.values()), report]
    course = Course.here(Path(__file__))
    asked = [problem for name in course.names() for problem in course.problems(name)]
    (told,) = re.findall(r"Of the \d+, (\d+) are for functions, (\d+) of them in core", README)
    assert float(told[0]) == sum(problem.points for problem in asked)
    assert float(told[1]) == sum(problem.points for problem in asked if problem.core)


def test_the_points_and_weights_of_the_guide_are_those_of_the_notebooks():
    """The guide's sums, and a weight for each notebook in proportion to its points."""
    guide, found = (ROOT / "book/instructor_guide.md").read_text(), points()
    del found["08_report"]
    everything = sum(found.values())
    assert {float(x) for x in re.findall(r"(?:in place of|the sum is) (\d+)\b", guide)} == {
        everything
    }
    rows = re.findall(r"^\| (`0[0-7]_.+) \| ([\d.]+)(?: each)? \|$", guide, re.MULTILINE)
    weights = {name: float(w) for names, w in rows for name in re.findall(r"`(\w+)`", names)}
    assert weights == {name: round(50.0 * x / everything, 1) for name, x in found.items()}


def test_every_verb_exists():
    """Each `make` verb that a page names is one that `make help` lists."""
    listed = subprocess.run(["make", "help"], cwd=ROOT, capture_output=True, text=True, check=True)
    verbs = set(re.findall(r"^  make (\S+)", listed.stdout, re.MULTILINE))
    for page in PAGES:
        named = set(re.findall(r"`make ([a-z0-9-]+)", page.read_text()))
        assert named <= verbs, (page.name, named - verbs)


@each
def test_links_lead_somewhere(page):
    """Every link to a file of the project leads to one."""
    for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text()):
        assert (page.parent / target).exists(), target


@each
def test_places_that_are_named_are_there(page):
    """Every file and module of the project that a page names exists; `topic` stands for any."""
    text = page.read_text().replace("NN_topic", "01_paths").replace("topic", "paths")
    for place in re.findall(r"`((?:labkit|solutions|tests|book)/[\w./-]*)`", text):
        assert (ROOT / place).exists() or place == "book/_build/html/index.html", place
    for module in re.findall(r"python -m ((?:labkit|solutions|tests)[\w.]*)", text):
        assert find_spec(module), module


def test_every_module_of_the_grader_has_its_line():
    """The table of the grader's page names each folder and, of all but the sandbox, each file."""
    grader = ROOT / "labkit/grader"
    rows = re.findall(r"^\| (.+?) \| (.+) \|$", (grader / "README.md").read_text(), re.MULTILINE)
    told = {folder.strip("`/"): set(re.findall(r"`(\w+)`", files)) for folder, files in rows}
    told[""] = told.pop("beside this page")
    for folder in ("", *(path.parent.name for path in grader.glob("*/__init__.py"))):
        files = {path.stem for path in (grader / folder).glob("[a-z]*.py")}
        assert told[folder] <= files, folder
        assert told[folder] == files or folder == "sandbox", files - told[folder]


def test_the_table_of_files_is_made_from_their_docstrings():
    """After a docstring or a file has changed, `python tests/modules.py` writes the table again."""
    assert modules.PAGE.read_text(encoding="utf-8") == modules.table()


def test_the_graders_page_names_each_of_its_files():
    """No file of the grader is missing from the page that says what each is for."""
    home = ROOT / "labkit/grader"
    page = set(re.findall(r"\w+", (home / "README.md").read_text(encoding="utf-8")))
    assert not {path.stem for path in home.rglob("[a-z]*.py")} - page
