"""What keeps the children of a forkserver apart: namespaces, a user id alone, or nothing."""

from __future__ import annotations

import os
import platform
import shutil
import signal
import tempfile
from contextlib import suppress
from typing import Any

from . import confine, seccomp

TRIES = 50
"""How often a user's processes are killed before they count as immortal."""


class Bare:
    """Nothing: a folder and limits, where somebody typed ``--unsafe-no-isolation``."""

    def fork(self) -> int:
        """Fork; as `os.fork`."""
        return os.fork()

    def enter(self, limits: dict[str, Any], uid: int) -> None:
        """Confine this process, a child; here it goes to a new folder, within limits.

        Args:
            limits: See `labkit.grader.sandbox.limits.Limits`.
            uid: Of a user that is this sandbox's alone; 0 if nobody can be given one.
        """
        os.chdir(tempfile.mkdtemp(prefix="labkit-"))
        confine.set_limits(limits | {"processes": 4096})

    def kill(self, child: int, *, whole: bool) -> None:
        """Kill what a child started and, if ``whole``, the child too."""
        for pid in _family(child) - (set() if whole else {child}):
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        if whole:
            with suppress(ChildProcessError):
                os.waitpid(child, 0)

    def close(self) -> None:
        """Clear away what is left, at the end; here that ends with the sandbox."""


class Namespaces(Bare):
    """Bubblewrap's inside: each child has a process namespace, mounts and folders of its own."""

    def __init__(self) -> None:
        confine.lock_devices()
        confine.cover_kernel()
        seccomp.program(platform.machine())
        self._home = os.open("/proc/self/ns/pid", os.O_RDONLY)
        self._shown = confine.shown_below()

    def fork(self) -> int:
        """Fork; the child begins a process namespace."""
        confine.check(confine.libc.unshare(confine.NEW_PIDS), "unshare")
        child = os.fork()
        if child:
            confine.check(confine.libc.setns(self._home, confine.NEW_PIDS), "setns")
        return child

    def enter(self, limits: dict[str, Any], uid: int) -> None:
        """Take away everything; see `confine.confine`."""
        os.close(self._home)
        confine.confine(limits, uid, self._shown)


class ByUser(Bare):
    """A user id alone, for a container of one submission in which nothing can be mounted.

    The child is an unprivileged user behind the same filter of system calls, without network, with
    the same limits, in a folder that is its own.  It sees ``/proc`` and whatever files the
    container shows to everybody, and can fill its disk; what it must not see is for root alone.
    """

    def __init__(self) -> None:
        seccomp.program(platform.machine())
        self._folder = tempfile.mkdtemp(prefix="labkit-")
        os.chmod(self._folder, 0o711)

    def enter(self, limits: dict[str, Any], uid: int) -> None:
        """Become the user, in a folder of its own."""
        if not uid:
            raise PermissionError("only root can give a process another user id")
        confine.first_to_go()
        own = self._own(os.getpid())
        os.mkdir(own, 0o700)
        os.chown(own, uid, uid)
        os.environ.update(HOME=own, TMPDIR=own, IPYTHONDIR=own)
        tempfile.tempdir = own
        confine.renounce(limits, uid, own)

    def kill(self, child: int, *, whole: bool) -> None:
        """Kill the user's processes, wherever they went; without ``whole`` all but the child."""
        try:
            uid = os.stat(self._own(child)).st_uid
        except FileNotFoundError:  # it was ended before it had become the user
            super().kill(child, whole=whole)
            return
        if not whole:
            for pid in alive(uid) - {child}:
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            return
        end_user(uid)
        with suppress(ChildProcessError):
            os.waitpid(child, 0)
        shutil.rmtree(self._own(child), ignore_errors=True)

    def close(self) -> None:
        """End what still runs; the worker may have been killed in the middle of a submission."""
        for child in os.listdir(self._folder):
            self.kill(int(child), whole=True)
        shutil.rmtree(self._folder, ignore_errors=True)

    def _own(self, child: int) -> str:
        return f"{self._folder}/{child}"


def end_user(uid: int) -> None:
    """Kill all processes of a user, those included that they start meanwhile.

    Raises:
        OSError: Some cannot be killed.
    """
    for _ in range(TRIES):
        killer = os.fork()
        if not killer:
            try:
                os.setgroups([])
                os.setresgid(uid, uid, uid)
                os.setresuid(uid, uid, uid)
                os.kill(-1, signal.SIGKILL)  # at one go: all that this user may kill, but itself
            finally:
                os._exit(0)
        os.waitpid(killer, 0)
        if not alive(uid):
            return
    raise OSError(f"processes of user {uid} cannot be killed")


def alive(uid: int) -> set[int]:
    """Processes of a user that still run."""
    found = set()
    for name in filter(str.isdigit, os.listdir("/proc")):
        with suppress(OSError), open(f"/proc/{name}/status") as file:
            said = dict(line.split(":", 1) for line in file)
            if int(said["Uid"].split()[0]) == uid and said["State"].split()[0] not in ("Z", "X"):
                found.add(int(name))
    return found


def _family(child: int) -> set[int]:
    """A process and all that descends from it."""
    parents = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        with suppress(OSError, ValueError), open(f"/proc/{name}/stat") as file:
            parents[int(name)] = int(file.read().rpartition(")")[2].split()[1])
    family, size = {child}, 0
    while len(family) > size:
        size = len(family)
        family |= {pid for pid, parent in parents.items() if parent in family}
    return family
