r"""One joint's loop in formulas: what a gain may be, given the lag and the delay.

The velocity mode from command to angle is :math:`e^{-sd} / (s\,(\tau s + 1))`; see
`labkit.analysis`.  The differences between controllers are judged in `claims`.
"""

from __future__ import annotations

from math import atan, hypot, radians
from typing import Any

from scipy.optimize import brentq

from labkit.analysis import Loop, velocity_joint
from labkit.arrays import as_number
from labkit.errors import OutOfRange


def open_loop(kp: float, lag: float, delay: float) -> Any:
    """The loop of a joint in velocity mode under proportional control.

    Args:
        kp: In [1/s].
        lag: Time constant of the speed, in [s].
        delay: In [s]; by Padé's approximation.

    Returns:
        A control.TransferFunction from error to angle.
    """
    return Loop(velocity_joint(lag, delay), kp).open()


def kp_for_margin(lag: float, delay: float, margin_deg: float) -> float:
    r"""The gain with a wanted phase margin.

    The crossover w solves :math:`90^\circ - \arctan(w \tau) - w d = \varphi`, and there
    :math:`k_p = w \sqrt{1 + (w \tau)^2}` makes the loop's gain 1.

    Args:
        lag: tau, in [s].
        delay: d, in [s].
        margin_deg: phi, in [degrees], between 0 and 90.

    Returns:
        kp in [1/s].

    Raises:
        OutOfRange: No gain, or any gain, has this margin.
    """
    lag, delay = as_number(lag, "lag", least=0.0), as_number(delay, "delay", least=0.0)
    margin = radians(as_number(margin_deg, "margin_deg", above=0.0))
    if margin >= radians(90.0):
        raise OutOfRange(
            f"margin_deg is {margin_deg:g}; the integrator leaves less than 90 degrees"
        )
    if lag == delay == 0.0:
        raise OutOfRange("lag and delay are 0: an integrator keeps 90 degrees at any gain")

    def excess(w: float) -> float:
        return radians(90.0) - atan(w * lag) - w * delay - margin

    w = brentq(excess, 0.0, 2.0 / max(lag, delay) * (1.0 + 1.0 / margin), xtol=1e-12)
    return float(w * hypot(1.0, w * lag))
