"""The Baxter Cup: one draw for everybody, a tag known by old pictures, benchmarks that were run."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import labkit as lk
from labkit.course import cup as play
from labkit.course.baxter_cup import (
    AGE,
    BENCHMARKS,
    BOX,
    PICTURES,
    PUBLIC_SEEDS,
    _sampled_and_delayed,
    _tour,
    cup_run,
)
from labkit.errors import Diverged
from labkit.trajectory import Sample

ROOT = Path(__file__).parents[2]
T_wt = lk.Model("left").pose(lk.Model("left").robot.ready)


def drawn(seed):
    return _tour(T_wt, np.random.default_rng([seed, 2007]))


@pytest.mark.parametrize("seed", PUBLIC_SEEDS)
def test_the_tour_stays_in_its_box_and_joins_the_tags_circle(seed):
    """It begins and ends at the ready tip, within the box; the same seed draws the same."""
    tour, lap = drawn(seed)
    again, _ = drawn(seed)
    other, _ = drawn(seed + 100)
    at = np.linspace(0.0, tour.duration, 200)
    places = np.array([tour(t).pose[:3, 3] for t in at]) - T_wt[:3, 3]
    low, high = np.transpose(BOX)
    assert (places >= np.minimum(low, 0.0) - 1e-12).all()
    assert (places <= np.maximum(high, 0.0) + 1e-12).all()
    for sample in (tour(0.0), tour(tour.duration), lap(0.0), lap(lap.duration)):
        np.testing.assert_allclose(sample.pose, T_wt, rtol=0, atol=1e-12)
    assert tour.duration == again.duration != other.duration


def test_of_the_tag_only_the_last_picture_is_known():
    """Before the tag all is told; then a place up to a picture older than its age, and no speed."""
    given = _sampled_and_delayed(lambda t: Sample(np.array([t]), np.ones(1), np.ones(1)), 2.0)
    assert given(1.9).velocity == 1.0
    for t in np.linspace(2.2, 8.0, 500):
        sample = given(t)
        age = t - sample.position[0]
        assert AGE - 1e-9 <= age <= AGE + 1 / PICTURES + 1e-9
        assert sample.velocity == sample.acceleration == 0.0
    assert given(2.01).position == 2.0


@pytest.mark.slow
def test_the_students_guide_enters_the_cup(monkeypatch, capsys):
    """The guide's own cell runs; its score stands among theirs; a still arm scores worse."""
    monkeypatch.setattr("labkit.course.baxter_cup.PUBLIC_SEEDS", PUBLIC_SEEDS[:1])
    text = (ROOT / "book/student_guide.md").read_text().partition("## The Baxter Cup")[2]
    (cell,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    names = {}
    exec(cell.partition("lk.replay")[0], names)
    (run,) = names["runs"]
    said = capsys.readouterr().out
    assert f"{run.score:8.1f} mm  yours" in said and "of 4 benchmarks beaten" in said
    still = cup_run(lambda model: lambda state, target: lk.JointVelocity(np.zeros(7)), 1)
    assert run.score < still.score < np.inf


@pytest.mark.soak
@pytest.mark.parametrize("name", BENCHMARKS)
def test_the_benchmarks_are_what_the_laws_score(name):
    """On every public seed, to what two engines may differ by."""
    from solutions.study.cup import score

    found = [score(name, seed) for seed in PUBLIC_SEEDS]
    np.testing.assert_allclose(found, BENCHMARKS[name], rtol=0, atol=0.1)


def test_an_arm_that_runs_away_beats_no_benchmark(monkeypatch, capsys):
    """Its score is infinite, and its log is kept."""
    stopped = Diverged("the arm ran away")
    stopped.log = "the log up to then"

    def run_away(*_):
        raise stopped

    monkeypatch.setattr("labkit.course.baxter_cup.run", run_away)
    runs = play(lambda model: None)
    assert {one.score for one in runs} == {np.inf} and runs[0].log == stopped.log
    said = capsys.readouterr().out
    assert "inf mm  yours" in said and "0 of 4 benchmarks beaten" in said
