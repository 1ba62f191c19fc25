"""Live: an arm in real time, driven by a controller, with a hand that can pull at it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import se3
from ..arm import Arm
from ..control import JointTorque
from ..errors import OutOfRange, TypeMismatch, UnknownName
from ..model import Model
from ..plant import EVIDENCE, Plant
from ..robot import SIDES
from ..run import check_order, name_of
from ..shapes import as_number, shown
from ..trajectory import Hold, Target
from .motion import Motion, compact, drawn
from .player import still
from .session import OF_PLANT, LiveSession, arguments

if TYPE_CHECKING:
    from .widgets import Live

_SOFT = np.array([300.0] * 3 + [2.0] * 3)  # [N/m] and [N m/rad]
_DAMPED = 15.0  # [1/s]


def live(
    arm: Arm,
    target: Target | None = None,
    controller: Callable[..., Any] | Mapping[str, Callable[..., Any]] | None = None,
    *,
    rate: float = 200.0,
    title: str = "The arm, live",
    **dials: Any,
) -> Live:
    """Show an arm in real time that the user can pull with the mouse, by touch or with keys.

    ``lk.live(lk.Arm("left"))`` is a soft arm to play with.  A tag to drag, which the student's
    own servo follows by the camera's readings::

        readings = lk.TagStream(camera, board.tag, rate=10.0, delay=0.1)
        lk.live(arm, lk.TagTarget(readings, follower), controller, rate=100.0)

    Nothing runs before "Start" is pressed.  While the arm moves it belongs to the cell, and its use
    in other cells raises an error; Pause frees it.  If a controller raises, loses the arm or is too
    slow, the arm is left at rest, and a message beside the picture names the controller.

    Args:
        arm: A simulated arm, preferably one made for this cell; it starts where it is.
        target: As for `run`.  A closed path repeats for ever.  None is the place where the arm is.
            Walls, bands and tags can be dragged.
        controller: As for `run`; or several by name, to switch between.  One that has an argument
            with the name of a dial is given the dial's value there: ``law(state, target, Kp)``.
            None is a spring of 300 N/m from the tip to the target's pose.
        rate: How often the controller is called, in [Hz].
        title: The heading.
        **dials: For each dial a range (low, high) or (low, high, start), and perhaps a unit, as in
            (50.0, 1500.0, 300.0, "N/m").  A number of `Plant`, such as payload, stiction or
            state_delay, changes the arm itself; it starts where the arm has it.

    Returns:
        A view to put last in a cell; ``view.close()`` pauses it.

    Raises:
        TypeMismatch: The arm is not simulated, a controller or the target is not a function, they
            are swapped, or a dial has no range.
        UnknownName: Neither a controller nor the plant has a number of a dial's name.
        OutOfRange: A dial starts outside its range, or the rate does not fit the physics step.
    """
    from .widgets import Live

    if not isinstance(arm, Arm):
        raise TypeMismatch(f"arm is {shown(arm)}, expected a simulated lk.Arm")
    target = Hold(arm.model.pose(arm.truth().q), 1.0) if target is None else target
    controller = _soft(arm.model) if controller is None else controller
    named = controller if isinstance(controller, Mapping) else {name_of(controller): controller}
    check_order(target, *named.values())
    laws = {str(name): law for name, law in named.items()}
    found = [read_dial(name, span, arm.plant, laws) for name, span in dials.items()]
    widget, robot = Live(), arm.robot
    values = {dial["name"]: dial["value"] for dial in found}
    widget.session = LiveSession(arm, laws, target, values, rate, widget.send)
    widget.on_msg(lambda _, message, __: widget.session.tell(message))
    first = widget.session.numbers()
    widget.data = compact(
        {
            "kind": "live",
            "title": title,
            "alt": title,
            "side": robot.name,
            **({} if robot.name in SIDES else {"robot": drawn(robot)}),
            "laws": list(laws),
            "dials": found,
            "joints": [n.removeprefix(f"{robot.name}_") for n in robot.joint_names],
            "first": first,
            "path": widget.session.around.path(),
        }
    )
    widget.words = f"{title}. Run this cell, press Start, and pull at the arm with the mouse."
    q, things = np.array([first["q"]] * 2), first["things"]
    widget.picture = lambda: still(Motion(robot, np.array([0.0, 1.0]), q, things=things))
    return widget


def _soft(model: Model) -> Callable[..., JointTorque]:
    """A spring from the tip to the target's pose; speeds die away as fast in all joints."""

    def soft(state: Any, target: Any) -> JointTorque:
        q, J = state.q, model.tip_jacobian(state.q)
        spring = J.T @ (_SOFT * se3.pose_error(target.pose, model.pose(q)))
        weight = 0.0 if model.plant.gravity_compensation else model.gravity(q)
        return JointTorque(spring - _DAMPED * model.mass_matrix(q) @ state.dq + weight)

    return soft


def read_dial(
    name: str, span: Any, plant: Plant, laws: Mapping[str, Callable[..., Any]]
) -> dict[str, Any]:
    """A dial, from its range (low, high) or (low, high, start), and perhaps a unit.

    Raises:
        TypeMismatch: It has no range.
        OutOfRange: Its start is outside its range.
        UnknownName: It is neither a number of the plant nor an argument of a controller.
    """
    taken = {x for law in laws.values() for x in arguments(law)[2:]}
    if name not in OF_PLANT | taken:
        raise UnknownName("dial", name, sorted(OF_PLANT | taken))
    try:
        usual = EVIDENCE[name].unit if name in EVIDENCE else ""
        *numbers, unit = span if isinstance(span[-1], str) else (*span, usual)
        low, high, *start = (as_number(x, name) for x in numbers)
    except (TypeError, ValueError, LookupError):
        raise TypeMismatch(
            f"the dial {name} is {shown(span)}; give its range, {name}=(low, high) or "
            f"{name}=(low, high, start)"
        ) from None
    value = start[0] if start else low
    if name in OF_PLANT:
        own: Any = getattr(plant, name)
        value = min(max(max(own) if isinstance(own, tuple) else own, low), high)
    if not low <= value <= high or low >= high:
        raise OutOfRange(f"the dial {name} starts at {value:g}, outside {low:g} to {high:g}")
    return {"name": name, "min": low, "max": high, "value": value, "unit": unit}
