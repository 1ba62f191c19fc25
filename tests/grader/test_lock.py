"""One grading of an assignment at a time; the shards of one split are one grading."""

from __future__ import annotations

import itertools

import pytest
from made import NAME, handed_in

from labkit.__main__ import main
from labkit.errors import LabkitError
from labkit.grader import lock
from labkit.grader.grading.batch import GradeOptions, grade_class
from labkit.grader.lock import WHOLE, exclusive_run

SHARDS = [WHOLE, (1, 2), (2, 2), (1, 3)]


@pytest.fixture(autouse=True)
def hurried(monkeypatch):
    monkeypatch.setattr(lock, "PATIENCE", 0.0)


@pytest.mark.parametrize(("first", "second"), [*itertools.product(SHARDS, SHARDS)])
def test_only_other_shards_of_one_split_run_together(tmp_path, first, second):
    """A whole run excludes all; 1/2 goes with 2/2 alone, and never with itself or with 1/3."""
    together = first != second and first[1] == second[1]
    with exclusive_run(tmp_path / "r", first):
        if together:
            with exclusive_run(tmp_path / "r", second):
                pass
        else:
            with pytest.raises(LabkitError, match="another run is grading r; wait for it"):
                exclusive_run(tmp_path / "r", second).__enter__()
        with exclusive_run(tmp_path / "other", second):
            pass
    with exclusive_run(tmp_path / "r", second):
        pass


@pytest.mark.parametrize("words", [["grade"], ["grade", "--shard", "1/2"], ["grade", "--diff"]])
def test_verbs_that_grade_exclude_each_other(course, capsys, words):
    """Beside a run that is under way, grade, a shard of it and --diff end in a sentence."""
    handed_in(course, "ada")
    with exclusive_run(course.results / NAME):
        assert main([*words, NAME, "--course", str(course.root)]) == 2
        assert "another run is grading" in capsys.readouterr().err
    with (
        exclusive_run(course.results / NAME, (2, 2)),
        pytest.raises(LabkitError, match="another run"),
    ):
        next(grade_class(course, NAME, ["ada"], GradeOptions()))
