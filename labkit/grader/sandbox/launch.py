"""Start a sandbox: a forkserver in bubblewrap or, if asked for, only under a user id of its own.

In bubblewrap there is no network, no environment and no file but, read-only, the folders with the
system's programs and libraries, those of each Python involved (a virtual environment and the one
from which it was made), and labkit.  A course within a folder that is shown is
covered by an empty one.
"""

from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager, suppress
from dataclasses import asdict
from enum import Enum
from pathlib import Path
from typing import Any

import labkit

from ...errors import LabkitError
from .limits import BOX, Limits, kill_user, make_group, remove_group
from .protocol import Connection, ProtocolError

FIRST_UID = 64000
"""If root grades, each sandbox has its own user from this one on."""
DEVICES = ("/dev/null", "/dev/zero", "/dev/full", "/dev/random", "/dev/urandom")
"""The devices that bubblewrap shows."""
_PACKAGE = Path(labkit.__file__).parent
_PARTS = ("bin", "lib", "lib32", "lib64", "pyvenv.cfg")
"""The parts that are shown of the system, of ``/usr`` and of each Python."""
_MORE = ("/etc/ld.so.cache", "/etc/alternatives", "/sys/kernel/mm/transparent_hugepage")
_FORKSERVER = (sys.executable, "-P", "-s", "-m", "labkit.grader.sandbox.forkserver")
_VARIABLES = {
    "PATH": "/usr/bin:/bin",
    "PYTHONHASHSEED": "0",
    "PYTHONDONTWRITEBYTECODE": "1",
    "MPLBACKEND": "Agg",
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "GLIBC_TUNABLES": "glibc.malloc.hugetlb=1",
    "PYTHONMALLOC": "malloc",
}
"""The variables inside; the last two put what is loaded on pages of 2 MB, from glibc 2.35 on.

Each question is answered by a fork, which copies the page table, so larger pages save time: a
submission of four questions takes 0.88 of the processor time that it takes without the two.
"""


class NoIsolation(LabkitError):
    """This machine cannot isolate a student's code; the message says what to do."""


class SandboxLost(BaseException):
    """A sandbox was lost, at its start or later; a new one may work.

    This is not an `Exception`, so that marking never mistakes it for one that a student raised.
    """


class Isolation(Enum):
    """What isolates a student's code."""

    BUBBLEWRAP = "bubblewrap"
    USER = "user"

    @classmethod
    def of(cls, level: str) -> Isolation:
        """The isolation of a result, from its text; see `Sandbox.level`."""
        return cls.USER if level.startswith("user") else cls.BUBBLEWRAP


class Sandbox(AbstractContextManager["Sandbox"]):
    """A sandbox, for one submission at a time.

    Args:
        loads: Modules that submissions will import, loaded once for all of them.
        hidden: Folders that must not be visible inside, wherever they are.
        isolation: What isolates submissions; only an explicit choice is weaker than bubblewrap.

    Raises:
        NoIsolation: The sandbox cannot be made on this machine.
        SandboxLost: The sandbox was killed while it started.
    """

    def __init__(
        self,
        loads: Sequence[str] = (),
        hidden: Iterable[Path] = (),
        isolation: Isolation = Isolation.BUBBLEWRAP,
    ) -> None:
        make = _bubblewrap if isolation is Isolation.BUBBLEWRAP else _user
        command, variables = make([place.resolve() for place in hidden])
        self.isolation = isolation
        self.uid, self._claim = _own_user()
        self.group = make_group()
        self._log = os.memfd_create("labkit-sandbox-log")
        ours, theirs = socket.socketpair()
        self._forkserver = Connection(ours)
        with theirs:
            self.process = subprocess.Popen(
                [*command, *_FORKSERVER, isolation.value, *loads],
                stdin=theirs.fileno(),
                stdout=self._log,
                stderr=self._log,
                env=variables,
                process_group=0,
                preexec_fn=self._enter,
            )
        try:
            self._forkserver.read(120.0)
            self.start(Limits())
            self.end()
        except (ProtocolError, SandboxLost) as error:
            why = f"{error}; {self._last_log_line()}"
            self.close()
            if self.process.returncode not in (0, 1):
                raise SandboxLost(f"it was killed while it started: {why}") from None
            raise NoIsolation(f"no sandbox: {why}; `labkit doctor` says what is missing") from None

    def _enter(self) -> None:
        """Give the new process limits of its own, and end it first if the machine lacks memory."""
        _, most = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))
        with suppress(OSError):
            Path("/proc/self/oom_score_adj").write_text("1000")
        if self.group is not None:
            (self.group / "cgroup.procs").write_text(str(os.getpid()))

    @property
    def level(self) -> str:
        """What isolates a submission here, in one line."""
        who = f"id {self.uid}" if self.uid else "an unprivileged user"
        return f"{self.isolation.value}, {who}, seccomp, limits{', a cgroup' * bool(self.group)}"

    def start(self, limits: Limits, data: bytes | None = None) -> Connection:
        """Fork a new process inside, in place of the one before.

        Args:
            limits: What the process may use.
            data: A notebook, whose cells the process sends first.

        Raises:
            SandboxLost: The process could not be started; the student is not to blame.
        """
        ours, theirs = socket.socketpair()
        connection = Connection(ours)
        with theirs, open(os.memfd_create("notebook"), "w+b") as file:
            file.write(data or b"")
            file.seek(0)
            ends = [theirs.fileno()] + [file.fileno()] * (data is not None)
            self._request({"limits": asdict(limits), "uid": self.uid}, ends)
        try:
            reply = connection.read(20.0)
        except ProtocolError as error:
            raise SandboxLost(f"no process could be started: {error}") from None
        if "confined" not in reply:
            raise SandboxLost(f"a sandboxed process could not be confined: {reply}")
        return connection

    def end(self) -> None:
        """Kill the process and all that it started."""
        self._request({}, [])

    def close(self) -> None:
        """End all processes of the sandbox, and remove what belongs to it."""
        self._forkserver.close()  # the forkserver notices, and ends
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(5.0)
        with suppress(ProcessLookupError):  # bubblewrap killed early leaves a process
            os.killpg(self.process.pid, signal.SIGKILL)
        if self.isolation is Isolation.USER:
            kill_user(self.uid)
        self.process.wait()
        os.close(self._log)
        if self.group is not None:
            remove_group(self.group)
        self._claim.close()

    def __exit__(self, *_: object) -> None:
        self.close()

    def _request(self, message: dict[str, Any], ends: Sequence[int]) -> None:
        """Send a request to the forkserver, perhaps with open files, and wait for its reply."""
        try:
            socket.send_fds(self._forkserver.socket, [json.dumps(message).encode()], ends)
            self._forkserver.read(20.0)
        except (OSError, ProtocolError) as error:
            raise SandboxLost(f"{error}; {self._last_log_line()}") from None

    def _last_log_line(self) -> str:
        """The last line that bubblewrap or the forkserver wrote."""
        lines = os.pread(self._log, 100_000, 0).decode(errors="replace").strip().splitlines()
        return lines[-1][:300] if lines else "it said nothing"


def _bubblewrap(hidden: Sequence[Path]) -> tuple[list[str], dict[str, str]]:
    """The words before the forkserver's own, with which bubblewrap makes a sandbox for it.

    Returns:
        The words, and bubblewrap's own environment.

    Raises:
        NoIsolation: Bubblewrap is missing.
    """
    program = shutil.which("bwrap")
    if program is None:
        raise NoIsolation("bubblewrap is missing; type: apt-get install bubblewrap libseccomp2")
    words = [program, "--unshare-ipc", "--unshare-pid", "--unshare-net", "--unshare-uts"]
    words += ["--unshare-cgroup-try", "--die-with-parent", "--new-session", "--clearenv"]
    if os.geteuid():
        words += ["--unshare-user", "--uid", "0", "--gid", "0"]
    for capability in ("SYS_ADMIN", "SETUID", "SETGID", "KILL"):
        words += ["--cap-add", f"CAP_{capability}"]
    words += ["--perms", "1777", "--tmpfs", BOX, "--proc", "/proc"]
    words += ["--perms", "0755", "--tmpfs", "/dev", "--symlink", BOX, "/dev/shm"]
    for device in DEVICES:
        words += ["--dev-bind", device, device]
    shown = python_paths()
    words += disk(shown, hidden)
    if not any(place.is_relative_to("/tmp") for place in shown):
        words += ["--symlink", BOX, "/tmp"]
    words += ["--perms", "0755", "--dir", "/lab", "--ro-bind", str(_PACKAGE), "/lab/labkit"]
    inside = {"HOME": BOX, "TMPDIR": BOX, "IPYTHONDIR": BOX, "MPLCONFIGDIR": f"{BOX}/mpl"}
    for name, value in (_VARIABLES | inside | {"PYTHONPATH": "/lab"}).items():
        words += ["--setenv", name, value]
    words += ["--remount-ro", "/dev", "--remount-ro", "/", "--chdir", "/"]
    return words, {"PATH": os.environ.get("PATH", "/usr/bin:/bin")}


def _user(hidden: Sequence[Path]) -> tuple[list[str], dict[str, str]]:
    """No words, and the environment of a forkserver that isolates by user id alone.

    Raises:
        NoIsolation: This is not root, or another user can enter what must be hidden.
    """
    if os.geteuid():
        raise NoIsolation("only root can give a student's code another user id; run it as root")
    for place in hidden:
        if all(folder.stat().st_mode & 1 for folder in (place, *place.parents)):
            raise NoIsolation(f"every user can enter {place}; type: chmod 700 {place}")
    return [], _VARIABLES | {"PYTHONPATH": str(_PACKAGE.parent)}


def python_paths() -> list[Path]:
    """The paths that must be shown so that Python and its packages work."""
    program = Path(sys.executable)
    prefixes = {Path("/"), Path("/usr"), Path("/usr/local")}
    prefixes |= {Path(sys.prefix), Path(sys.base_prefix), program.parents[1]}
    while program.is_symlink():  # from a virtual environment to its Python
        program = Path(os.path.normpath(program.parent / os.readlink(program)))
        prefixes.add(program.parents[1])
    prefixes |= {prefix.resolve() for prefix in prefixes}
    places = [*(prefix / part for prefix in prefixes for part in _PARTS), *map(Path, _MORE)]
    return sorted(place for place in places if place.exists())


def disk(shown: Iterable[Path], hidden: Iterable[Path]) -> list[str]:
    """Bubblewrap's arguments for a disk that shows some places and nothing else.

    Args:
        shown: Places to show, read-only.
        hidden: Folders, without links in their paths, that are empty inside, by whatever path;
            a place to show within one is shown.
    """
    covers = {
        place / folder.relative_to(place.resolve())
        for place in shown
        for folder in hidden
        if folder.is_relative_to(place.resolve())
    }
    words: list[str] = []
    for place in sorted({*shown, *covers}, key=lambda place: len(place.parts)):
        for above in [*reversed(place.parents)][1:]:  # by default, only root could enter it
            words += ["--perms", "0755", "--dir", str(above)]
        path = str(place)
        words += (
            ["--perms", "0755", "--tmpfs", path] if place in covers else ["--ro-bind", path, path]
        )
    return words + [word for place in covers for word in ("--remount-ro", str(place))]


def _own_user() -> tuple[int, socket.socket]:
    """The id of a user that no other sandbox has, and a socket that reserves it until it is closed.

    The kernel counts processes by user, so two graders on one machine must not share a user.
    Without root it is 0, for this very user.
    """
    claim = socket.socket(socket.AF_UNIX)
    for uid in range(FIRST_UID, FIRST_UID + 1000):
        with suppress(OSError):
            claim.bind(f"\0labkit-sandbox-{uid}")  # freed however this process ends
            return 0 if os.geteuid() else uid, claim
    raise NoIsolation("all 1000 users for sandboxes are in use; stop other graders")
