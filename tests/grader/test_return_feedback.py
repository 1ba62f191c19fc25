"""Feedback finds its way back to the student, by the exchange and by Moodle."""

from __future__ import annotations

import os
import pwd
import zipfile

import pytest
from handmade import hand_in, nbgrader, raw

from labkit.__main__ import main
from labkit.grader.collect import SECRET
from labkit.grader.roster import Student, save_roster

NAME = "01_curves"

pytestmark = pytest.mark.slow


def test_the_exchange_carries_work_and_feedback(course, tmp_path, capsys):
    """Released, fetched, submitted, collected, graded: the page that is fetched is ours."""
    home, exchange = tmp_path / "home", tmp_path / "exchange"
    for folder in (home, exchange):
        folder.mkdir()
    exchange.chmod(0o777)
    where = (f"--Exchange.root={exchange}", f"--Exchange.cache={tmp_path / 'cache'}")

    def step(folder, verb, *words):
        code, said = nbgrader(folder, verb, NAME, *words, *where)
        assert code == 0, said[-2000:]

    def ours(verb, *words):
        assert main([verb, NAME, *map(str, words), "--course", str(course.root)]) == 0

    step(course.root, "release_assignment")
    step(home, "fetch_assignment", "--course=trajectory_tracking")
    step(home, "submit", "--course=trajectory_tracking")
    me = pwd.getpwuid(os.getuid()).pw_name
    save_roster(course, [Student(me, login=me)])
    inbound = exchange / "trajectory_tracking" / "inbound"
    ours("collect", inbound)
    ours("grade")
    ours("feedback")
    assert f"nbgrader release_feedback {NAME}" in capsys.readouterr().out
    step(course.root, "release_feedback")
    step(home, "fetch_feedback", "--course=trajectory_tracking")
    (fetched,) = home.glob(f"{NAME}/feedback/*/{NAME}.html")
    (made,) = (course.root / "feedback").glob(f"*/{NAME}/{NAME}.html")
    assert fetched.read_bytes() == made.read_bytes()

    # The same work once more: it is the newer hand-in that a student asks about.
    step(home, "submit", "--course=trajectory_tracking")
    ours("collect", inbound)
    newest = max(inbound.iterdir(), key=lambda path: path.name.split("+")[2])
    (kept,) = course.submitted.glob(f"*/{NAME}/{SECRET}")
    assert kept.read_text() == (newest / SECRET).read_text()


def test_moodle_gets_each_page_back_under_its_participants_number(course, blank, tmp_path, capsys):
    """The zip's folders are called as Moodle's importer reads them, name, number, plug-in."""
    download = tmp_path / "moodle.zip"
    with zipfile.ZipFile(download, "w") as archive:
        archive.writestr(f"Ada Lovelace_101_assignsubmission_file/{NAME}.ipynb", raw(blank))
    where = ["--course", str(course.root)]
    save_roster(course, [Student("ada", "Ada", "Lovelace")])
    assert main(["collect", NAME, str(download), *where]) == 0
    hand_in(course, NAME, "brought-by-hand", blank)
    assert main(["grade", NAME, *where]) == 0
    back = tmp_path / "back.zip"
    assert main(["feedback", NAME, "--moodle", str(back), *where]) == 0
    assert "for Moodle, 1 of 2" in capsys.readouterr().out
    with zipfile.ZipFile(back) as archive:
        (name,) = archive.namelist()
        assert name == f"ada_101_assignfeedback_file/{NAME}.html"
        assert archive.read(name).startswith(b"<!doctype html")
