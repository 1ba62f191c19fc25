"""The plant: how the simulated arm differs from the textbook's, as one frozen value.

`IDEAL` is the textbook arm: exact state, no friction, commands obeyed at once, and gravity left to
the controller.  `BAXTER` has the effects of the real arm.  Some of its numbers are published; the
others are assumed, because nobody has identified them on a machine.  `EVIDENCE` says which is
which, and how far off each may be.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np

from .errors import OutOfRange
from .shapes import Array, as_each, as_number


@dataclass(frozen=True)
class Plant:
    """The properties of an arm; every effect is off by default.

    A property of shape (n,) takes one number for all joints, or one for each joint.  It is stored
    as a tuple, which has a single number if all are equal; `each` returns all n numbers.

    Attributes:
        name: Its name in figures and tables.
        fits: Names of the robots whose numbers these are; empty if it fits any.
        gravity_compensation: Whether the arm itself adds the torque that holds it against gravity,
            in every mode, as Baxter does; a torque controller then adds none.
        armature: Inertia of each motor's rotor as felt at its joint, which is the rotor's inertia
            times the gear ratio squared, shape (n,) in [kg m^2]; it adds to the diagonal of M.
        viscous: Viscous friction, shape (n,) in [N m s/rad].
        stiction: Dry friction that a joint must overcome, shape (n,) in [N m].
        payload: A point mass held at the tip, unknown to the arm's gravity compensation, in [kg].
        velocity_lag: Time constant with which the velocity mode follows its command, in [s].
        position_gain: How fast the position mode closes a gap, in [1/s]; 0 closes it as fast as
            the limits of speed and torque, braking included, allow.
        state_rate: How often the arm publishes its state, in [Hz]; 0 is every physics step.
        state_delay: Age of a state when it arrives, in [s].
        encoder_offset: Amount by which each joint's encoder reads too high, shape (n,) in [rad], a
            calibration error that no controller can see.
        encoder_step: Resolution of the encoders, shape (n,) in [rad]; 0 is exact.
        velocity_noise: Standard deviation of the measured joint speeds, shape (n,) in [rad/s].
        torque_noise: Standard deviation of the external torque that the arm estimates, shape (n,)
            in [N m].
        torque_lag: Time constant of that estimate, in [s]; with 0 it follows every physics step.
        lost_ticks: Share of the control ticks whose command comes too late to be used.
        command_timeout: Time without a command after which the arm holds its position, in [s].
    """

    name: str = "custom"
    fits: tuple[str, ...] = ()
    gravity_compensation: bool = False
    armature: Any = 0.0
    viscous: Any = 0.0
    stiction: Any = 0.0
    payload: float = 0.0
    velocity_lag: float = 0.0
    position_gain: float = 0.0
    state_rate: float = 0.0
    state_delay: float = 0.0
    encoder_offset: Any = 0.0
    encoder_step: Any = 0.0
    velocity_noise: Any = 0.0
    torque_noise: Any = 0.0
    torque_lag: float = 0.0
    lost_ticks: float = 0.0
    command_timeout: float = 0.2

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name in _PER_JOINT:
                value = tuple(as_each(value, None, field.name).tolist())  # hashable, comparable
                value = value[:1] if len(set(value)) == 1 else value
                object.__setattr__(self, field.name, value)
                if field.name != "encoder_offset":
                    as_number(min(value), field.name, least=0.0)
            elif field.name == "fits":
                object.__setattr__(self, "fits", tuple(value))  # a list, where a log was read
            elif field.name not in ("name", "gravity_compensation"):
                as_number(value, field.name, least=0.0)
        if self.lost_ticks > 1.0:
            raise OutOfRange(f"lost_ticks is {self.lost_ticks:g}; it is a share, at most 1")

    def each(self, name: str, n: int) -> Array:
        """A property of each of ``n`` joints, such as "stiction", shape (n,).

        Raises:
            ShapeError: This plant has a different number of joints.
        """
        numbers = getattr(self, name)
        return as_each(numbers if len(numbers) > 1 else numbers[0], n, f"the plant's {name}")


_PER_JOINT = (
    "armature",
    "viscous",
    "stiction",
    "encoder_offset",
    "encoder_step",
    "velocity_noise",
    "torque_noise",
)


IDEAL = Plant(name="ideal")
"""The textbook arm."""

BAXTER = Plant(
    name="baxter",
    fits=("left", "right"),
    gravity_compensation=True,
    armature=(0.1, 0.1, 0.08, 0.08, 0.05, 0.05, 0.05),
    viscous=0.7,
    stiction=(1.0, 1.0, 0.8, 0.8, 0.3, 0.3, 0.3),
    velocity_lag=0.03,
    position_gain=20.0,
    state_rate=100.0,
    state_delay=0.004,
    velocity_noise=(0.01, 0.01, 0.01, 0.01, 0.03, 0.03, 0.03),
    torque_noise=(0.3, 0.3, 0.3, 0.3, 0.1, 0.1, 0.1),
    torque_lag=0.01,
    lost_ticks=0.02,
)
"""Baxter's arm as far as its properties are known; see `EVIDENCE`.

No other robot takes it, unless it is asked to by ``replace(BAXTER, fits=())``."""


class Evidence(NamedTuple):
    """The evidence for one number of `BAXTER`.

    Attributes:
        unit: Unit of the number.
        source: Where the number comes from or, if nobody measured it, why it was assumed.
        assumed: Whether the number is assumed, because no measurement of it is published.
        least: Smallest plausible value, for each joint or one for all.
        most: Largest plausible value.
    """

    unit: str
    source: str
    assumed: bool
    least: Any
    most: Any


_MISSED = (0.005, -0.005, 0.005, 0.005, -0.005, -0.005, 0.005)  # 4.9 mm at the ready pose


def _times(factor: float, numbers: Any) -> tuple[float, ...]:
    return tuple(factor * np.array(numbers))


EVIDENCE = {
    "gravity_compensation": Evidence(
        "", "Rethink, Gravity Compensation: a channel of its own, always on", False, True, True),
    "armature": Evidence(
        "kg m²", "not published; without rotors the report's torque gains make w2 unstable at "
        "200 Hz", True, _times(0.5, BAXTER.armature), _times(2.0, BAXTER.armature)),
    "viscous": Evidence("N m s/rad", "damping in Rethink's URDF", False, 0.35, 1.4),
    "stiction": Evidence(
        "N m", "read off the plateaus of torque in the report's figures", True,
        _times(0.25, BAXTER.stiction), _times(2.0, BAXTER.stiction)),
    "payload": Evidence("kg", "an empty gripper", False, 0.0, 0.0),
    "velocity_lag": Evidence("s", "not published", True, 0.01, 0.06),
    "position_gain": Evidence("1/s", "not published", True, 10.0, 100.0),
    "state_rate": Evidence("Hz", "Rethink's default joint_state_publish_rate", False, 100.0, 100.0),
    "state_delay": Evidence("s", "four hops of a millisecond each, estimated", True, 0.0, 0.02),
    "encoder_offset": Evidence(
        "rad", "left out by default; about 5 mm at the tip is what users report of the real arm",
        True, 0.0, _MISSED),
    "encoder_step": Evidence(
        "rad", "left out by default; 14 bits a turn would be 0.00038", True, 0.0, 0.00038),
    "velocity_noise": Evidence(
        "rad/s", "read off the report's figures", True, 0.0, _times(2.0, BAXTER.velocity_noise)),
    "torque_noise": Evidence(
        "N m", "not published; what a spring's deflection sensor may give", True, 0.0,
        _times(2.0, BAXTER.torque_noise)),
    "torque_lag": Evidence("s", "not published", True, 0.0, 0.05),
    "lost_ticks": Evidence("", "not published; Linux without a real-time kernel", True, 0.0, 0.1),
    "command_timeout": Evidence(
        "s", "Rethink's joint command timeout, 0.2 s by default", False, 0.2, 0.2),
}  # fmt: skip
"""The evidence for each number of `BAXTER`, by the name of its field.

The plant does not model the springs in Baxter's joints, the counter-springs at s1 and their
hysteresis, the bandwidth of the motors' own torque loops, backlash, or errors in the gravity
compensation of the arm itself.
"""
