"""The dials of a live session, and the controllers that read them."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from ..errors import OutOfRange, TypeMismatch, UnknownName
from ..plant import EVIDENCE, Plant
from ..shapes import as_number, shown

_OF_PLANT = {f.name for f in fields(Plant)} - {"name", "fits", "gravity_compensation"}
_UNITS = {name: source.unit for name, source in EVIDENCE.items()}


@dataclass(frozen=True)
class Dial:
    """A number that the user can change.

    Attributes:
        name: Name of a number of `Plant`, or of an argument of a controller.
        min: Least value.
        max: Largest value.
        value: Starting value.
        unit: Unit of the values.
    """

    name: str
    min: float
    max: float
    value: float
    unit: str = ""

    @property
    def of_plant(self) -> bool:
        """Whether the dial belongs to the plant and not to a controller."""
        return self.name in _OF_PLANT


def read_dials(
    given: Mapping[str, Any], plant: Plant, laws: Mapping[str, Callable[..., Any]]
) -> dict[str, Dial]:
    """The dials by name.

    Args:
        given: For each dial, a range (low, high) or (low, high, start), and perhaps a unit.
        plant: The plant with the starting values of its dials.
        laws: The controllers that read the other dials, by name.

    Raises:
        TypeMismatch: A dial has no range.
        OutOfRange: A start is outside its range.
        UnknownName: A dial is neither a number of the plant nor an argument of a controller.
    """
    dials = {}
    for name, span in given.items():
        try:
            *numbers, unit = span if isinstance(span[-1], str) else (*span, _UNITS.get(name, ""))
            low, high, *start = (as_number(x, name) for x in numbers)
        except (TypeError, ValueError, LookupError):
            raise TypeMismatch(
                f"the dial {name} is {shown(span)}; give its range, {name}=(low, high) or "
                f"{name}=(low, high, start)"
            ) from None
        if name in _OF_PLANT:
            own = getattr(plant, name)
            usual = max(own) if isinstance(own, tuple) else own
        elif any(name in arguments(law) for law in laws.values()):
            usual = low
        else:
            known = {*_OF_PLANT, *(x for law in laws.values() for x in arguments(law)[2:])}
            raise UnknownName("dial", name, sorted(known))
        value = start[0] if start else min(max(usual, low), high)
        if not low <= value <= high or low >= high:
            raise OutOfRange(f"the dial {name} starts at {value:g}, outside {low:g} to {high:g}")
        dials[name] = Dial(name, low, high, value, unit)
    return dials


def arguments(law: Callable[..., Any]) -> tuple[str, ...]:
    """The names of a controller's arguments."""
    try:
        return tuple(inspect.signature(law).parameters)
    except (TypeError, ValueError):
        return ()


class Dialled:
    """The selected controller, called with the values of the dials that are among its arguments.

    Attributes:
        name: Name of the selected controller.
        values: Present values of the dials.
        asked: Latest command of the controller.
    """

    asked: Any = None

    def __init__(self, laws: Mapping[str, Callable[..., Any]], dials: Mapping[str, Dial]) -> None:
        """Select the first controller, and set the dials to their starting values."""
        self._laws, self._dials = laws, dials
        self._takes = {
            law: [d for d in dials if d in arguments(f) and not dials[d].of_plant]
            for law, f in laws.items()
        }
        self.name = next(iter(laws))
        self.values = {name: dial.value for name, dial in dials.items()}

    @property
    def __name__(self) -> str:
        """The controller and its dials, for logs and messages."""
        told = [f"{d} {self.values[d]:g}" for d in self._takes[self.name]]
        return ", ".join([self.name, *told])

    def reset(self) -> None:
        """Let the selected controller forget, if it has a memory."""
        if reset := getattr(self._laws[self.name], "reset", None):
            reset()

    def turn(self, name: str, value: float) -> bool:
        """Set a dial, and return whether it belongs to the plant."""
        self.values[name] = value
        return self._dials[name].of_plant

    def dialled(self, usual: Plant) -> Plant:
        """The usual plant with the values of its dials."""
        numbers: Any = {n: v for n, v in self.values.items() if self._dials[n].of_plant}
        return replace(usual, **numbers, name=f"{usual.name}, dialled")

    def __call__(self, state: Any, target: Any) -> Any:
        """The selected controller's command."""
        dials = {d: self.values[d] for d in self._takes[self.name]}
        self.asked = self._laws[self.name](state, target, **dials)
        return self.asked
