"""The bench compares like with like, and writes one flat object."""

import ast
import inspect
import json

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import labkit as lk
from tests.bench import __main__ as bench
from tests.bench import closed_loop, hand_loop

pytestmark = pytest.mark.pybullet


def test_the_plain_loop_does_the_same_work_bit_for_bit():
    """After 0.5 s it ends at exactly the angles of lk.run, and the arm has moved."""
    target, controller = closed_loop.task()
    client, body = hand_loop.open_arm(lk.robot("left").urdf())
    q = hand_loop.hand_loop(client, body, target, controller, 0.5)
    with lk.Arm() as arm:
        log = lk.run(arm, target, controller, rate=1000, duration=0.5)
    assert_array_equal(q, log.q[-1])
    assert np.abs(q - log.q[0]).max() > 1e-3


def test_the_plain_loop_is_plain():
    """At most 30 lines, no class, no log."""
    source = inspect.getsource(hand_loop.hand_loop)
    assert len(source.splitlines()) <= 30
    assert not any(isinstance(node, ast.ClassDef) for node in ast.walk(ast.parse(source)))
    assert closed_loop.PAIRS >= 15


def test_the_figures_are_one_flat_object(monkeypatch, tmp_path, capsys):
    """The file holds each figure, rounded, and null for one that this machine cannot measure."""

    class Fake:
        def measure():
            """Two figures, one of them not to be had."""
            return {"a": 1.23456, "b": None}

    monkeypatch.setattr(bench, "MEASUREMENTS", (Fake,))
    monkeypatch.setattr(bench, "OUT", tmp_path / "build" / "bench.json")
    bench.main()
    assert json.loads(bench.OUT.read_text()) == {"a": 1.235, "b": None}
    assert "not here" in capsys.readouterr().out


def test_one_that_fails_says_so_and_does_not_stop_the_others(monkeypatch, tmp_path, capsys):
    """The error is printed, the figures of the others are written, and the bench then fails."""

    class Broken:
        def measure():
            """A figure that cannot be had."""
            raise RuntimeError("no browser")

    class Fine:
        def measure():
            """A figure."""
            return {"a": 1.0}

    monkeypatch.setattr(bench, "MEASUREMENTS", (Broken, Fine))
    monkeypatch.setattr(bench, "OUT", tmp_path / "bench.json")
    with pytest.raises(SystemExit, match="Broken"):
        bench.main()
    assert json.loads(bench.OUT.read_text()) == {"a": 1.0}
    assert "RuntimeError: no browser" in capsys.readouterr().err


def test_one_alone_is_printed_and_not_written(monkeypatch, tmp_path, capsys):
    """The one named is measured alone and not written; the error for an unknown one lists all."""

    class One:
        def measure():
            """A figure."""
            return {"a": 1.0}

    class Other:
        def measure():
            """Another."""
            return {"b": 2.0}

    monkeypatch.setattr(bench, "MEASUREMENTS", (One, Other))
    monkeypatch.setattr(bench, "OUT", tmp_path / "bench.json")
    bench.main(["One"])
    assert "Another" not in capsys.readouterr().out and not bench.OUT.exists()
    with pytest.raises(SystemExit):
        bench.main(["three"])
    assert "no measurement three; there is" in capsys.readouterr().err


@pytest.mark.parametrize("module", bench.MEASUREMENTS, ids=lambda m: m.__name__)
def test_each_measurement_says_what_it_measures(module):
    """The first line of its docstring ends with a full stop."""
    assert module.measure.__doc__.splitlines()[0].endswith(".")
