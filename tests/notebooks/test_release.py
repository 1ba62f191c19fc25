"""What is committed for students: in sync with its sources, no answers, no hidden cases."""

import ast
import inspect
import json
import re
from pathlib import Path

import nbformat
import numpy as np
import pytest
from courses import copied

from labkit.course import question_data
from labkit.course.authoring.layout import Course
from labkit.course.authoring.release import same_but_for_rounding
from labkit.course.notebook import source_notebook
from labkit.course.serialize import encode
from labkit.grader.release import FORBIDDEN, release

pytestmark = pytest.mark.xdist_group("release")

COURSE = Course.here(Path(__file__))
NAMES = COURSE.names()
OTHER_SEED = 77

each = pytest.mark.parametrize("name", NAMES)


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory):
    """The same course in another folder, released anew with hidden cases of another seed."""
    course = copied(tmp_path_factory.mktemp("course"))
    for name in NAMES:
        release(course, name, OTHER_SEED)
    return course


def files(name):
    """The committed files of an assignment."""
    return {p.name: p for p in (COURSE.release / name).iterdir() if p.is_file()}


@pytest.mark.slow
@each
def test_in_sync_and_the_same_for_every_seed(name, elsewhere):
    """Released again elsewhere, with another seed, students get the same files.

    Numbers have the same eight digits: some known mistakes take differences of nearly equal ones.
    """
    again = {p.name: p for p in (elsewhere.release / name).iterdir()}
    assert set(again) == set(files(name)) == {f"{name}.ipynb", "checks.json"}
    mine = files(name)[f"{name}.ipynb"].read_text(encoding="utf-8")
    assert mine == again[f"{name}.ipynb"].read_text(encoding="utf-8"), "run: labkit release"
    ours, theirs = (
        json.loads(f["checks.json"].read_text(encoding="utf-8")) for f in (files(name), again)
    )
    others = [
        one["name"]
        for one, two in zip(ours.pop("questions"), theirs.pop("questions"), strict=True)
        if not same_but_for_rounding(one, two, 1e-8, 1e-8)
    ]
    assert (ours, others) == (theirs, []), "run: labkit release"


@each
def test_cells_are_deterministic(name):
    """Made twice, the source notebook is the same, ids included, and no id occurs twice."""
    questions = {p.name: p.question(1) for p in COURSE.problems(name)}
    more = COURSE.predictions(name)
    a, b = (source_notebook(COURSE.notebook_source(name), questions, more) for _ in range(2))
    assert nbformat.writes(a) == nbformat.writes(b)
    assert len({cell.id for cell in a.cells}) == len(a.cells)


@each
def test_no_answer_leaves(name):
    """No solution region, no import of the solutions, and no line of any answer in its stub."""
    for path in files(name).values():
        text = path.read_text(encoding="utf-8")
        assert not [word for word in FORBIDDEN if word in text]
    notebook = nbformat.read(files(name)[f"{name}.ipynb"], as_version=4)
    answers = {
        cell.metadata["nbgrader"]["grade_id"]: cell.source
        for cell in notebook.cells
        if cell.metadata["lab"] in ("answer", "why")
    }
    for asked in COURSE.predictions(name):
        assert answers[asked.name] == asked.cell() != asked.solved()
    for problem in COURSE.problems(name):
        stub = answers[problem.name]
        body = ast.parse(inspect.getsource(inspect.unwrap(problem.answer))).body[0].body
        for statement in body[1:]:
            assert ast.unparse(statement) not in stub
        assert stub.rstrip().endswith("raise NotImplementedError")


@each
def test_no_hidden_case_leaves(name):
    """No number of a hidden case is to be found in what students get, whatever its seed."""
    text = files(name)["checks.json"].read_text(encoding="utf-8")
    long = re.compile(r"\d\.\d{12,}(?![\de])")
    problems = COURSE.problems(name)
    public = json.dumps([question_data(problem.question(2019).public()) for problem in problems])
    known = np.array([*map(float, long.findall(public)), np.inf])  # but for the last digits
    for problem in problems:
        for test in problem.question(2019).tests:
            for case in test.cases:
                if case.hidden:
                    numbers = set(long.findall(json.dumps(encode(case))))
                    assert not {
                        x
                        for x in numbers
                        if x in text and not np.isclose(float(x), known, rtol=1e-12, atol=0).any()
                    }


@each
def test_it_stands_alone(name):
    """It opens with what is needed and given, and links to nothing that may not be there."""
    notebook = nbformat.read(files(name)[f"{name}.ipynb"], as_version=4)
    first = notebook.cells[0].source
    for word in ("You need", "Given", "You write", "Time", "points"):
        assert word in first
    assert len(first.splitlines()) < 30
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            assert not re.findall(r"\]\((?!https://)[^)]*\)", cell.source)
    points = sum(cell.metadata.get("nbgrader", {}).get("points", 0.0) for cell in notebook.cells)
    assert f"{points:g} points" in first
