"""The scripts that look for Python, packages and a browser, on machines that lack them."""

from __future__ import annotations

import ast
import re
import shlex
import shutil
import subprocess
import sys

import chromium
import pytest
from handmade import ROOT

HERE = "{}.{}".format(*sys.version_info)


@pytest.fixture
def machine(tmp_path):
    """A machine that has a shell, a Python 3.13, and ``apt-get``, which writes down its calls."""
    programs = tmp_path / "programs"
    programs.mkdir()
    for name in ("sh", "dirname", "tr", "cat"):
        (programs / name).symlink_to(shutil.which(name))

    def put(name, script):
        (programs / name).write_text(f"#!/bin/sh\n{script}\n")
        (programs / name).chmod(0o755)

    def run(tool, *arguments):
        return subprocess.run(
            ["sh", str(ROOT / ".ci" / tool), *arguments],
            env={"PATH": str(programs), "HOME": str(tmp_path)},
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )

    put("python3", "exit 1")
    put("id", "echo 0")
    put("apt-get", f'echo "$*" >> {tmp_path}/apt')
    run.put, run.calls = put, tmp_path / "apt"
    return run


def test_make_quick_says_at_the_end_what_it_left_out():
    """The folders of its own line in the Makefile, and the command that runs them."""
    words = re.search(r"pytest -n 2 (--quick .*)", (ROOT / "Makefile").read_text())[1]
    one = [sys.executable, "-m", "pytest", "tests/test_shapes.py", *shlex.split(words)]
    done = subprocess.run(one, cwd=ROOT, capture_output=True, text=True, check=True)
    folders = r"tests/grader, tests/book, tests/replay, tests/soak\b"
    assert re.search(rf"left out {folders}.* all slow tests; make test runs them", done.stdout)


def test_make_format_formats_despite_a_fault_that_only_a_person_can_correct(tmp_path):
    """It fails nevertheless, after both."""
    ruff = tmp_path / "ruff"
    ruff.write_text(f'#!/bin/sh\necho $1 >> {tmp_path}/asked\n[ "$1" = format ]\n')
    ruff.chmod(0o755)
    words = ["make", "format", f"BIN={tmp_path}", "--old-file=.venv/.dev"]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, check=False)
    assert done.returncode != 0
    assert (tmp_path / "asked").read_text().split() == ["check", "format"]


def test_a_newer_python_is_said_before_anything_is_installed(machine):
    """Without a Python 3.11 the ways to get one are said, once, and nothing is installed."""
    done = machine("need.sh", "ensurepip.py:python3.11-venv", "bwrap:bubblewrap")
    assert done.returncode == 1
    assert not machine.calls.exists()
    assert done.stderr.count("Python 3.11 is needed") == 1
    for way in ("python3.11-venv", "uv python install 3.11", "pyenv install 3.11", "PYTHON="):
        assert way in done.stderr
    (packaged,) = re.findall(r"^.*apt-get.*$", done.stderr, re.M)
    assert packaged.split()[:3] == ["Debian", "12", "(3.11),"]  # Ubuntu 24.04 has 3.12 alone


def test_a_python_that_uv_brought_is_found(machine):
    """After `uv python install` there is nothing else to set."""
    machine.put("uv", f'[ "$*" = "python find --system {HERE}" ] && echo {sys.executable}')
    assert machine("find_python.sh", HERE).stdout.strip() == sys.executable


def test_a_python_of_pyenv_is_found(machine, tmp_path):
    """Though its shim says that it is not chosen."""
    machine.put(f"python{HERE}", "exit 127")
    own = tmp_path / ".pyenv/versions" / f"{HERE}.9" / "bin"
    own.mkdir(parents=True)
    (own / "python3").symlink_to(sys.executable)
    assert machine("find_python.sh", HERE).stdout.strip() == str(own / "python3")


def test_uv_fetches_a_python_that_is_not_there(machine, tmp_path):
    """What it cannot fetch is said as where there is no uv."""
    found = f"test -e {tmp_path}/got && echo {sys.executable}"
    machine.put("uv", f'case "$*" in *install*) : > {tmp_path}/got;; *) {found};; esac')
    assert machine("find_python.sh", HERE).stdout.strip() == sys.executable
    machine.put("uv", "exit 1")
    done = machine("find_python.sh", HERE)
    assert done.returncode == 1 and f"Python {HERE} is needed" in done.stderr


def test_what_is_missing_is_installed_for_root_and_named_for_others(machine):
    """Root gets the missing packages and no others; anybody else gets the one line."""
    machine.put("python3.11", "exit 0")
    machine.put("there", "")
    wanted = ["need.sh", "there:have", "not-there,nor-this:bubblewrap", "json.py:python3.11-venv"]
    assert machine(*wanted).returncode == 0
    assert machine.calls.read_text().splitlines()[1].split()[-2:] == [
        "--no-install-recommends",
        "bubblewrap",
    ]
    machine.put("id", "echo 1000")
    done = machine(*wanted)
    assert done.returncode == 1
    assert done.stderr.rstrip().endswith("sudo apt-get install -y bubblewrap")


def test_chromium_is_the_systems_or_playwrights_but_no_snap(tmp_path, monkeypatch):
    """A snap is passed over for the one that Playwright brought; without any, the ways are said."""
    snap = tmp_path / "snap" / "bin" / "chromium"
    own = tmp_path / "own" / "chromium-1200" / "chrome-linux64" / "chrome"
    monkeypatch.setenv("PATH", str(snap.parent))
    monkeypatch.setenv("PLAYWRIGHT_BROWSERS_PATH", str(tmp_path / "own"))
    for path in (snap, own):
        path.parent.mkdir(parents=True)
    snap.write_text("")
    snap.chmod(0o755)
    with pytest.raises(SystemExit, match="playwright install"):
        chromium.program()
    own.write_text("")
    assert chromium.program() == str(own)


def test_what_shares_a_group_shares_a_worker(tmp_path):
    """The pytest and the xdist that are pinned agree on what a group is."""
    where = tmp_path / "where"
    (tmp_path / "test_group.py").write_text(
        "import os, pytest\n"
        "@pytest.mark.xdist_group('one')\n"
        "@pytest.mark.parametrize('k', range(6))\n"
        "def test_it(k):\n"
        f"    open({str(where)!r}, 'a').write(os.environ['PYTEST_XDIST_WORKER'] + ' ')\n"
    )
    command = [sys.executable, "-m", "pytest", "-q", "-n", "2", "--dist", "loadgroup", "."]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    workers = where.read_text().split()
    assert len(workers) == 6 and len(set(workers)) == 1


def test_every_test_says_what_it_proves():
    """Each test has a docstring, the sentence that it proves."""
    silent = [
        f"{path.relative_to(ROOT)}: {node.name}"
        for path in sorted((ROOT / "tests").rglob("test_*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef)
        if node.name.startswith("test_") and not ast.get_docstring(node)
    ]
    assert not silent
