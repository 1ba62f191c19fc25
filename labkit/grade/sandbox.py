"""A sandbox: bubblewrap around a process that forks for each submission.

No network, no environment, no files but Python and labkit, a folder in memory that dies with the
submission.
"""

from __future__ import annotations

import itertools
import json
import os
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import labkit

from ..errors import LabkitError
from .cgroup import Group
from .inside import seccomp
from .inside.wire import Gone, Line, TooLate, TooMuch
from .limits import Limits

MEND = "apt-get install bubblewrap"
FIRST_UID = 64000
MOST_USERS = 1000
"""When root grades, each sandbox is given a user of its own among these."""
_LAB = "/lab"
_ROLES = ("student", "parse")  # the ends of stdin and of stdout of the process inside
_numbers = itertools.count()


class NoIsolation(LabkitError):
    """This machine cannot keep a student's code apart; the sentence says how it could."""


class Broken(BaseException):
    """A sandbox that worked does not any more; a fresh one may.

    No `Exception`, so that marking never takes it for one of the student's.
    """


class Inside:
    """A process in the sandbox, the line to it, and the line to what forked it."""

    def __init__(self, line: Line, parent: Line, pid: int) -> None:
        self.line, self.parent, self.pid = line, parent, pid


class Sandbox:
    """One sandbox, for one submission at a time.

    Args:
        loads: Modules that submissions will import, to be loaded once for all.
        isolated: False only if somebody typed ``--unsafe-no-isolation``.

    Raises:
        NoIsolation: It cannot be made here.
    """

    def __init__(self, loads: Sequence[str] = (), *, isolated: bool = True) -> None:
        self.uid, self._claim = _user()
        self.isolated = isolated
        self.group = Group.make(f"labkit-{os.getpid()}-{next(_numbers)}") if isolated else None
        self._log = os.memfd_create("labkit-sandbox-log")
        ends = [socket.socketpair() for _ in _ROLES]
        self._lines = {role: Line(ours) for role, (ours, _) in zip(_ROLES, ends, strict=True)}
        stdin, stdout = (theirs for _, theirs in ends)
        try:
            self.process = subprocess.Popen(
                [*(command() if isolated else _bare()), *loads],
                stdin=stdin.fileno(),
                stdout=stdout.fileno(),
                stderr=self._log,
                env=environment() if isolated else _bare_environment(),
                preexec_fn=None if self.group is None else self.group.enter,
            )
        except OSError as error:
            raise NoIsolation(f"no sandbox: {error}; try: {MEND}") from None
        finally:
            stdin.close()
            stdout.close()
        try:
            for line in self._lines.values():
                line.read(120.0)
        except (Gone, TooLate, TooMuch):
            said = self._words()
            self.close()
            raise NoIsolation(
                f"the sandbox did not start: {said}; `labkit doctor` says what is missing"
            ) from None

    @property
    def level(self) -> str:
        """What keeps a submission apart here, in a line."""
        if not self.isolated:
            return "none (asked for by --unsafe-no-isolation)"
        who = f"user {self.uid}" if self.uid else "an unprivileged user"
        group = self.group.says if self.group else "no cgroup"
        return f"bubblewrap, {who}, no network, seccomp, limits, {group}"

    @contextmanager
    def enter(self, role: str, limits: Limits, **more: Any) -> Iterator[Inside]:
        """A fresh process inside, for as long as the block runs; nothing of it stays.

        Args:
            role: "student" or "parse".
            limits: What it may use.
            more: What else it is told.
        """
        ours, theirs = socket.socketpair()
        message = {"limits": limits.data(), "uid": self.uid, **more}
        parent = self._lines[role]
        with theirs:
            pid = int(self._ask(parent, message, theirs)["pid"])
        inside = Inside(Line(ours), parent, pid)
        try:
            try:
                said = inside.line.read(20.0)
            except (Gone, TooLate, TooMuch) as error:
                raise Broken(f"nothing could be started: {error}") from None
            if "confined" not in said:
                raise NoIsolation(f"a sandboxed process could not be confined: {said}")
            yield inside
        finally:
            ours.close()
            self.kill(inside, whole=True)

    def kill(self, inside: Inside, *, whole: bool = False) -> None:
        """Kill a process inside and all that it started, or only what it started."""
        self._ask(inside.parent, {"kill": inside.pid, "whole": whole})

    def close(self) -> None:
        """End everything inside."""
        for line in self._lines.values():
            line.close()  # the first processes inside see it, and go
        try:
            self.process.wait(2.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.close(self._log)
        if self.group is not None:
            self.group.remove()
        if self._claim is not None:
            self._claim.close()

    def __enter__(self) -> Sandbox:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _ask(
        self, line: Line, message: dict[str, Any], end: socket.socket | None = None
    ) -> dict[str, Any]:
        """Tell one of the first processes what to do, and take its word that it is done."""
        try:
            data = json.dumps(message).encode()
            socket.send_fds(line.end, [data], [end.fileno()] if end else [])
            return line.read(20.0)
        except (OSError, Gone, TooLate, TooMuch) as error:
            raise Broken(f"{error}; it said: {self._words()}") from None

    def _words(self) -> str:
        lines = os.pread(self._log, 100_000, 0).decode(errors="replace").strip().splitlines()
        return lines[-1][:300] if lines else "it gave no reason"


def _user() -> tuple[int, socket.socket | None]:
    """A user that no other sandbox has, and what keeps it ours until it is closed; 0 without root.

    The kernel counts processes by user, so two graders on one machine must not share one.
    """
    if os.geteuid():
        return 0, None
    for uid in range(FIRST_UID, FIRST_UID + MOST_USERS):
        claim = socket.socket(socket.AF_UNIX)
        try:
            claim.bind(f"\0labkit-sandbox-{uid}")  # goes with the process, however that ends
        except OSError:
            claim.close()
            continue
        return uid, claim
    raise NoIsolation(f"all {MOST_USERS} users for sandboxes are taken; end some graders")


def command() -> list[str]:
    """The command that makes a sandbox with `inside.zygote` in it.

    Raises:
        NoIsolation: There is no bubblewrap, or no filter for this processor.
    """
    program = shutil.which("bwrap")
    if program is None:
        raise NoIsolation(f"bubblewrap is missing; get it with: {MEND}")
    if not seccomp.supported():
        raise NoIsolation("no system call filter for this processor; grade on x86-64 or arm64")
    words = [program, "--unshare-ipc", "--unshare-pid", "--unshare-net", "--unshare-uts"]
    words += ["--unshare-cgroup-try", "--die-with-parent", "--new-session", "--clearenv"]
    if os.geteuid():
        words += ["--unshare-user", "--uid", "0", "--gid", "0"]
    for capability in ("SYS_ADMIN", "SETUID", "SETGID", "SETPCAP", "KILL"):
        words += ["--cap-add", f"CAP_{capability}"]
    made: set[Path] = set()
    shown: list[Path] = []
    for place in _places():
        if not any(place.is_relative_to(other) for other in shown):
            words += _folders(place.parent, made)
            link = os.readlink(place) if place.is_symlink() else ""
            words += ["--symlink", link] if link else ["--ro-bind", str(place)]
            words.append(str(place))
            shown.append(place)
    for optional in ("/etc/ld.so.cache", "/etc/alternatives", "/etc/localtime"):
        words += ["--ro-bind-try", optional, optional]
    package = Path(labkit.__file__).parent
    words += ["--perms", "0755", "--dir", _LAB, "--ro-bind", str(package), f"{_LAB}/labkit"]
    words += ["--ro-bind", str(_figure_cache()), f"{_LAB}/mpl"]
    words += ["--proc", "/proc", "--dev", "/dev", "--perms", "1777", "--tmpfs", "/tmp"]
    for name, value in _VARIABLES.items():
        words += ["--setenv", name, value]
    words += ["--remount-ro", "/", "--chdir", "/"]
    return [*words, sys.executable, "-s", "-m", "labkit.grade.inside.zygote"]


_VARIABLES = {
    "PATH": "/usr/bin:/bin",
    "HOME": "/tmp",
    "PYTHONPATH": _LAB,
    "PYTHONHASHSEED": "0",
    "PYTHONDONTWRITEBYTECODE": "1",
    "MPLBACKEND": "Agg",
    "MPLCONFIGDIR": "/tmp/mpl",
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "LC_ALL": "C.UTF-8",
    "IPYTHONDIR": "/tmp/ipython",
}


def environment() -> dict[str, str]:
    """What bubblewrap itself is given."""
    return {"PATH": os.environ.get("PATH", "/usr/bin:/bin")}


def _bare() -> list[str]:
    return [sys.executable, "-m", "labkit.grade.inside.zygote", "--bare"]


def _bare_environment() -> dict[str, str]:
    return (
        dict(os.environ)
        | {
            k: v
            for k, v in _VARIABLES.items()
            if k not in {"PATH", "HOME", "MPLCONFIGDIR", "PYTHONPATH"}
        }
        | {"PYTHONPATH": str(Path(labkit.__file__).parent.parent)}
    )


def _places() -> list[Path]:
    """What is shown inside, read-only: the system's programs, Python, its packages."""
    system = [Path(x) for x in ("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64")]
    python = {
        Path(sys.prefix),
        Path(sys.base_prefix),
        Path(os.path.realpath(sys.executable)).parents[1],
    }
    kept = [x for x in system if x.exists()]
    kept += sorted(x for x in python if not x.is_relative_to("/usr") and x != Path("/"))
    return kept


def _folders(folder: Path, made: set[Path]) -> list[str]:
    """Make the folders above a place, readable: bubblewrap would close them to all but root."""
    words: list[str] = []
    for above in (*reversed(folder.parents), folder):
        if above != Path("/") and above not in made:
            words += ["--perms", "0755", "--dir", str(above)]
            made.add(above)
    return words


def _figure_cache() -> Path:
    """Where matplotlib keeps its list of fonts; made once, as that takes a while."""
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    folder = base / "labkit" / "matplotlib"
    if not any(folder.glob("fontlist*")):
        folder.mkdir(parents=True, exist_ok=True)
        subprocess.run(
            [sys.executable, "-c", "import matplotlib.font_manager"],
            env=dict(os.environ) | {"MPLCONFIGDIR": str(folder)},
            check=False,
            capture_output=True,
        )
    return folder
