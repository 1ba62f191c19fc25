"""Probes, which are the public calls of a question with one thing in them changed.

A release records the right answers to them, and a check calls the student's function in the same
way.  So even a mistake that is not known yet can be described: the answer does not change with a
velocity, for example, or what the velocity adds to it has the other sign.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from inspect import signature
from itertools import combinations
from typing import Any

import numpy as np

from ..control import State
from ..model import Model
from ..shapes import Array
from ..trajectory import PoseSample, Sample
from .question import Call, Probe, Question


def make_probes(
    question: Question, answer: Callable[..., Any], expected: Callable[..., Any]
) -> tuple[Probe, ...]:
    """The probes of a question, with the right answers.

    Args:
        question: The question, whose public calls are changed; one with a `Choice` has no probes.
        answer: The reference, for the names of its arguments.
        expected: A function of the same arguments that returns what to compare with.

    Returns:
        A probe for each thing that can be changed in every call, if all its answers are numbers.
    """
    calls = [call for call in question.calls if isinstance(call, Call)]
    if not calls or len(calls) < len(question.calls):
        return ()
    changed = [dict(variations(call, tuple(signature(answer).parameters))) for call in calls]
    found = []
    for label in changed[0]:
        if all(label in one for one in changed):
            answers = tuple(try_call(one[label], expected) for one in changed)
            parts = [numeric_parts(one) for one in answers]
            if all(parts) and all(np.isfinite(x).all() for one in parts for x in one):
                found.append(Probe(label, answers))
    return tuple(found)


def try_call(call: Call, function: Callable[..., Any]) -> Any:
    """The function's answer to a call; None if it raises, because such a call reveals nothing."""
    try:
        with np.errstate(all="ignore"):
            return call.ask(function)
    except Exception:
        return None


def numeric_parts(answer: Any) -> list[Array]:
    """The numbers of an answer, part by part; empty if it does not consist of numbers."""
    answer = getattr(answer, "value", answer)
    items = answer if isinstance(answer, tuple) else (answer,)
    try:
        return [np.asarray(x, dtype=float) for x in items if x is not None]
    except (TypeError, ValueError):
        return []


def variations(call: Call, names: Sequence[str]) -> Iterator[tuple[str, Call]]:
    """The call with one thing in it replaced, each under a label such as "`kd` is 0"."""
    given = arguments(call, names)
    state = next((x for x in given.values() if isinstance(x, State)), None)
    model = next((x for x in given.values() if isinstance(x, Model)), None)
    for name, x in given.items():
        if name != "t":  # the time at which a motion is evaluated is not a part of it
            for where, value, other in _changes(x, state, model):
                yield f"`{name}{where}` is {value}", _with(call, names, {name: other})


def exchanges(call: Call, names: Sequence[str]) -> Iterator[tuple[str, Call]]:
    """The call with two arguments exchanged, or one transposed, each under a label."""
    given = arguments(call, names)
    for (a, x), (b, y) in combinations(given.items(), 2):
        alike = np.shape(x) == np.shape(y) if _numeric(x) and _numeric(y) else False
        if alike or (type(x) is type(y) and isinstance(x, tuple)):
            yield f"`{a}` and `{b}` are exchanged", _with(call, names, {a: y, b: x})
    for name, x in given.items():
        if isinstance(x, np.ndarray) and x.ndim == 2 and x.shape[0] == x.shape[1]:
            yield f"`{name}` is transposed", _with(call, names, {name: x.T})


def arguments(call: Call, names: Sequence[str]) -> dict[str, Any]:
    """The arguments of a call by their names."""
    return dict(zip(names, call.args, strict=False)) | dict(call.kwargs)


def _with(call: Call, names: Sequence[str], new: dict[str, Any]) -> Call:
    args = tuple(new.get(name, x) for name, x in zip(names, call.args, strict=False))
    return replace(call, args=args, kwargs={k: new.get(k, x) for k, x in call.kwargs.items()})


def _numeric(x: Any) -> bool:
    return isinstance(x, float | int | np.ndarray) and not isinstance(x, bool)


def _changes(x: Any, state: State | None, model: Model | None) -> Iterator[tuple[str, str, Any]]:
    """Replacements for an argument: the place in it, its new value in words, the new argument."""
    if isinstance(x, State):
        yield ".dq", "0", x._replace(dq=0.0 * x.dq)
    elif isinstance(x, Sample):
        yield ".velocity", "0", x._replace(velocity=0.0 * x.velocity)
        yield ".acceleration", "0", x._replace(acceleration=0.0 * x.acceleration)
        if state is not None:
            yield ".position", "`state.q`", x._replace(position=state.q)
            yield ".velocity", "`state.dq`", x._replace(velocity=state.dq)
    elif isinstance(x, PoseSample):
        yield ".twist", "0", x._replace(twist=np.zeros(6))
        yield ".dtwist", "0", x._replace(dtwist=np.zeros(6))
        if state is not None and model is not None:
            tip, twist = model.pose(state.q), model.tip_jacobian(state.q) @ state.dq
            yield ".pose[:3, 3]", "the tip's", x._replace(pose=_patched(x.pose, tip, np.s_[:3, 3]))
            turned = _patched(x.pose, tip, np.s_[:3, :3])
            yield ".pose[:3, :3]", "the tip's", x._replace(pose=turned)
            yield ".twist", "the tip's", x._replace(twist=twist)
    elif isinstance(x, tuple):
        for k, part in enumerate(x):
            if _numeric(part):
                yield f"[{k}]", "0", (*x[:k], 0.0 * part, *x[k + 1 :])
    elif isinstance(x, np.ndarray | list) and np.ndim(x) >= 1 and np.asarray(x).dtype.kind == "f":
        yield from _arrays_like(np.asarray(x))
    elif _numeric(x):
        yield "", "0", 0.0
        yield "", "1", 1.0


def _arrays_like(x: Array) -> Iterator[tuple[str, str, Any]]:
    if x.shape == (4, 4):
        yield "[:3, 3]", "0", _patched(x, np.zeros((4, 4)), np.s_[:3, 3])
        yield "[:3, :3]", "the identity", _patched(x, np.eye(4), np.s_[:3, :3])
    elif x.shape[-2:] == (3, 3) and np.allclose(x @ np.swapaxes(x, -1, -2), np.eye(3)):
        yield "", "the identity", np.broadcast_to(np.eye(3), x.shape)
    else:
        yield "", "0", 0.0 * x


def _patched(x: Array, other: Array, where: Any) -> Array:
    x = x.copy()
    x[where] = other[where]
    return x
