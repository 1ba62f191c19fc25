"""What isolates the children of a forkserver: namespaces, only a user id, or nothing."""

from __future__ import annotations

import os
import platform
import shutil
import signal
import tempfile
from contextlib import suppress
from typing import Any

from . import confine, seccomp

KILL_ATTEMPTS = 50
"""How often the grader tries to kill a user's processes before it gives up."""


class Bare:
    """No isolation but a folder and limits, for ``--unsafe-no-isolation``."""

    def fork(self) -> int:
        """Fork, as `os.fork` does."""
        return os.fork()

    def enter(self, limits: dict[str, Any], uid: int) -> None:
        """Confine this process, a child; this class only sets limits and makes a new folder.

        Args:
            limits: See `labkit.grader.sandbox.limits.Limits`.
            uid: The id of a user that only this sandbox has; 0 if it has none.
        """
        os.chdir(tempfile.mkdtemp(prefix="labkit-"))
        confine.set_limits(limits | {"processes": 4096})

    def kill(self, child: int, *, whole: bool) -> None:
        """Kill all that a child started and, if ``whole``, the child, too."""
        for pid in _descendants(child) - (set() if whole else {child}):
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        if whole:
            with suppress(ChildProcessError):
                os.waitpid(child, 0)

    def close(self) -> None:
        """Remove what is left when the sandbox ends; here there is nothing to do."""


class Namespaces(Bare):
    """Namespaces inside bubblewrap: each child has its own processes, mounts and folders."""

    def __init__(self) -> None:
        confine.lock_devices()
        confine.hide_sys()
        seccomp.program(platform.machine())
        self._outer = os.open("/proc/self/ns/pid", os.O_RDONLY)
        self._shown = confine.mounts_under_tmp()

    def fork(self) -> int:
        """Fork; the child is the first process of a new process namespace."""
        confine.check(confine.libc.unshare(confine.NEW_PIDS), "unshare")
        child = os.fork()
        if child:
            confine.check(confine.libc.setns(self._outer, confine.NEW_PIDS), "setns")
        return child

    def enter(self, limits: dict[str, Any], uid: int) -> None:
        """Take away everything that the child does not need; see `confine.confine`."""
        os.close(self._outer)
        confine.confine(limits, uid, self._shown)


class ByUser(Bare):
    """Isolation by user id only, for a container of one submission that cannot mount anything.

    The child is an unprivileged user with its own folder, behind the same filter of system calls,
    without network and with the same limits.  It sees ``/proc`` and all files that the container
    shows to everybody, and it can fill the disk.  What it must not see belongs to root.
    """

    def __init__(self) -> None:
        seccomp.program(platform.machine())
        self._folder = tempfile.mkdtemp(prefix="labkit-")
        os.chmod(self._folder, 0o711)

    def enter(self, limits: dict[str, Any], uid: int) -> None:
        """Become the user, in a new folder that belongs to them."""
        if not uid:
            raise PermissionError("only root can give a process another user id")
        confine.raise_oom_score()
        own = self._folder_of(os.getpid())
        os.mkdir(own, 0o700)
        os.chown(own, uid, uid)
        os.environ.update(HOME=own, TMPDIR=own, IPYTHONDIR=own)
        tempfile.tempdir = own
        confine.drop_privileges(limits, uid, own)

    def kill(self, child: int, *, whole: bool) -> None:
        """Kill all processes of the user, but spare the child unless ``whole``."""
        try:
            uid = os.stat(self._folder_of(child)).st_uid
        except FileNotFoundError:  # the child ended before it had become the user
            super().kill(child, whole=whole)
            return
        if not whole:
            for pid in processes_of(uid) - {child}:
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            return
        kill_user(uid)
        with suppress(ChildProcessError):
            os.waitpid(child, 0)
        shutil.rmtree(self._folder_of(child), ignore_errors=True)

    def close(self) -> None:
        """Kill what still runs, as the worker may have been killed while it graded."""
        for child in os.listdir(self._folder):
            self.kill(int(child), whole=True)
        shutil.rmtree(self._folder, ignore_errors=True)

    def _folder_of(self, child: int) -> str:
        return f"{self._folder}/{child}"


def kill_user(uid: int) -> None:
    """Kill all processes of a user, including those that they start meanwhile.

    Raises:
        OSError: Some processes cannot be killed.
    """
    for _ in range(KILL_ATTEMPTS):
        killer = os.fork()
        if not killer:
            try:
                os.setgroups([])
                os.setresgid(uid, uid, uid)
                os.setresuid(uid, uid, uid)
                os.kill(-1, signal.SIGKILL)  # all that this user may kill, at once
            finally:
                os._exit(0)
        os.waitpid(killer, 0)
        if not processes_of(uid):
            return
    raise OSError(f"processes of user {uid} cannot be killed")


def processes_of(uid: int) -> set[int]:
    """The processes of a user that still run."""
    found = set()
    for name in filter(str.isdigit, os.listdir("/proc")):
        with suppress(OSError), open(f"/proc/{name}/status") as file:
            said = dict(line.split(":", 1) for line in file)
            if int(said["Uid"].split()[0]) == uid and said["State"].split()[0] not in ("Z", "X"):
                found.add(int(name))
    return found


def _descendants(child: int) -> set[int]:
    """A process and all its descendants."""
    parents = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        with suppress(OSError, ValueError), open(f"/proc/{name}/stat") as file:
            parents[int(name)] = int(file.read().rpartition(")")[2].split()[1])
    family, size = {child}, 0
    while len(family) > size:
        size = len(family)
        family |= {pid for pid, parent in parents.items() if parent in family}
    return family
