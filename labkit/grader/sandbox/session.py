"""A session: the process of one submission in the sandbox, started again if it dies.

The message of an exception becomes one clean line here, because Gradescope shows it
before there is a result.  What cells print is only shown with a result, and is cleaned with it.
"""

from __future__ import annotations

import builtins
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from ... import errors
from ...course.calling import NoAnswer, answer
from ...course.question import Question
from ...course.serialize import encode
from .clean import clean_line
from .launch import Sandbox, SandboxProcess
from .limits import MAX_REPLY, MAX_VALUES, Limits
from .protocol import BadMessage, Disconnected, ProtocolError, Timeout

MAX_STARTS = 6
MAX_LOST = 3
"""After this number of calls that died or hung, a question is no longer tried."""
LEAST_SHARE = 0.05
"""The share of the time for all cells that a cell has once the others have spent it."""
_EXCEPTIONS = {"ArgumentChanged", "LinAlgError"} | {
    name
    for module in (builtins, errors)
    for name, thing in vars(module).items()
    if isinstance(thing, type) and issubclass(thing, BaseException)
}


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
        steps: The cells.
        limits: What the process may use.

    Attributes:
        spent: How many seconds the cells and the answers took.
        right: The questions whose public cases the submission passed; `stubs.use` reads them.
    """

    def __init__(self, sandbox: Sandbox, steps: Sequence[Step], limits: Limits) -> None:
        self.sandbox, self.steps, self.limits = sandbox, steps, limits
        self.spent = 0.0
        self.right: list[str] = []
        self._deadline = time.monotonic() + limits.wall
        self._cells, self._output = limits.cells, limits.output
        self._reports: dict[int, dict[str, Any]] = {}
        self._fatal: set[int] = set()
        self._process: SandboxProcess | None = None
        self._asked = ""
        self._starts = 0

    @property
    def exhausted(self) -> bool:
        """Whether the time is used up, or the process may not be started again."""
        dead = self._process is None and self._starts >= MAX_STARTS
        return dead or time.monotonic() > self._deadline

    def start(self) -> SandboxProcess:
        """Return the process, in which all cells have run; start it if necessary.

        Raises:
            Disconnected: The process died too often.
        """
        while self._process is None:
            if self.exhausted:
                raise Disconnected("it died too often")
            self._starts += 1
            self._process = self.sandbox.spawn("student", self.limits)
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
            Disconnected: The process cannot be started.
        """
        if self._asked == question.name:
            return False
        connection = self.start().connection
        message = {"question": question.name, "right": self.right}
        try:
            if "ready" not in connection.request(message, 2 * self.limits.grace, MAX_REPLY):
                raise Disconnected("it did not get ready")
        except ProtocolError as error:
            self.close()
            raise Disconnected(str(error)) from None
        self._asked = question.name
        return True

    def ask(self, message: dict[str, Any], seconds: float) -> dict[str, Any]:
        """Send one call to the question that is open, and return the reply.

        Args:
            message: The call.
            seconds: The longest time to wait.

        Raises:
            Timeout: No reply came in time; the fork that answers was killed.
            BadMessage: What came back is not a reply; the fork that answers was killed.
            Disconnected: The fork or the whole process died.
        """
        assert self._process is not None
        began = time.monotonic()
        longest = self.limits.call * self.limits.patience + self.limits.grace
        wait = max(0.0, min(seconds, longest, self._deadline - began))
        try:
            reply = self._process.connection.request(message, wait, MAX_REPLY, MAX_VALUES)
        except Disconnected:
            self.close()
            raise
        except ProtocolError:
            self._kill_question()
            raise
        finally:
            self.spent += time.monotonic() - began
        if "over" in reply:
            self._asked = ""
            raise Disconnected("it died")
        return reply

    def close_question(self) -> None:
        """End the question that is open, if there is one."""
        if self._asked and self._process is not None:
            with suppress(ProtocolError):
                connection = self._process.connection
                if "over" in connection.request({"end": True}, self.limits.grace, MAX_REPLY):
                    self._asked = ""
                    return
            self._kill_question()

    def failed(self) -> tuple[dict[str, Any], ...]:
        """A report on each cell that failed when it last ran, in order."""
        return tuple(
            {"cell": number, **report}
            for number, report in sorted(self._reports.items())
            if number >= 0 and (report["error"] or report["kind"])
        )

    def close(self) -> None:
        """Kill the process and all that it started."""
        self._asked = ""
        process, self._process = self._process, None
        if process is not None:
            process.close()

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
        assert self._process is not None
        began = time.monotonic()
        seconds = min(self.limits.cell, max(LEAST_SHARE * self.limits.cells, self._cells))
        wait = seconds * self.limits.patience + self.limits.grace
        wait = max(0.1, min(wait, self._deadline - began))
        cell = {"cell": step.number, "source": step.source, "answers": step.answers}
        kind, error, output = "died", "", ""
        try:
            said = self._process.connection.request(cell | {"seconds": seconds}, wait, MAX_REPLY)
            if said.get("ran") == step.number:
                kind = clean_line(str(said.get("kind", "")), 60)
                error = clean_line(str(said.get("error", "")), 400)
                output = str(said.get("output", ""))[: min(20_000, self._output)]
            else:
                error = "it disturbed the messages to the grader"
        except Timeout:
            error = f"it was stopped after {seconds:g} s"
        except ProtocolError:
            error = "it ended the process"
        spent = time.monotonic() - began
        self.spent += spent
        self._cells -= spent
        self._output -= len(output)
        report = {"kind": kind, "error": error, "output": output, "seconds": round(spent, 4)}
        self._reports[step.number] = report
        return kind

    def _kill_question(self) -> None:
        """Kill the fork that answers; if the process then does not reply, kill it, too."""
        self._asked = ""
        if self._process is None:
            return
        self._process.kill_children()
        with suppress(ProtocolError):
            until = time.monotonic() + self.limits.grace
            while (left := until - time.monotonic()) > 0:
                if "over" in self._process.connection.read(left, MAX_REPLY):
                    return
        self.close()


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
            limit = self.session.limits.call
            failed = "TimeoutError", f"TimeoutError: it did not return within {limit:g} s"
        except BadMessage as error:
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
        kind, says = str(reply["raised"]), clean_line(str(reply.get("says", "")))
        if kind == "TimeUp":
            self.lost += 1
            kind = "TimeoutError"
        if kind not in _EXCEPTIONS:
            kind = "Exception"  # a name that the student chose could carry a secret out
        return answer({"raised": kind, "says": says})
