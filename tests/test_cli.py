"""The command line: help with examples, and sentences with exit code 2 for wrong use."""

import shlex
import subprocess
import sys

import pytest
from courses import ROOT

from labkit.__main__ import main, program
from labkit.course.authoring.layout import Course

VERBS = program().commands


def test_help_shows_examples(capsys):
    """`labkit --help` lists the verbs and shows how they are used."""
    assert main(["--help"]) == 0
    out = capsys.readouterr().out
    assert "examples:" in out
    assert "release" in out


def test_instructors_have_at_most_fourteen_verbs():
    """Fourteen verbs run a term; whatever is written for others is a layout of `export`."""
    assert len(set(VERBS) - {"submit-check"}) <= 14


@pytest.mark.parametrize("words", [[], ["dance"], ["report-card", "--seed", "many"]])
def test_wrong_words_end_with_code_two(words, capsys):
    """Words that make no sense end with a usage line and exit code 2."""
    assert main(words) == 2
    assert "Usage: labkit" in capsys.readouterr().err


@pytest.mark.parametrize("name", VERBS)
def test_each_verb_shows_an_example_that_can_be_typed(name, capsys):
    """`labkit VERB --help` says what it does and ends with an example."""
    assert main([name, "--help"]) == 0
    last = capsys.readouterr().out.splitlines()[-1].strip()
    called, verb, *words = shlex.split(last.removeprefix("example: "))
    assert (called, verb) == ("labkit", name)
    VERBS[name].make_context(name, words)


def test_the_list_of_verbs_says_what_each_does(capsys):
    """No verb's sentence is cut off in the list."""
    main(["--help"])
    assert "..." not in capsys.readouterr().out.partition("Commands:")[2]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["report-card", "--seed", "-1"], "-1 is not in the range x>=0"),
        (["grade", "01_paths", "--jobs", "0"], "0 is not in the range x>=1"),
    ],
)
def test_a_number_that_makes_no_sense_is_a_sentence(words, sentence, capsys):
    """A number out of range ends with exit code 2, and the error has the range."""
    assert main(words) == 2
    assert sentence in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["submit-check", "."], ". is a folder, a pipe or a device"),
        (["term", "new", "--course", "nowhere"], "there is no "),
        (["feedback", "99_dance", "--course", ROOT], "'01_paths'"),
        (["grade", "--course", ROOT], "which assignment? "),
        (["export", "--layout", "moodle", "--course", ROOT], "labkit export ASSIGNMENT --layout m"),
        (
            ["export", "--layout", "moodle", "--column", "Paths", "--course", ROOT],
            "without them, labkit export writes",
        ),
        *(
            (
                ["export", "01_paths", "--layout", layout, "--column", "Paths", "--course", ROOT],
                f"--layout {layout} has no column that a platform knows by its name; --column is "
                "for --layout canvas or moodle",
            )
            for layout in ("questions", "nbgrader", "moodle-worksheet", "gradescope")
        ),
    ],
)
def test_a_wrong_file_or_folder_is_a_sentence(words, sentence, tmp_path, monkeypatch, capsys):
    """It ends with exit code 2 and one line that begins with the command, and writes nothing."""
    monkeypatch.chdir(tmp_path)
    assert main([str(word) for word in words]) == 2
    err = capsys.readouterr().err
    assert err.startswith(f"labkit {words[0]}: ") and sentence in err and err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_submission_that_calls_itself_a_course_is_none(tmp_path, monkeypatch, capsys):
    """A command typed inside it runs none of its code; only --course makes it the course."""
    inside = tmp_path / "submitted" / "mallory"
    inside.mkdir(parents=True)
    for folder in (tmp_path, inside):
        (folder / "nbgrader_config.py").write_text("raise SystemExit('executed')\n")
    monkeypatch.chdir(inside)
    assert main(["export", "01_paths"]) == 2
    assert f"lies inside the course {tmp_path}" in capsys.readouterr().err
    assert Course.here(inside).root == inside


def test_an_unknown_assignment_is_a_sentence(capsys):
    """A name that does not exist ends with one sentence that lists those that do."""
    assert main(["release", "99_dance"]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert "'01_paths'" in err


@pytest.mark.parametrize("verb", ["grade", "feedback", "class-report"])
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
    said = f"labkit {verb}: which assignment? handed in: 01_paths, 02_model\n"
    assert capsys.readouterr().err == said


def test_outside_a_course_it_says_so(tmp_path):
    """Away from a course the command names the folder and the way out, without a traceback."""
    done = subprocess.run(
        [sys.executable, "-m", "labkit", "grade", "01_paths"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2
    assert "--course" in done.stderr
    assert "Traceback" not in done.stderr


def test_ctrl_c_is_not_a_traceback(monkeypatch, capsys):
    """It ends with exit code 130 and one word."""

    def stopped(notebook):
        raise KeyboardInterrupt

    monkeypatch.setattr("labkit.course.handin.submit_check", stopped)
    assert main(["submit-check", "01_paths.ipynb"]) == 130
    assert capsys.readouterr().err == "labkit submit-check: stopped\n"


def test_a_students_labkit_has_the_students_commands_alone(monkeypatch):
    """Where the grader's folder is missing, one verb is left."""
    monkeypatch.setattr("labkit.__main__.find_spec", lambda name: None)
    assert set(program().commands) == {"submit-check"}


@pytest.mark.parametrize("package", ["sqlalchemy", "labkit_tests_miss_this"])
def test_a_missing_package_of_instructors_is_a_sentence(package, monkeypatch, capsys):
    """Any other one that is missing is an error of the installation, and keeps its traceback."""

    def missing(notebook):
        raise ModuleNotFoundError(name=f"{package}.exc")

    monkeypatch.setattr("labkit.course.handin.submit_check", missing)
    if package == "sqlalchemy":
        assert main(["submit-check", "x"]) == 2
        assert "pip install 'labkit[grader]'" in capsys.readouterr().err
    else:
        with pytest.raises(ModuleNotFoundError):
            main(["submit-check", "x"])
