"""Many runs: the same rows whoever works them through, tables, verdicts."""

import subprocess
import sys

import numpy as np
import pytest
from scipy import stats

import labkit as lk
from labkit import recordings
from solutions.comparison.answers import paired_difference
from solutions.study import campaign as report
from solutions.study import pictures
from solutions.study.claims import Outcome, judge, verdicts
from solutions.study.gains import five
from solutions.study.grid import Meter, cells, pick, row_of, spread, table, work_through

SMALL = cells(way=("joint velocity", "baseline"), task=("line",), plant=("baxter",), seed=(0, 1))


@pytest.fixture(scope="module")
def rows():
    return work_through(report.numbers, SMALL, jobs=1)


def test_any_number_of_workers_gives_the_same_rows_bit_for_bit(rows):
    told = []
    again = work_through(report.numbers, SMALL, jobs=2, progress=lambda *x: told.append(x))
    assert again == rows
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert len({row["digest"] for row in rows}) == 4, "and no two runs are one"


def test_a_dask_cluster_gives_the_same_rows_bit_for_bit(rows):
    from distributed import LocalCluster

    quiet = {"n_workers": 1, "threads_per_worker": 1, "dashboard_address": None}
    with LocalCluster(processes=False, **quiet) as cluster:
        again = work_through(report.numbers, SMALL, dask=cluster.scheduler_address)
    assert again == rows


def test_a_dask_cluster_that_is_not_there_is_a_sentence():
    """At an address that is none; from the command line too, which then ends with 2."""
    with pytest.raises(lk.LabkitError, match="no Dask scheduler at nonsense"):
        work_through(report.numbers, SMALL, dask="nonsense")
    command = [sys.executable, "-m", "solutions.study.campaign", "--dask", "nonsense"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and done.stderr.count("\n") == 1
    assert done.stderr.startswith("no Dask scheduler at nonsense: ")


def test_every_way_starts_a_seed_at_the_same_place():
    starts = [report.perform(way, "line", "ideal", 3).q[0] for way in report.WAYS]
    for start in starts:
        np.testing.assert_array_equal(start, starts[0])


def test_the_five_controllers_are_the_ones_with_stated_gains():
    assert set(report.FIVE) == set(five(lk.Model()))


def test_a_run_that_is_refused_is_a_row_and_the_rest_goes_on():
    rows = work_through(fails_on_two, cells(n=(1, 2, 3)), jobs=1)
    assert [row["failed"] for row in rows] == [None, "two is too many", None]
    assert table(rows, "failed", "n", "n").count("failed 1 of 1") == 1


def fails_on_two(n):
    if n == 2:
        raise lk.LabkitError("two is too many")
    return {"x": 1.0 / n}


def test_a_bug_in_a_job_is_no_finding():
    with pytest.raises(ZeroDivisionError):
        row_of(fails_on_two, {"n": 0})


def test_a_table_shows_the_mean_and_the_spread_over_seeds():
    rows = [{"way": "a", "task": "line", "x": x, "failed": None} for x in (1.0, 2.0, 6.0)] + [
        {"way": "b", "task": "line", "x": None, "failed": None}
    ]
    assert table(rows, "way", "task", "x").splitlines() == [
        "| way | line |",
        "|---|---|",
        "| a | 3 [1, 6] |",
        "| b | never |",
    ]
    assert spread([1.0, 2.0, 6.0]) == (3.0, 1.0, 6.0)
    assert pick(rows, way="b") == rows[3:]


def test_bad_grids_and_columns_are_sentences():
    with pytest.raises(lk.LabkitError, match="axis 'seed' is empty"):
        cells(way=("a",), seed=())
    with pytest.raises(lk.LabkitError, match="no column 'rms'; there is"):
        table([{"way": "a", "failed": None}], "way", "way", "rms")
    with pytest.raises(lk.LabkitError, match="jobs is 0"):
        work_through(fails_on_two, cells(n=(1,)), jobs=0)


def test_a_figure_of_the_report_is_numbered_drawn_and_put_into_words(tmp_path):
    """Figure 5: joint space velocity controller on the circle; every axis has its unit."""
    made = pictures.draw("joint velocity", "circle", str(tmp_path))
    assert made["figure"] == 5 and (tmp_path / made["file"]).stat().st_size > 50_000
    assert "circle: Tracking by joint velocity on the baxter left arm" in made["alt"]
    log = report.perform("workspace velocity", "circle", "ideal", 0)
    figure = pictures.overview(log, joints=report.joints("workspace velocity", "circle", 0))
    labels = {ax.get_ylabel() for ax in figure.axes}
    assert {"tip position [m]", "tip velocity [m/s]", "orientation error [deg]"} < labels
    assert {"s0", "s1", "e0", "e1", "w0", "w1", "w2"} < labels
    velocity = next(ax for ax in figure.axes if ax.get_ylabel() == "tip velocity [m/s]")
    drawn = velocity.get_lines()[1].get_ydata()  # x, after the target's x
    path = np.gradient(lk.metrics.tip_poses(log)[:, 0, 3], log.t)
    np.testing.assert_allclose(drawn[5:-5], path[5:-5], atol=5e-3)


# Verdicts


def test_the_interval_is_that_of_a_paired_t_test():
    random = np.random.default_rng(0)
    a, b = random.normal(3.0, 1.0, 12), random.normal(2.0, 1.0, 12)
    mean, half = paired_difference(a, b)
    low, high = stats.ttest_rel(a, b).confidence_interval(0.95)
    assert (mean - half, mean + half) == pytest.approx((low, high))
    with pytest.raises(lk.LabkitError, match="1 pair cannot show a spread, so 'a is larger'"):
        judge("a is larger", "mm", {(0,): 1.0}, {(0,): 0.5})


@pytest.mark.parametrize(
    ("differences", "outcome"),
    [
        ((1.0, 1.1, 0.9), Outcome.HELD),
        ((-1.0, -1.1, -0.9), Outcome.DID_NOT_HOLD),
        ((1.0, -1.1, 0.9), Outcome.UNDECIDED),
    ],
)
def test_a_claim_is_held_refuted_or_undecided(differences, outcome):
    a = {(seed,): 5.0 + d for seed, d in enumerate(differences)}
    verdict = judge("a is larger", "mm", a, {(seed,): 5.0 for seed in range(3)})
    assert verdict.outcome is outcome
    assert ("it flips with the seed" in str(verdict)) == (outcome is Outcome.UNDECIDED)


def test_a_claim_that_flips_with_the_seed_is_undecided_however_narrow_the_interval():
    keys = [(seed, task) for seed in (0, 1) for task in range(40)]
    a = {key: 2.0 if key[0] == 0 else -0.1 for key in keys}
    verdict = judge("a is larger", "mm", a, dict.fromkeys(keys, 0.0))
    assert verdict.difference > verdict.half_width
    assert verdict.outcome is Outcome.UNDECIDED


def test_every_claim_of_the_report_gets_a_verdict_from_rows():
    """On made-up rows in which the order of the ways is the order of their errors."""
    rows = [
        {**cell, "late_rms_mm": report.WAYS.index(cell["way"]) + 0.1 * cell["seed"], "failed": None}
        for cell in report.grid(2)
    ]
    gains = [
        {**cell, "tenth_s": 1.0 / cell["Kp"] + 0.01 * cell["seed"], "failed": None}
        for cell in report.gain_grid(2)
    ]
    noise = [
        {**cell, "late_rms_mm": 1.0, "shake_mm_s": cell["Kd"] * noisy(cell), "failed": None}
        for cell in report.noise_grid(2)
    ]
    found = {v.claim: v.outcome for v in verdicts(rows, gains, noise)}
    assert found["joint velocity tracks better than workspace velocity"] is Outcome.HELD
    assert found["MoveIt tracks better than joint torque"] is Outcome.DID_NOT_HOLD
    assert found["four times the gain converges faster on the realistic arm"] is Outcome.HELD
    assert found["noise limits Kd: through the noise, Kd = 1 makes the arm shake"] is Outcome.HELD
    assert len(found) == 12


def noisy(cell):
    return 2.0 + 0.1 * cell["seed"] if cell["plant"] == "baxter" else 1.0


def test_the_campaign_writes_its_numbers_and_tables(tmp_path, monkeypatch, capsys):
    """One seed of the line alone, without pictures."""
    monkeypatch.setattr(report, "grid", lambda seeds: SMALL[::2])
    monkeypatch.setattr(report, "gain_grid", lambda seeds: [])
    monkeypatch.setattr(report, "noise_grid", lambda seeds: [])
    monkeypatch.setattr(report, "verdicts", lambda *rows: [])
    monkeypatch.setattr(
        "sys.argv", ["campaign", "--jobs", "1", "--out", str(tmp_path), "--no-pictures"]
    )
    report.main()
    assert (tmp_path / "campaign.json").exists()
    assert "| joint velocity |" in (tmp_path / "campaign/tables.md").read_text()
    assert "2 runs in" in capsys.readouterr().out
    assert Meter("x")(1, 2) is None


def test_a_controller_alone_is_printed_and_not_written(tmp_path, monkeypatch, capsys):
    """Any that `gains` knows, not only the seven of the report."""
    monkeypatch.setattr(report, "TASKS", ("line",))
    words = ["--way", "augmented PD", "--seeds", "1", "--jobs", "1", "--out", str(tmp_path)]
    monkeypatch.setattr("sys.argv", ["campaign", *words])
    report.main()
    assert "| augmented PD |" in capsys.readouterr().out
    assert not list(tmp_path.iterdir())


def test_the_rows_kept_for_notebooks_are_those_of_the_campaign(rows):
    kept = recordings.campaign()
    assert len(kept) == len(report.grid(5))
    for fresh in rows:
        cell = {k: fresh[k] for k in ("way", "task", "plant", "seed")}
        (old,) = pick(kept, **cell)
        for number in ("late_rms_mm", "late_max_mm", "settling", "effort"):
            assert old[number] == pytest.approx(fresh[number], rel=1e-3, abs=1e-4)
