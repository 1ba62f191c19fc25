"""The containers: what a student's holds, and how it starts."""

from __future__ import annotations

import json
import os
import re
import subprocess

import pytest
from handmade import ROOT

STAGES = re.split(r"^FROM (?:\S+) AS ", (ROOT / "Dockerfile").read_text(), flags=re.MULTILINE)[1:]


@pytest.fixture
def begin(tmp_path):
    """Start a student's container, without the container: programs only say what they are."""
    lab, home, programs = (tmp_path / name for name in ("lab", "home", "programs"))
    for name in ("00_warmup", "01_paths"):
        (lab / "assignments" / name).mkdir(parents=True)
        (lab / "assignments" / name / f"{name}.ipynb").write_text("released")
    (lab / "assignments" / "START_HERE.ipynb").write_text("released")
    home.mkdir()
    programs.mkdir()
    (lab / "start.sh").write_text((ROOT / ".ci/start_container.sh").read_text())
    for name in ("jupyter", "jupyterhub-singleuser"):
        (programs / name).write_text('#!/bin/sh\necho "$(basename "$0") $*"\n')
        (programs / name).chmod(0o755)

    def run(*command, **environment):
        done = subprocess.run(
            ["sh", str(lab / "start.sh"), *command],
            env={"PATH": f"{programs}:{os.environ['PATH']}", "HOME": str(home), **environment},
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout.strip()

    run.home = home
    return run


def test_a_students_image_is_made_from_the_handout_alone():
    """No answer and no grader's file can reach a student's image: it copies what students get."""
    last = STAGES[-1]
    assert last.startswith("student\n")
    copied = re.findall(r"^(?:COPY|ADD) (.*)$", last, flags=re.MULTILINE)
    assert copied == [
        "--from=course /handout/baxter-lab /lab/.ci/start_container.sh /opt/baxter-lab/"
    ]
    assert STAGES[0].startswith("python\n")
    assert "COPY" not in STAGES[0]


def test_a_students_container_is_no_roots():
    """Anyone who works in a student's container is an ordinary user."""
    assert re.findall(r"^USER (.*)$", STAGES[-1], flags=re.MULTILINE) == ["jovyan"]


def test_the_dev_container_is_the_whole_course():
    """An engineer's container is made of the stage that has everything."""
    build = json.loads((ROOT / ".devcontainer/course/devcontainer.json").read_text())["build"]
    assert [stage.split()[0] for stage in STAGES] == ["python", build["target"], "student"]


def test_students_dev_container_and_binder_install_what_start_installs():
    """Both let pip install the students' folder, in a Python that the lab runs on."""
    folder = ROOT / ".ci/student"
    container = json.loads((folder / "devcontainer.json").read_text())
    command = "pip install --constraint constraints.txt ."
    assert container["postCreateCommand"] == command
    assert command in (folder / "postBuild").read_text()
    assert container["image"].startswith("python:3.12")
    assert (folder / "runtime.txt").read_text() == "python-3.12\n"


def test_a_new_home_gets_the_notebooks_and_an_old_one_keeps_its_work(begin):
    """What a student wrote is never written over; a folder that is missing comes."""
    begin("true")
    own = begin.home / "assignments" / "00_warmup" / "00_warmup.ipynb"
    assert own.read_text() == "released"
    assert (begin.home / "assignments" / "START_HERE.ipynb").exists()
    own.write_text("mine")
    (begin.home / "assignments" / "01_paths" / "01_paths.ipynb").unlink()
    (begin.home / "assignments" / "01_paths").rmdir()
    begin("true")
    assert own.read_text() == "mine"
    assert (begin.home / "assignments" / "01_paths" / "01_paths.ipynb").read_text() == "released"


def test_a_hub_that_hands_out_itself_gets_an_empty_home(begin):
    """With WITHOUT_NOTEBOOKS nothing is laid into the home."""
    begin("true", WITHOUT_NOTEBOOKS="1")
    assert not list(begin.home.iterdir())


def test_a_container_starts_what_its_place_asks_for(begin):
    """Alone it is Jupyter with a token of its own, on a hub the hub's; any other command is run."""
    alone = begin("lab")
    assert alone == "jupyter lab --ip=0.0.0.0 --no-browser"
    assert begin("lab", "--port=1", JUPYTERHUB_API_TOKEN="x") == "jupyterhub-singleuser --port=1"
    assert begin("echo", "labkit doctor") == "labkit doctor"
