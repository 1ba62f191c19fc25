"""Figures: drawn where asked, labelled, true to the log; nothing is shown or left open."""

import matplotlib as mpl
import numpy as np
import pytest
from numpy.testing import assert_allclose

mpl.use("Agg")
import matplotlib.pyplot as plt

import labkit as lk
from labkit import metrics, plotting


@pytest.fixture
def log(ideal):
    """A short run after joint angles."""
    q = ideal.robot.neutral
    turn = lk.Trajectory(lk.Line(q, q + 0.1), lk.Quintic(0.5))
    return lk.run(ideal, turn, lambda s, x: lk.JointVelocity(0.8 * x.velocity), rate=100)


@pytest.fixture(autouse=True)
def closed():
    """No figure stays open."""
    yield
    plt.close("all")


def test_tracking_draws_the_tip_against_its_target(log):
    """Above, position and target in metres; below, the distance between them in millimetres."""
    above, below = plotting.tracking(log)
    T_wt, T_wd = metrics.tip_poses(log), metrics.target_poses(log)
    lines = above.get_lines()
    for k in range(3):
        assert_allclose(lines[2 * k].get_ydata(), T_wd[:, k, 3])
        assert_allclose(lines[2 * k + 1].get_ydata(), T_wt[:, k, 3])
    e = metrics.tip_error(log)
    assert_allclose(below.get_lines()[0].get_ydata(), 1e3 * np.linalg.norm(e[:, :3], axis=1))
    assert "[m]" in above.get_ylabel()
    assert below.get_xlabel() == "time [s]"


def test_it_draws_where_it_is_told_and_opens_nothing(log):
    """Given axes come back as they are, and no other figure is opened."""
    _, axes = plt.subplots(2)
    before = plt.get_fignums()
    assert plotting.tracking(log, axes=axes) is axes
    assert plt.get_fignums() == before
    _, axes = plt.subplots(3)
    before = plt.get_fignums()
    assert plotting.scaling(lk.Cubic(1.0), axes=axes) is axes
    assert plt.get_fignums() == before


def test_scaling_draws_each_one_with_a_name_and_a_line_style_of_its_own():
    """The legend has the class's name or the one given, and the curve is s over time."""
    axes = plotting.scaling(lk.Cubic(2.0), ("mine", lk.BangBang(1.0)))
    names = [text.get_text() for text in axes[0].get_legend().get_texts()]
    assert names == ["Cubic", "mine"]
    styles = [line.get_linestyle() for line in axes[0].get_lines()]
    assert len(set(styles)) == 2
    t, s = axes[0].get_lines()[0].get_data()
    assert_allclose(s, [lk.Cubic(2.0)(x)[0] for x in t])


def test_curves_differ_by_style_as_well_as_by_colour(log):
    """The three curves of the tip's coordinates have three line styles."""
    above, _ = plotting.tracking(log)
    styles = [line.get_linestyle() for line in above.get_lines()[1::2]]
    assert len(set(styles)) == 3


def test_a_figure_has_words_for_who_does_not_see_it(log):
    """They name plant, arm and duration, then the RMS error, and end with a full stop."""
    words = plotting.describe(log)
    assert "on the ideal left arm over 0.5 s: RMS" in words
    assert words.endswith(".")
