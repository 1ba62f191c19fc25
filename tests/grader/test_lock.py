"""One grading of an assignment at a time."""

from __future__ import annotations

import stat

import pytest
from made import NAME, handed_in

from labkit.__main__ import main
from labkit.errors import LabkitError
from labkit.grader import files as lock
from labkit.grader.batch import GradeOptions, grade_class
from labkit.grader.files import exclusive_run, write


@pytest.fixture(autouse=True)
def hurried(monkeypatch):
    monkeypatch.setattr(lock, "PATIENCE", 0.0)


def test_one_run_of_an_assignment_at_a_time(tmp_path):
    """A second run is refused until the first has ended; one of another assignment is not."""
    with exclusive_run(tmp_path / "r"):
        with pytest.raises(LabkitError, match="another run is grading r; wait for it"):
            exclusive_run(tmp_path / "r").__enter__()
        with exclusive_run(tmp_path / "other"):
            pass
    with exclusive_run(tmp_path / "r"):
        pass


@pytest.mark.parametrize("words", [["grade"], ["grade", "--diff"]])
def test_verbs_that_grade_exclude_each_other(course, capsys, words):
    """Beside a run that is under way, grade and --diff end in a sentence."""
    handed_in(course, "ada")
    with exclusive_run(course.results / NAME):
        assert main([*words, NAME, "--course", str(course.root)]) == 2
        assert "another run is grading" in capsys.readouterr().err
        with pytest.raises(LabkitError, match="another run"):
            next(grade_class(course, NAME, ["ada"], GradeOptions()))


def test_what_is_written_is_its_owners_alone(tmp_path):
    """Marks, names and keys: on a hub with a shell nobody else reads them."""
    write(tmp_path / "private/file", "marks")
    assert stat.S_IMODE((tmp_path / "private/file").stat().st_mode) == 0o600
    assert stat.S_IMODE((tmp_path / "private").stat().st_mode) == 0o700
