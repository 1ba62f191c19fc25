"""Stubs of what a notebook has around it: checks that check nothing, a shell that does little.

A submission is marked elsewhere; in here `check` only has to exist.
"""

from __future__ import annotations

import builtins
import contextlib
import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any


def install() -> None:
    """Put the stubs in the places where a notebook looks."""
    import labkit

    checks = ModuleType("labkit.course")
    for function in (check, cup, hint, predict, use):
        setattr(checks, function.__name__, function)
    vars(checks).update(also=hint, case=hint)  # none of which a given cell calls
    for name in ("course", "check"):  # notebooks of version 0.1 say labkit.check
        sys.modules[f"labkit.{name}"] = checks
        vars(labkit)[name] = checks
    vars(labkit).update(ready=ready, hand_in=hint, my_arm=my_arm, my_bug=my_arm)
    shell = Shell()
    vars(builtins).update(get_ipython=lambda: shell, display=display)
    with contextlib.suppress(ImportError):
        import IPython
        from IPython import display as displays

        vars(IPython).update(get_ipython=lambda: shell, display=display)
        vars(displays)["display"] = display


def ready() -> None:
    """Nothing: whether the machine is ready is not a student's business here."""


def check(name: str, function: Callable[..., Any] | None = None) -> float:
    """No verdict; that is reached elsewhere."""
    return 0.0


def hint(name: str, level: int = 1) -> None:
    """No hint."""


class NoOwnArm(Exception):
    """A cell wants to run the student's own arm, whose numbers they have written down."""


def my_arm(*_: Any, **__: Any) -> None:
    """Nobody's arm is here; the cells that run it are left out."""
    raise NoOwnArm


def predict(name: str, said: Any = None, *, truth: Any = None) -> Any:
    """What was committed to."""
    return said


def cup(make: Callable[..., Any], workspace: bool = False) -> None:
    """Keep the controller that is entered; its runs are made elsewhere."""
    vars(cup).update(make=make, workspace=workspace)


right: set[str] = set()
"""Questions whose public cases the student's functions passed, as the grader says."""


def use(
    name: str,
    function: Callable[..., Any],
    given: Callable[..., Any],
    yours: Callable[..., Any] | None = None,
    **options: Any,
) -> Callable[..., Any]:
    """The student's function where it is right, else the one given, as in a notebook.

    The cells run before any function is tried, so each call finds out anew which of the two it is.
    """

    def either(*args: Any, **kwargs: Any) -> Any:
        return ((yours or function) if name in right else given)(*args, **kwargs)

    return either


def display(*things: Any, **options: Any) -> None:
    """Show nothing."""


class Nothing:
    """What has every attribute and takes every call, such as the shell's ``events.register``."""

    def __getattr__(self, name: str) -> Nothing:
        return Nothing()

    def __call__(self, *args: Any, **options: Any) -> None:
        """Do nothing."""


class Shell(Nothing):
    """As much of IPython's shell as a cell may ask for; it runs no commands."""

    def __init__(self) -> None:
        self.user_ns: dict[str, Any] = {}

    def run_line_magic(self, name: str, line: str, *rest: Any, **options: Any) -> None:
        """``%time x`` runs x; any other magic does nothing."""
        if name == "time":
            exec(compile(line, "<magic>", "exec"), self.user_ns)

    def getoutput(self, command: str) -> list[str]:
        """No output."""
        return []
