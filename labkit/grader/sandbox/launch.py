"""Start a sandbox: bubblewrap around a forkserver, which forks a process for each submission.

Inside there is no network, no environment and no file except Python and labkit (see `mounts`), and
a folder in memory that disappears with the submission.
"""

from __future__ import annotations

import itertools
import json
import os
import resource
import signal
import socket
import subprocess
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from . import mounts
from .cgroup import SANDBOX, Group
from .limits import Limits
from .mounts import INSTALL, Isolation, NoIsolation
from .protocol import Connection, Disconnected, ProtocolError, Timeout

FIRST_UID = 64000
MAX_USERS = 1000
"""If root grades, each sandbox has its own user among these."""
START = 120.0  # seconds
_ROLES = ("student", "parse")  # the two forkservers, reached by stdin and stdout
_numbers = itertools.count()


class SandboxLost(BaseException):
    """A sandbox was lost, at its start or later; a new one may work.

    This is not an `Exception`, so that marking never mistakes it for one that a student raised.
    """


class SandboxProcess:
    """A process in the sandbox.

    Args:
        connection: The connection to the process.
        kill: Makes the forkserver kill all that it started and, if ``whole``, the process, too.
    """

    def __init__(self, connection: Connection, kill: Callable[..., Any]) -> None:
        self.connection, self._kill = connection, kill

    def kill_children(self) -> None:
        """Kill all that the process started."""
        self._kill(whole=False)

    def close(self) -> None:
        """Kill the process and all that it started."""
        self.connection.close()
        self._kill(whole=True)

    def __enter__(self) -> SandboxProcess:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class Sandbox:
    """A sandbox, for one submission at a time.

    Args:
        loads: Modules that submissions will import, loaded once for all of them.
        hidden: Folders that must not be visible inside, wherever they are.
        isolation: What isolates submissions; only an explicit choice is weaker than bubblewrap.

    Raises:
        NoIsolation: The sandbox cannot be made on this machine.
        SandboxLost: The sandbox was killed while it started.
    """

    def __init__(
        self,
        loads: Sequence[str] = (),
        hidden: Iterable[Path] = (),
        isolation: Isolation = Isolation.BUBBLEWRAP,
    ) -> None:
        command, variables = mounts.command(isolation, hidden)
        self.isolation = isolation
        self.uid, self._claim = _user()
        self._confines = False
        counted = isolation is Isolation.BUBBLEWRAP
        self.group = Group.make(f"{os.getpid()}-{next(_numbers)}", SANDBOX) if counted else None
        self._log = os.memfd_create("labkit-sandbox-log")
        ours, theirs = zip(*(socket.socketpair() for _ in _ROLES), strict=True)
        self._forkservers = dict(zip(_ROLES, map(Connection, ours), strict=True))
        try:
            self.process = subprocess.Popen(
                [*command, *loads],
                stdin=theirs[0].fileno(),
                stdout=theirs[1].fileno(),
                stderr=self._log,
                env=variables,
                process_group=0,
                preexec_fn=self._set_own_limits,
            )
        except OSError as error:
            raise NoIsolation(f"no sandbox: {error}; try: {INSTALL}") from None
        finally:
            for end in theirs:
                end.close()
        self._wait_until_ready()

    def _set_own_limits(self) -> None:
        """Give the new process limits of its own, as its memory is not the worker's."""
        _, most = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))
        if self.group is not None:
            self.group.enter()

    def _wait_until_ready(self) -> None:
        """Wait until both forkservers are ready; close the sandbox if one does not start."""
        try:
            for forkserver in self._forkservers.values():
                self._wait_for(forkserver)
        except ProtocolError as error:
            why = self._last_log_line() or str(error)
            self.close()
            if isinstance(error, Disconnected) and self.process.returncode != 1:  # 1 is a failure
                raise SandboxLost("it was killed while it started") from None
            raise NoIsolation(
                f"the sandbox did not start: {why}; `labkit doctor` says what is missing"
            ) from None

    def _wait_for(self, forkserver: Connection) -> None:
        """Wait for the first message of a forkserver, as long as bubblewrap runs."""
        until = time.monotonic() + START
        while True:
            try:
                forkserver.read(1.0)
                return
            except Timeout:
                if self.process.poll() is not None:
                    raise Disconnected("bubblewrap has ended") from None
                if time.monotonic() > until:
                    raise

    @property
    def level(self) -> str:
        """What isolates a submission here, in one line."""
        if self.isolation is Isolation.NONE:
            return str(self.isolation.value)
        who = f"user {self.uid}" if self.uid else "an unprivileged user"
        group = self.group.description if self.group else "no cgroup"
        return f"{self.isolation.value}, {who}, no network, seccomp, limits, {group}"

    def spawn(self, role: str, limits: Limits, **more: Any) -> SandboxProcess:
        """Fork a new process inside; close it after use, and nothing of it remains.

        Args:
            role: "student" or "parse".
            limits: What the process may use.
            more: What else its forkserver needs to know.

        Raises:
            NoIsolation: The process could not be confined, and neither could any before it.
            SandboxLost: The process could not be started, or not confined although earlier ones
                could; the student is not to blame.
        """
        forkserver = self._forkservers[role]
        ours, theirs = socket.socketpair()
        message = {"limits": asdict(limits), "uid": self.uid, **more}
        with theirs:
            pid = self._request(forkserver, message, theirs)["pid"]

        def kill(*, whole: bool) -> None:
            self._request(forkserver, {"kill": pid, "whole": whole})

        process = SandboxProcess(Connection(ours), kill)
        try:
            reply = process.connection.read(20.0)
        except ProtocolError as error:
            process.close()
            raise SandboxLost(f"no process could be started: {error}") from None
        if "confined" not in reply:
            process.close()
            kind = SandboxLost if self._confines else NoIsolation
            raise kind(f"a sandboxed process could not be confined: {reply}")
        self._confines = True
        return process

    def close(self) -> None:
        """End all processes of the sandbox, and remove what belongs to it."""
        for forkserver in self._forkservers.values():
            forkserver.close()  # the forkserver notices, and ends
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(2.0)
        with suppress(ProcessLookupError):  # bubblewrap killed early leaves a process
            os.killpg(self.process.pid, signal.SIGKILL)
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

    def _request(
        self, forkserver: Connection, message: dict[str, Any], end: socket.socket | None = None
    ) -> dict[str, Any]:
        """Send a request to a forkserver, perhaps with a socket, and return the reply."""
        try:
            data = json.dumps(message).encode()
            socket.send_fds(forkserver.socket, [data], [end.fileno()] if end else [])
            return forkserver.read(20.0)
        except (OSError, ProtocolError) as error:
            why = self._last_log_line() or "none"
            raise SandboxLost(f"{error}; the last line of its log: {why}") from None

    def _last_log_line(self) -> str:
        """The last line that bubblewrap or the forkserver wrote; empty if there is none."""
        lines = os.pread(self._log, 100_000, 0).decode(errors="replace").strip().splitlines()
        return lines[-1][:300] if lines else ""


def _user() -> tuple[int, socket.socket | None]:
    """The id of a user that no other sandbox has, and a socket that reserves it until it is closed.

    The kernel counts processes by user, so two graders on one machine must not share a user.
    Without root, the id is 0 and there is no socket.
    """
    if os.geteuid():
        return 0, None
    for uid in range(FIRST_UID, FIRST_UID + MAX_USERS):
        claim = socket.socket(socket.AF_UNIX)
        try:
            claim.bind(f"\0labkit-sandbox-{uid}")  # freed however this process ends
        except OSError:
            claim.close()
            continue
        return uid, claim
    raise NoIsolation(
        f"all {MAX_USERS} user ids for sandboxes are in use; stop other grading processes"
    )
