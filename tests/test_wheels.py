"""The table of systems: what `make wheels` last found is what the pages show."""

from __future__ import annotations

import re

import pytest
import wheels

ROOT = wheels.ROOT
WRITTEN, TABLE = wheels.TABLE.read_text().split("\n", 1)


def test_the_pages_show_what_was_found():
    """README holds the table as it was printed, the student's guide without its last column."""
    assert TABLE in (ROOT / "README.md").read_text()
    for_students = re.sub(r"[^|]*\|$", "", TABLE, flags=re.MULTILINE)
    assert "grading" not in for_students
    assert for_students in (ROOT / "book/student_guide.md").read_text()


def test_what_was_found_is_of_todays_versions():
    """After a change of a version that students get, make wheels asks again."""
    assert wheels.asked() in WRITTEN


def test_no_wheel_is_told_from_no_answer(monkeypatch):
    """A package without a wheel is a cell of the table; a network that fails writes none."""

    def answers(code, out="", err=""):
        done = wheels.subprocess.CompletedProcess((), code, out, err)
        monkeypatch.setattr(wheels.subprocess, "run", lambda *args, **options: done)

    answers(0, "numpy==2.4.6\npybullet==3.2.7\n")
    assert "| resolved | resolved | resolved | MuJoCo; with 3.11, 3.12, 3.13 PyBullet too" in (
        wheels.row("a system", "its name")
    )
    answers(1, err="error: No solution found when resolving dependencies")
    assert "| no wheels | no wheels | no wheels | MuJoCo | `environment.yml`" in wheels.row(
        "s", "n"
    )
    answers(1, err="error: failed to look up the address")
    with pytest.raises(SystemExit, match="uv failed for"):
        wheels.row("s", "n")


def test_every_python_that_is_asked_for_is_one_that_may_install():
    """The table's columns are the Pythons of pyproject.toml and of start.py."""
    text = (ROOT / "pyproject.toml").read_text()
    assert 'requires-python = ">=3.11,<3.14"' in text
    assert wheels.PYTHONS == ("3.11", "3.12", "3.13")
    start = (ROOT / ".ci/student/start.py").read_text()
    assert 'VERSIONS = ("3.13", "3.12", "3.11")' in start
