"""The plant: how the simulated arm differs from the textbook's, as one frozen value.

`IDEAL` is the textbook: exact state, no friction, commands obeyed at once, and gravity left to the
controller.  `BAXTER` behaves as the real arm is known to (sources beside each number).
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from .errors import OutOfRange
from .shapes import as_each, as_number


@dataclass(frozen=True)
class Plant:
    """What the arm is like; every effect is off by default.

    Attributes:
        name: What figures and tables call it.
        gravity_compensation: The arm itself adds the torque that holds it against gravity, in every
            mode, as Baxter does; a torque controller then adds none.
        armature: Inertia of each motor's rotor as its joint feels it, which is that of the rotor
            times the gear ratio squared, shape (7,) in [kg m^2]; it adds to the diagonal of M.
        viscous: Viscous friction, shape (7,) in [N m s/rad].
        stiction: Dry friction that a joint must overcome, shape (7,) in [N m].
        payload: A point mass held at the tip, unknown to the arm's gravity compensation, in [kg].
        velocity_lag: Time constant with which the velocity mode follows its command, in [s].
        position_gain: How fast the position mode closes a gap, in [1/s]; 0 closes it as fast as
            speed and torque allow, the torque to brake before it included.
        state_rate: How often the arm publishes its state, in [Hz]; 0 is every physics step.
        state_delay: Age of a state when it arrives, in [s].
        velocity_noise: Standard deviation of the measured joint speeds, shape (7,) in [rad/s].
        torque_noise: Standard deviation of the external torque that the arm estimates, shape (7,)
            in [N m].
        torque_lag: Time constant of that estimate, in [s]; 0 is that of the last physics step.
        lost_ticks: Share of the control ticks whose command comes too late to be used.
        command_timeout: After this long without a command the arm holds its place, in [s].
    """

    name: str = "custom"
    gravity_compensation: bool = False
    armature: Any = 0.0
    viscous: Any = 0.0
    stiction: Any = 0.0
    payload: float = 0.0
    velocity_lag: float = 0.0
    position_gain: float = 0.0
    state_rate: float = 0.0
    state_delay: float = 0.0
    velocity_noise: Any = 0.0
    torque_noise: Any = 0.0
    torque_lag: float = 0.0
    lost_ticks: float = 0.0
    command_timeout: float = 0.2

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name in _PER_JOINT:
                value = tuple(as_each(value, 7, field.name).tolist())  # hashable, comparable
                object.__setattr__(self, field.name, value)
                as_number(min(value), field.name, least=0.0)
            elif field.name not in ("name", "gravity_compensation"):
                as_number(value, field.name, least=0.0)
        if self.lost_ticks > 1.0:
            raise OutOfRange(f"lost_ticks is {self.lost_ticks:g}; it is a share, at most 1")


_PER_JOINT = ("armature", "viscous", "stiction", "velocity_noise", "torque_noise")


IDEAL = Plant(name="ideal")
"""The textbook arm."""

BAXTER = Plant(
    name="baxter",
    gravity_compensation=True,  # Rethink, "Gravity compensation": a channel of its own, always on
    armature=(0.1, 0.1, 0.08, 0.08, 0.05, 0.05, 0.05),  # not published; the least that is stable
    viscous=0.7,  # the URDF's <dynamics damping>
    stiction=(1.0, 1.0, 0.8, 0.8, 0.3, 0.3, 0.3),  # plateaus of the report's torque figures
    velocity_lag=0.03,
    position_gain=20.0,
    state_rate=100.0,  # Rethink's default joint_state_publish_rate
    state_delay=0.004,  # four hops of a millisecond each
    velocity_noise=(0.01, 0.01, 0.01, 0.01, 0.03, 0.03, 0.03),  # read off the report's figures
    torque_noise=(0.3, 0.3, 0.3, 0.3, 0.1, 0.1, 0.1),  # not published; a spring's deflection sensor
    torque_lag=0.01,
    lost_ticks=0.02,
)
"""The arm as its users found it."""
