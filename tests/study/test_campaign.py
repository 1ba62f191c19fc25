"""Many runs: the same rows whoever works them through, tables, verdicts."""

import numpy as np
import pytest
from scipy import stats

import labkit as lk
from labkit import recordings
from solutions.study import __main__ as command_line
from solutions.study import campaign as report
from solutions.study.claims import Outcome, interval, judge, verdicts
from solutions.study.gains import course_controllers
from solutions.study.grid import Meter, cells, pick, row_of, spread, table, work_through

SMALL = cells(
    controller=("joint velocity", "baseline"), task=("line",), plant=("baxter",), seed=(0, 1)
)


@pytest.fixture(scope="module")
def rows():
    return work_through(report.numbers, SMALL, jobs=1)


def test_any_number_of_workers_gives_the_same_rows_bit_for_bit(rows):
    """Two processes give the four rows of one, all different, and count each as it is done."""
    told = []
    again = work_through(report.numbers, SMALL, jobs=2, progress=lambda *x: told.append(x))
    assert again == rows
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert len({row["digest"] for row in rows}) == 4, "and no two runs are one"


def test_every_way_starts_a_seed_at_the_same_place():
    """With seed 3 each controller starts the line at the same angles, bit for bit."""
    starts = [
        report.perform(controller, "line", "ideal", 3).q[0] for controller in report.CONTROLLERS
    ]
    for start in starts:
        np.testing.assert_array_equal(start, starts[0])


def test_the_five_controllers_are_the_ones_with_stated_gains():
    """The report's five names are those of the course's controllers."""
    assert set(report.FIVE) == set(course_controllers(lk.Model()))


def test_a_run_that_is_refused_is_a_row_and_the_rest_goes_on():
    """One job of three fails; its row has the sentence, and the table counts it."""
    rows = work_through(fails_on_two, cells(n=(1, 2, 3)), jobs=1)
    assert [row["failed"] for row in rows] == [None, "two is too many", None]
    assert table(rows, "failed", "n", "n").count("failed 1 of 1") == 1


def fails_on_two(n):
    if n == 2:
        raise lk.LabkitError("two is too many")
    return {"x": 1.0 / n}


def test_a_bug_in_a_job_is_no_finding():
    """An error that is not a LabkitError ends the work instead of becoming a row."""
    with pytest.raises(ZeroDivisionError):
        row_of(fails_on_two, {"n": 0})


def test_a_table_shows_the_mean_and_the_spread_over_seeds():
    """Runs of 1, 2 and 6 are shown as 3 [1, 6], and one without a number as never."""
    rows = [
        {"controller": "a", "task": "line", "x": x, "failed": None} for x in (1.0, 2.0, 6.0)
    ] + [{"controller": "b", "task": "line", "x": None, "failed": None}]
    assert table(rows, "controller", "task", "x").splitlines() == [
        "| controller | line |",
        "|---|---|",
        "| a | 3 [1, 6] |",
        "| b | never |",
    ]
    assert spread([1.0, 2.0, 6.0]) == (3.0, 1.0, 6.0)
    assert pick(rows, controller="b") == rows[3:]


# Verdicts


def test_the_interval_is_that_of_a_paired_t_test():
    """Over the seeds of one condition."""
    random = np.random.default_rng(0)
    a, b = random.normal(3.0, 1.0, 12), random.normal(2.0, 1.0, 12)
    keys = [(seed, "line") for seed in range(12)]
    found = judge("a", "mm", dict(zip(keys, a, strict=True)), dict(zip(keys, b, strict=True)))
    low, high = stats.ttest_rel(a, b).confidence_interval(0.95)
    x = found.overall
    assert (x.mean - x.half_width, x.mean + x.half_width) == pytest.approx((low, high))
    assert (x.of, x.units, found.tasks) == ("seeds", 12, ())
    with pytest.raises(lk.LabkitError, match="1 pair cannot show a spread, so 'line'"):
        judge("a is larger", "mm", {(0, "line"): 1.0}, {(0, "line"): 0.5})


def rows_of(by_task):
    """Differences of a claim, and zeros to subtract, from {task: differences}."""
    a = {(seed, task): d for task, ds in by_task.items() for seed, d in enumerate(ds)}
    return a, dict.fromkeys(a, 0.0)


@pytest.mark.parametrize(
    ("differences", "outcome"),
    [
        ((1.0, 1.1, 0.9), Outcome.HELD),
        ((-1.0, -1.1, -0.9), Outcome.DID_NOT_HOLD),
        ((1.0, -1.1, 0.9), Outcome.UNDECIDED),
    ],
)
def test_a_claim_is_held_refuted_or_undecided(differences, outcome):
    """Three differences of one sign hold or refute it; if one has the other sign it stays open."""
    found = judge("a is larger", "mm", *rows_of({"line": differences}))
    assert found.overall.outcome is outcome


def test_the_seeds_of_a_task_are_no_tasks():
    """Each task decided over its seeds, and they differ: over the tasks it is undecided."""
    steady = {"line": (2.0, 2.1, 1.9), "circle": (2.6, 2.5, 2.7), "tag": (-1.2, -1.3, -1.2)}
    found = judge("a is larger", "mm", *rows_of(steady))
    assert {t.of: t.outcome for t in found.tasks} == {
        "line": Outcome.HELD,
        "circle": Outcome.HELD,
        "tag": Outcome.DID_NOT_HOLD,
    }
    assert found.overall.units == 3 and found.overall.outcome is Outcome.UNDECIDED
    pooled = interval("pairs", [d for ds in steady.values() for d in ds], 1)
    assert pooled.half_width < 0.5 * found.overall.half_width, "pooling would pretend to know"


def test_every_claim_of_the_report_gets_a_verdict_from_rows():
    """On made-up rows in which the order of the controllers is the order of their errors."""
    rows = [
        {
            **cell,
            "late_rms_mm": report.CONTROLLERS.index(cell["controller"]) + 0.1 * cell["seed"],
            "failed": None,
        }
        for cell in report.grid(2)
    ]
    gains = [
        {**cell, "tenth_s": 1.0 / cell["Kp"] + 0.01 * cell["seed"], "failed": None}
        for cell in report.gain_grid(2)
    ]
    noise = [
        {
            **cell,
            "late_rms_mm": 1.0 + 0.01 * cell["seed"],
            "shake_mm_s": cell["Kd"] * noisy(cell),
            "failed": None,
        }
        for cell in report.noise_grid(2)
    ]
    found = {v.claim: v.overall.outcome for v in verdicts(rows, gains, noise)}
    assert found["joint velocity tracks better than workspace velocity"] is Outcome.HELD
    assert found["the built-in method tracks better than joint torque"] is Outcome.DID_NOT_HOLD
    assert found["four times the gain converges faster on the realistic arm"] is Outcome.HELD
    assert found["noise limits Kd: through the noise, Kd = 1 makes the arm shake"] is Outcome.HELD
    assert len(found) == 13
    planned = {v.claim: v for v in verdicts(rows, gains, noise)}
    on = planned["the built-in method tracks better than joint torque"].tasks
    assert {t.of for t in on} == {"line", "circle", "square"}, "on the tag it is told another goal"


def noisy(cell):
    return 2.0 + 0.001 * cell["seed"] if cell["plant"] == "baxter" else 1.0


def test_the_campaign_writes_its_numbers_and_tables(tmp_path, monkeypatch, capsys):
    """One seed of the line alone."""
    monkeypatch.setattr(command_line, "grid", lambda seeds: SMALL[::2])
    monkeypatch.setattr(command_line, "gain_grid", lambda seeds: [])
    monkeypatch.setattr(command_line, "noise_grid", lambda seeds: [])
    monkeypatch.setattr(command_line, "verdicts", lambda *rows: [])
    monkeypatch.setattr("sys.argv", ["campaign", "--jobs", "1", "--out", str(tmp_path)])
    command_line.main()
    assert (tmp_path / "campaign.json").exists()
    assert "| joint velocity |" in (tmp_path / "campaign/tables.md").read_text()
    assert "2 runs in" in capsys.readouterr().out
    assert Meter("x")(1, 2) is None


def test_a_controller_alone_is_printed_and_not_written(tmp_path, monkeypatch, capsys):
    """Any that `gains` knows, not only the seven of the report."""
    monkeypatch.setattr(report, "TASKS", ("line",))
    words = ["--controller", "augmented PD", "--seeds", "1", "--jobs", "1", "--out", str(tmp_path)]
    monkeypatch.setattr("sys.argv", ["campaign", *words])
    command_line.main()
    assert "| augmented PD |" in capsys.readouterr().out
    assert not list(tmp_path.iterdir())


def test_the_rows_kept_for_notebooks_are_those_of_the_campaign(rows):
    """There is one for each run of ten seeds, and four run again agree to 0.1 %."""
    kept = recordings.campaign()
    assert len(kept) == len(report.grid(10))
    for fresh in rows:
        cell = {k: fresh[k] for k in ("controller", "task", "plant", "seed")}
        (old,) = pick(kept, **cell)
        for number in ("late_rms_mm", "late_max_mm"):
            assert old[number] == pytest.approx(fresh[number], rel=1e-3, abs=1e-4)
