"""Check which isolation this machine offers, and say how to get the rest."""

from __future__ import annotations

import platform
from collections.abc import Iterator
from dataclasses import dataclass
from textwrap import wrap

from ..sim import chosen
from .pages import render

DOCKER = (
    "--security-opt=seccomp=unconfined",
    "--security-opt=apparmor=unconfined",
    "--security-opt=systempaths=unconfined",
    "--cap-add=SYS_ADMIN",
    "--cap-add=NET_ADMIN",
)
"""The options of a container in which bubblewrap works: namespaces, mounts, and a network that is
only a loopback.  The sandbox has its own filter of system calls."""


@dataclass(frozen=True)
class Finding:
    """One thing that was checked.

    Attributes:
        what: The name of the thing, in a few words.
        fine: Whether the check passed.
        says: What was found, or the command that repairs it.
    """

    what: str
    fine: bool
    says: str

    def __str__(self) -> str:
        return f"[{'ok  ' if self.fine else 'FAIL'}] {self.what}: {self.says}"


def examine() -> Iterator[Finding]:
    """Check everything that grading needs; the sandbox last, by making one and trying it."""
    system = platform.system()
    says = f"{system} {platform.machine()}"
    if system != "Linux":
        says += f"; students can work here, and grading needs Linux: the container\n\n{elsewhere()}"
        yield Finding("system", False, says)
        return
    says += f", Python {platform.python_version()}, {chosen()}"
    yield Finding("system", True, says)
    yield from sandbox()


def sandbox() -> Iterator[Finding]:
    """Make a sandbox and try to get out of it."""
    from .sandbox.launch import NoIsolation, Sandbox, SandboxLost
    from .sandbox.limits import Limits, slowness

    try:
        with Sandbox() as made:
            process = made.start(Limits())
            process.send({"cell": 0, "source": _TRY, "answers": [], "seconds": 10.0})
            failed = str(process.read(30.0).get("error", "it did not answer"))
            yield Finding("sandbox", not failed, failed or made.level)
    except (NoIsolation, SandboxLost) as error:
        yield Finding("sandbox", False, f"{error}\n\n{elsewhere()}")
    yield Finding("speed", True, f"time limits are multiplied by {slowness():g} on this machine")


_TRY = """
import os, socket
machine = "/etc/passwd", "/etc/hostname", "/usr/share/doc", "/var/log"
seen = [*filter(os.path.exists, machine), *os.listdir("/proc")]
assert not seen, f"it sees {seen}"
try:
    socket.socket()
except OSError:
    pass
else:
    raise AssertionError("it has a network")
"""


def elsewhere() -> str:
    """How to get isolation in the places where people grade."""
    options = " ".join([*DOCKER, "--memory=8g", "--pids-limit=500", "IMAGE"])
    lines = " \\\n    ".join(wrap(f"docker run {options}", 80, break_on_hyphens=False))
    rights = [x.removeprefix("--cap-add=") for x in DOCKER if x.startswith("--cap-add=")]
    return render("isolation.txt.j2", docker_run=lines, capabilities=rights).rstrip()
