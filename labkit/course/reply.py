"""Answers of a student's function as data, both in a notebook and in a grader's sandbox.

Both encode and decode the answer in the same way, so both accept the same answers.
"""

from __future__ import annotations

import _thread
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from itertools import islice
from time import monotonic, sleep
from typing import Any

from ..errors import LabkitError, TypeMismatch
from .advice import description, unwritten
from .calling import ArgumentChanged, call
from .serialize import NotComparable, decode_answer, encode

LONGEST = 400
"""Number of characters of an exception's message that are kept."""
MOST_ITEMS = 100_000
"""Number of items that are read from an answer that is not a list but can be iterated."""

NOT_WRITTEN = "NotWritten"
"""The kind of exception if a function calls a stub, and so is not a stub itself."""


class TimeUp(BaseException):
    """A cell or a call took too long."""


class NoAnswer(LabkitError):
    """A student's function did not answer.

    Attributes:
        kind: The name of the type of its exception.
    """

    def __init__(self, kind: str, sentence: str) -> None:
        """Take the kind of the exception, and a sentence about what happened."""
        self.kind = kind
        super().__init__(sentence)


def reply(
    function: Callable[..., Any], args: Sequence[Any], kwargs: Mapping[str, Any]
) -> dict[str, Any]:
    """A function's answer, or its exception, as JSON data.

    A value that is not a function, such as a prediction, is its own answer; None stands for a value
    that the student has not written yet.

    Returns:
        What the answer ``is``; or the type of the exception
        that was ``raised``, and what it ``says``.

    Raises:
        KeyboardInterrupt, TimeUp: The call was stopped from outside.
    """
    try:
        if function is None:
            raise NotImplementedError
        if not callable(function) and not args:
            return {"is": _as_data(function)}
        return {"is": _as_data(call(function, args, kwargs))}
    except (KeyboardInterrupt, TimeUp):
        raise
    except BaseException as error:
        with suppress(BaseException):  # its author may have made this raise
            if stub := unwritten(error):
                says = f"it calls {stub[:60]}, which is not written yet; write it or do without it"
                return {"raised": NOT_WRITTEN, "says": says}
        return {"raised": kind(error), "says": sentence(error)}


def answer(data: Mapping[str, Any]) -> Any:
    """The answer in what `reply` returned.

    Args:
        data: What `reply` returned, perhaps in another process.

    Raises:
        NoAnswer: The function did not answer.
    """
    if "is" in data:
        try:
            return decode_answer(data["is"])
        except TypeMismatch as error:
            raise NoAnswer("TypeMismatch", f"TypeMismatch: {error}") from None
    raised, says = str(data.get("raised", "Exception")), str(data.get("says", ""))
    if raised in (ArgumentChanged.__name__, NOT_WRITTEN):
        raise NoAnswer(raised, says)
    if raised == NotComparable.__name__:
        raise NoAnswer(raised, f"it returned a wrong kind of value: {says}")
    raise NoAnswer(raised, f"{raised}: {says}" if says else raised)


def kind(error: BaseException) -> str:
    """The name of an exception's type; its author may have made even this raise."""
    try:
        return str(type(error).__name__)
    except BaseException:
        return "Exception"


def sentence(error: BaseException) -> str:
    """The description of an exception; its author may have made this raise."""
    try:
        return description(error)[:LONGEST]
    except BaseException:
        return "(its message cannot be shown)"


class LocalFunction:
    """A student's function in this process, called in the same way as in a sandbox.

    Args:
        function: The student's function.
        seconds: Time limit of a call; after a call exceeds it, no other is made.
    """

    def __init__(self, function: Callable[..., Any], seconds: float = 10.0) -> None:
        self.function, self.seconds = function, seconds
        self.stopped: NoAnswer | None = None

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """The answer to one call.

        Raises:
            NoAnswer: The function did not answer.
        """
        if self.stopped is not None:
            raise self.stopped
        try:
            with time_limit(self.seconds):
                data = reply(self.function, args, kwargs)
        except TimeUp:
            says = f"it did not return within {self.seconds:g} s; does every loop in it end?"
            self.stopped = NoAnswer("TimeoutError", f"TimeoutError: {says}")
            raise self.stopped from None
        return answer(data)


class _Limit:
    """A limit of time: until when, and whether it was exceeded and whether its block is over."""

    def __init__(self, until: float) -> None:
        self.until, self.late, self.over = until, False, False


_watching: list[threading.Thread] = []
_limits: list[_Limit] = []
_lock = threading.Lock()


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raise `TimeUp` in the block after some seconds, and again if the block catches it.

    A thread interrupts the main one, as Ctrl-C does, on every system; other threads have no limit.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    limit = _Limit(monotonic() + seconds)

    def interrupted(number: int, frame: Any) -> None:
        if not limit.late:
            raise KeyboardInterrupt
        if not limit.over:
            raise TimeUp

    before = signal.signal(signal.SIGINT, interrupted)
    _limits.append(limit)
    if not any(thread.is_alive() for thread in _watching):  # it does not survive a fork
        _watching[:] = [threading.Thread(target=_watch, daemon=True)]
        _watching[0].start()
    try:
        yield
    finally:
        limit.over = True
        with _lock:  # an interruption has been sent by now, or never will be
            _limits.remove(limit)
        signal.signal(signal.SIGINT, before)


def _watch() -> None:
    while True:
        sleep(0.1)
        with _lock:
            for limit in _limits[-1:]:
                if monotonic() > limit.until and not limit.over:
                    limit.late, limit.until = True, monotonic() + 0.5
                    _interrupt()


def _interrupt() -> None:
    """Interrupt the main thread; a signal, where threads can be sent one, also ends its sleep."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
    else:
        _thread.interrupt_main()


def _as_data(given: Any) -> Any:
    """An answer as JSON data; what behaves like an array, number or sequence is taken for one."""
    try:
        return encode(given)
    except TypeMismatch as error:
        try:
            items = list(islice(given, MOST_ITEMS))
        except TypeError:  # such as a single Rotation, or a class
            raise error from None
        return encode(items)
