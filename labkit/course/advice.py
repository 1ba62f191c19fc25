"""Explanations of exceptions from a student's code: which line raised them, and what to do."""

from __future__ import annotations

import builtins
import linecache
import re
import sysconfig
from collections.abc import Iterable
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from traceback import walk_tb
from typing import Any

import numpy as np

from .. import se3
from ..control import State
from ..trajectory import PoseSample, Sample

_MINE = str(Path(__file__).parents[1])
_PACKAGES = {str(Path(np.__file__).parents[1]), *map(sysconfig.get_path, ("purelib", "platlib"))}
"""Folders of packages; an environment may take NumPy from another one than its own."""
_LIBRARIES = (_MINE, sysconfig.get_path("stdlib"), *_PACKAGES)


def in_library(file: str) -> bool:
    """Whether a file of code is a part of labkit, of Python or of an installed package."""
    return file.startswith(_LIBRARIES)


def line_of(error: BaseException) -> str:
    """The last line of the traceback that is outside labkit and all libraries, or ""."""
    found = ""
    for frame, number in walk_tb(error.__traceback__):
        file = frame.f_code.co_filename
        if not in_library(file):
            line = linecache.getline(file, number, frame.f_globals).strip()
            found = line or found  # code that a dataclass generates has no source line
    return found if len(found) <= 100 else f"{found[:97]}..."


def unwritten(error: BaseException) -> str:
    """The stub that raised an exception because a student's function called it, or ""."""
    codes = (frame.f_code for frame, _ in walk_tb(error.__traceback__))
    mine = [code for code in codes if not in_library(code.co_filename)]
    called = isinstance(error, NotImplementedError) and len({*mine}) > 1
    return mine[-1].co_name if called else ""


def still_raises(function: Any) -> str:
    """What to do where a function has more in it than a stub but raises as a stub does, or ""."""
    code = getattr(function, "__code__", None)
    if code is None or "NotImplementedError" not in code.co_names:  # a library raises it too
        return ""
    if len(code.co_names) == 1 and code.co_nlocals == code.co_argcount + code.co_kwonlyargcount:
        return ""  # a stub
    return (
        "Your function reaches its line `raise NotImplementedError`; delete this line once your "
        "own lines return the answer, and run the cell again."
    )


def remedy(error: BaseException) -> str:
    """What to do about an exception whose own message does not help a student, or ""."""
    text = str(error)
    if isinstance(error, NameError):
        return _unknown(error)
    if isinstance(error, AttributeError) and isinstance(error.obj, State | Sample | PoseSample):
        return f"it has {', '.join(error.obj._fields)}"
    if isinstance(error, AttributeError) and text.endswith("'"):  # numpy may give its own advice
        return _did_you_mean(_near(str(error.name or ""), dir(error.obj), 0.76))
    if isinstance(error, TypeError) and (kinds := re.search("'(State|Sample|PoseSample)'", text)):
        return f"did you mean {_ARRAYS[kinds[1]]}?"
    if "read-only" in text:
        return "the arrays that you are given are read-only; make a new array, or change x.copy()"
    if "matmul" in text and (sizes := re.search(r"size (\d+) is different from (\d+)", text)):
        b, a = sizes.groups()
        return f"the left side of @ has {a} columns and the right side {b} rows; they must be equal"
    if "could not be broadcast together" in text:
        return _unequal(text, line_of(error))
    if isinstance(error, TypeError) and "argument" in text and "()" in text and not line_of(error):
        return "leave the parameter names in the function's first line as they were given"
    return next((todo for words, todo in _REMEDIES.items() if words in text), "")


def _unknown(error: NameError) -> str:
    """The import that an unknown name needs, else a name in NumPy or a similar one, or ""."""
    name = str(error.name or "")
    if name in IMPORTS:
        return f"to use it, begin the cell with `{IMPORTS[name]}`"
    in_numpy = [f"np.{name}"] if hasattr(np, name) else []
    if getattr(getattr(se3, name, None), "__module__", "") == se3.__name__:
        return _did_you_mean([*in_numpy, f"lk.se3.{name}"])
    if name in import_module("labkit").__all__:
        return _did_you_mean([f"lk.{name}"])
    frames = [frame for frame, _ in walk_tb(error.__traceback__)][-1:]
    own = [x for frame in frames for x in (*frame.f_locals, *frame.f_globals)]
    near = _near(name, own, 0.85 if in_numpy else 0.6)
    return _did_you_mean([*near, *in_numpy] or _near(name, dir(builtins), 0.8))


def _near(name: str, names: Iterable[str], cutoff: float = 0.6) -> list[str]:
    """The public name that is most like an unknown one; none if it is not like it at all."""
    return get_close_matches(name, [x for x in names if x[:1] != "_"], 1, cutoff)


def _did_you_mean(names: Iterable[str]) -> str:
    return f"did you mean {' or '.join(names)}?" if names else ""


def _unequal(text: str, line: str) -> str:
    """What to do about arrays of different sizes; `@` is suggested only if it is possible."""
    says = "+, - and * work element by element, so the sizes must be equal"
    shapes = [shape.strip(",").split(",") for shape in re.findall(r"\((\d[\d,]*)\)", text)]
    if sorted(shapes) == [["6"], ["7"]]:
        return f"{says}; the tip's velocity has 6 numbers, the joints' 7, and J relates them"
    a, b = (*shapes, [], [])[:2]
    fits = len(a) > 1 and a[-1:] == b[-2:][:1]
    return f"{says}; use @ to multiply matrices" if fits and "@" not in line else says


IMPORTS = {
    line.split()[-1]: line
    for line in (
        "import math", "import numpy as np", "import numpy", "import scipy", "import control",
        "import control as ct", "import matplotlib.pyplot as plt", "import labkit as lk",
        "import labkit", "import pinocchio", "import pinocchio as pin", "import cv2",
        "from scipy import stats", "from labkit import se3",
    )
}  # fmt: skip
"""The line that imports each module of the course, by the name that it binds."""
_ARRAYS = {"State": "state.q", "Sample": "target.position", "PoseSample": "target.pose"}
"""What students usually mean when they use one of these as an array."""
_REMEDIES = {
    "does not have enough dimensions": "@ needs an array on each side; use * for a number",
    "broadcast input array from shape (3,1)": "a column, (3, 1), is used as a vector, (3,); "
    "convert it with .ravel()",
    "Singular matrix": "a matrix has an inverse only if its rank equals its size; J is (6, 7), so "
    "J @ J.T can have an inverse and J.T @ J cannot",
    "must be square": "only a square matrix can have an inverse",
    "object is not callable": "brackets after a name call a function; is a * missing, or did you "
    "use the name for something else?",
    "for ^:": "a power is written with **",
    "'bitwise_xor'": "a power is written with **",
    "as a data type": "give the shape in one pair of brackets, as in np.zeros((6, 7))",
    "method'": "brackets call a method, as in q.copy(); are they missing?",
    "cannot unpack non-iterable NoneType": "is a return missing?",
    "unsupported operand type(s) for -: 'list' and 'list'": "convert the lists with np.array "
    "first, or use np.subtract",
    "non-int of type 'TransferFunction'": "control.pade returns two lists, the numerator "
    "and the denominator; pass them to control.tf to make a transfer function",
    "argument 0 of type TransferFunction": "numpy cannot take the exponential of a transfer "
    "function; control.pade approximates a delay",
    "must have different signs": "brentq needs a function that has opposite signs at its two "
    "bounds; print it there, and look for a wrong sign, bounds that are too close together, or "
    "degrees among radians",
    "missing required argument 'cameraMatrix'": "after the pixels, pass the camera matrix and "
    "None for the distortion",
}
"""What to do about an exception, by words that its message contains."""


def description(error: BaseException) -> str:
    """What the exception says, the line that raised it, and the remedy."""
    text = str(error).strip()
    if isinstance(error, ValueError) and "gufunc" in text:
        number = "enough dimensions" in text
        text = "a single number beside @" if number else "sizes that do not match"
    line, todo = line_of(error), remedy(error)
    where = f"in the line `{line}`" if line else ""
    sentence = ", ".join(part for part in (text, where) if part)
    return f"{sentence}; {todo}" if todo else sentence


def full_description(error: BaseException) -> str:
    """The exception in one sentence: its type, followed by `description`."""
    sentence = description(error)
    return f"{type(error).__name__}: {sentence}" if sentence else type(error).__name__
