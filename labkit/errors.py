"""Errors, whose messages give the value, the limit and what to do.

Everything that labkit raises derives from `LabkitError`, so a caller can catch a single class.
Most subclasses are also the built-in exception that a Python programmer would expect, and some keep
their details as attributes.  `args` are the arguments of the constructor, so that errors can be
sent between processes.
"""

from __future__ import annotations

from collections.abc import Iterable


class LabkitError(Exception):
    """Base class of all labkit errors."""


class LabkitWarning(UserWarning):
    """A problem that deserves attention but does not stop the program."""


class ShapeError(LabkitError, ValueError):
    """An array does not have the shape that the mathematics requires."""

    def __init__(self, name: str, expected: tuple[int, ...], actual: tuple[int, ...]) -> None:
        """Name the array, the expected shape and the actual one."""
        super().__init__(name, expected, actual)
        self.name, self.expected, self.actual = name, expected, actual

    def __str__(self) -> str:
        hint, expected = _hint(self.expected, self.actual), self.expected or "one number"
        return f"{self.name} has shape {self.actual}, expected {expected}{hint}"


def _hint(expected: tuple[int, ...], actual: tuple[int, ...]) -> str:
    if expected == ():
        one = "; take the one number out of it, as in x[0], or leave out the brackets around it"
        return one if set(actual) == {1} else ""
    if len(expected) != 1:
        return "; the transpose would fit" if actual == expected[::-1] else ""
    n = expected[0]
    if len(actual) == 2 and sorted(actual) == [1, n]:
        return "; a vector in labkit is 1-D, so use .ravel() or write it without the extra brackets"
    if actual == ():
        return f"; a single number is not enough: give all {n}"
    if len(actual) == 1:
        return f"; give {n} numbers, not {actual[0]}"
    return "; a matrix came where a vector belongs"


class TypeMismatch(LabkitError, TypeError):
    """A value does not have the expected type and cannot be converted to it."""


class NotFinite(LabkitError, ValueError):
    """An array holds a NaN or an infinity."""


class OutOfRange(LabkitError, ValueError):
    """A number is outside its permitted range."""


class JointLimitExceeded(OutOfRange):
    """A joint angle is outside the joint's range."""

    def __init__(self, name: str, joint: str, value: float, lower: float, upper: float) -> None:
        """Name the joint, the value and the range, all in radians."""
        super().__init__(name, joint, value, lower, upper)
        self.name, self.joint, self.value, self.lower, self.upper = name, joint, value, lower, upper

    def __str__(self) -> str:
        hint = "; angles are in radians: is this one in degrees?" if abs(self.value) > 6.5 else ""
        return (
            f"{self.name}: joint {self.joint} at {self.value:.4g} rad is outside "
            f"[{self.lower:.4g}, {self.upper:.4g}] rad{hint}"
        )


class UnknownName(LabkitError, KeyError):
    """Nothing with that name exists."""

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        """Name the thing that is missing, and those that exist."""
        self.kind, self.name, self.known = kind, name, tuple(known)
        super().__init__(kind, name, self.known)

    def __str__(self) -> str:
        known = ", ".join(map(repr, self.known)) or "none"
        return f"no {self.kind} {self.name!r:.60}; there is {known}"


class Unreachable(LabkitError, ValueError):
    """Inverse kinematics found no joint angles for a pose."""


class ControllerError(LabkitError):
    """A controller or a target returned nothing usable; `log` keeps the run up to that point."""

    log: object = None


class Diverged(ControllerError):
    """The closed loop ran away."""


class Closed(LabkitError, RuntimeError):
    """The simulated world was closed and can no longer be used."""


def listed(names: Iterable[str]) -> str:
    """One name or more as a sentence lists them: "a", "a and b" or "a, b and c"."""
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last
