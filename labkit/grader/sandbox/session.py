"""A session: one submission's process in the sandbox, made again where it dies."""

from __future__ import annotations

import time
from contextlib import AbstractContextManager, suppress
from typing import Any

from ...course.question import Question
from ..clean import clean_line, clean_text
from ..plan import Plan, Step
from .launch import Sandbox, SandboxProcess
from .limits import REPLY, VALUES, Limits
from .protocol import Disconnected, MessageTooLarge, Timeout

MOST_STARTS = 6
LEAST = 0.05
"""Share of the time of all cells that each still has when those before it have spent it."""


class Session:
    """Runs a plan's cells in a fresh process, and puts calls to its functions.

    A cell that kills the process is left out when the process is made again.

    Args:
        sandbox: Where.
        todo: The cells.
        limits: What may be used.

    Attributes:
        spent: Seconds that its cells and answers took.
        right: Questions whose public cases it passed; other answers may lean on these.
    """

    def __init__(self, sandbox: Sandbox, todo: Plan, limits: Limits) -> None:
        self.sandbox, self.todo, self.limits = sandbox, todo, limits
        self.spent = 0.0
        self._until = time.monotonic() + limits.wall
        self._cells = limits.cells
        self._output = limits.output
        self.right: list[str] = []
        self._reports: dict[int, dict[str, Any]] = {}
        self._deadly: set[int] = set()
        self._entered: AbstractContextManager[SandboxProcess] | None = None
        self._inside: SandboxProcess | None = None
        self._asked = ""
        self._starts = 0

    @property
    def over(self) -> bool:
        """Whether it had its chances."""
        return time.monotonic() > self._until or (
            self._inside is None and self._starts >= MOST_STARTS
        )

    def start(self) -> SandboxProcess:
        """Make a process in which all cells have run, unless there is one.

        Raises:
            Disconnected: It died too often.
        """
        while self._inside is None:
            if self.over:
                raise Disconnected("it died too often")
            self._starts += 1
            self._entered = self.sandbox.spawn("student", self.limits)
            self._inside = self._entered.__enter__()
            died = self._run_cells()
            if died is not None:
                self._deadly.add(died)
                self._leave()
        return self._inside

    def open(self, question: Question) -> bool:
        """Make a process ready to be asked; True if it is a new one.

        Raises:
            Disconnected: It cannot be made.
        """
        if self._asked == question.name:
            return False
        inside = self.start()
        try:
            about = {"withheld": list(question.withheld), "right": self.right}
            inside.connection.send({"question": question.name, **about}, self.limits.grace)
            if "ready" not in inside.connection.read(2 * self.limits.grace, REPLY):
                raise Disconnected("it did not get ready")
        except (Disconnected, Timeout, MessageTooLarge) as error:
            self._leave()
            raise Disconnected(str(error)) from None
        self._asked = question.name
        return True

    def ask(self, message: dict[str, Any], seconds: float) -> dict[str, Any]:
        """Put one call; the process must be open.

        Args:
            message: The call.
            seconds: How long to wait at most.

        Raises:
            Timeout: No answer in time; the process was killed.
            MessageTooLarge: What came back is no answer; likewise.
            Disconnected: It died.
        """
        assert self._inside is not None
        began = time.monotonic()
        most = self.limits.call * self.limits.patience + self.limits.grace
        try:
            wait = max(0.0, min(seconds, most, self._until - began))
            self._inside.connection.send(message, wait)
            reply = self._inside.connection.read(wait, REPLY, VALUES)
        except (Timeout, MessageTooLarge):
            self._end_question()
            raise
        except Disconnected:
            self._leave()
            raise
        finally:
            self.spent += time.monotonic() - began
        if "over" in reply:
            self._asked = ""
            raise Disconnected("it died")
        return reply

    def close(self) -> None:
        """No more calls to this question."""
        if self._asked and self._inside is not None:
            try:
                self._inside.connection.send({"end": True}, self.limits.grace)
                if "over" in self._inside.connection.read(self.limits.grace, REPLY):
                    self._asked = ""
                    return
            except (Timeout, MessageTooLarge, Disconnected):
                pass
            self._end_question()

    def failed(self) -> tuple[dict[str, Any], ...]:
        """What is to be said of cells, in order, as they ran the last time."""
        return tuple(
            {"cell": number, **report}
            for number, report in sorted(self._reports.items())
            if number >= 0 and (report["error"] or report["kind"])
        )

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self._leave()

    def _run_cells(self) -> int | None:
        """Run all cells; returns the number of one that the process did not outlive."""
        again = []
        for step in self.todo.steps:
            if step.number not in self._deadly:
                kind = self._run(step)
                if kind == "died":
                    return step.number
                if kind == "NameError":  # its cells may stand in another order
                    again.append(step)
        return next((step.number for step in again if self._run(step) == "died"), None)

    def _run(self, step: Step) -> str:
        """Run one cell, note what came of it; returns the kind of its exception, or "died"."""
        assert self._inside is not None
        began = time.monotonic()
        seconds = min(self.limits.cell, max(LEAST * self.limits.cells, self._cells))
        wait = seconds * self.limits.patience + self.limits.grace
        wait = max(0.1, min(wait, self._until - began))
        message = {"cell": step.number, "source": step.source, "answers": list(step.answers)}
        kind, error, output = "died", "", ""
        try:
            self._inside.connection.send({**message, "seconds": seconds}, wait)
            said = self._inside.connection.read(wait, REPLY)
            if said.get("ran") == step.number:
                kind = clean_line(str(said.get("kind", "")), 60)
                error = clean_line(str(said.get("error", "")), 400)
                output = clean_text(str(said.get("output", ""))[: min(20_000, self._output)])
            else:
                error = "it broke into the conversation with the grader"
        except Timeout:
            error = f"it was stopped after {seconds:g} s"
        except (MessageTooLarge, Disconnected):
            error = "it ended the process"
        spent = time.monotonic() - began
        self.spent += spent
        self._cells -= spent
        self._output -= len(output)
        report = {"kind": kind, "error": error, "output": output, "seconds": round(spent, 4)}
        self._reports[step.number] = report
        return kind

    def _end_question(self) -> None:
        """Kill the fork that answers; if the process then says nothing, kill that too."""
        self._asked = ""
        if self._inside is None:
            return
        self.sandbox.kill(self._inside)
        with suppress(Timeout, MessageTooLarge, Disconnected):
            until = time.monotonic() + self.limits.grace
            while (left := until - time.monotonic()) > 0:
                if "over" in self._inside.connection.read(left, REPLY):
                    return
        self._leave()

    def _leave(self) -> None:
        self._asked = ""
        entered, self._entered, self._inside = self._entered, None, None
        if entered is not None:
            entered.__exit__(None, None, None)
