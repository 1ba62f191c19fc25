"""Live: an arm in real time, driven by a controller, with a hand that can pull at it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arm import Arm
from ..errors import TypeMismatch
from ..robot import SIDES
from ..run import check_order, name_of
from ..shapes import shown
from ..trajectory import Target
from .dials import read_dials
from .figure import compact
from .motion import drawn
from .saved import still
from .session import Session
from .surroundings import faces

if TYPE_CHECKING:
    from .front import Live


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
    in other cells raises an error.  If a controller raises, loses the arm, is too slow or never
    returns, the arm is left at rest, and a message beside the picture names the controller.

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
    from .front import Live

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
