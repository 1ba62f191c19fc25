"""Making notebooks from sources: what is fed in, what comes out, what is refused."""

import json
from dataclasses import replace
from pathlib import Path

import nbformat
import pytest
from courses import copied

from labkit.check import read_question
from labkit.cli import main
from labkit.errors import LabkitError
from labkit.grade.course import Course
from labkit.grade.notebook import brief, source_notebook
from labkit.grade.release import FORBIDDEN, release
from labkit.grade.solved import inlined, solution_notebook

COURSE = Course.here(Path(__file__))
NAME = "00_warmup"
PROBLEMS = {problem.name: problem for problem in COURSE.problems(NAME)}
QUESTIONS = {name: problem.question(1) for name, problem in PROBLEMS.items()}


def source():
    return source_notebook(COURSE.notebook_source(NAME), QUESTIONS)


def cells(notebook, kind):
    return [cell for cell in notebook.cells if cell.metadata["lab"] == kind]


def test_each_question_gets_brief_stub_and_check():
    """Three cells for each question, in order; the check is locked and carries the points."""
    notebook = source()
    assert not nbformat.validate(notebook)
    kinds = [cell.metadata["lab"] for cell in notebook.cells]
    assert kinds.count("brief") == kinds.count("answer") == kinds.count("check") == len(QUESTIONS)
    for stub, test in zip(cells(notebook, "answer"), cells(notebook, "check"), strict=True):
        name = stub.metadata["nbgrader"]["grade_id"]
        assert test.metadata["nbgrader"]["grade_id"] == f"{name}-check"
        assert test.metadata["nbgrader"]["points"] == QUESTIONS[name].points
        assert test.metadata["nbgrader"]["locked"] and not stub.metadata["nbgrader"]["locked"]
        assert test.source.endswith(f'check("{name}", {name})')


def test_the_brief_says_what_is_hidden_and_withheld():
    """Points, gate, classes of hidden case, withheld names and the hint stand above each stub."""
    words = brief(QUESTIONS["orientation_error"])
    assert "4 points" in words and "rolls at other yaws" in words
    assert "`lk.se3.orientation_error`" in words and "hint(" in words


def test_stubs_and_questions_must_match(tmp_path):
    """A stub without a question, and a question without a stub, are refused by name."""
    text = tmp_path / "x.py"
    text.write_text('# %% question="double"\ndef double(x):\n    pass\n')
    with pytest.raises(LabkitError, match="'double', which has no Problem"):
        source_notebook(text, {})
    one = QUESTIONS["joint_error"]
    region = "    ### BEGIN SOLUTION\n    return 1\n    ### END SOLUTION\n\n"
    stub = f'# %% question="joint_error"\ndef joint_error(x):\n{region}'
    for source, sentence in (
        ("# %%\nx = 1\n", "has 0 stubs of joint_error"),
        (stub + stub, "has 2 stubs of joint_error"),
        (stub.replace("def joint_error", "def error"), "defines no joint_error"),
        (stub.replace("    ### END SOLUTION\n", ""), "needs one region"),
    ):
        text.write_text(source)
        with pytest.raises(LabkitError, match=sentence):
            source_notebook(text, {"joint_error": one})


@pytest.mark.parametrize("name", COURSE.names())
def test_solutions_are_whole(name):
    """The solved notebook holds the answers' source, runs on its own, and no hidden cases."""
    problems = {p.name: p for p in COURSE.problems(name)}
    questions = {key: p.question(1) for key, p in problems.items()}
    solved = solution_notebook(source_notebook(COURSE.notebook_source(name), questions), problems)
    text = "\n".join(cell.source for cell in solved.cells)
    assert not [word for word in FORBIDDEN if word in text]
    for problem in problems.values():
        names: dict[str, object] = {}
        exec(inlined(problem), names)
        assert callable(names[problem.name])


@pytest.mark.slow
def test_an_answer_that_leaks_stops_the_release(tmp_path):
    """If an answer stands outside its solution region, nothing is released."""
    course = copied(tmp_path)
    path = tmp_path / "solutions" / "notebooks" / f"{NAME}.py"
    path.write_text(path.read_text() + "\n# %%\nfrom solutions.warmup import joint_error\n")
    with pytest.raises(LabkitError, match="nothing released"):
        release(course, NAME, 1)
    assert not (course.release / NAME).exists()


def test_a_notebook_without_problems_is_a_sentence(tmp_path):
    """A source that somebody has begun says which file is still to be written."""
    course = copied(tmp_path)
    (tmp_path / "solutions/notebooks/08_dance.py").write_text("# %%\n")
    with pytest.raises(LabkitError, match=r"write solutions/problems/dance\.py with PROBLEMS"):
        course.problems("08_dance")


def test_a_withheld_name_must_exist(tmp_path, monkeypatch):
    """A name that is misspelt would withhold nothing; so nothing is released."""
    course = copied(tmp_path)
    (first, *others) = PROBLEMS.values()
    problems = (replace(first, withheld=("labkit.Circel",)), *others)
    monkeypatch.setattr(Course, "problems", lambda self, name: problems)
    with pytest.raises(LabkitError, match=r"withholds labkit\.Circel, which does not exist"):
        release(course, NAME, 1)
    assert not course.build.exists()


def test_a_students_environment_is_told_what_an_instructors_has(monkeypatch, capsys):
    """Where a package of the instructor's is missing, the line that brings it is said."""

    def missing(*args):
        raise ModuleNotFoundError("No module named 'nbgrader'", name="nbgrader.apps")

    monkeypatch.setattr("labkit.grade.release.release", missing)
    assert main(["release", NAME, "--course", str(COURSE.root)]) == 2
    said = "labkit release: nbgrader is missing; type: pip install 'labkit[instructor]'\n"
    assert capsys.readouterr().err == said


def test_mistakes_of_the_caller_are_one_sentence(capsys):
    """An unknown assignment, a folder without a course: exit code 2 and a way out."""
    assert main(["release", "09_nothing", "--course", str(COURSE.root)]) == 2
    assert "'00_warmup'" in capsys.readouterr().err
    assert main(["release", "--course", "/"]) == 2
    assert "nbgrader_config.py" in capsys.readouterr().err


def test_the_public_file_is_small_and_valid():
    """What lies beside the notebook is one line of JSON without a hidden case."""
    for name in COURSE.names():
        path = COURSE.release / name / "checks.json"
        assert path.stat().st_size < 300_000
        data = json.loads(path.read_text(encoding="utf-8"))
        assert data["assignment"] == name
        questions = map(read_question, data["questions"])
        cases = [case for question in questions for test in question.tests for case in test.cases]
        assert cases and not any(case.hidden for case in cases)
