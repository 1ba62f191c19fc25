"""Calls of a student's function, in a notebook and in a grader's sandbox alike.

What it prints is captured, its arguments are copies, and its answer becomes plain data.
nbgrader takes any text on stderr for a failure, and PyBullet writes to the C streams, so the
streams of Python and of C are both captured.
"""

from __future__ import annotations

import _thread
import inspect
import signal
import tempfile
import threading
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from io import StringIO
from itertools import islice
from time import monotonic, sleep
from typing import Any

import numpy as np

from ..errors import LabkitError, TypeMismatch
from ..quiet import diverted
from .advice import description, unwritten
from .own_arm import Recipe
from .serialize import NotComparable, decode_answer, encode


class Captured:
    """The text of the streams and the warnings, which is complete once the block is over."""

    text: str = ""


class CappedText(StringIO):
    """A text stream that keeps only its beginning.

    Args:
        most: Number of characters to keep.
    """

    def __init__(self, most: int) -> None:
        super().__init__()
        self.most, self.size = most, 0

    def write(self, text: str) -> int:
        """Keep as much as there is room for, and report all of it as written."""
        left = self.most - self.size
        if left > 0:
            self.size += super().write(text[:left])
        return len(text)


MOST_CAPTURED = 100_000
"""Number of characters, and of bytes of the C streams, that `captured` keeps."""


@contextmanager
def captured() -> Iterator[Captured]:
    """Capture stdout and stderr of Python and of C, and warnings, while the block runs."""
    out, result = CappedText(MOST_CAPTURED), Captured()
    with (
        tempfile.TemporaryFile() as file,
        diverted(file.fileno()),
        warnings.catch_warnings(record=True) as said,
    ):
        warnings.simplefilter("always")
        with redirect_stdout(out), redirect_stderr(out):
            try:
                yield result
            finally:
                words = [out.getvalue(), *(f"{w.category.__name__}: {w.message}\n" for w in said)]
                file.seek(0)
                below = file.read(MOST_CAPTURED).decode(errors="replace")
                result.text = "".join([*words, below])


class ArgumentChanged(LabkitError):
    """A function changed a list, a dict or an array that it was given."""


def call(function: Callable[..., Any], args: Sequence[Any], kwargs: Mapping[str, Any]) -> Any:
    """The function's answer to arguments that it cannot spoil for the next call.

    The function is given copies that can be written to, because scipy and cv2 read no others.

    Raises:
        ArgumentChanged: The function changed the copy of a list, of a dict or of an array.
    """
    given, named = [copied(x) for x in args], {key: copied(x) for key, x in kwargs.items()}
    answer = function(*given, **named)
    places: list[int | str] = [*range(len(args)), *kwargs]
    befores, afters = [*args, *kwargs.values()], [*given, *named.values()]
    for place, before, after in zip(places, befores, afters, strict=True):
        changed = before is not after and not isinstance(before, Recipe)
        if changed and not _same(before, after):
            raise ArgumentChanged(_sentence(function, place, before))
    return answer


def called(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, each call of which goes through `call`."""
    return lambda *args, **kwargs: call(function, args, kwargs)


def copied(x: Any) -> Any:
    """A copy with new containers and arrays; what a recipe makes; else the value itself."""
    if isinstance(x, Recipe):
        return x.made()
    if isinstance(x, np.ndarray):
        return x.copy()
    if type(x) is list:
        return [copied(item) for item in x]
    if type(x) is dict:
        return {key: copied(item) for key, item in x.items()}
    if isinstance(x, tuple):
        items = [copied(item) for item in x]
        if all(a is b for a, b in zip(x, items, strict=True)):
            return x
        return type(x)(*items) if hasattr(x, "_fields") else tuple(items)
    return x


def _same(before: Any, after: Any) -> bool:
    """Whether a copy still holds the original's objects; no ``==`` of an object is called."""
    if isinstance(before, np.ndarray):
        return bool(before.shape == after.shape and before.tobytes() == after.tobytes())
    if isinstance(before, list | tuple):
        return len(before) == len(after) and all(map(_same, before, after))
    if isinstance(before, dict):
        return list(before) == list(after) and all(map(_same, before.values(), after.values()))
    return before is after


def _sentence(function: Callable[..., Any], place: int | str, before: Any) -> str:
    name = place if isinstance(place, str) else _parameter(function, place)
    array = isinstance(before, np.ndarray)
    kind = "array" if array else type(before).__name__
    inner = before.values() if isinstance(before, dict) else before
    flat = not array and not any(isinstance(x, list | dict | tuple | np.ndarray) for x in inner)
    how = "np.array" if array else kind if flat and kind in ("list", "dict") else "copy.deepcopy"
    which = f" `{name}`" if name else ""
    copy = name and f", {how}({name})"
    who = getattr(function, "__name__", "the function")
    return f"{who} changes the {kind}{which} that it is given; work on a copy{copy}"


def _parameter(function: Callable[..., Any], place: int) -> str:
    """The name of a function's parameter; "" if it cannot be determined."""
    with suppress(TypeError, ValueError, IndexError):
        parameter = list(inspect.signature(function).parameters.values())[place]
        if parameter.kind is not inspect.Parameter.VAR_POSITIONAL:
            return parameter.name
    return ""


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
