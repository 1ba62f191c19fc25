"""Which system calls a student's process may make: a small filter, written for the kernel here.

A list of what is forbidden: everything that makes namespaces, mounts, looks into other processes,
talks to a network or widens the kernel's surface.  Forbidden calls fail with EPERM, so that a
program can say what it was refused.
"""

from __future__ import annotations

import ctypes
import errno
import platform
import socket
import struct

_X86 = (
    "ptrace 101 syslog 103 personality 135 vhangup 153 modify_ldt 154 pivot_root 155 adjtimex 159 "
    "chroot 161 acct 163 settimeofday 164 mount 165 umount2 166 swapon 167 swapoff 168 reboot 169 "
    "sethostname 170 setdomainname 171 iopl 172 ioperm 173 init_module 175 delete_module 176 "
    "quotactl 179 lookup_dcookie 212 clock_settime 227 kexec_load 246 add_key 248 request_key 249 "
    "keyctl 250 migrate_pages 256 unshare 272 move_pages 279 perf_event_open 298 "
    "name_to_handle_at 303 open_by_handle_at 304 clock_adjtime 305 setns 308 process_vm_readv 310 "
    "process_vm_writev 311 kcmp 312 finit_module 313 kexec_file_load 320 bpf 321 userfaultfd 323"
)
_ARM = (
    "lookup_dcookie 18 umount2 39 mount 40 pivot_root 41 chroot 51 vhangup 58 quotactl 60 acct 89 "
    "personality 92 unshare 97 kexec_load 104 init_module 105 delete_module 106 clock_settime 112 "
    "syslog 116 ptrace 117 reboot 142 sethostname 161 setdomainname 162 settimeofday 170 "
    "adjtimex 171 add_key 217 request_key 218 keyctl 219 swapon 224 swapoff 225 migrate_pages 238 "
    "move_pages 239 perf_event_open 241 name_to_handle_at 264 open_by_handle_at 265 "
    "clock_adjtime 266 setns 268 process_vm_readv 270 process_vm_writev 271 kcmp 272 "
    "finit_module 273 bpf 280 userfaultfd 282 kexec_file_load 294"
)
_NEW = (  # numbered alike on every machine
    "io_uring_setup 425 io_uring_enter 426 io_uring_register 427 open_tree 428 move_mount 429 "
    "fsopen 430 fsconfig 431 fsmount 432 fspick 433 pidfd_getfd 438 process_madvise 440 "
    "mount_setattr 442 quotactl_fd 443 memfd_secret 447"
)
_MACHINES = {
    "x86_64": (0xC000003E, _X86, {"clone": 56, "socket": 41}),
    "aarch64": (0xC00000B7, _ARM, {"clone": 220, "socket": 198}),
}
_CLONE3 = 435
_NAMESPACES = 0x7E020080  # every CLONE_NEW... flag, time included
_ALLOW, _KILL = 0x7FFF0000, 0x80000000
_ERRNO = 0x00050000
_LOAD, _EQUAL, _SET, _AT_LEAST, _RETURN = 0x20, 0x15, 0x45, 0x35, 0x06
_NUMBER, _ARCH, _FIRST_ARGUMENT = 0, 4, 16


def supported() -> bool:
    """Whether a filter can be made for this machine's processor."""
    return platform.machine() in _MACHINES


def program() -> bytes:
    """The filter as the kernel's instructions."""
    arch, calls, numbers = _MACHINES[platform.machine()]
    refuse = _step(_RETURN, _ERRNO | errno.EPERM)
    steps = [
        _step(_LOAD, _ARCH),
        _step(_EQUAL, arch, 1, 0),
        _step(_RETURN, _KILL),
        _step(_LOAD, _NUMBER),
        _step(_AT_LEAST, 0x40000000, 0, 1),  # the x32 interface has numbers of its own
        refuse,
    ]
    for number in map(int, f"{calls} {_NEW}".split()[1::2]):
        steps += [_step(_EQUAL, number, 0, 1), refuse]
    steps += [  # clone3 hides its flags behind a pointer; the C library then takes clone
        _step(_EQUAL, _CLONE3, 0, 1),
        _step(_RETURN, _ERRNO | errno.ENOSYS),
        _step(_EQUAL, numbers["clone"], 0, 4),
        _step(_LOAD, _FIRST_ARGUMENT),
        _step(_SET, _NAMESPACES, 0, 1),
        refuse,
        _step(_RETURN, _ALLOW),
        _step(_EQUAL, numbers["socket"], 0, 3),
        _step(_LOAD, _FIRST_ARGUMENT),
        _step(_EQUAL, int(socket.AF_UNIX), 1, 0),
        refuse,
        _step(_RETURN, _ALLOW),
    ]
    return b"".join(steps)


def install(libc: ctypes.CDLL) -> None:
    """Put the filter on this process and all its children, for good.

    Raises:
        OSError: The kernel refused.
    """
    code = program()
    buffer = ctypes.create_string_buffer(code, len(code))

    class Program(ctypes.Structure):
        _fields_ = (("length", ctypes.c_ushort), ("steps", ctypes.c_void_p))

    whole = Program(len(code) // 8, ctypes.cast(buffer, ctypes.c_void_p))
    if libc.prctl(22, 2, ctypes.byref(whole), 0, 0):  # PR_SET_SECCOMP, SECCOMP_MODE_FILTER
        raise OSError(ctypes.get_errno(), "the system call filter was refused")


def _step(code: int, value: int, yes: int = 0, no: int = 0) -> bytes:
    return struct.pack("HBBI", code, yes, no, value)
