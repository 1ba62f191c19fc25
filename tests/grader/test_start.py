"""What a student starts: it makes an environment, mends it, and says why it cannot."""

from __future__ import annotations

import ast
import importlib.util
import os
import subprocess
import sys
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
    for name in ("HERE", "ENV", "DONE", "CACHE", "LOG"):
        old = getattr(module, name)
        monkeypatch.setattr(module, name, tmp_path / old.relative_to(FILE.parent))
    monkeypatch.setattr("os.environ", dict(os.environ))  # which main changes
    module.said = []
    monkeypatch.setattr("venv.create", lambda path, with_pip: module.ENV.mkdir())
    monkeypatch.setattr(module, "install", lambda python: module.LOG.touch())
    monkeypatch.setattr(module, "run", lambda *words: module.said.append(words))
    monkeypatch.setattr(module, "become", lambda words: module.said.append(words))
    monkeypatch.setattr(module, "SYSTEMS", [(sys.platform, module.platform.machine())])
    return module


def test_any_python_3_can_read_it():
    """One that is too old must be able to say so."""
    tree = ast.parse(FILE.read_text(), feature_version=(3, 4))
    assert not [node for node in ast.walk(tree) if isinstance(node, ast.JoinedStr)]


def test_the_second_start_installs_nothing(start, monkeypatch):
    """What is made is noted last; after that JupyterLab is opened at once."""
    assert not start.made()
    start.main(["install"])
    assert start.made() and not start.LOG.exists()
    monkeypatch.setattr(start, "make", lambda python: pytest.fail("made twice"))
    start.main([])
    assert "jupyterlab" in start.said[-1]
    assert "--LabApp.default_url=/lab/tree/START_HERE.ipynb" in start.said[-1]


def test_it_opens_no_other_notebooks_and_needs_no_home(start, tmp_path):
    """Workspaces are remembered in the environment; so is the rest where the home is closed."""
    os.environ["HOME"] = str(tmp_path / "not there")
    start.main([])
    assert os.environ["HOME"] == str(start.ENV / "home") and (start.ENV / "home").is_dir()
    assert os.environ["JUPYTERLAB_WORKSPACES_DIR"] == str(start.ENV / "workspaces")


def test_whoever_stops_it_stops_pip(start):
    """Nothing goes on installing behind the next start's back."""
    with (
        subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as pip,
        pytest.raises(KeyboardInterrupt),
        start.ended_too(pip),
    ):
        raise KeyboardInterrupt
    assert pip.returncode < 0


def test_a_half_made_environment_is_made_anew(start):
    """As is one of another version; nothing of it stays."""
    start.ENV.mkdir()
    (start.ENV / "half").touch()
    start.main(["install"])
    assert not (start.ENV / "half").exists()
    (start.HERE / "labkit-1-py3-none-any.whl").write_bytes(b"a newer wheel")
    assert not start.made()


def test_what_stops_the_installation_leaves_it_unmade(start, monkeypatch):
    """The arm that does not move, too."""

    def fails(*words):
        raise start.Stop("the lab is installed and does not run")

    monkeypatch.setattr(start, "run", fails)
    with pytest.raises(start.Stop):
        start.main([])
    assert not start.made()


def test_a_python_that_will_not_do_hands_over_to_one_that_will(start, monkeypatch, tmp_path):
    """Or says what is needed and how to get it."""
    monkeypatch.setattr(start, "VERSIONS", ("3.99",))
    monkeypatch.setattr(start, "PLACES", (str(tmp_path),))
    needs = r"this is Python .*needs 3.11, 3.12 or 3.13.* If you cannot, install Miniforge"
    with pytest.raises(start.Stop, match=needs):
        start.main([])
    (tmp_path / "python3.99").symlink_to(sys.executable)
    start.main(["install"])
    assert start.said == [[str(tmp_path / "python3.99"), start.HERE / "start.py", "install"]]


def test_each_obstacle_is_a_sentence_with_the_way_out(start, monkeypatch):
    """No wheels for the system, no room, no venv."""
    monkeypatch.setattr(start, "FREE", 1e18)
    with pytest.raises(start.Stop, match=r"has .* GB free, .* make room, then type the same"):
        start.main([])
    monkeypatch.setattr(start, "FREE", 0.0)

    def no_pip(path, with_pip):
        raise CalledProcessError(1, "ensurepip")

    monkeypatch.setattr("venv.create", no_pip)
    with pytest.raises(start.Stop, match=r"apt-get install python3.*-venv"):
        start.main([])
    monkeypatch.setattr(start, "SYSTEMS", ())
    with pytest.raises(start.Stop, match=r"conda env create -f environment\.yml"):
        start.main([])


def test_other_words_are_refused_before_anything_is_made(start):
    """`start.py --help` says what to type, and installs nothing."""
    with pytest.raises(start.Stop, match=r"start\.py install"):
        start.main(["--help"])
    assert not start.said
