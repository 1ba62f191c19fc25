r"""Analysis of one joint's loop: margins and ultimate gain, computed by python-control.

A joint is a transfer function from its command to its angle, with a delay.  In velocity mode

.. math:: G(s) = \frac{e^{-sd}}{s\,(\tau s + 1)}, \qquad u = \dot q_d + K_p e + K_d \dot e,

and the loop is :math:`L(s) = (K_p + K_d s)\,G(s)`.  Åström & Murray, *Feedback Systems*, chapters
10 and 12.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, radians
from typing import NamedTuple

import control
import numpy as np

from .errors import OutOfRange
from .plant import Plant
from .shapes import as_number


@dataclass(frozen=True)
class VelocityJoint:
    """A joint in velocity mode as its controller sees it: first-order lag, integrator, delay.

    Attributes:
        lag: Time constant with which its speed follows a command, in [s].
        delay: Delay between command and effect, including the measurement, in [s].
    """

    lag: float
    delay: float = 0.0

    def __post_init__(self) -> None:
        as_number(self.lag, "lag", least=0.0)
        as_number(self.delay, "delay", least=0.0)


def velocity_joint_of(plant: Plant, rate: float = 200.0) -> VelocityJoint:
    """The joint that a controller called ``rate`` times a second sees in a plant's velocity mode.

    The delay is the mean age of the state that the controller sees, plus half a period, the mean
    age of a command.
    """
    return VelocityJoint(plant.velocity_lag, mean_age(plant, rate) + 0.5 / rate)


def mean_age(plant: Plant, rate: float) -> float:
    """The mean age of the state that a controller sees, in [s].

    Args:
        plant: The plant, with its state rate and delay.
        rate: How often the controller is called, in [Hz].
    """
    ticks = 1.0 + np.arange(2000) / as_number(rate, "rate", above=0.0)
    if plant.state_rate == 0.0:
        return 0.0
    newest = np.floor((ticks - plant.state_delay) * plant.state_rate + 1e-9) / plant.state_rate
    return float(np.mean(ticks - newest))


class Margins(NamedTuple):
    """How far a loop is from instability.

    Attributes:
        gain: Factor by which the gain may grow; infinite if there is no limit.
        phase: Phase that may be lost at the crossover, in [degrees].
        crossover: Frequency at which the loop's gain is 1, in [rad/s]; infinite if there is none.
        delay: Additional delay that is tolerated, in [s].
        stable: Whether the closed loop is stable.
    """

    gain: float
    phase: float
    crossover: float
    delay: float
    stable: bool


def margins(joint: VelocityJoint, Kp: float, Kd: float = 0.0) -> Margins:
    """Gain, phase and delay margins of a joint under feedback, from its exact frequency response.

    Args:
        joint: The controlled joint.
        Kp: Proportional gain, at least 0, in [1/s].
        Kd: Derivative gain, at least 0, without unit.

    Raises:
        OutOfRange: A gain is negative, or both are zero, so there is no loop.
    """
    Kp, Kd = as_number(Kp, "Kp", least=0.0), as_number(Kd, "Kd", least=0.0)
    if Kp == 0.0 and Kd == 0.0:
        raise OutOfRange("Kp and Kd are both 0, so there is no loop that could have margins")
    omega = np.logspace(-2, 4, 1000)
    s = 1j * omega
    L = (Kp + Kd * s) / np.polyval((joint.lag, 1.0, 0.0), s) * np.exp(-s * joint.delay)
    data = control.FrequencyResponseData(L, omega, smooth=True)
    gain, phase, _, _, crossover, _ = (
        inf if x is None or np.isnan(x) else float(x) for x in control.stability_margins(data)
    )
    room = radians(phase) / crossover if crossover < inf else inf
    # With an integrator and falling gain, this condition is exact.
    return Margins(gain, phase, crossover, room, stable=gain > 1.0 and phase > 0.0)


def ultimate_gain(joint: VelocityJoint) -> float:
    """The proportional gain at which the joint would oscillate for ever; infinite if none does."""
    return margins(joint, 1.0).gain
