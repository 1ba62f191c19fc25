"""Confine one process: its own mounts, no privileges, limits, and a system call filter."""

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
"""The devices that a sandbox has."""
_PRIVATE_FOLDERS = ("/tmp", "/dev/shm")
"""Folders in memory that each confined process has for itself."""
_NEW_MOUNTS, _NEW_IPC, NEW_PIDS = 0x00020000, 0x08000000, 0x20000000
_READ_ONLY, _NO_SUID, _NO_DEV, _REMOUNT, _BIND = 1, 2, 4, 32, 4096
_RECURSIVE, _PRIVATE = 16384, 1 << 18
_MEGA = 2**20

libc = ctypes.CDLL(None, use_errno=True)


def check(result: int, what: str) -> None:
    """Raise an OSError if a call of the C library failed."""
    if result:
        number = ctypes.get_errno()
        raise OSError(number, f"{what}: {os.strerror(number)}")


def lock_devices() -> None:
    """Mount the sandbox's devices read-only: they can still be written to, but not changed.

    They are the devices of the machine itself, so every sandbox would see a change of their times.
    """
    for device in DEVICES:
        flags = os.statvfs(device).f_flag & (_NO_SUID | os.ST_NOEXEC)
        _mount(None, device, None, _REMOUNT | _BIND | _READ_ONLY | flags)


def hide_sys() -> None:
    """Hide ``/sys``, which the C library has read by now; see `mounts`."""
    if os.path.exists("/sys"):
        _mount("tmpfs", "/sys", "tmpfs", _READ_ONLY | _NO_SUID | _NO_DEV, "size=0")


def mounts_under_tmp() -> list[str]:
    """The mounts below the folders that each confined process has for itself.

    The Python of a course below ``/tmp``, for example, is mounted there.
    """
    with open("/proc/self/mountinfo") as file:
        places = [re.sub(r"\\(\d{3})", _unescape, line.split()[4]) for line in file]
    below = [x for x in places if x.startswith(tuple(f"{own}/" for own in _PRIVATE_FOLDERS))]
    return [x for x in below if not any(x.startswith(f"{other}/") for other in below)]


def confine(limits: dict[str, Any], uid: int, shown: Sequence[str] = ()) -> None:
    """Take away everything from this process that a student's code does not need.

    The process must be the first one of its own process namespace.

    Args:
        limits: See `labkit.grader.sandbox.limits.Limits`.
        uid: The id of the user and group to become; ignored unless this is root.
        shown: What `mounts_under_tmp` found.

    Raises:
        OSError: Something could not be taken away.
    """
    check(libc.unshare(_NEW_MOUNTS | _NEW_IPC), "unshare")
    raise_oom_score()
    _mount(None, "/", None, _RECURSIVE | _PRIVATE)
    held = [(place, os.open(place, os.O_PATH)) for place in shown]
    size = f"size={limits['files'] * _MEGA},nr_inodes=4096,mode=1777"
    for place in _PRIVATE_FOLDERS:
        _mount("tmpfs", place, "tmpfs", _NO_SUID | _NO_DEV, size)
    for place, end in held:
        _mount_again(place, end)
    _mount("tmpfs", "/proc", "tmpfs", _READ_ONLY | _NO_SUID | _NO_DEV, "size=0")
    drop_privileges(limits, uid, "/tmp")


def raise_oom_score() -> None:
    """Make the kernel end this process and its children first if memory runs out."""
    with suppress(OSError), open("/proc/self/oom_score_adj", "w") as file:
        file.write("1000")


def drop_privileges(limits: dict[str, Any], uid: int, folder: str) -> None:
    """Become an unprivileged user in a folder, with limits and the filter of system calls."""
    if os.geteuid() == 0 and uid:
        with suppress(PermissionError):  # a user namespace has only one group
            os.setgroups([])
        os.setresgid(uid, uid, uid)
        os.setresuid(uid, uid, uid)
    drop_capabilities()
    os.chdir(folder)
    os.umask(0o077)
    set_limits(limits)
    seccomp.install(libc)


def drop_capabilities() -> None:
    """Give up every capability, for this process and for all that it starts."""
    check(libc.prctl(38, 1, 0, 0, 0), "no new privileges")  # PR_SET_NO_NEW_PRIVS
    for capability in range(64):
        libc.prctl(24, capability, 0, 0, 0)  # PR_CAPBSET_DROP; unknown ones fail harmlessly
    header = (ctypes.c_uint32 * 2)(0x20080522, 0)
    check(libc.capset(header, (ctypes.c_uint32 * 6)()), "dropping capabilities")


def set_limits(limits: dict[str, Any]) -> None:
    """Set the kernel's limits on processor time, memory, files and processes."""
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
    """The size of what this process has mapped so far, in bytes."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[0]) * resource.getpagesize()


def _unescape(octal: re.Match[str]) -> str:
    """The character that the kernel escaped: a space, a tab, a newline or a backslash."""
    return chr(int(octal[1], 8))


def _mount_again(place: str, end: int) -> None:
    """Mount again what was at a place before its parent was covered; it stays read-only."""
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
