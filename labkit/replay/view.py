"""Live: an arm in real time, driven by a controller, with a hand that can pull at it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arm import Arm
from ..errors import OutOfRange, TypeMismatch, UnknownName
from ..plant import EVIDENCE, Plant
from ..robot import SIDES
from ..run import check_order, name_of
from ..shapes import as_number, shown
from ..trajectory import Target
from .motion import compact, drawn
from .player import still
from .session import OF_PLANT, Dial, Session, arguments
from .surroundings import faces

if TYPE_CHECKING:
    from .widgets import Live

_UNITS = {name: source.unit for name, source in EVIDENCE.items()}


def live(
    arm: Arm,
    target: Target,
    controller: Callable[..., Any] | Mapping[str, Callable[..., Any]],
    *,
    rate: float = 200.0,
    title: str = "The arm, live",
    **dials: Any,
) -> Live:
    """Show an arm in real time that the user can pull with the mouse, by touch or with keys.

    Nothing runs before "Start" is pressed.  From then on the arm belongs to the cell, and its use
    in other cells raises an error.  If a controller raises, loses the arm or is too slow, the arm
    is left at rest, and a message beside the picture names the controller.

    Args:
        arm: A simulated arm, preferably one made for this cell; it starts where it is.
        target: As for `run`.  A closed path repeats for ever; a target of poses can be dragged,
            and so can walls, tables, bands and tags.
        controller: As for `run`; or several by name, to switch between.  One that has an argument
            with the name of a dial is given the dial's value there: ``law(state, target, Kp)``.
        rate: How often the controller is called, in [Hz].
        title: The heading.
        **dials: For each dial a range (low, high) or (low, high, start), and perhaps a unit, as in
            (50.0, 1500.0, 300.0, "N/m").  A number of `Plant`, such as payload, stiction or
            state_delay, changes the arm itself.

    Returns:
        A view to put last in a cell; ``view.log`` is the run that was kept last, ``view.logs`` are
        all, ``view.close()`` frees the arm.  A run begins with Start, Reset, and each turn of a
        dial or choice of a controller, and anew after 120 s.

    Raises:
        TypeMismatch: The arm is not simulated, a controller or the target is not a function, they
            are swapped, or a dial has no range.
        UnknownName: Neither a controller nor the plant has a number of a dial's name.
        OutOfRange: A dial starts outside its range, or the rate does not fit the physics step.
    """
    from .widgets import Live

    if not isinstance(arm, Arm):
        raise TypeMismatch(f"arm is {shown(arm)}, expected a simulated lk.Arm")
    named = controller if isinstance(controller, Mapping) else {name_of(controller): controller}
    check_order(target, *named.values())
    laws = {str(name): law for name, law in named.items()}
    found = read_dials(dials, arm.plant, laws)
    widget = Live()
    widget.session = Session(arm, laws, target, found, rate, widget.send)
    widget.on_msg(lambda _, message, __: widget.session.tell(message))
    first = widget.session.numbers()
    widget.data = compact(
        {
            "kind": "live",
            "title": title,
            "alt": f"{title}: Baxter's {arm.robot.name} arm" if arm.robot.name in SIDES else title,
            "side": arm.robot.name,
            **({} if arm.robot.name in SIDES else {"robot": drawn(arm.robot)}),
            "laws": list(laws),
            "dials": [asdict(dial) for dial in found.values()],
            "joints": [n.removeprefix(f"{arm.robot.name}_") for n in arm.robot.joint_names],
            "first": first,
            "path": widget.session.around.path(),
        }
    )
    widget.words = (
        f"{title}. The controller is {' or '.join(laws)}. Run this cell, press Start, and pull at "
        "the arm with the mouse or with the buttons below it."
    )
    elbow = arm.model.point_on(first["q"], arm.robot.n // 2, np.zeros(3))[0]
    widget.picture = lambda: still(
        arm.robot, first["q"], around=elbow[None, :], alone=True, through=faces(first["things"])
    )
    return widget


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
        if name in OF_PLANT:
            own = getattr(plant, name)
            usual = max(own) if isinstance(own, tuple) else own
        elif any(name in arguments(law) for law in laws.values()):
            usual = low
        else:
            known = {*OF_PLANT, *(x for law in laws.values() for x in arguments(law)[2:])}
            raise UnknownName("dial", name, sorted(known))
        value = start[0] if start else min(max(usual, low), high)
        if not low <= value <= high or low >= high:
            raise OutOfRange(f"the dial {name} starts at {value:g}, outside {low:g} to {high:g}")
        dials[name] = Dial(name, low, high, value, unit)
    return dials
