"""A sandbox: bubblewrap around a forkserver, which forks a process for each submission.

No network, no environment, no files but Python and labkit (see `mounts`), a folder in memory that
ends with the submission.
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
"""When root grades, each sandbox is given a user of its own among these."""
START = 120.0  # seconds
_ROLES = ("student", "parse")  # the forkservers, on stdin and stdout of the process inside
_numbers = itertools.count()


class SandboxLost(BaseException):
    """A sandbox was lost, at its start or later; a fresh one may work.

    It is not an `Exception`, so that marking never takes it for one of the student's.
    """


class SandboxProcess:
    """A process in the sandbox.

    Args:
        connection: To the process.
        kill: Asks its forkserver to kill the process, if ``whole``, and all that it started.
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
    """One sandbox, for one submission at a time.

    Args:
        loads: Modules that submissions will import, to be loaded once for all.
        hidden: Folders that must not be seen inside, wherever they lie.
        isolation: What keeps submissions apart; nothing weaker than bubblewrap is taken unasked.

    Raises:
        NoIsolation: It cannot be made here.
        SandboxLost: It was killed while it started.
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
                preexec_fn=self._count_apart,
            )
        except OSError as error:
            raise NoIsolation(f"no sandbox: {error}; try: {INSTALL}") from None
        finally:
            for end in theirs:
                end.close()
        self._wait_until_ready()

    def _count_apart(self) -> None:
        """Run in the process to come: its memory is not the worker's."""
        _, most = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))
        if self.group is not None:
            self.group.enter()

    def _wait_until_ready(self) -> None:
        """Wait until both forkservers say so; close the sandbox where one does not."""
        try:
            for forkserver in self._forkservers.values():
                self._wait_for(forkserver)
        except ProtocolError as error:
            why = self._last_words() or str(error)
            self.close()
            if isinstance(error, Disconnected) and self.process.returncode != 1:  # 1 is a failure's
                raise SandboxLost("it was killed while it started") from None
            raise NoIsolation(
                f"the sandbox did not start: {why}; `labkit doctor` says what is missing"
            ) from None

    def _wait_for(self, forkserver: Connection) -> None:
        """Wait for its first word, as long as bubblewrap runs."""
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
        """What keeps a submission apart here, in a line."""
        if self.isolation is Isolation.NONE:
            return str(self.isolation.value)
        who = f"user {self.uid}" if self.uid else "an unprivileged user"
        group = self.group.says if self.group else "no cgroup"
        return f"{self.isolation.value}, {who}, no network, seccomp, limits, {group}"

    def spawn(self, role: str, limits: Limits, **more: Any) -> SandboxProcess:
        """Fork a fresh process inside, to be closed after use; nothing of it stays.

        Args:
            role: "student" or "parse".
            limits: What it may use.
            more: What else its forkserver needs to know.

        Raises:
            NoIsolation: It could not be confined, nor could any before it.
            SandboxLost: Nothing could be started, or confined any more: no fault of the student's.
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
            raise SandboxLost(f"nothing could be started: {error}") from None
        if "confined" not in reply:
            process.close()
            kind = SandboxLost if self._confines else NoIsolation
            raise kind(f"a sandboxed process could not be confined: {reply}")
        self._confines = True
        return process

    def close(self) -> None:
        """End everything inside."""
        for forkserver in self._forkservers.values():
            forkserver.close()  # which sees it, and ends
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(2.0)
        with suppress(ProcessLookupError):  # killed early, bubblewrap leaves a half behind
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
        """Have a forkserver do something, perhaps with a socket, and return its reply."""
        try:
            data = json.dumps(message).encode()
            socket.send_fds(forkserver.socket, [data], [end.fileno()] if end else [])
            return forkserver.read(20.0)
        except (OSError, ProtocolError) as error:
            why = self._last_words() or "nothing"
            raise SandboxLost(f"{error}; its last words: {why}") from None

    def _last_words(self) -> str:
        """The last line that bubblewrap or the forkserver wrote, empty if there is none."""
        lines = os.pread(self._log, 100_000, 0).decode(errors="replace").strip().splitlines()
        return lines[-1][:300] if lines else ""


def _user() -> tuple[int, socket.socket | None]:
    """A user that no other sandbox has, and what claims it until that is closed; 0 without root.

    The kernel counts processes by user, so two graders on one machine must not share one.
    """
    if os.geteuid():
        return 0, None
    for uid in range(FIRST_UID, FIRST_UID + MAX_USERS):
        claim = socket.socket(socket.AF_UNIX)
        try:
            claim.bind(f"\0labkit-sandbox-{uid}")  # ends with the process, however that ends
        except OSError:
            claim.close()
            continue
        return uid, claim
    raise NoIsolation(
        f"all {MAX_USERS} user ids for sandboxes are in use; stop other grading processes"
    )
