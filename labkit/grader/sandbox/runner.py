"""The runner, a submission's own process, which runs the cells and forks for each question.

Everything in this process belongs to the student; nothing they do to it harms anybody else.
"""

from __future__ import annotations

import linecache
import os
import signal
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from labkit.course.calling import CappedText, TimeUp, kind, reply, sentence
from labkit.course.serialize import decode
from labkit.course.source import plain

from . import parse, stubs
from .protocol import Connection, Disconnected


def serve(connection: Connection, limits: dict[str, Any], files: Sequence[int] = ()) -> None:
    """Serve the worker until it closes its end of the socket.

    Args:
        connection: The connection to the worker.
        limits: See `labkit.grader.sandbox.limits.Limits`.
        files: The notebook, an open file, if its cells are asked for; nothing of it runs before.
    """
    for file in files:
        with open(file, "rb") as notebook_file:
            connection.send(parse.read(notebook_file.read()))
    notebook = Notebook(limits)
    signal.signal(signal.SIGALRM, _time_up)
    signal.signal(signal.SIGPROF, _time_up)
    while True:
        try:
            asked = connection.read()
        except Disconnected:
            return
        if "cell" in asked:
            connection.send(notebook.run(**asked))
        elif "question" in asked:
            connection.send({"over": notebook.fork(connection, **asked)})


class Notebook:
    """The namespace of the notebook, and the functions in it that answer questions."""

    def __init__(self, limits: dict[str, Any]) -> None:
        module = type(sys)("__main__")
        sys.modules["__main__"] = module
        self.names: dict[str, Any] = vars(module)
        self.names.update(__builtins__=__builtins__, In=[""], Out={})
        self.functions: dict[str, Any] = {}
        self.limits = limits

    def run(self, cell: int, source: str, answers: list[str], seconds: float) -> dict[str, Any]:
        """Run one cell, and keep the functions that answer questions."""
        out = CappedText(20_000)
        error = raised = ""
        with _captured(out):
            try:
                with self._alarm(seconds):
                    self._execute(f"<cell {cell}>", source)
            except TimeUp:
                raised, error = "TimeUp", f"it was stopped after {seconds:g} s"
            except BaseException as why:
                raised, error = kind(why), sentence(why)
        for name in answers:
            if name in self.names:
                self.functions[name] = self.names[name]
        return {"ran": cell, "kind": raised, "error": error, "output": out.getvalue()}

    def _execute(self, name: str, source: str) -> None:
        text = plain(source)
        linecache.cache[name] = (len(text), None, text.splitlines(True), name)
        exec(compile(text, name, "exec"), self.names)

    def fork(self, connection: Connection, question: str, right: list[str]) -> int:
        """Answer one question in a fork of this process; return the exit code of the fork."""
        child = os.fork()
        if child:
            return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        with suppress(BaseException):
            stubs.right.update(right)
            self._answer(connection, question)
        os._exit(0)

    def _answer(self, connection: Connection, name: str) -> None:
        """Answer one call after another until a message is not a call."""
        kwargs: dict[str, Any] = {}
        connection.send({"ready": name})
        while "args" in (asked := connection.read()):
            with _captured(CappedText(0)):
                try:
                    args = [decode(x) for x in asked["args"]]
                    if asked["kwargs"] is not None:
                        kwargs = {key: decode(x) for key, x in asked["kwargs"].items()}
                    data = self._reply(name, args, kwargs)
                except BaseException as raised:
                    data = {"raised": kind(raised), "says": sentence(raised)}
            connection.send(data)

    def _reply(self, name: str, args: list[Any], kwargs: dict[str, Any]) -> dict[str, Any]:
        seconds = self.limits["call"]
        if name not in self.functions:
            raise NameError(f"the notebook defines no {name}")
        try:
            with self._alarm(seconds):
                return reply(self.functions[name], args, kwargs)
        except TimeUp:
            return {"raised": "TimeUp", "says": f"it did not return within {seconds:g} s"}

    @contextmanager
    def _alarm(self, seconds: float) -> Iterator[None]:
        """Raise `TimeUp` after a number of seconds of computing, and again if it is caught.

        Code that only waits is stopped after ``patience`` times as long.  Where no exception can
        reach it, the worker kills this process.
        """
        signal.setitimer(signal.ITIMER_PROF, seconds, 0.5)
        signal.setitimer(signal.ITIMER_REAL, seconds * self.limits["patience"], 0.5)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            signal.setitimer(signal.ITIMER_REAL, 0.0)


def _time_up(number: int, frame: Any) -> None:
    raise TimeUp


@contextmanager
def _captured(out: CappedText) -> Iterator[None]:
    """Redirect Python's standard streams to a buffer and silence warnings in a block."""
    sys.stdout = sys.stderr = out
    warnings.simplefilter("ignore")
    try:
        yield
    finally:
        sys.stdout = sys.stderr = sys.__stdout__
