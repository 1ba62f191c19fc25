"""Stubs for what a notebook expects: checks that check nothing, and a shell that does little.

A submission is marked outside the sandbox, so `check` only has to exist.
"""

from __future__ import annotations

import builtins
import contextlib
import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any


def install() -> None:
    """Put the stubs where a notebook looks for the originals."""
    import labkit
    from labkit.course.own_arm import commanded, my_arm, my_bug

    checks = ModuleType("labkit.course")
    for function in (check, predict, use):
        setattr(checks, function.__name__, function)
    vars(checks).update(case=nothing, commanded=commanded)
    sys.modules["labkit.course"] = vars(labkit)["course"] = checks
    vars(labkit).update(ready=ready, hand_in=nothing, progress=nothing, restore=nothing)
    vars(labkit).update(my_arm=my_arm, my_bug=my_bug)
    shell = Shell()
    vars(builtins).update(get_ipython=lambda: shell, display=display)
    with contextlib.suppress(ImportError):
        import IPython
        from IPython import display as displays

        vars(IPython).update(get_ipython=lambda: shell, display=display)
        vars(displays)["display"] = display


def ready() -> None:
    """Do nothing, as the machine is not the student's."""


def check(name: str, function: Callable[..., Any] | None = None) -> float:
    """Give no verdict; the grader does, outside."""
    return 0.0


def nothing(name: str = "") -> None:
    """Do nothing."""


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


def display(*things: Any, **options: Any) -> None:
    """Show nothing."""


class NullObject:
    """An object with every attribute and every method, such as ``events.register``."""

    def __getattr__(self, name: str) -> NullObject:
        return NullObject()

    def __call__(self, *args: Any, **options: Any) -> None:
        """Do nothing."""


class Shell(NullObject):
    """The part of IPython's shell that cells may use; it does not run commands."""

    def __init__(self) -> None:
        self.user_ns: dict[str, Any] = {}

    def run_line_magic(self, name: str, line: str, *rest: Any, **options: Any) -> None:
        """Run x for ``%time x``; ignore all other magics."""
        if name == "time":
            exec(compile(line, "<magic>", "exec"), self.user_ns)

    def getoutput(self, command: str) -> list[str]:
        """Return no output."""
        return []
