"""A session: one submission's process in the sandbox, started again where it dies.

What an exception says becomes one clean line here: Gradescope and the cup show it before there is a
result.  What cells print is shown with a result alone, and is cleaned with that.
"""

from __future__ import annotations

import builtins
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from ... import errors
from ...course.question import Question
from ...course.reply import NoAnswer, answer
from ...course.serialize import encode
from .clean import clean_line
from .launch import Sandbox, SandboxProcess
from .limits import REPLY, VALUES, Limits
from .protocol import Disconnected, MessageTooLarge, ProtocolError, Timeout

MAX_STARTS = 6
MAX_LOST = 3
"""After this number of calls that died or hung, a question is not asked any more."""
LEAST_SHARE = 0.05
"""Share of the time of all cells that each still has once those before it have spent it."""
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
        number: Its place in the notebook, from 0; the release's setup cells have negative ones.
        source: Its text.
        answers: Questions whose function it defines.
    """

    number: int
    source: str
    answers: tuple[str, ...] = ()


class Session:
    """Runs cells in a fresh process, and puts calls to the functions that they define.

    A cell that kills the process is left out when the process is started again.

    Args:
        sandbox: Where.
        steps: The cells.
        limits: What may be used.

    Attributes:
        spent: Seconds that its cells and answers took.
        right: Questions whose public cases it passed; other answers may lean on these.
    """

    def __init__(self, sandbox: Sandbox, steps: Sequence[Step], limits: Limits) -> None:
        self.sandbox, self.steps, self.limits = sandbox, steps, limits
        self.spent = 0.0
        self.right: list[str] = []
        self._until = time.monotonic() + limits.wall
        self._cells, self._output = limits.cells, limits.output
        self._reports: dict[int, dict[str, Any]] = {}
        self._deadly: set[int] = set()
        self._process: SandboxProcess | None = None
        self._asked = ""
        self._starts = 0

    @property
    def over(self) -> bool:
        """Whether its time is used up, or it may not be started again."""
        dead = self._process is None and self._starts >= MAX_STARTS
        return dead or time.monotonic() > self._until

    def start(self) -> SandboxProcess:
        """Return the process, in which all cells have run; start it if need be.

        Raises:
            Disconnected: It died too often.
        """
        while self._process is None:
            if self.over:
                raise Disconnected("it died too often")
            self._starts += 1
            self._process = self.sandbox.spawn("student", self.limits)
            died = self._run_cells()
            if died is not None:
                self._deadly.add(died)
                self.close()
        return self._process

    def open(self, question: Question) -> bool:
        """Make the process ready to answer a question; return whether it was not before.

        Raises:
            Disconnected: It cannot be started.
        """
        if self._asked == question.name:
            return False
        connection = self.start().connection
        message = {"question": question.name, "withheld": question.withheld, "right": self.right}
        try:
            if "ready" not in connection.request(message, 2 * self.limits.grace, REPLY):
                raise Disconnected("it did not get ready")
        except ProtocolError as error:
            self.close()
            raise Disconnected(str(error)) from None
        self._asked = question.name
        return True

    def ask(self, message: dict[str, Any], seconds: float) -> dict[str, Any]:
        """Put one call to the question that is open, and return the reply.

        Args:
            message: The call.
            seconds: How long to wait at most.

        Raises:
            Timeout: No reply in time; the fork that answers was killed.
            MessageTooLarge: What came back is not a reply; likewise.
            Disconnected: The fork, or the whole process, died.
        """
        assert self._process is not None
        began = time.monotonic()
        longest = self.limits.call * self.limits.patience + self.limits.grace
        wait = max(0.0, min(seconds, longest, self._until - began))
        try:
            reply = self._process.connection.request(message, wait, REPLY, VALUES)
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
                if "over" in connection.request({"end": True}, self.limits.grace, REPLY):
                    self._asked = ""
                    return
            self._kill_question()

    def failed(self) -> tuple[dict[str, Any], ...]:
        """What is to be said of cells that failed, in order, as they ran the last time."""
        return tuple(
            {"cell": number, **report}
            for number, report in sorted(self._reports.items())
            if number >= 0 and (report["error"] or report["kind"])
        )

    def close(self) -> None:
        """End the process, and all that it started."""
        self._asked = ""
        process, self._process = self._process, None
        if process is not None:
            process.close()

    def _run_cells(self) -> int | None:
        """Run all cells; return the number of one that the process did not outlive."""
        again = []  # cells that met a NameError: their order may be another one
        for step in self.steps:
            if step.number not in self._deadly:
                kind = self._run(step)
                if kind == "died":
                    return step.number
                if kind == "NameError":
                    again.append(step)
        return next((step.number for step in again if self._run(step) == "died"), None)

    def _run(self, step: Step) -> str:
        """Run one cell and report on it; return the kind of its exception, or "died"."""
        assert self._process is not None
        began = time.monotonic()
        seconds = min(self.limits.cell, max(LEAST_SHARE * self.limits.cells, self._cells))
        wait = seconds * self.limits.patience + self.limits.grace
        wait = max(0.1, min(wait, self._until - began))
        cell = {"cell": step.number, "source": step.source, "answers": step.answers}
        kind, error, output = "died", "", ""
        try:
            said = self._process.connection.request(cell | {"seconds": seconds}, wait, REPLY)
            if said.get("ran") == step.number:
                kind = clean_line(str(said.get("kind", "")), 60)
                error = clean_line(str(said.get("error", "")), 400)
                output = str(said.get("output", ""))[: min(20_000, self._output)]
            else:
                error = "it broke into the conversation with the grader"
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
        """Kill the fork that answers; if the process then says nothing, kill that too."""
        self._asked = ""
        if self._process is None:
            return
        self._process.kill_children()
        with suppress(ProtocolError):
            until = time.monotonic() + self.limits.grace
            while (left := until - time.monotonic()) > 0:
                if "over" in self._process.connection.read(left, REPLY):
                    return
        self.close()


class RemoteFunction:
    """A student's function as one that lives here; each call is put to the session that has it.

    Attributes:
        left: Seconds that its answers may still take, those to hidden cases included.
        lost: How many calls died or hung.
    """

    def __init__(self, question: Question, session: Session) -> None:
        self.question, self.session = question, session
        self.left = session.limits.question
        self.lost = 0
        self._sent: Mapping[str, Any] = {}

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """The answer to one call.

        Raises:
            NoAnswer: There is none.
            Withheld: The function used a tool that the question withholds.
        """
        if self.lost >= MAX_LOST or self.session.over or self.left <= 0.0:
            raise NoAnswer("TimeoutError", "TimeoutError: too much time was spent already")
        try:
            if self.session.open(self.question):
                self._sent = {}
            data = [encode(x) for x in args]
            return self._answer({"args": data, "kwargs": self._unless_sent(kwargs)})
        except Timeout:
            limit = self.session.limits.call
            failed = "TimeoutError", f"TimeoutError: it did not return within {limit:g} s"
        except MessageTooLarge as error:
            failed = "TypeMismatch", str(error)
        except Disconnected:
            failed = "SystemExit", "SystemExit: its process ended before it answered"
        self.lost += 1
        raise NoAnswer(*failed)

    def _unless_sent(self, kwargs: Mapping[str, Any]) -> dict[str, Any] | None:
        """Keyword arguments as data; None where they are those of the call before.

        A closed loop has the same ones in each of its thousand calls.
        """
        same = self._sent.keys() == kwargs.keys()
        same = same and all(x is self._sent[key] for key, x in kwargs.items())
        self._sent = kwargs
        return None if same and kwargs else {key: encode(x) for key, x in kwargs.items()}

    def _answer(self, message: dict[str, Any]) -> Any:
        """What came of one call; decoding it counts as the student's time."""
        began = time.monotonic()
        try:
            reply = self.session.ask(message, self.left)
            if "raised" not in reply:
                return answer(reply, self.question.withheld)
        finally:
            self.left -= time.monotonic() - began
        kind, says = str(reply["raised"]), clean_line(str(reply.get("says", "")))
        if kind == "TimeUp":
            self.lost += 1
            kind = "TimeoutError"
        if kind not in _EXCEPTIONS:
            kind = "Exception"  # a name of its own could carry a secret out
        return answer({"raised": kind, "says": says}, self.question.withheld)
