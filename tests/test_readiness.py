"""The first line of every notebook."""

import sys

import pytest

import labkit as lk
from labkit.errors import LabkitError
from labkit.sim import chosen


def test_ready_prints_one_line_with_versions_platform_and_the_motion(capsys):
    """It has at most 110 characters, and the arm moved by more than 50 mm."""
    lk.ready()
    out, err = capsys.readouterr()
    assert err == ""
    assert out.count("\n") == 1
    for word in (
        lk.__version__,
        "the arm moved",
        "mm",
        "Python 3",
        f"{chosen()} ",
    ):
        assert word in out
    assert len(out) <= 110  # a notebook beside its file browser breaks longer lines
    assert float(out.split("the arm moved ")[1].split(" mm")[0]) > 50.0


def test_an_arm_that_does_not_move_is_said_so(monkeypatch):
    """An arm that ends 0.1 rad off its goal is an error that says how far, and to reinstall."""
    ready = lk.ready

    run = lk.run

    def stuck(arm, target, controller):
        return run(arm, lk.Hold(arm.state().q, 0.5), controller)

    monkeypatch.setattr(sys.modules["labkit.run"], "run", stuck)
    with pytest.raises(LabkitError, match=r"ended 0\.100 rad from where it was sent; reinstall"):
        ready()
