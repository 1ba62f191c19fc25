"""The first process in a sandbox: it loads what notebooks import, and forks for each submission.

It never runs students' code.  Each child gives up everything before it reads what a student wrote:
in bubblewrap it has its own processes, mounts and folder; else it is a user of its own.
"""

from __future__ import annotations

import ctypes
import gc
import json
import os
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import labkit

from . import runner, stubs
from .limits import BOX, kill_user
from .protocol import Connection
from .seccomp import Filter

LOADED = ("numpy", "scipy.linalg", "IPython.core.inputtransformer2", "matplotlib.font_manager")
"""Modules that most answers need; each of them makes every fork slower, so there are no more."""
_PYPLOT = "matplotlib.pyplot"
_NEW_MOUNTS, _NEW_IPC, _NEW_PIDS = 0x00020000, 0x08000000, 0x20000000
_READ_ONLY, _NO_SUID, _NO_DEV = 1, 2, 4
_SET_MOUNT, _HERE, _BELOW_TOO = 442, -100, 0x8000  # mount_setattr, from Linux 5.12 on
_RECURSIVE, _PRIVATE = 16384, 1 << 18
_ADOPTS = 36  # PR_SET_CHILD_SUBREAPER: orphans below become children of this process

_libc = ctypes.CDLL(None, use_errno=True)


class InBubblewrap:
    """Each child is the first process of its own namespaces, which end with it."""

    def __init__(self) -> None:
        self._outer = os.open("/proc/self/ns/pid", os.O_RDONLY)
        times = (ctypes.c_uint64 * 4)(_READ_ONLY)  # those of a device, which all sandboxes see
        _libc.syscall(_SET_MOUNT, _HERE, b"/dev", _BELOW_TOO, times, 32)

    def fork(self) -> int:
        """Fork; the child is the first process of a new process namespace."""
        _check(_libc.unshare(_NEW_PIDS))
        child = os.fork()
        if child:
            _check(_libc.setns(self._outer, _NEW_PIDS))
        return child

    def enter(self, uid: int, size: int) -> None:
        """Cover, in this process's own mounts, what others write to or can be seen in."""
        os.close(self._outer)
        _check(_libc.unshare(_NEW_MOUNTS | _NEW_IPC))
        _mount(b"", b"/", _RECURSIVE | _PRIVATE)
        room = f"size={size},nr_inodes=4096,mode=1777"
        _mount(b"tmpfs", BOX.encode(), _NO_SUID | _NO_DEV, room)
        _mount(b"tmpfs", b"/proc", _READ_ONLY | _NO_SUID | _NO_DEV, "size=0")
        os.chdir(BOX)

    def end(self, child: int, uid: int) -> None:
        """Kill a child and all that it started."""
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)


class AsUser:
    """Each child has its own folder, and a user id that no other sandbox has."""

    def __init__(self) -> None:
        _check(_libc.prctl(_ADOPTS, 1, 0, 0, 0))
        self._folder = ""

    def fork(self) -> int:
        """Fork, as `os.fork` does, with a new folder for the child."""
        self._folder = tempfile.mkdtemp(prefix="labkit-")
        return os.fork()

    def enter(self, uid: int, size: int) -> None:
        """Go to the folder, which becomes the user's."""
        os.chown(self._folder, uid, uid)
        os.environ.update(dict.fromkeys(("HOME", "TMPDIR", "IPYTHONDIR"), self._folder))
        tempfile.tempdir = self._folder
        os.chdir(self._folder)

    def end(self, child: int, uid: int) -> None:
        """Kill all processes of the user, and remove the folder."""
        kill_user(uid)
        with suppress(ChildProcessError):
            while True:
                os.waitpid(-1, 0)
        subprocess.run(["rm", "-rf", self._folder], check=False)


def main() -> None:
    """Serve the worker until it closes its socket, which is stdin.

    A request that comes with a socket is for a process at its other end; one without ends the
    process.  There is one at a time.
    """
    how, *modules = sys.argv[1:]
    worker = Connection(socket.socket(fileno=os.dup(0)))
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 0)
    os.dup2(nowhere, 1)
    _load(modules)
    children = AsUser() if how == "user" else InBubblewrap()
    only, loaded = Filter(), int(Path("/proc/self/statm").read_text().split()[0])
    gc.collect()
    gc.freeze()
    worker.send({"ready": True})
    child = uid = 0
    while True:
        worker.socket.settimeout(None)  # it may judge for long
        data, ends, _, _ = socket.recv_fds(worker.socket, 65536, 2)
        if child:
            children.end(child, uid)
            child = 0
        if not data:
            return
        if ends:
            request = json.loads(data)
            uid = request["uid"]
            child = children.fork()
            if not child:
                break
        for end in ends:
            os.close(end)
        worker.send({"done": True})
    worker.close()
    os.dup2(nowhere, 2)
    connection = Connection(socket.socket(fileno=ends[0]))
    try:
        children.enter(uid, request["limits"]["files"] << 20)
        _confine(request["limits"], uid, loaded * resource.getpagesize(), only)
        connection.send({"confined": True})
        runner.serve(connection, request["limits"], ends[1:])
    except BaseException:
        with suppress(BaseException):
            connection.send({"failed": traceback.format_exc(limit=3)[-2000:]})
    os._exit(0)


def _load(modules: Sequence[str]) -> None:
    """Import what notebooks use, pyplot only when it is used, and install the stubs."""
    sys.modules[_PYPLOT] = _Pyplot(_PYPLOT)
    for name in (*LOADED, *modules):
        import_module(name)
    vars(sys.modules["matplotlib"])["pyplot"] = sys.modules[_PYPLOT]
    with labkit.Arm("left") as arm:  # the physics engine and the model load what they need
        arm.model.mass_matrix(arm.state().q)
    stubs.install()


class _Pyplot(ModuleType):
    """Matplotlib's pyplot, which takes long to import, as soon as something of it is used."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        sys.modules.pop(_PYPLOT, None)
        vars(self).update(vars(import_module(_PYPLOT)))
        return vars(self)[name]


def _confine(limits: dict[str, Any], uid: int, space: int, only: Filter) -> None:
    """Become an unprivileged user with limits, for good."""
    if uid:
        os.setgroups([])
        os.setresgid(uid, uid, uid)
        os.setresuid(uid, uid, uid)
    header = (ctypes.c_uint32 * 2)(0x20080522, 0)
    _check(_libc.capset(header, (ctypes.c_uint32 * 6)()))  # not one capability
    os.umask(0o077)
    for what, value in (
        (resource.RLIMIT_CPU, int(limits["wall"]) + 1),
        (resource.RLIMIT_AS, space + (limits["memory"] << 20)),
        (resource.RLIMIT_FSIZE, limits["files"] << 20),
        (resource.RLIMIT_NPROC, limits["processes"]),
        (resource.RLIMIT_NOFILE, 128),
        (resource.RLIMIT_CORE, 0),
    ):
        resource.setrlimit(what, (value, value))
    only.install()


def _mount(source: bytes, target: bytes, flags: int, data: str = "") -> None:
    _check(_libc.mount(source, target, source or None, ctypes.c_ulong(flags), data.encode()))


def _check(result: int) -> None:
    """Raise an OSError if a call of the C library failed."""
    if result:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


if __name__ == "__main__":
    main()
