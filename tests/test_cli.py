"""The command line: help with examples, and sentences with exit code 2 for wrong use."""

import subprocess
import sys

import pytest

from labkit import cli


def test_help_shows_examples(capsys):
    """`labkit --help` lists the verbs and shows how they are used."""
    with pytest.raises(SystemExit) as end:
        cli.main(["--help"])
    out = capsys.readouterr().out
    assert end.value.code == 0
    assert "examples:" in out
    assert "release" in out


@pytest.mark.parametrize("words", [[], ["dance"], ["release", "--seed", "many"]])
def test_wrong_words_end_with_code_two(words, capsys):
    """Words that make no sense end with a usage line and exit code 2."""
    with pytest.raises(SystemExit) as end:
        cli.main(words)
    assert end.value.code == 2
    assert "usage" in capsys.readouterr().err


def test_an_unknown_assignment_is_a_sentence(capsys):
    """A name that does not exist ends with one sentence that lists those that do."""
    assert cli.main(["release", "99_dance"]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert "'01_paths'" in err


def test_outside_a_course_it_says_so(tmp_path):
    """Away from a course the command names the folder and the way out, without a traceback."""
    done = subprocess.run(
        [sys.executable, "-m", "labkit.cli", "grade", "01_paths"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2
    assert "--course" in done.stderr
    assert "Traceback" not in done.stderr
