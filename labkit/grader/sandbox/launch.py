"""A sandbox: bubblewrap around a process that forks for each submission.

No network, no environment, no files but Python and labkit (see `launch`), a folder in memory that
dies with the submission.
"""

from __future__ import annotations

import itertools
import json
import os
import resource
import socket
import subprocess
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from .cgroup import SANDBOX, Group
from .limits import Limits
from .mounts import INSTALL, NoIsolation, bare_command, bare_environment, command, environment
from .protocol import Connection, Disconnected, MessageTooLarge, Timeout

FIRST_UID = 64000
MOST_USERS = 1000
"""When root grades, each sandbox is given a user of its own among these."""
START = 120.0  # seconds
_ROLES = ("student", "parse")  # the ends of stdin and of stdout of the process inside
_numbers = itertools.count()


class SandboxLost(BaseException):
    """A sandbox was lost, at its start or later; a fresh one may work.

    No `Exception`, so that marking never takes it for one of the student's.
    """


class SandboxProcess:
    """A process in the sandbox, the line to it, and the line to what forked it."""

    def __init__(self, line: Connection, parent: Connection, pid: int) -> None:
        self.connection, self.parent, self.pid = line, parent, pid


class Sandbox:
    """One sandbox, for one submission at a time.

    Args:
        loads: Modules that submissions will import, to be loaded once for all.
        hidden: Folders that must not be seen inside, wherever they lie.
        isolated: False only if somebody typed ``--unsafe-no-isolation``.

    Raises:
        NoIsolation: It cannot be made here.
        SandboxLost: It was killed while it started.
    """

    def __init__(
        self, loads: Sequence[str] = (), hidden: Iterable[Path] = (), *, isolated: bool = True
    ) -> None:
        words, variables = (
            (command(hidden), environment()) if isolated else (bare_command(), bare_environment())
        )
        self.isolated = isolated
        self.uid, self._claim = _user()
        self.group = Group.make(f"{os.getpid()}-{next(_numbers)}", SANDBOX) if isolated else None
        self._log = os.memfd_create("labkit-sandbox-log")
        ends = [socket.socketpair() for _ in _ROLES]
        self._lines = {role: Connection(ours) for role, (ours, _) in zip(_ROLES, ends, strict=True)}
        stdin, stdout = (theirs for _, theirs in ends)
        try:
            self.process = subprocess.Popen(
                [*words, *loads],
                stdin=stdin.fileno(),
                stdout=stdout.fileno(),
                stderr=self._log,
                env=variables,
                preexec_fn=self._apart,
            )
        except OSError as error:
            raise NoIsolation(f"no sandbox: {error}; try: {INSTALL}") from None
        finally:
            stdin.close()
            stdout.close()
        self._wait_until_ready()

    def _apart(self) -> None:
        """Runs in the process to come: it is counted apart from the worker."""
        _, most = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))
        if self.group is not None:
            self.group.enter()

    def _wait_until_ready(self) -> None:
        """Wait for the word of both processes that fork; close where it does not come."""
        try:
            for line in self._lines.values():
                line.read(START)
        except (Disconnected, Timeout, MessageTooLarge) as error:
            said = self._words() or str(error)
            self.close()
            if (
                isinstance(error, Disconnected) and self.process.returncode != 1
            ):  # what failed says 1
                raise SandboxLost("it was killed while it started") from None
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
    def spawn(self, role: str, limits: Limits, **more: Any) -> Iterator[SandboxProcess]:
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
        inside = SandboxProcess(Connection(ours), parent, pid)
        try:
            try:
                said = inside.connection.read(20.0)
            except (Disconnected, Timeout, MessageTooLarge) as error:
                raise SandboxLost(f"nothing could be started: {error}") from None
            if "confined" not in said:
                raise NoIsolation(f"a sandboxed process could not be confined: {said}")
            yield inside
        finally:
            ours.close()
            self.kill(inside, whole=True)

    def kill(self, inside: SandboxProcess, *, whole: bool = False) -> None:
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
        self, line: Connection, message: dict[str, Any], end: socket.socket | None = None
    ) -> dict[str, Any]:
        """Tell one of the first processes what to do, and take its word that it is done."""
        try:
            data = json.dumps(message).encode()
            socket.send_fds(line.socket, [data], [end.fileno()] if end else [])
            return line.read(20.0)
        except (OSError, Disconnected, Timeout, MessageTooLarge) as error:
            raise SandboxLost(f"{error}; it said: {self._words() or 'nothing'}") from None

    def _words(self) -> str:
        """The last line that bubblewrap or the forkserver wrote, empty if there is none."""
        lines = os.pread(self._log, 100_000, 0).decode(errors="replace").strip().splitlines()
        return lines[-1][:300] if lines else ""


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
