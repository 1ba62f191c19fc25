"""The command line: one sentence for wrong use, and no more verbs and options than a term needs."""

import shlex
import subprocess
import sys

import click
import pytest
from courses import ROOT

from labkit.__main__ import main, program
from labkit.course.authoring.layout import Course

VERBS = program().commands


def test_a_term_needs_twelve_verbs_and_few_options():
    """Whatever is written for others is a layout of `export`."""
    assert len(set(VERBS) - {"submit-check"}) <= 12
    options = [x for one in VERBS.values() for x in one.params if isinstance(x, click.Option)]
    assert len(options) <= 36


@pytest.mark.parametrize("name", VERBS)
def test_each_verb_shows_an_example_that_can_be_typed(name, capsys):
    """`labkit VERB --help` says what it does and ends with an example."""
    assert main([name, "--help"]) == 0
    last = capsys.readouterr().out.splitlines()[-1].strip()
    called, verb, *words = shlex.split(last.removeprefix("example: "))
    assert (called, verb) == ("labkit", name)
    VERBS[name].make_context(name, words)


@pytest.mark.parametrize(
    "words",
    [
        *([], ["dance"], ["grade", "01_paths", "--jobs", "0"]),
        ["defence", "ada", "--mark", "9" * 5000, "1", "1"],
    ],
)
def test_wrong_words_end_with_code_two(words, capsys):
    """Words that make no sense end with a usage line."""
    assert main(words) == 2
    assert "Usage: labkit" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (["submit-check", "."], ". is a folder"),
        (["release", "99_dance"], "'01_paths'"),
        (["term", "new", "--course", "nowhere"], "nowhere"),
        (["term", "forget"], "submitted/"),
        (["feedback", "99_dance"], "'01_paths'"),
        (["grade"], "01_paths"),
        (["grade", "09_defence"], "--mark"),
        (["export", "--layout", "moodle"], "labkit export ASSIGNMENT"),
        (["export", "99_dance"], "'01_paths'"),
        (["export", "--course", "/"], "nbgrader_config.py"),
    ],
)
def test_wrong_use_is_a_sentence(words, named, tmp_path, monkeypatch, capsys):
    """One line that begins with the verb and names the way out; nothing is written."""
    monkeypatch.chdir(tmp_path)
    there = [] if "--course" in words or words[0] == "submit-check" else ["--course", str(ROOT)]
    assert main([*words, *there]) == 2
    err = capsys.readouterr().err
    assert err.startswith(f"labkit {words[0]}: ") and named in err and err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_submission_that_calls_itself_a_course_is_none(tmp_path, monkeypatch, capsys):
    """A command typed inside it runs none of its code; only --course makes it the course."""
    inside = tmp_path / "submitted" / "mallory"
    inside.mkdir(parents=True)
    for folder in (tmp_path, inside):
        (folder / "nbgrader_config.py").write_text("raise SystemExit('executed')\n")
    monkeypatch.chdir(inside)
    assert main(["export", "01_paths"]) == 2
    assert str(tmp_path) in capsys.readouterr().err
    assert Course.here(inside).root == inside


@pytest.mark.parametrize("verb", ["collect", "grade", "feedback", "class-report"])
def test_without_an_assignment_it_lists_those_that_were_handed_in(verb, tmp_path, capsys):
    """In the order of the course, whoever handed them in; other folders are left out."""
    (tmp_path / "nbgrader_config.py").touch()
    for name in ("01_paths", "02_model", "03_dance"):
        source = tmp_path / "solutions" / name[3:] / f"{name}.py"
        source.parent.mkdir(parents=True)
        source.touch()
    for handed_in in ("ada/02_model", "bob/01_paths", "bob/02_model", "bob/figures"):
        (tmp_path / "submitted" / handed_in).mkdir(parents=True)
    assert main([verb, "--course", str(tmp_path)]) == 2
    if verb != "collect":  # which needs a download, too
        assert capsys.readouterr().err.endswith(": 01_paths, 02_model\n")


def test_outside_a_course_it_says_so(tmp_path):
    """Away from a course the command names the way out, without a traceback."""
    words = [sys.executable, "-m", "labkit", "grade", "01_paths"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "--course" in done.stderr and "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (KeyboardInterrupt(), 130),
        (ModuleNotFoundError(name="sqlalchemy.exc"), 2),
        (OSError(28, "No space left on device", "x\x1b[2J"), 2),
    ],
)
def test_what_stops_a_verb_is_a_sentence(error, code, monkeypatch, capsys):
    """Ctrl-C, a package of instructors that is missing, a full disk; no name clears a screen."""

    def stopped(notebook):
        raise error

    monkeypatch.setattr("labkit.course.handin.submit_check", stopped)
    assert main(["submit-check", "01_paths.ipynb"]) == code
    err = capsys.readouterr().err.strip()
    assert err.startswith("labkit submit-check: ") and err.isprintable()


def test_a_students_labkit_has_the_students_commands_alone(monkeypatch):
    """Where the grader's folder is missing, one verb is left."""
    monkeypatch.setattr("labkit.__main__.find_spec", lambda name: None)
    assert set(program().commands) == {"submit-check"}
