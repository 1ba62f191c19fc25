"""Conversion of values, questions, verdicts and results to JSON data and back.

labkit's own records, such as verdicts, are read by msgspec as strictly as their fields are typed.
Other values carry the name of their kind; only the kinds named here are converted, and neither
pickle nor code is used.  `decode` builds every kind that labkit writes; `decode_answer` builds only
plain data, because students determine the content of an answer.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from contextlib import suppress
from types import MethodType
from typing import Any, TypeVar, get_args

import msgspec
import numpy as np

from .. import control, paths, plant, scene, servo, trajectory
from ..errors import LabkitError, TypeMismatch
from ..log import Log
from ..model import Model
from ..recordings import Runner, Trials
from ..robot import robot
from ..shapes import locked
from .judges import Judge, Ratio, TipTorque
from .own_arm import Bug, OwnArm
from .question import Case, Mistake, Question, Raised, Term, Test

DATA = (
    control.State,
    trajectory.Sample,
    trajectory.PoseSample,
    control.JointPosition,
    control.JointVelocity,
    control.JointTorque,
    paths.Line,
    paths.BangBang,
    trajectory.Trajectory,
    servo.Memory,
    servo.Bend,
    Ratio,
)
"""What a student's function may return, besides numbers, arrays, texts, lists and dicts."""

GIVEN = (
    paths.Circle,
    paths.Polyline,
    paths.Cubic,
    paths.Quintic,
    paths.Trapezoid,
    paths.Spline,
    trajectory.PosePath,
    trajectory.Chain,
    trajectory.Hold,
    Model,
    plant.Plant,
    scene.Push,
    scene.Spring,
    scene.Table,
    scene.Wall,
    Log,
    Trials,
    Runner,
    servo.Hand,
    servo.Conveyor,
    OwnArm,
    Bug,
)
"""What a student's function may also be given; each is sent as the arguments that make it."""

QUESTION = (Question, Test, Mistake, Term, Raised, TipTorque, *get_args(Case), *get_args(Judge))
"""The other types in a question."""

_MADE_OF: dict[type, Callable[[Any], dict[str, Any]]] = {
    paths.Spline: lambda spline: {"s": spline.s, "values": spline.values},
    trajectory.Chain: lambda chain: {"parts": chain.parts},
    trajectory.Hold: lambda hold: {"place": hold(0.0)[0], "duration": hold.duration},
    Model: lambda model: {"side": model.robot.name, "plant": model.plant},
    Log: lambda log: {
        **{f.name: getattr(log, f.name) for f in dataclasses.fields(log) if f.name != "robot"},
        "side": log.robot.name,
    },
}
"""The arguments that make a value again, for types that are not dataclasses or named tuples."""

_MADE_BY: dict[str, Callable[..., Any]] = {
    "Model": lambda side, plant: Model(side, plant),
    "Log": lambda side, **columns: Log(**columns, robot=robot(side)),
}
"""What makes a value from these arguments, if not its type; robots are named as Baxter's arms."""

Kinds = Mapping[str, Any]
"""Types by their names."""

_DATA: Kinds = {kind.__name__: kind for kind in DATA}
_ALL: Kinds = {kind.__name__: kind for kind in (*DATA, *GIVEN, *QUESTION)}
"""What `decode` builds, besides methods."""
_Record = TypeVar("_Record")

_COMMANDS: dict[str, type] = {kind.__name__: kind for kind in control.COMMANDS}


def question_data(question: Question) -> dict[str, Any]:
    """A question as JSON data, with all its cases."""
    data: dict[str, Any] = encode(question)
    return data


def read_question(data: Any) -> Question:
    """The question that `question_data` wrote."""
    question: Question = decode(data)
    return question


def record_data(record: Any) -> Any:
    """One of labkit's own records, such as a `Verdict`, as JSON data."""
    return msgspec.to_builtins(record)


def read_record(kind: type[_Record], data: Any) -> _Record:
    """The record that `record_data` wrote.

    Raises:
        LabkitError: A field is missing or has the wrong type; the message says which.
    """
    try:
        return msgspec.convert(data, kind)
    except (msgspec.ValidationError, RecursionError) as error:
        raise LabkitError(str(error)) from None


class NotComparable(TypeMismatch):
    """A value, such as a student's answer, is of a kind that no question compares."""


def encode(value: Any) -> Any:
    """A value as JSON data.

    Args:
        value: None, a truth value, number, text, list, tuple, dict with text keys, array of
            numbers, one of `DATA`, `GIVEN` or `QUESTION`, a method of one of these, or a type of
            command.

    Returns:
        Data for `json.dumps`; numbers keep every bit.

    Raises:
        NotComparable: The value is of another type.
    """
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, np.bool_):
        return bool(value)
    if isinstance(value, int | np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        return _number(float(value))
    if isinstance(value, np.ndarray):
        if value.dtype.kind == "O":
            with suppress(TypeError, ValueError):  # numbers that an array of objects holds
                value = value.astype(float)
        if value.dtype.kind not in "fiub":
            raise NotComparable(
                f"{'an array' if value.ndim else 'a number'} of type {value.dtype} cannot be "
                "compared; return real numbers or, if the question asks for one, a transfer "
                "function of python-control"
            )
        numbers = [_number(x) for x in np.asarray(value).ravel().tolist()]  # a matrix stays 2-D
        return {"$": "array", "shape": list(value.shape), "numbers": numbers}
    name = type(value).__name__
    if type(value) is _ALL.get(name):
        return {"$": name, **{key: encode(x) for key, x in _made_of(value).items()}}
    if isinstance(value, list):
        return [encode(x) for x in value]
    if isinstance(value, tuple):
        return {"$": "tuple", "items": [encode(x) for x in value]}
    if isinstance(value, dict):
        if not all(isinstance(key, str) for key in value):
            raise NotComparable("a dict must have text keys to be compared; convert them with str")
        return {"$": "dict", "items": {key: encode(x) for key, x in value.items()}}
    if isinstance(value, MethodType):
        return {"$": "method", "of": encode(value.__self__), "name": value.__name__}
    if type(value).__module__ == "control.statesp":
        from control import tf

        value = tf(value)
    if type(value).__module__.startswith("control.") and hasattr(value, "num"):
        num, den = (tuple(float(x) for x in part[0][0]) for part in (value.num, value.den))
        return encode(Ratio(num, den))
    if isinstance(value, type) and value is _COMMANDS.get(value.__name__):
        return {"$": "command type", "name": value.__name__}
    real = not np.iscomplexobj(value)
    if real and (hasattr(value, "__array__") or hasattr(value, "__float__")):  # as a fraction
        with suppress(TypeError, ValueError):
            return encode(np.asarray(value, dtype=float))
    raise NotComparable(
        f"a value of type {name} cannot be compared; give real numbers, arrays, lists or "
        + ", ".join(kind.__name__ for kind in DATA if kind is not Ratio)
        + ", or a transfer function of python-control"
    )


def _made_of(value: Any) -> dict[str, Any]:
    if type(value) in _MADE_OF:
        return _MADE_OF[type(value)](value)
    if dataclasses.is_dataclass(value):
        return {f.name: getattr(value, f.name) for f in dataclasses.fields(value) if f.init}
    fields: dict[str, Any] = value._asdict()
    return fields


def decode(data: Any) -> Any:
    """The value that `encode` wrote, from labkit's own JSON; arrays are read-only."""
    return _decode(data, _ALL)


def decode_answer(data: Any) -> Any:
    """Plain data, see `DATA`, from an answer that a student's process wrote.

    Raises:
        TypeMismatch: The data do not have the form that `encode` writes.
    """
    try:
        return _decode(data, _DATA)
    except Exception as error:  # the data may be made to raise anything
        raise TypeMismatch(f"the answer did not arrive in one piece: {error}") from None


def _decode(data: Any, kinds: Kinds) -> Any:
    def inner(x: Any) -> Any:
        return _decode(x, kinds)

    if isinstance(data, list):
        return [inner(x) for x in data]
    if not isinstance(data, dict):
        return data
    kind = data["$"]
    if kind == "float":
        return float(data["value"])
    if kind == "array":
        numbers = [
            x if isinstance(x, bool | int | float) else float(x["value"]) for x in data["numbers"]
        ]
        return locked(np.array(numbers, dtype=float).reshape([int(n) for n in data["shape"]]))
    if kind == "tuple":
        return tuple(inner(x) for x in data["items"])
    if kind == "dict":
        return {str(key): inner(x) for key, x in data["items"].items()}
    if kind in kinds:
        made = _MADE_BY.get(kind) or kinds[kind]
        return made(**{key: inner(x) for key, x in data.items() if key != "$"})
    if kinds is not _DATA and kind == "method":
        return getattr(inner(data["of"]), data["name"])
    if kinds is not _DATA and kind == "command type":
        return _COMMANDS[data["name"]]
    raise TypeMismatch(f"no value of kind {kind!r} can be read here")


def _number(x: Any) -> Any:
    """A number as JSON data; JSON does not have NaN and the infinities."""
    return x if isinstance(x, bool | int) or np.isfinite(x) else {"$": "float", "value": repr(x)}
