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
from ..shapes import locked


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
    """A function changed a list or a dict that it was given."""


def call(function: Callable[..., Any], args: Sequence[Any], kwargs: Mapping[str, Any]) -> Any:
    """The function's answer to arguments that it cannot spoil for the next call.

    The function is given copies of lists and dicts, and read-only arrays.

    Raises:
        ArgumentChanged: The function changed the copy of a list or of a dict.
    """
    given, named = [_copied(x) for x in args], {key: _copied(x) for key, x in kwargs.items()}
    answer = function(*given, **named)
    places: list[int | str] = [*range(len(args)), *kwargs]
    befores, afters = [*args, *kwargs.values()], [*given, *named.values()]
    for place, before, after in zip(places, befores, afters, strict=True):
        if before is not after and not _same(before, after):
            raise ArgumentChanged(_sentence(function, place, before))
    return answer


def _copied(x: Any) -> Any:
    """A copy with new containers and read-only arrays; the value itself if it has neither."""
    if isinstance(x, np.ndarray):
        return locked(x.copy()) if x.flags.writeable else x
    if type(x) is list:
        return [_copied(item) for item in x]
    if type(x) is dict:
        return {key: _copied(item) for key, item in x.items()}
    if isinstance(x, tuple):
        items = [_copied(item) for item in x]
        if all(a is b for a, b in zip(x, items, strict=True)):
            return x
        return type(x)(*items) if hasattr(x, "_fields") else tuple(items)
    return x


def _same(before: Any, after: Any) -> bool:
    """Whether a copy still holds the original's objects; no ``==`` of an object is called."""
    if isinstance(before, np.ndarray):
        return True  # it cannot be written to
    if isinstance(before, list | tuple):
        return len(before) == len(after) and all(map(_same, before, after))
    if isinstance(before, dict):
        return list(before) == list(after) and all(map(_same, before.values(), after.values()))
    return before is after


def _sentence(function: Callable[..., Any], place: int | str, before: Any) -> str:
    name = place if isinstance(place, str) else _parameter(function, place)
    kind = type(before).__name__
    inner = before.values() if isinstance(before, dict) else before
    flat = kind != "tuple" and not any(isinstance(x, list | dict | tuple) for x in inner)
    which = f" `{name}`" if name else ""
    copy = name and f", {kind if flat else 'copy.deepcopy'}({name})"
    who = getattr(function, "__name__", "the function")
    return f"{who} changes the {kind}{which} that it is given; work on a copy{copy}"


def _parameter(function: Callable[..., Any], place: int) -> str:
    """The name of a function's parameter; "" if it cannot be determined."""
    with suppress(TypeError, ValueError, IndexError):
        parameter = list(inspect.signature(function).parameters.values())[place]
        if parameter.kind is not inspect.Parameter.VAR_POSITIONAL:
            return parameter.name
    return ""
