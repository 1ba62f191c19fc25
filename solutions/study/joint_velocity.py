r"""Joint velocity PD with feed-forward.

.. math:: u = \dot q_d + K_p\,(q_d - q) + K_d\,(\dot q_d - \dot q)

Lynch & Park, *Modern Robotics*, section 11.3, with the error as target minus actual.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from labkit import JointVelocity, Sample, State
from labkit.shapes import as_gains


@dataclass(frozen=True, eq=False)
class JointVelocityPD:
    """Speeds that follow a joint trajectory.

    Attributes:
        Kp: Position gains, shape (n,) or one number, in [1/s].
        Kd: Velocity gains, shape (n,) or one number, without unit.
    """

    Kp: Any = 5.0
    Kd: Any = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "Kp", as_gains(self.Kp, None, "Kp"))
        object.__setattr__(self, "Kd", as_gains(self.Kd, None, "Kd"))

    def __call__(self, state: State, target: Sample) -> JointVelocity:
        """The command at this tick; the target's samples are joint angles."""
        e, de = target.position - state.q, target.velocity - state.dq
        return JointVelocity(target.velocity + self.Kp * e + self.Kd * de)
