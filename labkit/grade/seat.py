"""A seat: one submission's process in the sandbox, made again where it dies."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, suppress
from typing import Any

from ..check.question import Question
from .inside.inmate import PATIENCE
from .inside.wire import Gone, TooLate, TooMuch
from .limits import Limits
from .plan import Plan
from .sandbox import Inside, Sandbox

MOST_STARTS = 6
GRACE = 2.0
"""Seconds that a process has to stop by itself, before it is killed."""


class Seat:
    """Runs a plan's cells in a fresh process, and puts calls to its functions.

    A cell that kills the process is left out when the process is made again.

    Args:
        sandbox: Where.
        todo: The cells.
        limits: What may be used.

    Attributes:
        right: Questions whose public cases it passed; other answers may lean on these.
    """

    def __init__(self, sandbox: Sandbox, todo: Plan, limits: Limits) -> None:
        self.sandbox, self.todo, self.limits = sandbox, todo, limits
        self.until = time.monotonic() + limits.wall
        self.spent = 0.0
        self.right: list[str] = []
        self._reports: dict[int, dict[str, Any]] = {}
        self._deadly: set[int] = set()
        self._entered: AbstractContextManager[Inside] | None = None
        self._inside: Inside | None = None
        self._asked = ""
        self._starts = 0

    @property
    def over(self) -> bool:
        """Whether it had its chances."""
        return time.monotonic() > self.until or (
            self._inside is None and self._starts >= MOST_STARTS
        )

    def open(self, question: Question) -> bool:
        """Make a process ready to be asked; True if it is a new one.

        Raises:
            Gone: It cannot be made.
        """
        if self._asked == question.name:
            return False
        inside = self._ready()
        about = {"withheld": list(question.withheld), "right": self.right}
        inside.line.send({"question": question.name, **about})
        reply = self._read(GRACE + 5.0)
        if "ready" not in reply:
            raise Gone("it did not get ready")
        self._asked = question.name
        return True

    def ask(self, message: dict[str, Any]) -> dict[str, Any]:
        """Put one call; the process must be open.

        Raises:
            TooLate: No answer in time; the process was killed.
            TooMuch: An answer that is none; likewise.
            Gone: It died.
        """
        assert self._inside is not None
        began = time.monotonic()
        try:
            self._inside.line.send(message)
            reply = self._read(self.limits.call * PATIENCE + GRACE)
        except (TooLate, TooMuch):
            self._end_question()
            raise
        finally:
            self.spent += time.monotonic() - began
        if "over" in reply:
            self._asked = ""
            raise Gone("it died")
        return reply

    def close(self) -> None:
        """No more calls to this question."""
        if self._asked and self._inside is not None:
            try:
                self._inside.line.send({"end": True})
                if "over" in self._read(GRACE):
                    self._asked = ""
                    return
            except (TooLate, TooMuch, Gone):
                pass
            self._end_question()

    def failed(self) -> Iterator[dict[str, Any]]:
        """What is to be said of cells, in order."""
        for number, report in sorted(self._reports.items()):
            if number >= 0 and (report["error"] or report["kind"]):
                yield {"cell": number, **report}

    def __enter__(self) -> Seat:
        return self

    def __exit__(self, *_: object) -> None:
        self._leave()

    def _ready(self) -> Inside:
        """A process in which all cells have run."""
        while self._inside is None:
            if self.over:
                raise Gone("it died too often")
            self._starts += 1
            self._entered = self.sandbox.enter("student", self.limits)
            self._inside = self._entered.__enter__()
            died = self._run_cells()
            if died is not None:
                self._deadly.add(died)
                self._leave()
        return self._inside

    def _run_cells(self) -> int | None:
        """Run all cells; returns the number of one that the process did not outlive."""
        again = []
        for step in self.todo.steps:
            if step.number not in self._deadly:
                report = self._run(step.number, step.source, step.answers)
                if report is None:
                    return step.number
                if report["kind"] == "NameError":  # its cells may stand in another order
                    again.append(step)
        for step in again:
            if self._run(step.number, step.source, step.answers) is None:
                return step.number
        return None

    def _run(self, number: int, source: str, answers: tuple[str, ...]) -> dict[str, Any] | None:
        assert self._inside is not None
        began, why = time.monotonic(), ""
        left = max(0.1, min(self.limits.cell * PATIENCE + GRACE, self.until - began))
        report: dict[str, Any] | None = None
        try:
            self._inside.line.send({"cell": number, "source": source, "answers": list(answers)})
            said = self._read(left)
            if said.get("ran") == number:
                report = {
                    "kind": str(said.get("kind", ""))[:60],
                    "error": str(said.get("error", ""))[:400],
                    "output": str(said.get("output", ""))[:20_000],
                }
            else:
                why = "it broke into the conversation with the grader"
        except TooLate:
            why = f"it was stopped after {self.limits.cell:g} s"
        except (TooMuch, Gone):
            why = "it ended the process"
        spent = time.monotonic() - began
        self.spent += spent
        kept = report or {"kind": "died", "error": why, "output": ""}
        self._reports[number] = kept | {"seconds": round(spent, 4)}
        return report

    def _read(self, seconds: float) -> dict[str, Any]:
        assert self._inside is not None
        try:
            return self._inside.line.read(seconds)
        except Gone:
            self._leave()
            raise

    def _end_question(self) -> None:
        """Kill the fork that answers; if the process then says nothing, kill that too."""
        self._asked = ""
        if self._inside is None:
            return
        self.sandbox.kill(self._inside)
        with suppress(TooLate, TooMuch, Gone):
            until = time.monotonic() + GRACE
            while time.monotonic() < until:
                if "over" in self._read(GRACE):
                    return
        self._leave()

    def _leave(self) -> None:
        self._asked = ""
        entered, self._entered, self._inside = self._entered, None, None
        if entered is not None:
            entered.__exit__(None, None, None)
