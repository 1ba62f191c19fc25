"""The arguments of the call at which a check stopped."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

import labkit as lk
from labkit.course import case, check
from labkit.errors import LabkitError

ROOT = Path(__file__).parents[2]


@pytest.fixture
def beside(tmp_path, monkeypatch):
    shutil.copy(ROOT / "assignments/00_warmup/checks.json", tmp_path)
    monkeypatch.chdir(tmp_path)


def test_the_failing_call_can_be_run(beside, capsys):
    """A check that shows <3 x 3 numbers> says how to get them, and they fail as it said."""

    def orientation_error(R_wd, R_wt):
        return lk.se3.rotation_log(R_wt.T @ R_wd)

    check("orientation_error", orientation_error)
    assert 'args, kwargs = lk.course.case("orientation_error")' in capsys.readouterr().out
    args, kwargs = case("orientation_error")
    right = lk.se3.orientation_error(*args)
    assert not np.allclose(orientation_error(*args, **kwargs), right)


def test_without_a_failing_call_there_is_a_sentence(beside):
    """Before any check, and after a right answer."""
    with pytest.raises(LabkitError, match="run its check first"):
        case("orientation_error")
    check("orientation_error", lk.se3.orientation_error)
    with pytest.raises(LabkitError, match="did not stop at a call"):
        case("orientation_error")


def test_the_function_is_not_asked_again_for_its_failing_call(beside):
    """What a check saw is kept; a function that then answers otherwise is not asked."""
    calls = []

    def orientation_error(R_wd, R_wt):
        calls.append(R_wd)
        raise NotImplementedError

    check("orientation_error", orientation_error)
    asked = len(calls)
    args, _ = case("orientation_error")
    assert args[0] is not None and len(calls) == asked
