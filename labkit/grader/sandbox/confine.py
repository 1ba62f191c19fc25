"""Confinement of one process: its own mounts, no privileges, limits, a filter of system calls."""

from __future__ import annotations

import ctypes
import os
import re
import resource
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

from . import seccomp

DEVICES = ("/dev/null", "/dev/zero", "/dev/full", "/dev/random", "/dev/urandom")
"""Those that a sandbox has."""
_OWN = ("/tmp", "/dev/shm")
"""Folders in memory, new for each process that is confined."""
_NEW_MOUNTS, _NEW_IPC, NEW_PIDS = 0x00020000, 0x08000000, 0x20000000
_READ_ONLY, _NO_SUID, _NO_DEV, _REMOUNT, _BIND = 1, 2, 4, 32, 4096
_RECURSIVE, _PRIVATE = 16384, 1 << 18
_MEGA = 2**20

libc = ctypes.CDLL(None, use_errno=True)


def check(result: int, what: str) -> None:
    """Raise what the C library reported."""
    if result:
        number = ctypes.get_errno()
        raise OSError(number, f"{what}: {os.strerror(number)}")


def lock_devices() -> None:
    """Make the sandbox's devices read-only: they can be written to, but not changed.

    They are the machine's own, shown here, and times set on one would be seen by everybody.
    """
    for device in DEVICES:
        flags = os.statvfs(device).f_flag & (_NO_SUID | os.ST_NOEXEC)
        _mount(None, device, None, _REMOUNT | _BIND | _READ_ONLY | flags)


def cover_kernel() -> None:
    """Hide what the C library has read of the kernel; see `mounts`."""
    if os.path.exists("/sys"):
        _mount("tmpfs", "/sys", "tmpfs", _READ_ONLY | _NO_SUID | _NO_DEV, "size=0")


def shown_below() -> list[str]:
    """What the sandbox shows below the folders that are new for each process.

    A course below ``/tmp`` may have its Python there.
    """
    with open("/proc/self/mountinfo") as file:
        places = [re.sub(r"\\(\d{3})", _character, line.split()[4]) for line in file]
    below = [x for x in places if x.startswith(tuple(f"{own}/" for own in _OWN))]
    return [x for x in below if not any(x.startswith(f"{other}/") for other in below)]


def confine(limits: dict[str, Any], uid: int, shown: Sequence[str] = ()) -> None:
    """Take away from this process everything that a student's code does not need.

    It must be the first process of its own process namespace.

    Args:
        limits: See `labkit.grader.sandbox.limits.Limits`.
        uid: User and group to become; the present one if that is not root.
        shown: What `shown_below` found.

    Raises:
        OSError: Something could not be taken away.
    """
    check(libc.unshare(_NEW_MOUNTS | _NEW_IPC), "unshare")
    first_to_go()
    _mount(None, "/", None, _RECURSIVE | _PRIVATE)
    held = [(place, os.open(place, os.O_PATH)) for place in shown]
    size = f"size={limits['files'] * _MEGA},nr_inodes=4096,mode=1777"
    for place in _OWN:
        _mount("tmpfs", place, "tmpfs", _NO_SUID | _NO_DEV, size)
    for place, end in held:
        _show_again(place, end)
    _mount("tmpfs", "/proc", "tmpfs", _READ_ONLY | _NO_SUID | _NO_DEV, "size=0")
    renounce(limits, uid, "/tmp")


def first_to_go() -> None:
    """If memory runs out, the kernel ends this process and its children before any other."""
    with suppress(OSError), open("/proc/self/oom_score_adj", "w") as file:
        file.write("1000")


def renounce(limits: dict[str, Any], uid: int, folder: str) -> None:
    """Become a user without any rights, in a folder, within limits, behind the filter of calls."""
    if os.geteuid() == 0 and uid:
        with suppress(PermissionError):  # a user namespace has but one group
            os.setgroups([])
        os.setresgid(uid, uid, uid)
        os.setresuid(uid, uid, uid)
    drop_privileges()
    os.chdir(folder)
    os.umask(0o077)
    set_limits(limits)
    seccomp.install(libc)


def drop_privileges() -> None:
    """Give up every capability, for this process and all that it may start."""
    check(libc.prctl(38, 1, 0, 0, 0), "no new privileges")  # PR_SET_NO_NEW_PRIVS
    for capability in range(64):
        libc.prctl(24, capability, 0, 0, 0)  # PR_CAPBSET_DROP; unknown ones fail harmlessly
    header = (ctypes.c_uint32 * 2)(0x20080522, 0)
    check(libc.capset(header, (ctypes.c_uint32 * 6)()), "dropping capabilities")


def set_limits(limits: dict[str, Any]) -> None:
    """Limits of the kernel on processor time, memory, files and processes."""
    memory = limits["address_space"] + limits["memory"] * _MEGA
    for what, value in (
        (resource.RLIMIT_CPU, int(limits["wall"]) + 1),
        (resource.RLIMIT_AS, memory),
        (resource.RLIMIT_FSIZE, limits["files"] * _MEGA),
        (resource.RLIMIT_NPROC, limits["processes"]),
        (resource.RLIMIT_NOFILE, 128),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_MSGQUEUE, 0),
        (resource.RLIMIT_MEMLOCK, 0),
    ):
        resource.setrlimit(what, (value, value))


def address_space() -> int:
    """How much this process has mapped already, in bytes."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[0]) * resource.getpagesize()


def _character(octal: re.Match[str]) -> str:
    """What the kernel writes as its number: a space, a tab, a newline, a backslash."""
    return chr(int(octal[1], 8))


def _show_again(place: str, end: int) -> None:
    """Show what lay at a place before something was mounted above it, as read-only as it was."""
    before = f"/proc/self/fd/{end}"
    if os.path.isdir(before):
        os.makedirs(place)
    else:
        os.makedirs(os.path.dirname(place), exist_ok=True)
        open(place, "x").close()
    _mount(before, place, None, _BIND | _RECURSIVE)
    os.close(end)


def _mount(source: str | None, target: str, kind: str | None, flags: int, data: str = "") -> None:
    words = [None if x is None else x.encode() for x in (source, target, kind)]
    result = libc.mount(*words, ctypes.c_ulong(flags), data.encode() or None)
    check(result, f"mounting {target}")
