"""What a sandbox shows: what Python needs, and nothing of a course, wherever either lies."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from handmade import ROOT
from processes import below

from labkit.grader.sandbox import mounts as launch
from labkit.grader.sandbox.confine import DEVICES
from labkit.grader.sandbox.launch import Sandbox
from labkit.grader.sandbox.limits import Limits

PLACES = (Path("/tmp"), Path("/dev/shm"), Path("/usr/local/share"), Path(sys.prefix, "lib"))
"""Where a course may lie: in a folder that each session gets anew, and below what is shown."""


def run(sandbox, source):
    """What a cell prints, alone in a session; what it raises fails the test."""
    with sandbox.spawn("student", Limits()) as inside:
        inside.connection.send({"cell": 0, "source": source, "answers": [], "seconds": 30.0})
        said = inside.connection.read(60.0)
    assert not said["error"]
    return said["output"]


def files(words, below):
    """The files that a program sees below a folder, on a disk that is laid out by some words."""
    found = subprocess.run(
        ["bwrap", *words, "--remount-ro", "/", "/usr/bin/find", below, "-type", "f"],
        capture_output=True,
        text=True,
        check=True,
    )
    return sorted(str(Path(x).relative_to(below)) for x in found.stdout.splitlines())


def on_huge_pages(rollup):
    """Whether a process has any, by the kernel's account of its memory."""
    return int(rollup.partition("AnonHugePages:")[2].split()[0]) > 0


@pytest.fixture
def tree(tmp_path):
    """A folder with a Python, a course in its libraries, and a Python of its own in the course."""
    for name in ("py/lib/a", "py/lib/course/secret", "py/lib/course/.venv/lib/b", "py/share/c"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("")
    (tmp_path / "link").symlink_to("py")
    return tmp_path


def test_a_hidden_folder_within_a_shown_one_is_empty(tree):
    """A course within Python's libraries is covered; what is needed of it is shown again."""
    course = tree / "py/lib/course"
    shown = [*launch.python_paths(), tree / "py/lib"]
    assert files(launch.mount_arguments(shown, [course]), tree) == ["py/lib/a"]
    words = launch.mount_arguments([*shown, course / ".venv/lib"], [course])
    assert files(words, tree) == ["py/lib/a", "py/lib/course/.venv/lib/b"]


def test_a_link_on_the_way_stays_a_link(tree):
    """What is shown by a path with a link in it is there by both, and nothing beside it."""
    words = launch.mount_arguments([*launch.python_paths(), tree / "link/lib/course/.venv"], [])
    assert files(words, tree) == ["py/lib/course/.venv/lib/b"]
    assert files(words, tree / "link/lib") == ["course/.venv/lib/b"]


@pytest.mark.parametrize("through_a_link", [False, True])
def test_a_virtual_environment_starts_wherever_it_lies(tmp_path, through_a_link):
    """What an environment below /tmp needs is found, also where its Python is behind a link."""
    (tmp_path / "minor").symlink_to(sys.base_prefix)
    made_by = tmp_path / "minor" if through_a_link else Path(sys.base_prefix)
    python = tmp_path / "env/bin/python"
    subprocess.run(
        [made_by / "bin/python3", "-m", "venv", "--without-pip", tmp_path / "env"], check=True
    )
    code = "from json import dumps; from labkit.grader.sandbox import mounts\n"
    code += "print(dumps(mounts.mount_arguments(mounts.python_paths(), [])))"
    asked = subprocess.run(
        [python, "-c", code],
        env=dict(os.environ, PYTHONPATH=":".join([str(ROOT), *filter(None, sys.path)])),
        capture_output=True,
        check=True,
    )
    words = json.loads(asked.stdout)
    works = subprocess.run(
        ["bwrap", *words, "--dev", "/dev", python, "-c", "import ssl, sys; print(sys.prefix)"],
        env={},
        capture_output=True,
        text=True,
        check=True,
    )
    assert works.stdout.strip() == str(tmp_path / "env")


def test_only_what_is_needed_is_shown(sandbox):
    """Of the system there are programs, libraries and fonts; no home, no settings, no sources."""
    look = "import json, os\nos.chdir('/')\nprint(json.dumps({x: os.listdir(x) for x in "
    look += "('/', 'etc', 'usr', 'usr/share', 'usr/local', 'dev', 'proc', 'sys') "
    look += "if os.path.exists(x)}))"
    found = {name: set(inside) for name, inside in json.loads(run(sandbox, look)).items()}
    paths = [x for path in launch.python_paths() for x in (path, path.resolve())]
    assert found["/"] <= {path.parts[1] for path in paths} | {"lab", "proc", "dev", "tmp"}
    parts = {"bin", "lib", "lib32", "lib64"}
    assert found["usr"] <= parts | {"local", "share"}
    assert found.get("usr/local", set()) <= parts
    assert found.get("usr/share", set()) <= {"fonts"}
    assert found["etc"] <= {"alternatives", "ld.so.cache"}
    assert found["dev"] == {"shm"} | {Path(device).name for device in DEVICES}
    assert not found["proc"] and not found.get("sys")


def test_what_is_loaded_lies_on_pages_of_2_mb_where_any_program_gets_some():
    """The C library learns of them before what it asks is hidden."""
    code = "import numpy; print(open('/proc/self/smaps_rollup').read())"
    asked = subprocess.run(
        [sys.executable, "-c", code],
        env={"GLIBC_TUNABLES": "glibc.malloc.hugetlb=1", "PYTHONMALLOC": "malloc"},
        capture_output=True,
        text=True,
        check=True,
    )
    with Sandbox() as sandbox:
        places = [f"/proc/{pid}/smaps_rollup" for pid, _ in below(sandbox.process.pid, 4)]
        inside = [on_huge_pages(Path(place).read_text()) for place in places]
    assert any(inside) == on_huge_pages(asked.stdout)


@pytest.mark.parametrize("place", [place for place in PLACES if os.access(place, os.W_OK)], ids=str)
def test_a_course_is_never_seen(place):
    """Of a course there is no file inside, wherever it lies."""
    with tempfile.TemporaryDirectory(prefix="course-", dir=place) as folder:
        os.chmod(folder, 0o755)  # or nobody but its owner would see it anyhow
        canary = f"canary-{Path(folder).name}"  # another run may have a course there, too
        for part in ("submitted/ada", "build/course", "solutions"):
            Path(folder, part).mkdir(parents=True)
            Path(folder, part, canary).write_text("")
        look = f"import os\nprint(*(p for p, _, files in os.walk('/') if {canary!r} in files))"
        with Sandbox(hidden=[Path(folder)]) as sandbox:
            assert not run(sandbox, look).strip()


def test_what_is_shown_below_tmp_is_there_in_each_session(monkeypatch, tmp_path):
    """Folders that a session gets anew still hold what the sandbox shows there, read-only."""
    needed = launch.python_paths()
    (tmp_path / "with space" / "lib").mkdir(parents=True)
    (tmp_path / "with space" / "lib" / "a").write_text("library")
    (tmp_path / "with space" / "pyvenv.cfg").write_text("settings")
    more = [tmp_path / "with space" / name for name in ("lib", "pyvenv.cfg")]
    monkeypatch.setattr(launch, "python_paths", lambda: [*needed, *more])
    source = f"""
import os
print(open({str(more[0] / "a")!r}).read(), open({str(more[1])!r}).read())
for write in (lambda: open({str(more[0] / "b")!r}, "w"), lambda: open({str(more[1])!r}, "w")):
    try:
        write()
        print("written")
    except OSError:
        pass
"""
    with Sandbox() as sandbox:
        assert [run(sandbox, source).split() for _ in range(2)] == [["library", "settings"]] * 2


def test_devices_work_and_cannot_be_changed(sandbox):
    """A time set on a device would be seen by later students; none can be set, by any method."""
    before = [os.stat(device) for device in DEVICES]
    source = f"""
import os
from stat import S_ISCHR
def device(end):
    try:
        return S_ISCHR(os.fstat(end).st_mode)
    except OSError:
        return False
for place in (*{DEVICES!r}, *filter(device, range(128))):
    for change in (
        lambda: os.utime(place),
        lambda: os.utime(place, ns=(1, 1)),
        lambda: os.chmod(place, 0o777),
        lambda: os.setxattr(place, "user.x", b"1"),
    ):
        try:
            change()
            print(place)
        except OSError:
            pass
assert open("/dev/zero", "rb").read(3) == bytes(3) and len(open("/dev/urandom", "rb").read(3)) == 3
open("/dev/null", "w").write("x")
"""
    assert not run(sandbox, source)
    after = [os.stat(device) for device in DEVICES]
    times = [(x.st_mtime_ns, x.st_ctime_ns) for x in before]
    assert times == [(x.st_mtime_ns, x.st_ctime_ns) for x in after]


def test_nothing_that_a_submission_writes_outlives_it(sandbox):
    """Only its own folders in memory can be written to, and the next one finds them empty."""
    source = """
import os
for place, folders, files in os.walk("/"):
    if "left-here" in files:
        print("found", place)
    try:
        open(os.path.join(place, "left-here"), "x").close()
        print("written", place)
    except OSError:
        pass
"""
    for _ in range(2):
        assert sorted(run(sandbox, source).splitlines()) == ["written /dev/shm", "written /tmp"]


def test_a_parser_waits_for_its_file_no_longer_than_the_limit(sandbox):
    """Where the worker sends nothing, the process is not left for half a minute."""
    with sandbox.spawn("parse", Limits(parse=0.2), size=10) as inside:
        assert "timed out" in inside.connection.read(10.0)["failed"]
