"""A sandbox: what it shows, allows and keeps, by either isolation, and what doctor says of it."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from autograder import as_root, processes_of
from handmade import ROOT

from labkit.grader.doctor import DOCKER, elsewhere, examine
from labkit.grader.sandbox import launch
from labkit.grader.sandbox.launch import FIRST_UID, Isolation, NoIsolation, Sandbox, SandboxLost
from labkit.grader.sandbox.limits import Limits

PLACES = (Path("/tmp"), Path("/dev/shm"), Path("/usr/local/share"), Path(sys.prefix, "lib"))
"""Where a course may lie: in a folder that each submission gets anew, and below what is shown."""
DOCKERS_OWN = (
    "chown dac_override fowner fsetid kill setgid setuid setpcap net_bind_service net_raw "
    "sys_chroot mknod audit_write setfcap"
)
"""Rights that Docker leaves to root in a container."""


def run(sandbox, source):
    """What a cell prints, alone in a process; what it raises fails the test."""
    inside = sandbox.start(Limits())
    inside.send({"cell": 0, "source": source, "answers": [], "seconds": 30.0})
    said = inside.read(60.0)
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


def test_a_hidden_folder_is_empty_by_whatever_path_it_is_shown(tmp_path):
    """A course within Python's libraries is covered; what is needed of it is shown again."""
    for name in ("py/lib/a", "py/lib/course/secret", "py/lib/course/.venv/lib/b", "py/share/c"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    (tmp_path / "link").symlink_to("py")
    course = tmp_path / "py/lib/course"
    shown = [*launch.python_paths(), tmp_path / "py/lib", tmp_path / "link/lib"]
    assert files(launch.disk(shown, [course]), tmp_path) == ["link/lib/a", "py/lib/a"]
    words = launch.disk([*shown, course / ".venv/lib"], [course])
    assert "py/lib/course/.venv/lib/b" in files(words, tmp_path)


def test_a_virtual_environment_starts_wherever_it_lies(tmp_path):
    """What an environment below /tmp needs is found, also where its Python is behind a link."""
    (tmp_path / "minor").symlink_to(sys.base_prefix)
    python = tmp_path / "env/bin/python"
    words = [tmp_path / "minor/bin/python3", "-m", "venv", "--without-pip", tmp_path / "env"]
    subprocess.run(words, check=True)
    code = "from json import dumps; from labkit.grader.sandbox import launch\n"
    code += "print(dumps(launch.disk(launch.python_paths(), [])))"
    path = dict(os.environ, PYTHONPATH=":".join([str(ROOT), *filter(None, sys.path)]))
    asked = subprocess.run([python, "-c", code], env=path, capture_output=True, check=True)
    words = ["bwrap", *json.loads(asked.stdout), "--dev", "/dev", python]
    tried = [*words, "-c", "import ssl, sys; print(sys.prefix)"]
    works = subprocess.run(tried, env={}, capture_output=True, text=True, check=True)
    assert works.stdout.strip() == str(tmp_path / "env")


def test_only_what_is_needed_is_shown(sandbox):
    """Of the system there are programs and libraries; no home, no settings, no sources."""
    look = "import json, os\nos.chdir('/')\nprint(json.dumps({x: os.listdir(x) for x in "
    look += "('/', 'etc', 'usr', 'usr/local', 'dev', 'proc') if os.path.exists(x)}))"
    found = {name: set(inside) for name, inside in json.loads(run(sandbox, look)).items()}
    paths = [x for path in launch.python_paths() for x in (path, path.resolve())]
    assert found["/"] <= {path.parts[1] for path in paths} | {"lab", "proc", "dev", "tmp", "box"}
    parts = {"bin", "lib", "lib32", "lib64"}
    assert found["usr"] <= parts | {"local"}
    assert found.get("usr/local", set()) <= parts
    assert found["etc"] <= {"alternatives", "ld.so.cache"}
    assert found["dev"] == {"shm"} | {Path(device).name for device in launch.DEVICES}
    assert not found["proc"]


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


def test_nothing_that_a_submission_writes_outlives_it(sandbox):
    """Only its own folder in memory can be written to, and the next one finds it empty."""
    source = """
import os
for place, folders, files in os.walk("/", followlinks=False):
    if "left-here" in files:
        print("found", place)
    for name in files if place == "/dev" else ():
        try:
            os.utime(os.path.join(place, name))
            print("touched", name)
        except OSError:
            pass
    try:
        open(os.path.join(place, "left-here"), "x").close()
        print("written", place)
    except OSError:
        pass
"""
    for _ in range(2):
        assert run(sandbox, source).splitlines() == ["written /box"]


USES = {
    "numpy and scipy": "import numpy as np, scipy.linalg, scipy.optimize\n"
    "a = np.random.default_rng(0).random((300, 300))\nnp.linalg.svd(a @ a)\nscipy.linalg.expm(a)",
    "threads of BLAS": "import subprocess, sys\ncode = 'import numpy as np; a = np.ones((500, 500));'\n"
    "code += 'print((a @ a)[0, 0], len(__import__(\"os\").sched_getaffinity(0)))'\n"
    "run = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True,\n"
    "    env={'OPENBLAS_NUM_THREADS': '4'})\nassert run.stdout.startswith('500.0'), run.stderr",
    "matplotlib": "import matplotlib.pyplot as plt\nplt.plot([1, 2])\nplt.title('Δ')\n"
    "plt.savefig('x.png')\nplt.savefig('/tmp/x.pdf')",
    "cv2": "import cv2, numpy as np\nx = np.zeros((200, 200), np.uint8)\ncv2.GaussianBlur(x, (5, 5), 1)\n"
    "cv2.imwrite('x.png', x)\nassert cv2.imread('x.png') is not None",
    "pinocchio and pybullet": "import labkit as lk\nwith lk.Arm('left') as arm:\n"
    "    arm.model.mass_matrix(arm.state().q)\n    hold = lk.Hold(arm.state().q, 0.1)\n    lk.run(arm, hold, lambda s, t: lk.JointVelocity([0.0] * 7))",
    "processes": "import multiprocessing as m, subprocess\nwith m.get_context('fork').Pool(2) as pool:\n"
    "    assert pool.map(abs, [-1, 2]) == [1, 2]\nm.Lock(); m.Value('d', 1.0)\n"
    "assert subprocess.check_output('echo hi | cat', shell=True) == b'hi\\n'",
    "threads and signals": "import signal, concurrent.futures as f\nwith f.ThreadPoolExecutor(4) as e:\n"
    "    assert sum(e.map(abs, range(9))) == 36\nhits = []\n"
    "signal.signal(signal.SIGUSR1, lambda *a: hits.append(a))\nsignal.raise_signal(signal.SIGUSR1)\nassert hits",
    "asyncio": "import asyncio\nasync def f():\n    await asyncio.sleep(0.01)\n"
    "    p = await asyncio.create_subprocess_exec('true')\n    return await p.wait()\n"
    "assert asyncio.run(f()) == 0",
    "files": "import os, shutil, tempfile, mmap, sqlite3, zipfile\nos.mkdir('own')\n"
    "os.chdir('own')\nopen('a', 'w').write('x')\n"
    "shutil.copy2('a', 'b')\nshutil.copytree('.', 'd', ignore=lambda *x: ['d'])\n"
    "os.rename('b', 'c')\nos.symlink('c', 'e')\nos.truncate('c', 0)\nos.utime('c')\nos.chmod('c', 0o600)\n"
    "with tempfile.TemporaryDirectory() as t:\n    zipfile.ZipFile(t + '/z', 'w').write('a')\n"
    "mmap.mmap(-1, 4096)[:1] = b'x'\nsqlite3.connect(':memory:').execute('create table t(x)')\n"
    "os.isatty(0)\nos.statvfs('.')",
    "time and limits": "import os, time, resource, random, secrets, uuid, platform\ntime.sleep(0.001)\n"
    "time.process_time()\nresource.getrusage(resource.RUSAGE_SELF)\n"
    "secrets.token_hex()\nuuid.uuid1()\nplatform.uname()\nos.nice(0)\nos.times()",
}


@pytest.mark.parametrize("what", USES)
def test_what_the_labs_packages_call_passes(what, sandbox):
    """Numerics with threads, pictures, simulation, processes, signals and files work."""
    run(sandbox, USES[what])


REFUSED = """
import ctypes, fcntl, os, socket, termios
libc = ctypes.CDLL(None, use_errno=True)
passed = []
def call(*arguments):
    if libc.syscall(*arguments) < 0: raise OSError
for name, what in {
    "memfd_create": lambda: os.memfd_create("x"),
    "pidfd_open": lambda: os.pidfd_open(os.getpid()),
    "fadvise64": lambda: os.posix_fadvise(0, 0, 1, os.POSIX_FADV_DONTNEED),
    "sendfile": lambda: os.sendfile(1, 0, 0, 1),
    "copy_file_range": lambda: os.copy_file_range(0, 1, 1),
    "preadv2": lambda: os.preadv(os.open("/dev/zero", 0), [bytearray(1)], 0, os.RWF_NOWAIT),
    "pwritev2": lambda: os.pwritev(os.open("/dev/null", 1), [b"x"], 0, os.RWF_DSYNC),
    "flock": lambda: fcntl.flock(open("/dev/null"), fcntl.LOCK_SH),
    "lockf": lambda: fcntl.lockf(open("a", "w"), fcntl.LOCK_EX),
    "lease": lambda: fcntl.fcntl(open("a"), fcntl.F_SETLEASE, fcntl.F_RDLCK),
    "typing": lambda: fcntl.ioctl(0, termios.TIOCSTI, b"x"),
    "network": lambda: socket.socket(),
    "netlink": lambda: socket.socket(socket.AF_NETLINK),
    "namespace": lambda: libc.unshare(0x10000000) and [][0],
    "clone": lambda: call(56, 0x10000011, 0, 0, 0, 0),
}.items():
    try:
        what()
        passed.append(name)
    except (OSError, IndexError):
        pass
assert not passed, passed
"""


@pytest.mark.parametrize(
    "isolation", [Isolation.BUBBLEWRAP, pytest.param(Isolation.USER, marks=as_root)]
)
def test_what_nobody_needs_is_refused(isolation, monkeypatch):
    """Locks, networks, namespaces, the page cache; without bubblewrap, too, and without /proc's."""
    if isolation is Isolation.USER:
        monkeypatch.setenv("PATH", "/nowhere")
    with Sandbox(isolation=isolation) as sandbox:
        assert Isolation.of(sandbox.level) is isolation
        run(sandbox, REFUSED)
        said = run(sandbox, "import os\nprint(os.getuid(), os.getgroups())")
        assert said.split() == [str(sandbox.uid), "[]"] or os.geteuid()


@as_root
def test_without_bubblewrap_a_daemon_ends_with_its_submission(monkeypatch):
    """Whatever a submission started is gone once its process is ended, and its folder too."""
    monkeypatch.setenv("PATH", "/usr/bin:/bin")
    source = "import os, signal\nprint(os.getcwd(), flush=True)\nfor _ in range(9):\n"
    source += (
        "    if not os.fork():\n        os.setsid()\n        os.fork()\n        signal.pause()"
    )
    with Sandbox(isolation=Isolation.USER) as sandbox:
        folder = run(sandbox, source).strip()
        assert len(processes_of(sandbox.uid)) > 9 and os.path.isdir(folder)
        sandbox.end()
        assert not processes_of(sandbox.uid) and not os.path.exists(folder)


def test_nothing_weaker_is_taken_unasked(monkeypatch, tmp_path):
    """Bubblewrap's, or there is none; by user id for root alone, if nobody can see the course."""
    monkeypatch.setenv("PATH", "/nowhere")
    with pytest.raises(NoIsolation):
        Sandbox()
    with pytest.raises(NoIsolation):
        Sandbox(isolation=Isolation.USER, hidden=[Path("/usr")])
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    with pytest.raises(NoIsolation):
        Sandbox(isolation=Isolation.USER)


def test_no_two_sandboxes_share_a_user():
    """Two graders on one machine have two users, as the kernel counts processes by user."""
    with Sandbox() as one, Sandbox() as other:
        if os.geteuid() == 0:
            assert min(one.uid, other.uid) >= FIRST_UID and one.uid != other.uid
        else:
            assert one.uid == other.uid == 0


def test_what_can_no_longer_be_confined_is_a_sandbox_lost(sandbox):
    """A machine that lacks something says so when a sandbox is made; later it is lost."""
    with pytest.raises(SandboxLost):
        sandbox.start(Limits(files=-1))
    assert run(sandbox, "print(1)") == "1\n"


def test_doctor_finds_a_working_sandbox_or_says_what_each_system_needs(monkeypatch):
    """The sandbox that is tried decides; without Linux doctor looks no further."""
    assert not [str(x) for x in examine() if not x.fine]
    monkeypatch.setenv("PATH", "/nowhere")
    (found,) = [x for x in examine() if not x.fine]
    assert found.says.endswith(elsewhere())
    monkeypatch.setattr("platform.system", lambda: "Darwin")
    (found,) = examine()
    assert not found.fine


def test_containers_state_the_same_options():
    """Dockerfile, dev container and doctor agree on what a container that grades is given."""
    text = " ".join((ROOT / "Dockerfile").read_text().replace("\n#", " ").split())
    assert " ".join(DOCKER) in text
    given = json.loads((ROOT / ".devcontainer/course/devcontainer.json").read_text())["runArgs"]
    assert tuple(given) == DOCKER
    assert all(option in elsewhere() for option in DOCKER)
    ignored, left_out = ((ROOT / x).read_text().split() for x in (".gitignore", ".dockerignore"))
    assert {x.strip("/") for x in ignored} <= {x.removeprefix("**/") for x in left_out}


@as_root
@pytest.mark.parametrize("added", [DOCKER, DOCKER[:-1], ()], ids=["all", "one less", "none"])
def test_dockers_rights_suffice(added):
    """With the rights that a container is given there is a sandbox; with one less, a way out."""
    more = [x.removeprefix("--cap-add=").lower() for x in added if x.startswith("--cap-add")]
    left = ",".join(f"+{name}" for name in (*DOCKERS_OWN.split(), *more))
    done = subprocess.run(
        ["setpriv", f"--bounding-set=-all,{left}", sys.executable, "-m", "labkit", "doctor"],
        env=dict(os.environ, PYTHONPATH=str(ROOT)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == (0 if added == DOCKER else 1), done.stdout + done.stderr


def test_the_sandbox_knows_nothing_of_the_grader():
    """Its files import each other, the course and the lab, and no other file of the grader."""
    for path in (ROOT / "labkit/grader/sandbox").glob("*.py"):
        assert not re.search(r"^\s*from \.\. ?import|^\s*from \.\.\w|labkit\.grader\.(?!sandbox)",
                             path.read_text(), re.M), path  # fmt: skip
