"""nbgrader's exchange: nobody hands in earlier than they did."""

from __future__ import annotations

import time
from datetime import UTC, datetime

import pytest
from downloaded import NAME, bare_course, counting, handed_in, written_at
from hypothesis import given
from hypothesis import strategies as st

from labkit.__main__ import main
from labkit.grader.rules import read_rules
from labkit.grader.students import exchange_times
from labkit.grader.students.attempts import attempts
from labkit.grader.students.collect import collect
from labkit.grader.students.exchange_times import SLACK, Times

STATED, WRITTEN = "2026-03-01 10:00:00 UTC", "2026-03-03 09:12:00 UTC"
HOURS = st.floats(0.0, 3600.0 * 24)


@pytest.fixture
def course(tmp_path):
    """A course in which the work is due between the two times."""
    course = bare_course(tmp_path / "course")
    (course.root / "course.toml").write_text(f"[assignments.{NAME}]\ndue = 2026-03-02T00:00:00Z\n")
    return course


def collected(course, inbound):
    """What wants a look, and when the attempt of the one student was handed in."""
    says = [str(x) for x in collect(course, NAME, inbound, unverified=True) if not x.fine]
    return says, [x.when for one in attempts(course, "root", NAME) for x in one.hand_ins]


def at(text):
    return datetime.strptime(text, "%Y-%m-%d %H:%M:%S UTC").replace(tzinfo=UTC)


def test_a_time_that_is_told_is_believed_where_nothing_contradicts_it(course, tmp_path):
    """An honest hand-in counts from what its name says, to the second."""
    folder = handed_in(tmp_path / "in", "root", "1", STATED)
    written_at(folder, "2026-03-01 10:02:00 UTC")  # a large one takes a while to copy
    assert collected(course, folder.parent) == ([], [at(STATED)])


def test_a_late_hand_in_that_is_dated_back_is_late_and_named(course, tmp_path, capsys):
    """The folder says before the due date, the disk after it: the later counts; exit code 1."""
    folder = handed_in(tmp_path / "in", "root", "1", STATED)
    written_at(folder, WRITTEN)
    words = ["collect", NAME, str(folder.parent), "--unverified", "--course", str(course.root)]
    assert main(words) == 1
    said = capsys.readouterr().err
    assert "its name says 2026-03-01 10:00 UTC" in said
    assert "last changed at 2026-03-03 09:12 UTC, which counts" in said
    assert collected(course, folder.parent)[1] == [at(WRITTEN)]
    assert at(WRITTEN) > read_rules(course).due_for("root", NAME)
    stamp = course.submitted / "root" / NAME / "timestamp.txt"
    assert stamp.read_text().startswith("2026-03-03 09:12:00")
    assert counting(course) == {"root": "1"}


def test_a_notebook_that_is_changed_afterwards_is_late(course, tmp_path):
    """A student who writes into the folder after the due date keeps its name and not its time."""
    folder = handed_in(tmp_path / "in", "root", "1", STATED)
    before = folder.stat()
    (folder / f"{NAME}.ipynb").write_text("2")
    assert folder.stat().st_mtime == before.st_mtime
    (said,), (when,) = collected(course, folder.parent)
    assert "possibly an attempt to cheat" in said
    assert when > at(WRITTEN)


def test_a_modification_time_that_is_set_back_is_seen_through(course, tmp_path, monkeypatch):
    """`touch -d` moves no time of change: a hand-in that came earlier says so."""
    monkeypatch.setattr(exchange_times, "SLACK", 0.05)
    now = datetime.now(UTC)
    handed_in(tmp_path / "in", "ada", "hers", f"{now:%Y-%m-%d %H:%M:%S.%f %Z}")
    time.sleep(0.2)
    handed_in(tmp_path / "in", "root", "1", STATED)
    (said,), (when,) = collected(course, tmp_path / "in")
    assert "its name says 2026-03-01 10:00 UTC" in said
    assert when >= now.replace(microsecond=0)


@given(
    st.lists(st.tuples(HOURS, st.floats(0.0, SLACK)), min_size=1, max_size=6),
    st.floats(1e5, 1e6),
    HOURS,
)
def test_nobody_honest_is_accused_whatever_others_write(honest, copied, forged):
    """Neither where the exchange stands, nor after a copy that keeps its times."""
    here = [Times(x, x, x + took) for x, took in honest]
    liar = Times(forged, forged, forged + 2e4)
    assert not [x for x in here if x.contradicted([*here, liar])]
    copy = [Times(x.stated, x.written, copied + 0.01 * k) for k, x in enumerate([*here, liar])]
    assert not [x for x in copy if x.contradicted(copy)]


@given(HOURS, st.floats(2 * SLACK + 1.0, 3600.0 * 24), st.floats(0.01, 0.99))
def test_any_witness_in_between_suffices(stated, later, share):
    """One honest hand-in between the time that is told and the true one shows the true one."""
    between = stated + SLACK + share * (later - 2 * SLACK)
    liar, witness = Times(stated, stated, stated + later), Times(between, between, between)
    assert liar.contradicted([liar, witness]) == datetime.fromtimestamp(int(stated + later), UTC)


def test_a_modification_time_in_the_far_future_is_no_time(course, tmp_path):
    """It is no later than the system's own, which has the year that it is."""
    import os

    folder = handed_in(tmp_path / "in", "root", "1", STATED)
    os.utime(folder, (1e11, 1e11))
    _, (when,) = collected(course, folder.parent)
    assert when <= datetime.now(UTC)
