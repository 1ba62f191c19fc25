"""Numbers of one's own arm are typed, because nothing runs on that arm when they are marked."""

from labkit.course.gaps import calculated_from_runs

RUN = ("mine = lk.my_arm(HANDLE)", "log = lk.run(mine, target, law)")


def test_a_number_from_ones_own_runs_is_told():
    """Through any cells between, what comes from a run of one's own arm is a calculation."""
    cells = (*RUN, "late = log.t[3]", "my_lag = late / 2")
    assert calculated_from_runs(cells, "my_lag").startswith(
        "my_lag is calculated from runs of your arm"
    )


def test_a_number_that_is_typed_is_not_told():
    """What the cell writes down itself can be marked; of two cells the last one counts."""
    assert not calculated_from_runs((*RUN, "guess = 0.06\nmy_lag = guess / 2"), "my_lag")
    assert not calculated_from_runs((*RUN, "my_lag = log.t[3]", "my_lag = 0.06"), "my_lag")
