"""How a student's function answers: as data, in a notebook as in a grader's sandbox.

The answer crosses the same border in both, so what one understands the other understands too.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import islice
from typing import Any

import numpy as np

from ..errors import LabkitError, TypeMismatch
from .advice import description
from .calling import ArgumentChanged, call
from .serialize import decode_answer, encode
from .withheld import Withheld

LONGEST = 400
"""Characters of an exception's message that are kept."""
MOST_ITEMS = 100_000
"""Items that are read of an answer that is not a list but behaves as one."""


class TimeUp(BaseException):
    """A cell or a call took too long."""


class NoAnswer(LabkitError):
    """A student's function did not answer.

    Attributes:
        kind: The type of the exception there.
    """

    def __init__(self, kind: str, sentence: str) -> None:
        """What happened there."""
        self.kind = kind
        super().__init__(sentence)


def reply(
    function: Callable[..., Any], args: Sequence[Any], kwargs: Mapping[str, Any]
) -> dict[str, Any]:
    """What a function does with some arguments, as JSON data, whatever that is.

    A value that is not a function, such as a prediction, is its own answer; None stands for a value
    that the student has not written yet.

    Returns:
        What it ``is``; or the tool that is ``withheld`` and that it used; or the type of what it
        ``raised``, and what that ``says``.

    Raises:
        KeyboardInterrupt, TimeUp: Somebody stopped it.
    """
    try:
        if function is None:
            raise NotImplementedError
        if not callable(function) and not args:
            return {"is": _as_data(function)}
        return {"is": _as_data(call(function, args, kwargs))}
    except (KeyboardInterrupt, TimeUp):
        raise
    except Withheld as error:
        return {"withheld": error.tool}
    except BaseException as error:
        return {"raised": kind(error), "says": sentence(error)}


def answer(data: Mapping[str, Any], withheld: Sequence[str]) -> Any:
    """The answer that a `reply` holds.

    Args:
        data: From `reply`, perhaps from another process.
        withheld: The tools that the question withholds.

    Raises:
        NoAnswer: There is none.
        Withheld: The function used a tool that the question withholds.
    """
    if "is" in data:
        try:
            return decode_answer(data["is"])
        except TypeMismatch as error:
            raise NoAnswer("TypeMismatch", f"TypeMismatch: {error}") from None
    if data.get("withheld") in withheld:
        raise Withheld(data["withheld"])
    raised, says = str(data.get("raised", "Exception")), str(data.get("says", ""))
    if raised == ArgumentChanged.__name__:
        raise NoAnswer(raised, says)
    raise NoAnswer(raised, f"{raised}: {says}" if says else raised)


def kind(error: BaseException) -> str:
    """The type of an exception, whatever its author made of that."""
    try:
        return str(type(error).__name__)
    except BaseException:
        return "Exception"


def sentence(error: BaseException) -> str:
    """What an exception says, whatever its author made of it."""
    try:
        return description(error)[:LONGEST]
    except BaseException:
        return "(its message cannot be shown)"


class LocalFunction:
    """A student's function of this process, asked as one in a sandbox is.

    Args:
        function: The student's function.
        withheld: The tools that the question withholds.
        seconds: After so long a call is stopped, and no other is made.
    """

    def __init__(
        self, function: Callable[..., Any], withheld: Sequence[str], seconds: float = 10.0
    ) -> None:
        self.function, self.withheld, self.seconds = function, withheld, seconds
        self.stopped: NoAnswer | None = None

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """The answer to one call.

        Raises:
            NoAnswer: There is none.
            Withheld: A withheld tool was used.
        """
        if self.stopped is not None:
            raise self.stopped
        try:
            with time_limit(self.seconds):
                data = reply(self.function, args, kwargs)
        except TimeUp:
            says = f"it did not come back within {self.seconds:g} s; does every loop in it end?"
            self.stopped = NoAnswer("TimeoutError", f"TimeoutError: {says}")
            raise self.stopped from None
        return answer(data, self.withheld)


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raise `TimeUp` in the block after some seconds, and again, should it be caught.

    Only where Python can: in the main thread, and not on Windows.
    """
    if threading.current_thread() is not threading.main_thread() or not hasattr(
        signal, "setitimer"
    ):
        yield
        return
    before = signal.signal(signal.SIGALRM, _time_up)
    signal.setitimer(signal.ITIMER_REAL, seconds, 0.5)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def _time_up(number: int, frame: Any) -> None:
    raise TimeUp


def _as_data(given: Any) -> Any:
    """An answer as JSON data; what behaves as an array or as a sequence is taken as one."""
    try:
        return encode(given)
    except TypeMismatch:
        if hasattr(given, "__array__"):
            return encode(np.asarray(given))
        if hasattr(given, "__float__"):
            return encode(float(given))
        if not hasattr(given, "__iter__"):
            raise
        return encode(list(islice(given, MOST_ITEMS)))
