"""An exception from a student's code, in words: which line raised it, and what to do."""

from __future__ import annotations

import linecache
import re
import sysconfig
from pathlib import Path
from types import TracebackType

from ..control import State
from ..trajectory import PoseSample, Sample

_MINE = str(Path(__file__).parents[1])
_LIBRARIES = tuple({_MINE, *(sysconfig.get_path(p) for p in ("stdlib", "purelib", "platlib"))})


def in_labkit(file: str) -> bool:
    """Whether a line of code, by its file, is labkit's own."""
    return file.startswith(_MINE)


def in_library(file: str) -> bool:
    """Whether a line of code, by its file, is labkit's, Python's or an installed package's."""
    return file.startswith(_LIBRARIES)


def line_of(error: BaseException) -> str:
    """The last line of the traceback outside labkit and all libraries, or ""."""
    found = ""
    step: TracebackType | None = error.__traceback__
    while step is not None:
        file = step.tb_frame.f_code.co_filename
        if not in_library(file):
            line = linecache.getline(file, step.tb_lineno, step.tb_frame.f_globals).strip()
            found = line or found  # code that a dataclass writes has no line
        step = step.tb_next
    return found if len(found) <= 100 else f"{found[:97]}..."


def remedy(error: BaseException) -> str:
    """What to do about an exception whose own message does not help a student, or ""."""
    text = str(error)
    if isinstance(error, AttributeError) and isinstance(error.obj, State | Sample | PoseSample):
        return f"it has {', '.join(error.obj._fields)}"
    if isinstance(error, TypeError) and (kinds := re.search("'(State|Sample|PoseSample)'", text)):
        return f"did you mean {_ARRAYS[kinds[1]]}?"
    if "read-only" in text:
        return (
            "the arrays that you are given cannot be changed; make a new array, or change x.copy()"
        )
    if "matmul" in text and (sizes := re.search(r"size (\d+) is different from (\d+)", text)):
        b, a = sizes.groups()
        return f"left of the @ are {a} columns, right of it {b} rows; these must be equal"
    if "could not be broadcast together" in text:
        return _unequal(re.findall(r"\((\d[\d,]*)\)", text))
    if isinstance(error, TypeError) and "argument" in text and "()" in text:
        return "leave the names in the function's first line as they were given"
    return next((todo for words, todo in _REMEDIES.items() if words in text), "")


def _unequal(shapes: list[str]) -> str:
    """What to do about arrays of different sizes; only a matrix can have been meant for @."""
    says = "+, - and * go element by element, so sizes must be equal"
    sizes = [shape.strip(",") for shape in shapes]
    if any("," in size for size in sizes):
        return f"{says}; the product of matrices is @"
    if sorted(sizes) == ["6", "7"]:
        return f"{says}: a velocity of the tip has 6 numbers, one of the joints 7; J goes between"
    return says


_ARRAYS = {"State": "state.q", "Sample": "target.position", "PoseSample": "target.pose"}
"""What is mostly meant where one of these is used as an array."""
_REMEDIES = {
    "does not have enough dimensions": "@ needs arrays on both sides; for a number write *",
    "broadcast input array from shape (3,1)": "a column, (3, 1), is used as a vector, (3,); "
    "write .ravel()",
    "Singular matrix": "a matrix has an inverse only if its rank equals its size; J is (6, 7), so "
    "J @ J.T can have an inverse and J.T @ J cannot",
    "must be square": "only square matrices have an inverse",
    "object is not callable": "brackets after a name call it; is a * missing, or did you use "
    "the name for something else?",
    "cannot unpack non-iterable NoneType": "is a return missing?",
    "unsupported operand type(s) for -: 'list' and 'list'": "turn lists into arrays first, with "
    "np.array or np.subtract",
    "non-int of type 'TransferFunction'": "control.pade returns two lists, numerator and "
    "denominator; control.tf makes a transfer function from them",
    "argument 0 of type TransferFunction": "numpy cannot take the exponential of a transfer "
    "function; control.pade approximates a delay",
    "missing required argument 'cameraMatrix'": "after the pixels it needs the camera's matrix and "
    "None for the distortion",
}
"""What to do about an exception, by words of its message."""


def description(error: BaseException) -> str:
    """What the exception says, the line that raised it, and the remedy."""
    text = str(error)
    if isinstance(error, ValueError) and "gufunc" in text:
        text = "sizes that do not match"
    line, todo = line_of(error), remedy(error)
    where = f"in the line `{line}`" if line else ""
    sentence = ", ".join(part for part in (text, where) if part)
    return f"{sentence}; {todo}" if todo else sentence


def full_description(error: BaseException) -> str:
    """The exception in one sentence: its type, and `description`."""
    sentence = description(error)
    return f"{type(error).__name__}: {sentence}" if sentence else type(error).__name__
