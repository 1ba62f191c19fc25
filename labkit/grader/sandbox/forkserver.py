"""The forkserver, first process in a sandbox: loads what notebooks import, forks for each session.

It runs no student's code.  Parsers are forked from a twin of it that has loaded next to nothing,
which is quicker.  Each child becomes the first process of its own process namespace and
gives up everything (see `confine`) before it reads a word that a student wrote.
"""

from __future__ import annotations

import ctypes
import gc
import json
import os
import platform
import shutil
import signal
import socket
import sys
import tempfile
import traceback
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from typing import Any

from . import confine, seccomp
from . import parse as cells
from .protocol import Connection, Disconnected

MAGIC = "IPython.core.inputtransformer2"
"""What reads a notebook's own ``%`` and ``!`` lines."""
LOADED = (
    "numpy",
    "scipy.interpolate",
    "scipy.linalg",
    "matplotlib.pyplot",
    MAGIC,
)
"""What cells import that answers lean on, loaded once, before the forks.

Not more than that: each fork costs time in proportion to what is loaded.
"""
_COLLAPSE = 25  # MADV_COLLAPSE, since Linux 6.1
_HUGE = 2**21  # bytes


def main() -> None:
    """Serve the worker until it goes away: at the end of stdin for students, of stdout for parsers.

    Modules named on the command line are loaded too.  With ``--bare`` nothing is confined; see
    `labkit grade --unsafe-no-isolation`.
    """
    words = sys.argv[1:]
    bare = "--bare" in words
    students, parsers = (socket.socket(fileno=os.dup(number)) for number in (0, 1))
    if not bare:
        confine.lock_devices()
        seccomp.program(platform.machine())
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 0)
    os.dup2(nowhere, 1)
    codec = withhold = serve = None
    if os.fork():
        control = students
        parsers.close()
        codec, withhold, serve = _load([word for word in words if word != "--bare"])
    else:
        control = parsers
        students.close()
        import_module(MAGIC)
    space = confine.address_space()
    gc.collect()
    gc.freeze()
    _into_huge_pages()
    home = None if bare else os.open("/proc/self/ns/pid", os.O_RDONLY)
    shown = [] if bare else confine.shown_below()
    line = Connection(control)
    line.send({"ready": True})
    while True:
        try:
            asked, ends = _read(control)
        except Disconnected:
            return
        if "kill" in asked:
            _end(asked["kill"], whole=asked["whole"])
            line.send({"killed": asked["kill"]})
            continue
        if home is not None:
            confine.check(confine.libc.unshare(confine.NEW_PIDS), "unshare")
        child = os.fork()
        if child:
            if home is not None:
                confine.check(confine.libc.setns(home, confine.NEW_PIDS), "setns")
            os.close(ends[0])
            line.send({"pid": child})
            continue
        os.dup2(nowhere, 2)
        end = Connection(socket.socket(fileno=ends[0]))
        try:
            control.close()
            limits = asked["limits"] | {"address_space": space}
            if home is None:
                os.chdir(tempfile.mkdtemp(prefix="labkit-"))
                confine.set_limits(limits | {"processes": 4096})
            else:
                os.close(home)
                confine.confine(limits, asked["uid"], shown)
            end.send({"confined": True})
            if serve is None:
                end.send(cells.read(_bytes(end, asked["size"])))
            else:
                serve(end, codec, withhold, asked["limits"])
        except BaseException:
            with suppress(BaseException):
                end.send({"failed": traceback.format_exc(limit=3)[-2000:]})
        os._exit(0)


def _load(more: Sequence[str]) -> tuple[Any, Any, Any]:
    """Import what notebooks use, and put the stubs in place."""
    with suppress(FileNotFoundError, KeyError):
        shutil.copytree("/lab/mpl", os.environ["MPLCONFIGDIR"])  # making the list of fonts is slow
    for name in (*LOADED, *more):
        import_module(name)
    import labkit
    from labkit.course import serialize as codec
    from labkit.course.withheld import withhold

    from . import stubs as standins
    from .runner import serve

    with labkit.Arm("left") as arm:  # the physics engine and the model load what they need
        arm.model.mass_matrix(arm.state().q)
    standins.install()
    return codec, withhold, serve


def _into_huge_pages() -> None:
    """Let the kernel keep what is loaded in large pages; a fork copies the table of all pages.

    A kernel that cannot refuses, and forks take longer.
    """
    with open("/proc/self/maps") as file:
        areas = [line.split() for line in file]
    for span, rights, _, _, inode, *name in areas:
        if rights.startswith("rw") and inode == "0" and name in ([], ["[heap]"]):
            begin, end = (int(x, 16) for x in span.split("-"))
            first = -(-begin // _HUGE) * _HUGE
            size = (end - first) // _HUGE * _HUGE
            if size > 0:
                confine.libc.madvise(ctypes.c_void_p(first), ctypes.c_size_t(size), _COLLAPSE)


def _read(control: socket.socket) -> tuple[dict[str, Any], list[int]]:
    control.settimeout(None)
    data, ends, _, _ = socket.recv_fds(control, 65536, 1)
    if not data:
        raise Disconnected("the worker is gone")
    message: dict[str, Any] = json.loads(data)
    return message, ends


def _bytes(end: Connection, size: int) -> bytes:
    data = bytearray()
    end.socket.settimeout(30.0)
    while len(data) < size:
        piece = end.socket.recv(min(1 << 20, size - len(data)))
        if not piece:
            raise Disconnected("the file never came")
        data += piece
    return bytes(data)


def _end(child: int, *, whole: bool) -> None:
    """Kill a submission's process namespace, or only what its first process has started."""
    for pid in _family(child) - (set() if whole else {child}):
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
    if whole:
        with suppress(ChildProcessError):
            os.waitpid(child, 0)


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


if __name__ == "__main__":
    main()
