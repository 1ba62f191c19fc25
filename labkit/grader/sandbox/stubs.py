"""Stubs for what a notebook expects: checks that check nothing, and a shell that does nothing.

A submission is marked outside the sandbox, so `check` only has to exist.
"""

from __future__ import annotations

import builtins
import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any

import IPython

import labkit
from labkit.course.own_arm import commanded, my_arm, my_bug


def install() -> None:
    """Put the stubs where a notebook looks for the originals."""
    checks = ModuleType("labkit.course")
    vars(checks).update(check=nothing, case=nothing, predict=predict, use=use, commanded=commanded)
    sys.modules["labkit.course"] = vars(labkit)["course"] = checks
    vars(labkit).update(ready=nothing, hand_in=nothing, progress=nothing, restore=nothing)
    vars(labkit).update(my_arm=my_arm, my_bug=my_bug)
    vars(builtins).update(get_ipython=Shell, display=nothing)
    vars(IPython).update(get_ipython=Shell, display=nothing)
    vars(IPython.display)["display"] = nothing


def nothing(*_: Any, **__: Any) -> None:
    """Do nothing, as the grader gives verdicts outside, and nobody looks."""


def predict(name: str, said: Any = "?", *, truth: Any = None) -> Any:
    """Return the prediction that the student committed to; None for "?"."""
    return None if isinstance(said, str) and said == "?" else said


right: set[str] = set()
"""Questions whose public cases the student's functions passed; the grader sends them."""


def use(
    name: str,
    function: Callable[..., Any],
    given: Callable[..., Any],
    yours: Callable[..., Any] | None = None,
    **options: Any,
) -> Callable[..., Any]:
    """The student's function if it is right, else the given one, as in a notebook.

    The cells run before any function is tried, so the choice is made in each call.
    """

    def either(*args: Any, **kwargs: Any) -> Any:
        return ((yours or function) if name in right else given)(*args, **kwargs)

    return either


class Shell:
    """An object with every attribute and every method, none of which does anything."""

    def __getattr__(self, name: str) -> Shell:
        return Shell()

    def __call__(self, *args: Any, **options: Any) -> None:
        """Do nothing."""
