"""Differences in words, which say how an answer differs from the expected one."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from ..control import COMMANDS
from ..shapes import Array
from .question import in_brief
from .verdict import Difference, Kind, Value

_COMMANDS = [kind.__name__ for kind in COMMANDS]
_NAME = re.compile(r"(?!it |there )\w+(:| is| has| seems) ")
"""The beginning of a sentence that starts with the name of a part, which is not capitalised."""

_MEASURES = {
    "max_mm": ("the largest error of the tip", " mm"),
    "rms_mm": ("the RMS error of the tip", " mm"),
    "max_deg": ("the largest error of the tip's orientation", " degrees"),
    "rms_velocity_mm_s": ("the RMS error of the tip's velocity", " mm/s"),
    "worst_mm": ("the worst error", " mm"),
    "end_mm": ("the error at the end", " mm"),
    "place_step_mm": ("the largest jump of the reference", " mm"),
    "speed_step": ("the largest jump of the reference's speed", " m/s"),
    "lines": ("the number of new lines", ""),
}
"""The measures of a run in words, and their units."""

_CAUSES = {
    -1.0: "has the other sign",
    math.degrees(1.0): "seems to be in degrees; use radians",
    1e3: "is a thousand times too large: millimetres for metres?",
    1e-3: "is a thousand times too small",
    2.0: "is twice what is expected",
    0.5: "is half of what is expected",
}
"""The likely cause of each factor by which all numbers are wrong."""


def sentence(d: Difference, start: str = "") -> str:
    """A difference as a sentence, after its ``start``, that tells a student where to begin."""
    text, expected, got, guess = words(d)
    if got and d.several:
        text = f"{text}it gives {got}. Expected: {expected}"
    elif got and d.at:
        text = f"{text}it gives {got} instead of {expected}"
    elif got and isinstance(d.expected, tuple) and isinstance(d.found, tuple):
        text = _farthest(d, np.array(d.expected), np.array(d.found))
    elif got:
        text = f"{d.part or 'it'} is {got} instead of {expected}"
    if guess:
        text = f"{d.part or 'it'} {guess}"
    says = f"{start}it{text}" if text.startswith(" ") else f"{start}{text}"
    if not (d.kind is Kind.CHANGED or _NAME.match(says)):
        says = says[:1].upper() + says[1:]
    return says if says.endswith((".", "?", "!", "`")) else f"{says}."


def _farthest(d: Difference, expected: Array, found: Array) -> str:
    at = tuple(map(int, np.unravel_index(np.argmax(np.abs(found - expected)), found.shape)))
    where = _index(at)
    of = f"{d.part}: " if d.part else ""
    should, is_ = _apart(float(expected[at]), float(found[at]))
    return f"{of}the number at {where} is farthest off: it is {is_} instead of {should}"


def _index(at: Sequence[float]) -> str:
    index = ", ".join(f"{k:g}" for k in at)
    return f"index {f'({index})' if len(at) > 1 else index}"


def words(d: Difference) -> tuple[str, str, str, str]:
    """The place of a difference, what was expected, what was returned, and a likely cause."""
    of = f"{_quoted(d.part)}: " if d.part else ""
    text = ""
    match d.kind:
        case Kind.NUMBERS:
            at = f"at {_index(d.at)} " if d.at else ""
            also = ", or any that moves the tip in the same way" if d.several else ""
            expected, found = _apart(d.expected, d.found)
            return f"{of}{at}", expected + also, found, likely_cause(d)
        case Kind.RESPONSE:
            return f"at {d.at[0]:g} rad/s ", _polar(d.expected), _polar(d.found), ""
        case Kind.MEASURE:
            what, unit = _MEASURES.get(d.part, (d.part.replace("_", " "), ""))
            found = f"{_much(d.found)}{unit}"
            if str(d.found) == "inf":  # the arm was lost, or the gains are beyond the recorded ones
                found = "infinite, because no error was recorded for gains as large as these"
            text = f"{what} is {found}; the limit is {_much(d.expected)}{unit}"
        case Kind.TYPE if not d.expected:
            text = f"{of}the answer should be plain numbers, not a {d.found}"
        case Kind.TYPE:
            text = f"{of}it should be a {d.expected}, not {_instead(d)}"
        case Kind.VALUE:
            text = f"{of}it should be {d.expected}, not {_brief(d.found)}"
        case Kind.KEY:
            text = f"the key {d.part!r} is missing"
        case Kind.PARTS:
            parts = f"{len(d.parts)} values ({', '.join(d.parts)})"
            text = f"{of}it should be {parts}, not {_brief(d.found)}"
        case Kind.NOTHING:
            text = "it returned nothing (None); does each of its branches end with a return?"
        case Kind.RAISED:
            found = str(d.found or d.error)
            run = re.sub("^controller ", "the controller ", found)  # from `run`: a whole sentence
            text = f" raised {found}" if found.startswith(d.error) else run
        case Kind.REFUSED | Kind.CHANGED:
            text = str(d.found or d.error)
        case Kind.OTHER:
            text = "the answer cannot be compared with the expected one"
    return text, "", "", ""


def _quoted(part: str) -> str:
    """The name of a part, in quotation marks if it is a sentence, such as a claim."""
    return f'"{part}"' if part.count(" ") > 1 else part


def likely_cause(d: Difference) -> str:
    """The likely cause of wrong numbers."""
    if _is_rounded(d.expected, d.found):
        return "is float32, which has 7 digits; compute in float64"
    if d.times is None:
        return ""
    for factor, means in _CAUSES.items():
        if math.isclose(d.times, factor, rel_tol=1e-6):
            return means
    return ""


def _instead(d: Difference) -> str:
    """What was returned instead of the expected type, and how to make that type."""
    if d.found in _COMMANDS:
        return f"a {d.found}"
    what = _brief(d.found) or "plain numbers"
    if d.expected not in _COMMANDS:
        return what
    return f"{what}; return lk.{d.expected}(...) with one number for each joint"


def _is_rounded(expected: Value, found: Value) -> bool:
    """Whether numbers are right but for float32; short numbers, such as 0.5, do not show it."""
    if not isinstance(found, float | tuple) or type(found) is not type(expected):
        return False
    a, b = np.array(found), np.array(expected)
    short = all(x == float(f"{x:.6g}") for x in a.ravel().tolist())
    tiny = 1e-6 * np.abs(b).max(initial=0.0)
    alike = a.shape == b.shape and np.allclose(a, b, rtol=1e-5, atol=tiny)
    return bool(alike and not short and (a == a.astype(np.float32)).all())


def _apart(expected: Value, found: Value) -> tuple[str, str]:
    """Two values in short notation, with more digits if they would look the same."""
    pairs = [(_brief(expected, n), _brief(found, n)) for n in (0, 9, 12, 17)]
    return next((pair for pair in pairs if pair[0] != pair[1]), pairs[0])


def _brief(x: Value, digits: int = 0) -> str:
    if isinstance(x, float):
        return f"{x:.{digits or 6}g}" if abs(x) > 1e-10 else "0"
    return x if isinstance(x, str) else in_brief(x, digits or 5)


def _polar(x: Value) -> str:
    return f"{x[0]:.4g} at {x[1]:.4g} degrees" if isinstance(x, tuple) else str(x)


def _much(x: Value) -> str:
    return f"{x:.{'3g' if abs(x) < 1e3 else '0f'}}" if isinstance(x, float) else str(x)
