"""The plant: how the simulated arm differs from the textbook's, as one frozen value.

`IDEAL` is the textbook: exact state, no friction, commands obeyed at once, and gravity left to the
controller.  `BAXTER` behaves as the real arm is known to (sources beside each number).
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from .errors import OutOfRange
from .shapes import Array, as_each, as_number


@dataclass(frozen=True)
class Plant:
    """What the arm is like; every effect is off by default.

    What belongs to each joint is one number, or as many as the arm has joints: shape (n,).  Here it
    is kept as a tuple, of one number where all are equal; `each` gives all n.

    Attributes:
        name: What figures and tables call it.
        gravity_compensation: The arm itself adds the torque that holds it against gravity, in every
            mode, as Baxter does; a torque controller then adds none.
        armature: Inertia of each motor's rotor as its joint feels it, which is that of the rotor
            times the gear ratio squared, shape (n,) in [kg m^2]; it adds to the diagonal of M.
        viscous: Viscous friction, shape (n,) in [N m s/rad].
        stiction: Dry friction that a joint must overcome, shape (n,) in [N m].
        payload: A point mass held at the tip, unknown to the arm's gravity compensation, in [kg].
        velocity_lag: Time constant with which the velocity mode follows its command, in [s].
        position_gain: How fast the position mode closes a gap, in [1/s]; 0 closes it as fast as
            speed and torque allow, the torque to brake before it included.
        state_rate: How often the arm publishes its state, in [Hz]; 0 is every physics step.
        state_delay: Age of a state when it arrives, in [s].
        velocity_noise: Standard deviation of the measured joint speeds, shape (n,) in [rad/s].
        torque_noise: Standard deviation of the external torque that the arm estimates, shape (n,)
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
                value = tuple(as_each(value, None, field.name).tolist())  # hashable, comparable
                value = value[:1] if len(set(value)) == 1 else value
                object.__setattr__(self, field.name, value)
                as_number(min(value), field.name, least=0.0)
            elif field.name not in ("name", "gravity_compensation"):
                as_number(value, field.name, least=0.0)
        if self.lost_ticks > 1.0:
            raise OutOfRange(f"lost_ticks is {self.lost_ticks:g}; it is a share, at most 1")

    def each(self, name: str, n: int) -> Array:
        """What belongs to each of ``n`` joints, such as "stiction", shape (n,).

        Raises:
            ShapeError: This plant has another number of joints.
        """
        numbers = getattr(self, name)
        return as_each(numbers if len(numbers) > 1 else numbers[0], n, f"the plant's {name}")


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
