"""The filter of system calls: only named calls pass, and what the lab's packages need is named."""

from __future__ import annotations

import errno
import fcntl
import socket
import struct
import termios

import pytest

from labkit.grader.sandbox.limits import Limits
from labkit.grader.sandbox.seccomp import program
from labkit.grader.sandbox.syscalls import ALLOWED, CONDITIONAL

MACHINES = {"x86_64": (0, 0xC000003E), "aarch64": (1, 0xC00000B7)}
ALLOW, KILL, ERRNO = 0x7FFF0000, 0x80000000, 0x00050000
REFUSED, UNKNOWN = ERRNO | errno.EPERM, ERRNO | errno.ENOSYS


def outcome(machine, number, *arguments, arch=None):
    """What the kernel makes of a call: the filter, run instruction by instruction."""
    steps = list(struct.iter_unpack("HBBI", program(machine)))
    data = struct.pack("iI Q", number, arch or MACHINES[machine][1], 0)
    data += struct.pack("6Q", *arguments, *[0] * (6 - len(arguments)))
    at, loaded = 0, 0
    while True:
        code, yes, no, value = steps[at]
        if code == 0x06:
            return value
        if code == 0x20:
            (loaded,) = struct.unpack_from("I", data, value)
        else:
            holds = {0x15: loaded == value, 0x45: bool(loaded & value)}[code]
            at += yes if holds else no
        at += 1


@pytest.mark.parametrize("machine", MACHINES)
def test_only_named_calls_pass(machine):
    """Each named call is allowed; every other number fails as on a kernel that lacks it."""
    column, _ = MACHINES[machine]
    allowed = {numbers[column] for numbers in ALLOWED.values()} - {None}
    with_arguments = {numbers[column] for numbers in CONDITIONAL.values()}
    assert len(allowed) == len([x for x in ALLOWED.values() if x[column] is not None])
    assert not allowed & with_arguments
    for number in {*range(600), 0x40000000, 0x40000000 + 39}:
        if number not in with_arguments:
            expected = ALLOW if number in allowed else UNKNOWN
            assert outcome(machine, number) == expected, number


@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize(
    ("name", "arguments", "passes"),
    [
        ("clone", (0x3D0F00,), True),  # a thread
        ("clone", (0x01200011,), True),  # a process
        ("clone", (0x10000011,), False),  # one in a user namespace
        ("clone", (0x00020011,), False),  # one in a mount namespace
        ("socket", (socket.AF_UNIX,), True),
        ("socket", (socket.AF_INET,), False),
        ("socket", (socket.AF_NETLINK,), False),
        ("socketpair", (socket.AF_UNIX,), True),
        ("socketpair", (socket.AF_INET,), False),
        ("fcntl", (3, fcntl.F_GETFL), True),
        ("fcntl", (3, fcntl.F_SETLK), False),
        ("fcntl", (3, fcntl.F_SETLEASE), False),
        ("fcntl", (3, fcntl.F_NOTIFY), False),
        ("ioctl", (3, termios.TCGETS), True),
        ("ioctl", (3, termios.TIOCSTI), False),
    ],
)
def test_some_calls_depend_on_their_arguments(machine, name, arguments, passes):
    """Processes but no namespaces, local sockets alone, no locks on shared files, no typing."""
    number = CONDITIONAL[name][MACHINES[machine][0]]
    assert outcome(machine, number, *arguments) == (ALLOW if passes else REFUSED)


@pytest.mark.parametrize("machine", MACHINES)
def test_a_program_for_another_processor_is_killed(machine):
    """A call in another processor's numbers would mean something else."""
    assert outcome(machine, 0, arch=0x40000003) == KILL


USES = {
    "numpy and scipy": "import numpy as np, scipy.linalg, scipy.optimize\n"
    "a = np.random.default_rng(0).random((300, 300))\nnp.linalg.svd(a @ a)\nscipy.linalg.expm(a)\n"
    "scipy.optimize.minimize(lambda x: x @ x, np.ones(3))",
    "threads of BLAS": "import subprocess, sys\ncode = 'import numpy as np; a = np.ones((500, 500));'\n"
    "code += 'print((a @ a)[0, 0], len(__import__(\"os\").sched_getaffinity(0)))'\n"
    "run = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True,\n"
    "    env={'OPENBLAS_NUM_THREADS': '4'})\nassert run.stdout.startswith('500.0'), run.stderr",
    "matplotlib": "import matplotlib.pyplot as plt\nplt.plot([1, 2])\nplt.title('Δ')\n"
    "plt.savefig('x.png')\nplt.savefig('x.pdf')",
    "cv2": "import cv2, numpy as np\nx = np.zeros((200, 200), np.uint8)\ncv2.GaussianBlur(x, (5, 5), 1)\n"
    "cv2.imwrite('x.png', x)\nassert cv2.imread('x.png') is not None",
    "pinocchio and pybullet": "import labkit as lk\nwith lk.Arm('left') as arm:\n"
    "    arm.model.mass_matrix(arm.state().q)\n    hold = lk.Hold(arm.state().q, 0.1)\n    lk.run(arm, hold, lambda s, t: lk.JointVelocity([0.0] * 7))",
    "processes": "import multiprocessing as m\nwith m.get_context('fork').Pool(2) as pool:\n"
    "    assert pool.map(abs, [-1, 2]) == [1, 2]\nq = m.get_context('fork').Queue()\nq.put(1)\n"
    "assert q.get() == 1\nm.Lock(); m.Value('d', 1.0)",
    "programs": "import subprocess\nassert subprocess.run(['ls', '/'], capture_output=True).stdout\n"
    "assert subprocess.check_output('echo hi | cat', shell=True) == b'hi\\n'",
    "threads": "import threading, concurrent.futures as f\nwith f.ThreadPoolExecutor(4) as e:\n"
    "    assert sum(e.map(abs, range(9))) == 36",
    "signals": "import signal\nhits = []\nsignal.signal(signal.SIGUSR1, lambda *a: hits.append(a))\n"
    "signal.raise_signal(signal.SIGUSR1)\nassert hits\nsignal.sigtimedwait([signal.SIGUSR2], 0.01)",
    "local sockets": "import socket\na, b = socket.socketpair()\na.send(b'x')\nassert b.recv(1) == b'x'\n"
    "s = socket.socket(socket.AF_UNIX)\ns.bind('here')\ns.listen()\n"
    "c = socket.socket(socket.AF_UNIX)\nc.connect('here')\nc.settimeout(1)",
    "asyncio": "import asyncio\nasync def f():\n    await asyncio.sleep(0.01)\n"
    "    p = await asyncio.create_subprocess_exec('true')\n    return await p.wait()\n"
    "assert asyncio.run(f()) == 0",
    "files": "import os, shutil, tempfile, mmap, sqlite3, zipfile\nos.mkdir('own')\n"
    "os.chdir('own')\nopen('a', 'w').write('x')\n"  # a course below /tmp lies in what is above
    "shutil.copy2('a', 'b')\nshutil.copytree('.', 'd', ignore=lambda *x: ['d'])\n"
    "os.rename('b', 'c')\nos.symlink('c', 'e')\nos.truncate('c', 0)\nos.utime('c')\nos.chmod('c', 0o600)\n"
    "with tempfile.TemporaryDirectory() as t:\n    zipfile.ZipFile(t + '/z', 'w').write('a')\n"
    "mmap.mmap(-1, 4096)[:1] = b'x'\nsqlite3.connect(':memory:').execute('create table t(x)')\n"
    "os.isatty(0)\nos.statvfs('.')\nos.listdir('.')\nnext(os.walk('.'))",
    "time and limits": "import os, time, resource, random, secrets, uuid, platform\ntime.sleep(0.001)\n"
    "time.process_time()\nresource.getrusage(resource.RUSAGE_SELF)\nrandom.SystemRandom().random()\n"
    "secrets.token_hex()\nuuid.uuid1()\nplatform.uname()\nos.nice(0)\nos.sched_getaffinity(0)\nos.times()",
}


@pytest.fixture
def run(sandbox):
    """Runs one cell in a session of its own; what it raised, empty if nothing."""

    def cell(source):
        with sandbox.spawn("student", Limits()) as inside:
            inside.connection.send({"cell": 0, "source": source, "answers": [], "seconds": 30.0})
            return inside.connection.read(60.0)["error"]

    return cell


@pytest.mark.parametrize("what", USES)
def test_what_the_labs_packages_call_passes(what, run):
    """Numerics with threads, pictures, simulation, processes, signals and local sockets work."""
    assert not run(USES[what])


@pytest.mark.parametrize(
    "call",
    [
        "import os\nos.memfd_create('x')",
        "import os\nos.pidfd_open(os.getpid())",
        "import os\nos.posix_fadvise(0, 0, 1, os.POSIX_FADV_DONTNEED)",
        "import os\nos.sendfile(1, 0, 0, 1)",
        "import fcntl\nfcntl.flock(open('/dev/null'), fcntl.LOCK_SH)",
        "import ctypes, os\nlibc = ctypes.CDLL(None, use_errno=True)\n"
        "if libc.inotify_init() < 0: raise OSError(ctypes.get_errno(), 'no')",
    ],
)
def test_what_nobody_needs_is_missing(call, run):
    """A call that is not named fails as on a kernel that does not have it."""
    assert "[Errno 38]" in run(call)
