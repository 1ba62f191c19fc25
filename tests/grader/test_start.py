"""What a student starts: it makes an environment, once, and says why it cannot."""

from __future__ import annotations

import ast
import importlib.util
import os
from subprocess import CalledProcessError

import pytest
from handmade import ROOT

FILE = ROOT / ".ci/student/start.py"


@pytest.fixture
def start(tmp_path, monkeypatch):
    """The script, in a folder of its own with a wheel; it installs nothing and opens nothing."""
    spec = importlib.util.spec_from_file_location("start", FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    (tmp_path / "labkit-1-py3-none-any.whl").write_bytes(b"a wheel")
    (tmp_path / "constraints.txt").write_text("numpy==2\n")
    for name in ("HERE", "TOOLS", "ENV", "DONE", "CACHE", "LOG"):
        monkeypatch.setattr(module, name, tmp_path / getattr(module, name).relative_to(FILE.parent))
    monkeypatch.setattr("os.environ", dict(os.environ))  # which main changes
    module.said = []

    def wait(words, size=None):
        module.said.append([str(x) for x in words])
        module.ENV.mkdir(exist_ok=True)
        module.LOG.write_text("")

    monkeypatch.setattr("venv.create", lambda path, with_pip: module.TOOLS.mkdir())
    monkeypatch.setattr(module, "wait", wait)
    monkeypatch.setattr("subprocess.call", module.said.append)
    return module


def test_an_old_python_can_read_it():
    """One that is too old must be able to say so."""
    tree = ast.parse(FILE.read_text(), feature_version=(3, 5))
    assert not [node for node in ast.walk(tree) if isinstance(node, ast.JoinedStr)]


def test_the_second_start_installs_nothing(start):
    """What is made is noted last; after that JupyterLab is opened at once, without a home."""
    os.environ["HOME"] = str(start.HERE / "not there")
    start.main(["install"])
    assert [words[1:3] for words in start.said[1:3]] == [["venv", "--python"], ["pip", "install"]]
    start.said.clear()
    start.main([])
    (opened,) = start.said
    assert "--LabApp.default_url=/lab/tree/START_HERE.ipynb" in opened
    assert os.environ["HOME"] == str(start.ENV / "home")


def test_what_stops_the_installation_leaves_it_unmade(start, monkeypatch):
    """The arm that does not move, too; and a half-made environment is made anew."""
    start.ENV.mkdir()
    (start.ENV / "half").touch()

    def fails(words, size=None):
        raise start.Stop("no")

    monkeypatch.setattr(start, "wait", fails)
    with pytest.raises(start.Stop):
        start.main([])
    assert not start.DONE.exists() and not (start.ENV / "half").exists()


@pytest.mark.parametrize("obstacle", ["room", "venv", "words", "wheel"])
def test_each_obstacle_stops_it(start, monkeypatch, obstacle):
    """No room, no venv, other words, no wheel."""

    def no_pip(path, with_pip):
        raise CalledProcessError(1, "ensurepip")

    if obstacle == "room":
        monkeypatch.setattr(start, "FREE", 1e18)
    elif obstacle == "venv":
        monkeypatch.setattr("venv.create", no_pip)
    elif obstacle == "wheel":
        (start.HERE / "labkit-1-py3-none-any.whl").unlink()
    with pytest.raises(start.Stop):
        start.main(["--help"] if obstacle == "words" else [])
    assert not start.said
