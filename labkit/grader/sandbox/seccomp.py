"""A seccomp filter: the system calls that a student's process may make.

Allowed are those that Python, NumPy with its threads, the engines, OpenCV, Matplotlib,
`multiprocessing` and `subprocess` use.  Every other call, such as one that a later kernel adds,
fails with ENOSYS, as on a kernel without it, so that the C library falls back to an older call
(`clone3` to `clone`), and a program that probes for a feature does without it.

What asks or moves the page cache (preadv2, fadvise64, sendfile) and locks on files, which all
sandboxes share, are not allowed: one submission could tell another by them.
"""

from __future__ import annotations

import ctypes
import errno
import fcntl
import os
import socket
import termios
from ctypes import c_int, c_uint, c_uint64

ALLOWED = """
exit exit_group fork vfork execve wait4 waitid kill tkill tgkill getpid getppid gettid getuid
geteuid getgid getegid getresuid getresgid getgroups getpgrp getpgid setpgid getsid setsid prctl
arch_prctl set_tid_address rseq set_robust_list futex membarrier
brk mmap munmap mremap mprotect madvise msync
rt_sigaction rt_sigprocmask rt_sigreturn rt_sigpending rt_sigsuspend rt_sigtimedwait sigaltstack
restart_syscall pause alarm getitimer setitimer nanosleep clock_nanosleep clock_gettime
clock_getres gettimeofday time times
getrusage getrlimit setrlimit prlimit64 getpriority setpriority getcpu sched_yield
sched_getaffinity sched_setaffinity sched_getparam sched_getscheduler sched_get_priority_max
sched_get_priority_min
read write readv writev pread64 pwrite64 preadv pwritev lseek fsync fdatasync ftruncate truncate
fallocate dup dup2 dup3 close close_range pipe pipe2 select pselect6 poll ppoll epoll_create
epoll_create1 epoll_ctl epoll_wait epoll_pwait eventfd2
open openat stat lstat fstat newfstatat statx access faccessat faccessat2 readlink readlinkat
getdents64 getcwd chdir fchdir mkdir mkdirat rmdir unlink unlinkat rename renameat renameat2
link linkat symlink symlinkat chmod fchmod fchmodat umask utimensat statfs fstatfs
getxattr lgetxattr fgetxattr setxattr lsetxattr fsetxattr listxattr llistxattr flistxattr
bind connect listen accept accept4 getsockname getpeername getsockopt setsockopt sendto recvfrom
sendmsg recvmsg shutdown
uname getrandom
"""
"""Calls with any arguments, by name: processes, memory, signals and time, limits, reading and
writing, files by name, local sockets."""

_DESCRIPTORS = (termios.FIONBIO, termios.FIOCLEX, termios.FIONCLEX)
WITH_ARGUMENT = {
    "socket": (0, (socket.AF_UNIX,)),
    "socketpair": (0, (socket.AF_UNIX,)),
    "fcntl": (1, (*range(5), fcntl.F_DUPFD_CLOEXEC, 1031, 1032)),  # descriptors and pipes
    "ioctl": (1, (termios.TCGETS, termios.TIOCGWINSZ, termios.FIONREAD, *_DESCRIPTORS)),
}
"""Which argument of a call has to have one of which values: no network, locks, leases, typing."""
_NAMESPACES = 0x7E020080
"""Every CLONE_NEW... flag, time included: `clone` makes processes and threads alone."""

_ALLOW, _ERRNO = 0x7FFF0000, 0x00050000
_EQUAL, _MASKED = 4, 7


class _Compare(ctypes.Structure):
    """A condition on an argument, as libseccomp's ``struct scmp_arg_cmp``."""

    _fields_ = (("place", c_uint), ("how", c_int), ("first", c_uint64), ("second", c_uint64))


class Filter:
    """The filter, made by libseccomp for this machine's processor.

    Raises:
        OSError: libseccomp is missing, or refuses.
    """

    def __init__(self) -> None:
        self._library = ctypes.CDLL("libseccomp.so.2")
        self._library.seccomp_init.restype = ctypes.c_void_p
        self._filter = ctypes.c_void_p(self._library.seccomp_init(_ERRNO | errno.ENOSYS))
        for name in ALLOWED.split():
            self._allow(name)
        self._allow("clone", _Compare(0, _MASKED, _NAMESPACES, 0))
        for name, (place, values) in WITH_ARGUMENT.items():
            for value in values:
                self._allow(name, _Compare(place, _EQUAL, value, 0))

    def install(self) -> None:
        """Install the filter in this process and all its children, irrevocably.

        No program gives them new privileges from then on.
        """
        _check(self._library.seccomp_load(self._filter))

    def _allow(self, name: str, *only: _Compare) -> None:
        """Allow a call, perhaps with some arguments only, if this processor has it."""
        number = self._library.seccomp_syscall_resolve_name(name.encode())
        if number >= 0:
            some = (_Compare * len(only))(*only)
            add = self._library.seccomp_rule_add_array
            _check(add(self._filter, c_uint(_ALLOW), number, len(only), some))


def _check(result: int) -> None:
    if result:
        raise OSError(-result, f"the system call filter was refused: {os.strerror(-result)}")
