"""A seccomp filter: the system calls that a student's process may make.

The filter is a list of allowed calls (`syscalls`): those that Python, NumPy with its threads,
Pinocchio, PyBullet, OpenCV, Matplotlib, `multiprocessing` and `subprocess` use.  Every other call,
such as one that a later kernel adds, is refused.  It fails with ENOSYS, as on a kernel without it,
so that the C library falls back to an older call (`clone3` to `clone`), and a program that probes
for a feature does without it.

Five calls are allowed with some arguments only, and fail with EPERM otherwise: `clone` makes
processes and threads but not namespaces; `socket` and `socketpair` make sockets of AF_UNIX; `fcntl`
does not take locks or leases; `ioctl` only asks about terminals and descriptors.  Locks and leases
belong to files, which all sandboxes share, so one submission could send signals to another with
them.  `flock` is refused for the same reason.
"""

from __future__ import annotations

import ctypes
import errno
import fcntl
import platform
import socket
import struct
import termios
from collections.abc import Iterable, Iterator
from functools import cache

from .syscalls import ALLOWED, CONDITIONAL

_NAMESPACES = 0x7E020080  # every CLONE_NEW... flag, time included
_PIPE_SIZES = (1031, 1032)  # F_SETPIPE_SZ, F_GETPIPE_SZ
_ARGUMENTS: dict[str, tuple[int, tuple[int, ...]]] = {
    "socket": (0, (socket.AF_UNIX,)),
    "socketpair": (0, (socket.AF_UNIX,)),
    "fcntl": (
        1,
        (fcntl.F_DUPFD, fcntl.F_GETFD, fcntl.F_SETFD, fcntl.F_GETFL, fcntl.F_SETFL)
        + (fcntl.F_DUPFD_CLOEXEC, *_PIPE_SIZES),
    ),
    "ioctl": (
        1,
        (termios.TCGETS, termios.TIOCGWINSZ, termios.FIONREAD, termios.FIONBIO)
        + (termios.FIOCLEX, termios.FIONCLEX),
    ),
}
"""The argument of each call that the filter checks, and the values that it may have."""

_MACHINES = {"x86_64": (0, 0xC000003E), "aarch64": (1, 0xC00000B7)}
"""The column of a processor in `syscalls`, and its number in the kernel."""

_ALLOW, _KILL, _ERRNO = 0x7FFF0000, 0x80000000, 0x00050000
_LOAD, _EQUAL, _ANY_BIT, _RETURN = 0x20, 0x15, 0x45, 0x06
_NUMBER, _ARCH, _FIRST_ARGUMENT = 0, 4, 16  # offsets in the kernel's data; an argument has 8 bytes


def supported() -> bool:
    """Whether a filter can be made for this machine's processor."""
    return platform.machine() in _MACHINES


@cache
def program(machine: str) -> bytes:
    """The filter as instructions for the kernel, compiled once, before the first fork.

    Args:
        machine: "x86_64" or "aarch64".
    """
    return b"".join(struct.pack("HBBI", *step) for step in _steps(*_MACHINES[machine]))


def _steps(column: int, arch: int) -> Iterator[tuple[int, int, int, int]]:
    """The instructions: code, number to skip if true, number to skip if false, value."""
    allow = (_RETURN, 0, 0, _ALLOW)
    yield _LOAD, 0, 0, _ARCH
    yield _EQUAL, 1, 0, arch
    yield _RETURN, 0, 0, _KILL
    yield _LOAD, 0, 0, _NUMBER
    for numbers in ALLOWED.values():
        number = numbers[column]
        if number is not None:
            yield _EQUAL, 0, 1, number
            yield allow
    yield from _if_called(CONDITIONAL["clone"][column], 0, [(_ANY_BIT, 1, 0, _NAMESPACES), allow])
    for name, (place, values) in _ARGUMENTS.items():
        tests = [step for value in values for step in ((_EQUAL, 0, 1, value), allow)]
        yield from _if_called(CONDITIONAL[name][column], place, tests)
    yield _RETURN, 0, 0, _ERRNO | errno.ENOSYS


def _if_called(
    number: int, place: int, tests: Iterable[tuple[int, int, int, int]]
) -> Iterator[tuple[int, int, int, int]]:
    """Tests of an argument of one call; if it passes none of them, the call is refused."""
    steps = [
        (_LOAD, 0, 0, _FIRST_ARGUMENT + 8 * place),
        *tests,
        (_RETURN, 0, 0, _ERRNO | errno.EPERM),
    ]
    yield _EQUAL, 0, len(steps), number
    yield from steps


def install(libc: ctypes.CDLL) -> None:
    """Install the filter in this process and all its children, irrevocably.

    Raises:
        OSError: The kernel refused the filter.
    """
    code = program(platform.machine())
    buffer = ctypes.create_string_buffer(code, len(code))

    class Program(ctypes.Structure):
        _fields_ = (("length", ctypes.c_ushort), ("steps", ctypes.c_void_p))

    whole = Program(len(code) // 8, ctypes.cast(buffer, ctypes.c_void_p))
    if libc.prctl(22, 2, ctypes.byref(whole), 0, 0):  # PR_SET_SECCOMP, SECCOMP_MODE_FILTER
        raise OSError(ctypes.get_errno(), "the system call filter was refused")
