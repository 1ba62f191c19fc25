"""Check which isolation this machine offers, and say how to get the rest."""

from __future__ import annotations

import os
import platform
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from textwrap import wrap

from ..sim import installed
from .pages import render

DOCKER = (
    "--security-opt=seccomp=unconfined",
    "--security-opt=apparmor=unconfined",
    "--security-opt=systempaths=unconfined",
    "--cap-add=SYS_ADMIN",
    "--cap-add=NET_ADMIN",
)
"""The options of a container in which sandboxes can be made, with namespaces, mounts, and a network
that is only a loopback.  The sandbox has its own filter of system calls."""


@dataclass(frozen=True)
class Finding:
    """One thing that was checked.

    Attributes:
        what: The name of the thing, in a few words.
        fine: Whether the check passed.
        says: What was found, or the command that repairs it.
        needed: Whether grading is impossible without it.
    """

    what: str
    fine: bool
    says: str
    needed: bool = True

    def __str__(self) -> str:
        mark = "ok  " if self.fine else ("FAIL" if self.needed else "note")
        return f"[{mark}] {self.what}: {self.says}"


def examine() -> Iterator[Finding]:
    """Check everything that grading needs; the sandbox last, by making one and trying it."""
    system = platform.system()
    says = f"{system} {platform.machine()}"
    if system != "Linux":
        says += f"; students can work here, and grading needs Linux: the container\n\n{elsewhere()}"
        yield Finding("system", False, says)
        return
    yield Finding("system", True, says)
    yield from _linux()


def _linux() -> Iterator[Finding]:
    """Check a Linux machine."""
    from .sandbox import seccomp  # not every system has what these import
    from .sandbox.limits import slowness

    yield Finding("Python", True, f"{platform.python_version()}, {' and '.join(installed())}")
    missing = [x for x in ("nbgrader", "jupytext") if find_spec(x) is None]
    says = f"missing {', '.join(missing)}; type: pip install 'labkit[grader]'"
    yield Finding("instructor's packages", not missing, says if missing else "installed")
    program = shutil.which("bwrap")
    yield Finding("bubblewrap", program is not None, program or "missing")
    fine = seccomp.supported()
    yield Finding("filter of system calls", fine, platform.machine())
    yield from sandbox()
    yield Finding(
        "speed", True, f"time limits are multiplied by {slowness():g} on this machine", needed=False
    )


def sandbox() -> Iterator[Finding]:
    """Make a sandbox and try to get out of it."""
    from .sandbox.launch import Sandbox, SandboxLost
    from .sandbox.limits import Limits
    from .sandbox.mounts import NoIsolation

    try:
        with Sandbox() as made, made.spawn("student", Limits()) as process:
            process.connection.send({"cell": 0, "source": _TRY, "answers": [], "seconds": 10.0})
            failed = str(process.connection.read(30.0).get("error", "it did not answer"))
            yield Finding("sandbox", not failed, failed or made.level)
            counted = made.group is not None
            says = made.group.description if made.group else (
                "no cgroup here: memory is limited for each process, not for all together; "
                "grade as root, or under `systemd-run --user --scope -p Delegate=yes`; "
                "a container's own --memory and --pids-limit hold for it as a whole"
            )  # fmt: skip
            yield Finding("limits of a whole sandbox", counted, says, needed=False)
            away = os.geteuid() == 0
            says = f"user {made.uid}" if away else "yours, without any rights, in a user namespace"
            yield Finding("a user of its own", away, says, needed=False)
    except (NoIsolation, SandboxLost) as error:
        yield Finding("sandbox", False, f"{error}\n\n{elsewhere()}")


_TRY = """
import os, socket
bad = []
try:
    socket.create_connection(("192.0.2.1", 80), 1)
    bad.append("it has a network")
except PermissionError:
    pass
except OSError as error:
    bad.append(f"sockets are not refused: {error}")
if len([x for x in os.listdir("/proc") if x.isdigit()]):
    bad.append("it sees processes")
try:
    open("/usr/x", "w")
    bad.append("it can write to /usr")
except OSError:
    pass
machine = "/etc/passwd", "/etc/hostname", "/usr/share/doc", "/var/log", "/sys/kernel"
if any(map(os.path.exists, machine)):
    bad.append("it sees files of the machine")
try:
    os.utime("/dev/null")
    bad.append("it can change devices")
except OSError:
    pass
import ctypes
if ctypes.CDLL(None).unshare(0x10000000) == 0:
    bad.append("it can make namespaces")
if bad:
    raise RuntimeError("; ".join(bad))
"""


def elsewhere() -> str:
    """How to get isolation in the places where people grade."""
    options = " ".join([*DOCKER, "--memory=8g", "--pids-limit=500", "IMAGE"])
    lines = " \\\n    ".join(wrap(f"docker run {options}", 80, break_on_hyphens=False))
    rights = [x.removeprefix("--cap-add=") for x in DOCKER if x.startswith("--cap-add=")]
    return render("isolation.txt.j2", docker_run=lines, capabilities=rights).rstrip()
