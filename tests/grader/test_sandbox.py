"""What a sandbox takes from the machine, and what doctor and the containers say of it."""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys

import pytest
from autograder import as_root
from handmade import ROOT

from labkit.grader.doctor import DOCKER, elsewhere, examine
from labkit.grader.sandbox.launch import FIRST_UID, Sandbox, SandboxLost
from labkit.grader.sandbox.limits import Limits
from labkit.grader.sandbox.mounts import NoIsolation

SANDBOX = ROOT / "labkit" / "grader" / "sandbox"
DOCKERS_OWN = (
    "chown dac_override fowner fsetid kill setgid setuid setpcap net_bind_service net_raw "
    "sys_chroot mknod audit_write setfcap"
)
"""Rights that Docker leaves to root in a container."""


def rights(options):
    """Those that options of Docker add."""
    return [x.removeprefix("--cap-add=").lower() for x in options if x.startswith("--cap-add")]


def test_doctor_finds_a_working_sandbox():
    """On a machine that grades, nothing that is needed is missing."""
    found = list(examine())
    assert not [str(x) for x in found if x.needed and not x.fine]
    assert [x for x in found if x.what == "sandbox"]


def test_where_there_is_no_linux_doctor_names_the_container_and_looks_no_further(monkeypatch):
    """A Mac or Windows: students work there, grading is done in the container."""
    monkeypatch.setattr("platform.system", lambda: "Darwin")
    (found,) = examine()
    assert found.needed and not found.fine
    assert "grading needs Linux" in found.says and "docker run" in found.says


def test_no_two_sandboxes_share_a_user():
    """Two graders on one machine have two users, as the kernel counts processes by user."""
    with Sandbox() as one, Sandbox() as other:
        if os.geteuid() == 0:
            assert one.uid != other.uid
            assert min(one.uid, other.uid) >= FIRST_UID
        else:
            assert one.uid == other.uid == 0


def test_what_can_no_longer_be_confined_is_a_sandbox_lost():
    """Where it never could, the machine lacks something; later it is not a student's fault."""
    impossible = Limits(files=-1)
    with Sandbox() as sandbox:
        with pytest.raises(NoIsolation, match="could not be confined"):
            sandbox.spawn("student", impossible)
        sandbox.spawn("student", Limits()).close()
        with pytest.raises(SandboxLost, match="could not be confined"):
            sandbox.spawn("student", impossible)


def test_containers_state_the_same_options():
    """Dockerfile, dev container and doctor agree on what a container that grades is given."""
    text = " ".join((ROOT / "Dockerfile").read_text().replace("\n#", " ").split())
    assert " ".join(DOCKER) in text
    given = json.loads((ROOT / ".devcontainer/course/devcontainer.json").read_text())["runArgs"]
    assert tuple(given) == DOCKER
    assert all(option in elsewhere() for option in DOCKER)


def test_where_no_sandbox_can_be_made_doctor_says_what_each_system_needs(monkeypatch):
    """The sandbox that is tried decides; settings of the kernel are not judged by themselves."""

    def fails(*_):
        raise NoIsolation("the sandbox did not start")

    monkeypatch.setattr(Sandbox, "__enter__", fails)
    (found,) = [x for x in examine() if x.needed and not x.fine]
    assert found.says == f"the sandbox did not start\n\n{elsewhere()}"
    for command in ("apt-get install", "unprivileged_userns_clone", "max_user_namespaces"):
        assert command in found.says


@as_root
@pytest.mark.parametrize("added", [DOCKER, DOCKER[:-1], ()], ids=["all", "one less", "none"])
def test_dockers_rights_suffice(added):
    """With the rights that a container is given there is a sandbox; with one less, a way out."""
    left = ",".join(f"+{name}" for name in (*DOCKERS_OWN.split(), *rights(added)))
    run = subprocess.run(
        ["setpriv", f"--bounding-set=-all,{left}", sys.executable, "-m", "labkit", "doctor"],
        env=dict(os.environ, PYTHONPATH=str(ROOT)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == (0 if added == DOCKER else 1), run.stdout + run.stderr
    assert (elsewhere() in run.stdout) == (added != DOCKER)


@pytest.mark.parametrize("path", sorted(SANDBOX.glob("*.py")), ids=lambda path: path.name)
def test_the_sandbox_knows_nothing_of_the_grader(path):
    """Its files import each other, the course and the lab, and no other file of the grader."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom):
            package = ["labkit", "grader", "sandbox"][: 4 - node.level] if node.level else []
            stem = ".".join([*package, *([node.module] if node.module else [])])
            names = [f"{stem}.{alias.name}" for alias in node.names]
        else:
            names = [alias.name for alias in getattr(node, "names", []) if hasattr(alias, "name")]
        for name in names:
            inside = name.startswith("labkit.grader.sandbox.")
            assert inside or not name.startswith("labkit.grader"), name
