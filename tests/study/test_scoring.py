"""Gains on held-out cases."""

import labkit as lk
from solutions.study import grid, scoring, tasks
from solutions.study.gains import Candidate
from solutions.study.joint_velocity import JointVelocityPD


def test_a_controller_is_scored_on_every_case_and_seed_with_its_spread():
    """Two cases and two seeds give four rows, and twice as fast has the larger error."""
    rows = scoring.score(
        Candidate(JointVelocityPD(5.0), 200.0, True), scoring.CASES[::2], seeds=(0, 1)
    )
    assert [(r["case"], r["seed"]) for r in rows] == [
        (case, seed) for case in ("as tuned", "twice as fast") for seed in (0, 1)
    ]
    means = [grid.spread(r["rms_mm"] for r in rows[i : i + 2])[0] for i in (0, 2)]
    assert means[0] < means[1], "faster is harder"
    assert "[" in grid.table(rows, "case", "failed", "rms_mm")


def test_a_controller_that_loses_the_arm_is_a_row_with_a_sentence():
    """A wrong sign of torque is a row that names the controller and the time."""

    def wrong_sign(state, target):
        return lk.JointTorque(100.0 * (state.q - target.position))

    ideal = scoring.Case("ideal", tasks.line, lk.IDEAL)
    (row,) = scoring.score(Candidate(wrong_sign, 200.0, True), (ideal,), seeds=(0,))
    assert "wrong_sign lost the arm at t = " in row["failed"]
