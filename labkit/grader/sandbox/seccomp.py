"""Which system calls a student's process may make: a small filter for the kernel.

A list of what is allowed (`syscalls`): what Python, NumPy with its threads, Pinocchio, PyBullet,
OpenCV, Matplotlib, `multiprocessing` and `subprocess` use.  A call that nobody thought of, or that
a later kernel adds, is thus refused.  It fails with ENOSYS, as on a kernel that does not have it,
so that the C library falls back to an older call (`clone3` to `clone`) and a program that probes
for a feature does without it.

Five calls are allowed for some arguments only, and fail with EPERM for others: `clone` makes
processes and threads, no namespaces; sockets are of AF_UNIX; `fcntl` takes no lock and no lease,
and `ioctl` asks only about terminals and descriptors.  Locks and leases belong to files, which all
sandboxes share, so one submission could signal to another by them; `flock` is refused for the same
reason.
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
"""Which argument of a call is looked at, and the values that it may have."""

_MACHINES = {"x86_64": (0, 0xC000003E), "aarch64": (1, 0xC00000B7)}
"""A processor's column in `syscalls`, and what the kernel calls it."""

_ALLOW, _KILL, _ERRNO = 0x7FFF0000, 0x80000000, 0x00050000
_LOAD, _EQUAL, _ANY_BIT, _RETURN = 0x20, 0x15, 0x45, 0x06
_NUMBER, _ARCH, _FIRST_ARGUMENT = 0, 4, 16  # where the kernel puts them; arguments have 8 bytes


def supported() -> bool:
    """Whether a filter can be made for this machine's processor."""
    return platform.machine() in _MACHINES


@cache
def program(machine: str) -> bytes:
    """The filter as the kernel's instructions; made once, before any process that it is put on.

    Args:
        machine: "x86_64" or "aarch64".
    """
    return b"".join(struct.pack("HBBI", *step) for step in _steps(*_MACHINES[machine]))


def _steps(column: int, arch: int) -> Iterator[tuple[int, int, int, int]]:
    """Each instruction: its code, how many to skip if it holds and if not, its value."""
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
    """For one call, tests of an argument; a call that passes none is refused."""
    steps = [
        (_LOAD, 0, 0, _FIRST_ARGUMENT + 8 * place),
        *tests,
        (_RETURN, 0, 0, _ERRNO | errno.EPERM),
    ]
    yield _EQUAL, 0, len(steps), number
    yield from steps


def install(libc: ctypes.CDLL) -> None:
    """Put the filter on this process and all its children, for good.

    Raises:
        OSError: The kernel refused.
    """
    code = program(platform.machine())
    buffer = ctypes.create_string_buffer(code, len(code))

    class Program(ctypes.Structure):
        _fields_ = (("length", ctypes.c_ushort), ("steps", ctypes.c_void_p))

    whole = Program(len(code) // 8, ctypes.cast(buffer, ctypes.c_void_p))
    if libc.prctl(22, 2, ctypes.byref(whole), 0, 0):  # PR_SET_SECCOMP, SECCOMP_MODE_FILTER
        raise OSError(ctypes.get_errno(), "the system call filter was refused")
