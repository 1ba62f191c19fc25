"""Call a student's function, capture what it prints, and protect the arguments that it is given.

nbgrader takes any text on stderr for a failure, and PyBullet writes to the C streams, so the
streams of Python and of C are both captured.
"""

from __future__ import annotations

import inspect
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from io import StringIO
from typing import Any

import numpy as np

from ..errors import LabkitError
from ..quiet import diverted


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


class Recipe:
    """An argument that is made anew for each call, such as an arm."""

    def made(self) -> Any:
        """The argument that the function is given."""
        raise NotImplementedError


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
