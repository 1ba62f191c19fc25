"""A session: the process of one submission in the sandbox, started again if it dies.

The message of an exception becomes one clean line here, because Gradescope shows it
before there is a result.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from ...course.calling import NoAnswer, answer
from ...course.question import Question
from ...course.serialize import encode
from ...errors import LabkitError
from .launch import Sandbox
from .limits import MAX_REPLY, MAX_VALUES, Limits
from .protocol import BadMessage, Connection, Disconnected, ProtocolError, Timeout, clean_line

MAX_STARTS = 12
MAX_LOST = 3
"""After this number of calls that died or hung, a question is no longer tried.

After one that had to be killed with the whole process, it is not tried either.
"""
LEAST_SHARE = 0.05
"""The share of the time for all cells that a cell has once the others have spent it."""


@dataclass(frozen=True)
class Step:
    """One cell to run.

    Attributes:
        number: Its position in the notebook, from 0; negative for setup cells of the release.
        source: The text of the cell.
        answers: The questions whose functions it defines.
    """

    number: int
    source: str
    answers: tuple[str, ...] = ()


class Session:
    """Runs cells in a new process, and calls the functions that they define.

    A cell that kills the process is skipped when the process is started again.

    Args:
        sandbox: The sandbox that makes the process.
        limits: What the process may use.
        steps: The cells to run, which may be set later.

    Attributes:
        spent: How many seconds the cells and the answers took.
        right: The questions whose public cases the submission passed; `stubs.use` reads them.
    """

    def __init__(self, sandbox: Sandbox, limits: Limits, steps: Sequence[Step] = ()) -> None:
        self.sandbox, self.limits, self.steps = sandbox, limits, steps
        self.spent = 0.0
        self.right: list[str] = []
        self._left, self._cells = limits.wall, limits.cells
        self._reports: dict[int, dict[str, Any]] = {}
        self._fatal: set[int] = set()
        self._process: Connection | None = None
        self._ran = False
        self._asked = ""
        self._starts = 0

    @property
    def exhausted(self) -> bool:
        """Whether the time is used up, or the process may not be started again."""
        return self._left <= 0.0 or (self._process is None and self._starts >= MAX_STARTS)

    def read(self, data: bytes) -> list[dict[str, Any]]:
        """The cells of a notebook, before any of them runs.

        Raises:
            LabkitError: It cannot be read.
        """
        began = time.monotonic()
        self._process = self.sandbox.start(self.limits, data)
        try:
            found = self._process.read(self.limits.parse)
        except ProtocolError:
            raise LabkitError("the file takes too much time or memory to read") from None
        finally:
            self._left -= time.monotonic() - began
        if "cells" not in found:
            raise LabkitError(str(found.get("rejected")))
        return list(found["cells"])

    def start(self) -> Connection:
        """Return the process, in which all cells have run; start it if necessary.

        Raises:
            Disconnected: The process died too often.
        """
        while self._process is None or not self._ran:
            if self.exhausted:
                raise Disconnected("it died too often")
            self._starts += 1
            self._process = self._process or self.sandbox.start(self.limits)
            self._ran = True
            died = self._run_cells()
            if died is not None:
                self._fatal.add(died)
                self.close()
        return self._process

    def open(self, question: Question) -> bool:
        """Open a question, so that the process answers calls to it, unless it is open already.

        Returns:
            Whether the question was opened now.

        Raises:
            ProtocolError: The process cannot be started, or does not get ready.
        """
        if self._asked == question.name:
            return False
        self.start()
        self._request({"question": question.name, "right": self.right}, 2 * self.limits.grace)
        self._asked = question.name
        return True

    def ask(self, message: dict[str, Any], seconds: float) -> dict[str, Any]:
        """Send one call to the question that is open, and return the reply.

        Args:
            message: The call.
            seconds: The longest time to wait.

        Raises:
            Timeout: No reply came in time; the process was killed.
            BadMessage: What came back is not a reply; the process was killed.
            Disconnected: The fork that answers, or the whole process, died.
        """
        longest = self.limits.call * self.limits.patience + self.limits.grace
        reply = self._request(message, min(seconds, longest))
        if "over" in reply:
            self._asked = ""
            raise Disconnected("it died")
        return reply

    def close_question(self) -> None:
        """End the question that is open, if there is one."""
        if self._asked:
            with suppress(ProtocolError):
                if "over" not in self._request({"end": True}, self.limits.grace):
                    self.close()
            self._asked = ""

    def failed(self) -> tuple[dict[str, Any], ...]:
        """A report on each cell that failed when it last ran, in order."""
        return tuple(
            {"cell": number, **report}
            for number, report in sorted(self._reports.items())
            if number >= 0 and (report["error"] or report["kind"])
        )

    def close(self) -> None:
        """Kill the process and all that it started."""
        self._asked, self._ran = "", False
        process, self._process = self._process, None
        if process is not None:
            process.close()
            self.sandbox.end()

    def _request(self, message: dict[str, Any], seconds: float) -> dict[str, Any]:
        """Send a message and return the reply; kill the process if there is none in time."""
        assert self._process is not None
        began = time.monotonic()
        wait = max(0.1, min(seconds, self._left))
        try:
            self._process.send(message, wait)
            return self._process.read(wait, MAX_REPLY, MAX_VALUES)
        except ProtocolError:
            self.close()
            raise
        finally:
            spent = time.monotonic() - began
            self.spent += spent
            self._left -= spent

    def _run_cells(self) -> int | None:
        """Run all cells; return the number of the one that ended the process, if any."""
        again = []  # cells with a NameError, which may be in the wrong order
        for step in self.steps:
            if step.number not in self._fatal:
                kind = self._run(step)
                if kind == "died":
                    return step.number
                if kind == "NameError":
                    again.append(step)
        return next((step.number for step in again if self._run(step) == "died"), None)

    def _run(self, step: Step) -> str:
        """Run one cell and report on it; return the kind of its exception, "" or "died"."""
        began = time.monotonic()
        seconds = min(self.limits.cell, max(LEAST_SHARE * self.limits.cells, self._cells))
        wait = seconds * self.limits.patience + self.limits.grace
        cell = {"cell": step.number, "source": step.source, "answers": step.answers}
        kind, error = "died", ""
        try:
            said = self._request(cell | {"seconds": seconds}, wait)
            if said.get("ran") == step.number:
                kind = clean_line(str(said.get("kind", "")), 60)
                error = clean_line(str(said.get("error", "")), 400)
            else:
                error = "it disturbed the messages to the grader"
        except Timeout:
            error = f"it was stopped after {seconds:g} s"
        except ProtocolError:
            error = "it ended the process"
        self._cells -= time.monotonic() - began
        self._reports[step.number] = {"kind": kind, "error": error}
        return kind


class RemoteFunction:
    """A student's function, which is called here and runs in the process of its session.

    Attributes:
        left: The seconds that its answers may still take, those to hidden cases included.
        lost: The number of calls that died or hung.
    """

    def __init__(self, question: Question, session: Session) -> None:
        self.question, self.session = question, session
        self.left = session.limits.question
        self.lost = 0
        self._sent: Mapping[str, Any] = {}

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Call the function and return its answer.

        Raises:
            NoAnswer: There is no answer.
        """
        if self.lost >= MAX_LOST or self.session.exhausted or self.left <= 0.0:
            raise NoAnswer("TimeoutError", "TimeoutError: too much time was spent already")
        try:
            if self.session.open(self.question):
                self._sent = {}
            data = [encode(x) for x in args]
            return self._answer({"args": data, "kwargs": self._changed_kwargs(kwargs)})
        except Timeout:
            self.lost = MAX_LOST
            limit = self.session.limits.call
            failed = "TimeoutError", f"TimeoutError: it did not return within {limit:g} s"
        except BadMessage as error:
            self.lost = MAX_LOST
            failed = "TypeMismatch", str(error)
        except Disconnected:
            failed = "SystemExit", "SystemExit: its process ended before it answered"
        self.lost += 1
        raise NoAnswer(*failed)

    def _changed_kwargs(self, kwargs: Mapping[str, Any]) -> dict[str, Any] | None:
        """Keyword arguments as data; None if they are the same as in the previous call.

        A closed loop passes the same ones in each of its thousand calls.
        """
        same = self._sent.keys() == kwargs.keys()
        same = same and all(x is self._sent[key] for key, x in kwargs.items())
        self._sent = kwargs
        return None if same and kwargs else {key: encode(x) for key, x in kwargs.items()}

    def _answer(self, message: dict[str, Any]) -> Any:
        """The answer to one call; the time for decoding it is charged to the student."""
        began = time.monotonic()
        try:
            reply = self.session.ask(message, self.left)
            if "raised" not in reply:
                return answer(reply)
        finally:
            self.left -= time.monotonic() - began
        kind, says = clean_line(str(reply["raised"]), 60), clean_line(str(reply.get("says", "")))
        if kind == "TimeUp":
            self.lost += 1
            kind = "TimeoutError"
        return answer({"raised": kind, "says": says})
