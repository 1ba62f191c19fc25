"""A machine that lacks a program fails: the gate leaves nothing out."""

import os
import shutil
import subprocess
from pathlib import Path
from subprocess import CompletedProcess

import demo
import pytest

ROOT = Path(__file__).parents[1]


def test_a_missing_package_fails_with_the_line_that_installs_it(tmp_path):
    """Anybody but root gets the one line; only what is missing is in it."""
    for name in ("sh", "dirname", "tr"):
        (tmp_path / name).symlink_to(shutil.which(name))
    (tmp_path / "id").write_text("#!/bin/sh\necho 1000\n")
    (tmp_path / "id").chmod(0o755)
    done = subprocess.run(
        ["sh", str(ROOT / ".ci/need.sh"), "sh:have", "not-there,nor-this:bubblewrap"],
        env=os.environ | {"PATH": str(tmp_path)}, cwd=ROOT, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr.endswith("sudo apt-get install -y bubblewrap\n")


@pytest.mark.parametrize("broken", ["doctor", "grade 01_paths", "--compare", "build_book", None])
def test_the_demo_fails_where_it_cannot_grade_or_a_step_fails(broken, monkeypatch):
    """Where nothing fails it ends with 0."""

    def run(command, **options):
        fails = broken is not None and broken in " ".join(map(str, command))
        return CompletedProcess(command, int(fails), stdout="")

    monkeypatch.setattr(demo.subprocess, "run", run)
    monkeypatch.setattr(demo, "set_up", lambda: None)
    assert demo.main([]) == (broken is not None)
