"""Making notebooks from sources: what is fed in, what comes out, what is refused."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import nbformat
import numpy as np
import pytest
from courses import SYNTHETIC, synthetic
from handmade import NAME

from labkit.__main__ import main
from labkit.course.authoring.layout import Course
from labkit.course.authoring.problem import _none
from labkit.course.authoring.refusals import refusals
from labkit.course.notebook import source_notebook
from labkit.errors import LabkitError
from labkit.grader.release import release

COURSE = Course(SYNTHETIC.parent)
REAL = Course.here(Path(__file__))
PROBLEMS = {problem.name: problem for problem in COURSE.problems(NAME)}
QUESTIONS = {name: problem.question(1) for name, problem in PROBLEMS.items()}


def source():
    return source_notebook(COURSE.notebook_source(NAME), QUESTIONS, COURSE.predictions(NAME))


def cells(notebook, kind):
    return [cell for cell in notebook.cells if cell.metadata["lab"] == kind]


def test_each_question_gets_brief_stub_and_check():
    """Three cells for each question, in order; the check is locked and carries the points."""
    notebook = source()
    assert not nbformat.validate(notebook)
    kinds = [cell.metadata["lab"] for cell in notebook.cells]
    asked = len(QUESTIONS) + len(COURSE.predictions(NAME))
    assert kinds.count("answer") == kinds.count("check") == asked
    assert kinds.count("brief") == asked + kinds.count("why")
    for stub, test in zip(cells(notebook, "answer"), cells(notebook, "check"), strict=True):
        name = stub.metadata["nbgrader"]["grade_id"]
        if name not in QUESTIONS:
            continue
        assert test.metadata["nbgrader"]["grade_id"] == f"{name}-check"
        assert test.metadata["nbgrader"]["points"] == QUESTIONS[name].points
        assert test.metadata["nbgrader"]["locked"] and not stub.metadata["nbgrader"]["locked"]
        assert test.source.endswith(f'check("{name}", {name})')


def test_stubs_and_questions_must_match(tmp_path):
    """A stub without a question, and a question without a stub, are refused by name."""
    text = tmp_path / "x.py"
    text.write_text('# %% question="double"\ndef double(x):\n    pass\n')
    with pytest.raises(LabkitError, match=r"'double', which is not in PROBLEMS of problems\.py"):
        source_notebook(text, {})
    one = QUESTIONS["circle"]
    region = "    ### BEGIN SOLUTION\n    return 1\n    ### END SOLUTION\n\n"
    stub = f'# %% question="circle"\ndef circle(x):\n{region}'
    for source, sentence in (
        ("# %%\nx = 1\n", "has 0 stubs of circle"),
        (stub + stub, "has 2 stubs of circle"),
        (stub.replace("def circle", "def disc"), "does not define circle"),
        (stub.replace("    ### END SOLUTION\n", ""), "needs one region"),
    ):
        text.write_text(source)
        with pytest.raises(LabkitError, match=sentence):
            source_notebook(text, {"circle": one})


@pytest.mark.parametrize(
    ("key", "name", "listed"),
    [
        ("question", "twice_the_time", r"PROBLEMS of problems\.py"),
        ("predict", "circle", r"PREDICTIONS of predictions\.py"),
    ],
)
def test_what_is_in_the_other_list_is_refused(tmp_path, key, name, listed):
    """A stub for a prediction, or a value for a question, names the list that lacks it."""
    text = tmp_path / "x.py"
    text.write_text(f'# %% {key}="{name}"\n')
    with pytest.raises(LabkitError, match=f"'{name}', which is not in {listed}"):
        source_notebook(text, QUESTIONS, COURSE.predictions(NAME))


def written(root):
    """The synthetic course, with sources that a test may change."""
    course = synthetic(root / "course")
    (course.root / "solutions").unlink()
    shutil.copytree(SYNTHETIC, course.root / "solutions")
    return course


def test_an_answer_that_leaks_stops_the_release(tmp_path):
    """If an answer stands outside its solution region, nothing is released."""
    course = written(tmp_path)
    path = course.notebook_source(NAME)
    path.write_text(path.read_text() + "\n# %%\nfrom solutions.curves import problems\n")
    with pytest.raises(LabkitError, match="nothing released"):
        release(course, NAME, 1)
    assert not (course.release / NAME).exists()


def test_a_notebook_without_problems_is_a_sentence(tmp_path):
    """A source that somebody has begun says which file is still to be written."""
    course = written(tmp_path)
    (course.root / "solutions/dance").mkdir()
    (course.root / "solutions/dance/09_dance.py").write_text("# %%\n")
    with pytest.raises(LabkitError, match=r"write solutions/dance/problems\.py with PROBLEMS"):
        course.problems("09_dance")


def test_names_of_tools_and_outcomes_must_exist():
    """One that is misspelt would withhold nothing, or be missing from the class report."""
    first = replace(PROBLEMS["circle"], withheld=("labkit.Circel",), outcomes=("moton",))
    assert len(refused(PROBLEMS | {"circle": first})) == 2


def test_one_refusal_stops_no_other_release(monkeypatch, capsys):
    """The others are released, and the reason comes at the end, with the name."""

    def release(course, name, seed):
        if name == "01_paths":
            raise LabkitError("the first cell says 24 points")
        return f"{name} is made"

    monkeypatch.setattr("labkit.grader.release.release", release)
    assert main(["release", "00_warmup", "01_paths", "08_report", "--course", str(REAL.root)]) == 1
    said = capsys.readouterr()
    assert said.out.startswith("00_warmup is made\n08_report is made\n")
    assert said.err == "01_paths is not released: the first cell says 24 points\n"


def refused(problems, text=None):
    """Why a release with these problems, and with this notebook text, is refused."""
    questions = {name: problem.question(1) for name, problem in problems.items()}
    return refusals(
        source_notebook(text or COURSE.notebook_source(NAME), questions, COURSE.predictions(NAME)),
        problems,
        questions,
    )


def with_trials(name, change):
    """The problems, one of them with changed trials."""
    problem = PROBLEMS[name]
    trials = tuple(change(k, trial) for k, trial in enumerate(problem.trials))
    return PROBLEMS | {name: replace(problem, trials=trials)}


def test_a_weighted_test_needs_a_hidden_case():
    """Without one the public file has its points, and who memorises it earns them."""
    bare, by_heart = refused(with_trials("circle", lambda k, t: replace(t, hidden=_none)))
    assert "'on its way' carries 4 of 4 points and has no hidden case" in bare
    assert "memorises its public cases earns 4 of 4 points" in by_heart
    gate = with_trials("circle", lambda k, t: replace(t, hidden=t.hidden if k else _none))
    assert refused(gate) == [], "a gate carries no points"


def test_a_stand_in_pays_nothing(tmp_path):
    """A notebook that falls back to the answer gives it away, unless the question withholds it."""
    text = tmp_path / f"{NAME}.py"
    source = COURSE.notebook_source(NAME).read_text()
    worse = "return np.clip(t / duration, 0.0, 1.0), 1.0 / duration, 0.0"
    text.write_text(source.replace(worse, "return lk.BangBang(duration)(t)"))
    assert refused(PROBLEMS, text) == []
    open_door = {"bang_bang": replace(PROBLEMS["bang_bang"], withheld=())}
    (sentence,) = refused(PROBLEMS | open_door, text)
    assert "bang_bang: the stand-in" in sentence and "earns 3 of 3 points" in sentence


def test_known_mistakes_must_be_told_apart():
    """Two with the same answers, or one with the right ones, would accuse the innocent."""
    problem = PROBLEMS["circle"]
    first = problem.wrong[0]
    twin = replace(first, name="its twin")
    right = replace(first, name="nothing wrong", function=problem.answer)
    (sentence,) = refused(PROBLEMS | {problem.name: replace(problem, wrong=(first, twin))})
    assert "'backwards' and 'its twin' give the same answers on all" in sentence
    (sentence,) = refused(PROBLEMS | {problem.name: replace(problem, wrong=(right,))})
    assert "'nothing wrong' gives the right answers on all public calls" in sentence


def test_a_known_mistake_must_give_an_answer():
    """One that only raises, or only returns NaN, would name every answer that does so too."""

    def slips(*args):
        return undefined_here(args)  # noqa: F821

    problem = PROBLEMS["circle"]
    broken = replace(problem.wrong[0], name="no turn", function=slips)
    (sentence,) = refused(PROBLEMS | {problem.name: replace(problem, wrong=(broken,))})
    assert "its known mistake 'no turn' raises NameError on each public call" in sentence
    divides = replace(broken, function=lambda *args: np.full(3, np.nan))
    (sentence,) = refused(PROBLEMS | {problem.name: replace(problem, wrong=(divides,))})
    assert "its known mistake 'no turn' returns NaN on each public call" in sentence


def test_a_release_with_a_reason_against_it_writes_nothing(course, monkeypatch):
    """All reasons are said at once, and what was released before stays."""
    before = {p: p.read_bytes() for p in course.root.rglob("*") if p.is_file()}
    bare = with_trials("circle", lambda k, t: replace(t, hidden=_none))
    monkeypatch.setattr(Course, "problems", lambda self, name: tuple(bare.values()))
    with pytest.raises(LabkitError, match=rf"^solutions/{NAME[3:]}:\n") as caught:
        release(course, NAME, 1)
    assert str(caught.value).count("circle: ") == 2
    assert before == {p: p.read_bytes() for p in course.root.rglob("*") if p.is_file()}


def test_what_another_machine_rounds_otherwise_changes_no_file(course):
    """A release anew leaves public cases that agree, and writes them if a number is another."""
    checks = course.release / NAME / "checks.json"
    text = checks.read_text()
    for factor, kept in ((1 + 1e-12, True), (1 + 1e-6, False)):
        other = re.sub(r"[0-9]+\.[0-9]{9,}", lambda x, k=factor: repr(float(x[0]) * k), text)
        assert other != text
        checks.write_text(other)
        release(course, NAME, 7)
        assert checks.read_text() == (other if kept else text)
