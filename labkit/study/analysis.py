r"""One joint's loop on paper: margins, root locus and step response, by python-control.

A joint is a transfer function from its command to its angle, and a delay.  In velocity mode

.. math:: G(s) = \frac{e^{-sd}}{s\,(\tau s + 1)}, \qquad u = \dot q_d + K_p e + K_d \dot e,

and the loop is :math:`L(s) = (K_p + K_d s)\,G(s)`.  Åström & Murray, *Feedback Systems*, chapters
10 and 12.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any

import control
import numpy as np

from ..arrays import Array, as_number, as_numbers, shown
from ..errors import OutOfRange
from ..plant import Plant

_PADE = 4
"""Order of the rational stand-in for the delay; where a delay can be exact, it is."""


@dataclass(frozen=True)
class Joint:
    """A joint as its controller meets it.

    Attributes:
        numerator: Of its transfer function without the delay, highest power first.
        denominator: The same.
        delay: Between command and effect, measuring included, in [s].
    """

    numerator: tuple[float, ...]
    denominator: tuple[float, ...]
    delay: float = 0.0

    def __post_init__(self) -> None:
        as_number(self.delay, "delay", least=0.0)

    def transfer(self) -> Any:
        """From command to angle, the delay by Padé's approximation: a control.TransferFunction."""
        G = control.tf(self.numerator, self.denominator)
        if self.delay == 0.0:
            return G
        return control.tf(*control.pade(self.delay, _PADE)) * G

    def response(self, omega: Any) -> Any:
        """The exact frequency response, delay included.

        Args:
            omega: Angular frequencies, shape (k,) in [rad/s].

        Returns:
            Complex numbers, shape (k,).
        """
        s = 1j * np.asarray(omega, dtype=float)
        G = np.polyval(self.numerator, s) / np.polyval(self.denominator, s)
        return G * np.exp(-s * self.delay)


def velocity_joint(lag: float, delay: float = 0.0) -> Joint:
    """A joint in velocity mode: first-order lag, integrator, delay.

    Args:
        lag: Time constant with which its speed follows a command, in [s].
        delay: In [s].
    """
    lag = as_number(lag, "lag", least=0.0)
    return Joint((1.0,), (lag, 1.0, 0.0) if lag else (1.0, 0.0), delay)


def velocity_joint_of(plant: Plant, rate: float = 200.0) -> Joint:
    """What a plant's velocity mode is to a controller asked ``rate`` times a second.

    The delay is the mean age of the state that the controller sees plus half a period, for which a
    command is on average already out of date.
    """
    return velocity_joint(plant.velocity_lag, mean_age(plant, rate) + 0.5 / rate)


def mean_age(plant: Plant, rate: float) -> float:
    """How old, on average, the state is that a controller sees, in [s].

    Args:
        plant: Its state rate and delay.
        rate: How often the controller is asked, in [Hz].
    """
    as_number(rate, "rate", above=0.0)
    ticks = 1.0 + np.arange(2000) / rate
    if plant.state_rate == 0.0:
        return 0.0
    newest = np.floor((ticks - plant.state_delay) * plant.state_rate + 1e-9) / plant.state_rate
    return float(np.mean(ticks - newest))


@dataclass(frozen=True)
class Margins:
    """How far a loop is from instability.

    Attributes:
        gain: Factor by which the gain may grow; infinite if by any.
        phase: Phase that may be lost at the crossover, in [degrees].
        crossover: Where the loop's gain is 1, in [rad/s]; infinite if it is so nowhere.
        delay: Further delay that may come in, in [s].
        stable: Whether the closed loop is stable.
    """

    gain: float
    phase: float
    crossover: float
    delay: float
    stable: bool

    def __str__(self) -> str:
        if not self.stable:
            return "unstable"
        if self.crossover == inf:
            return f"gain margin {self.gain:.3g}, and at no frequency is the loop's gain 1"
        return (
            f"gain margin {self.gain:.3g}, phase margin {self.phase:.3g} degrees at "
            f"{self.crossover:.3g} rad/s, room for {1e3 * self.delay:.3g} ms of delay"
        )


@dataclass(frozen=True)
class Loop:
    """A joint under proportional and derivative feedback with feed-forward.

    Attributes:
        joint: What is controlled.
        Kp: Proportional gain, at least 0.
        Kd: Derivative gain, at least 0.
    """

    joint: Joint
    Kp: float
    Kd: float = 0.0

    def __post_init__(self) -> None:
        as_number(self.Kp, "Kp", least=0.0)
        as_number(self.Kd, "Kd", least=0.0)

    def open(self) -> Any:
        """The loop L(s), the delay by Padé: a control.TransferFunction."""
        return control.tf((self.Kd, self.Kp), (1.0,)) * self.joint.transfer()

    def margins(self) -> Margins:
        """Gain, phase and delay margins from the exact frequency response.

        Raises:
            OutOfRange: Both gains are zero, so there is no loop.
        """
        if self.Kp == 0.0 and self.Kd == 0.0:
            raise OutOfRange("Kp and Kd are both 0, so there is no loop that could have margins")
        omega = np.logspace(-2, 4, 1000)
        L = (self.Kp + 1j * omega * self.Kd) * self.joint.response(omega)
        data = control.FrequencyResponseData(L, omega, smooth=True)
        gain, phase, _, _, crossover, _ = control.stability_margins(data)
        gain, phase, crossover = (
            inf if x is None or np.isnan(x) else float(x) for x in (gain, phase, crossover)
        )
        room = np.radians(phase) / crossover if crossover < inf else inf
        # An integrator and falling gain: stable exactly when both margins are on the right side.
        stable = gain > 1.0 and phase > 0.0
        return Margins(gain, phase, crossover, float(room), stable)

    def step(self, t: Any) -> Array:
        """The joint's angle after a unit step of the wanted angle, without feed-forward.

        Args:
            t: Evenly spaced times from 0, shape (k,) in [s].

        Returns:
            Shape (k,) in [rad].

        Raises:
            OutOfRange: The times are not such.
        """
        t = as_numbers(t, "t")
        even = t.ndim == 1 and t.size > 1 and t[0] == 0.0 < t[-1]
        if not even or not np.allclose(t, np.linspace(0.0, t[-1], t.size)):
            raise OutOfRange(
                f"t is {shown(t)}; a step is computed at evenly spaced times from 0, such as "
                "np.linspace(0, 2, 201)"
            )
        out = control.step_response(control.feedback(self.open()), T=t).outputs
        return np.asarray(out, dtype=float).reshape(len(t))

    def locus(self, factors: Any) -> Array:
        """The closed loop's poles as both gains grow together (root locus).

        Args:
            factors: By which to multiply the gains, shape (k,).

        Returns:
            Complex poles, one row for each factor.
        """
        found = control.root_locus_map(self.open(), gains=np.asarray(factors, dtype=float))
        return np.asarray(found.loci)


def ultimate_gain(joint: Joint) -> float:
    """The proportional gain at which the joint would oscillate for ever; infinite if none does."""
    return Loop(joint, 1.0).margins().gain
