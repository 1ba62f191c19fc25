"""The runner, a submission's own process: runs the cells; a fork of it answers for each question.

Everything in here belongs to the student: whatever they do to it costs nobody else anything.
"""

from __future__ import annotations

import asyncio
import builtins
import inspect
import io
import linecache
import math
import os
import resource
import signal
import sys
import time
import traceback
import warnings
from collections.abc import Callable
from contextlib import AbstractContextManager, suppress
from typing import Any

from labkit.course.reply import LONGEST, TimeUp, kind, reply, sentence
from labkit.course.source import plain

from . import stubs as standins
from .protocol import Connection, Disconnected


class Notebook:
    """The student's names, and the functions that answer for the questions."""

    def __init__(self, codec: Any, limits: dict[str, Any]) -> None:
        module = type(sys)("__main__")
        sys.modules["__main__"] = module
        self.names: dict[str, Any] = vars(module)
        self.names.update(__builtins__=__builtins__, In=[""], Out={})
        self.functions: dict[str, Any] = {}
        self.codec, self.limits, self.output = codec, limits, 0
        shell = getattr(builtins, "get_ipython", None)
        if shell is not None:
            shell().user_ns = self.names

    def run(self, number: int, source: str, answers: list[str], seconds: float) -> dict[str, Any]:
        """Run one cell, and keep the functions that it is to define."""
        out = _Capped(min(20_000, max(0, self.limits["output"] - self.output)))
        began, error, raised = time.perf_counter(), "", ""
        with _Streams(out):
            try:
                with _Alarm(seconds, self.limits["patience"]):
                    self._execute(f"<cell {number}>", source)
            except TimeUp:
                raised, error = "TimeUp", f"it was stopped after {seconds:g} s"
            except BaseException as why:
                raised, error = kind(why), _sentence(why)
        for name in answers:
            if name in self.names:
                self.functions[name] = self.names[name]
        self.output += out.size
        spent = time.perf_counter() - began
        return {"kind": raised, "error": error, "output": out.getvalue(), "seconds": spent}

    def _execute(self, name: str, source: str) -> None:
        text = plain(source)
        linecache.cache[name] = (len(text), None, text.splitlines(True), name)
        code = compile(text, name, "exec", flags=0x2000)  # await may stand at the top level
        found = eval(code, self.names)
        if inspect.iscoroutine(found):
            asyncio.run(found)

    def answer(self, line: Connection, name: str) -> None:
        """Answer one call after another, until told to stop."""
        kwargs: dict[str, Any] = {}
        decode = self.codec.decode
        line.send({"ready": name})
        while True:
            asked = line.read()
            if "args" not in asked:
                return
            with _Streams(_Capped(0)):
                try:
                    args = [decode(x) for x in asked["args"]]
                    if asked["kwargs"] is not None:
                        kwargs = {key: decode(x) for key, x in asked["kwargs"].items()}
                    said = self._reply(name, args, kwargs)
                except BaseException as raised:
                    said = {"raised": kind(raised), "says": sentence(raised)}
            line.send(said)

    def _reply(self, name: str, args: list[Any], kwargs: dict[str, Any]) -> dict[str, Any]:
        seconds = self.limits["call"]
        if name not in self.functions:
            raise NameError(f"the notebook defines no {name}")
        try:
            with _Alarm(seconds, self.limits["patience"]):
                return reply(self.functions[name], args, kwargs)
        except TimeUp:
            return {"raised": "TimeUp", "says": f"it did not come back within {seconds:g} s"}


def serve(
    line: Connection,
    codec: Any,
    withhold: Callable[..., AbstractContextManager[None]],
    limits: dict[str, Any],
) -> None:
    """Do what the checker asks, until it closes its end."""
    notebook = Notebook(codec, limits)
    signal.signal(signal.SIGALRM, _time_up)
    signal.signal(signal.SIGPROF, _time_up)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    while True:
        try:
            asked = line.read()
        except Disconnected:
            return
        if "cell" in asked:
            result = notebook.run(
                asked["cell"], asked["source"], asked["answers"], asked["seconds"]
            )
            line.send({"ran": asked["cell"]} | result)
        if "question" not in asked:
            continue
        _sweep()
        child = os.fork()
        if child == 0:
            with suppress(BaseException):
                limit = int(_cpu() + limits["question"]) + 1
                with suppress(ValueError, OSError):
                    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
                standins.right.update(asked["right"])
                with withhold(asked["withheld"], notebook.names):
                    notebook.answer(line, asked["question"])
            os._exit(0)
        _, status = os.waitpid(child, 0)
        line.send({"over": os.waitstatus_to_exitcode(status)})


def _sweep() -> None:
    """End what the cells left running; a question needs room for a process of its own."""
    if os.getpid() == 1:  # first of its namespace: -1 is all the others
        with suppress(ProcessLookupError):
            os.kill(-1, signal.SIGKILL)
        with suppress(ChildProcessError):
            while True:
                os.waitpid(-1, 0)


def _sentence(error: BaseException) -> str:
    if isinstance(error, SyntaxError):
        with suppress(BaseException):
            return traceback.format_exception_only(error)[-1].partition(": ")[2].strip()[:LONGEST]
    return sentence(error)


def _time_up(number: int, frame: Any) -> None:
    raise TimeUp


def _stop_after(seconds: float | None) -> None:
    """Let the kernel end this process after that much more computing."""
    _, hard = resource.getrlimit(resource.RLIMIT_CPU)
    soft = hard if seconds is None else min(hard, math.ceil(_cpu() + seconds))
    with suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_CPU, (soft, hard))


def _cpu() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


class _Alarm:
    """Raises `TimeUp` after some seconds of computing, and again and again, should it be caught.

    Code that only waits is stopped after ``patience`` times as long; code that computes where no
    exception can reach it, by the kernel, soon after.
    """

    def __init__(self, seconds: float, patience: float) -> None:
        self.seconds, self.patience = seconds, patience

    def __enter__(self) -> None:
        signal.setitimer(signal.ITIMER_PROF, self.seconds, 0.5)
        signal.setitimer(signal.ITIMER_REAL, self.seconds * self.patience, 0.5)
        _stop_after(self.seconds + 1.0)

    def __exit__(self, *_: object) -> None:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        _stop_after(None)


class _Capped(io.StringIO):
    """Text that stops growing."""

    def __init__(self, most: int) -> None:
        super().__init__()
        self.most, self.size = most, 0

    def write(self, text: str) -> int:
        room = self.most - self.size
        if room > 0:
            self.size += super().write(text[:room])
        return len(text)


class _Streams:
    """Python's own streams and warnings go into a buffer while the block runs."""

    def __init__(self, out: _Capped) -> None:
        self.out = out

    def __enter__(self) -> None:
        sys.stdout = sys.stderr = self.out
        warnings.simplefilter("ignore")

    def __exit__(self, *_: object) -> None:
        sys.stdout = sys.stderr = sys.__stdout__
