r"""Workspace velocity PD with feed-forward, and a posture in the null space.

.. math::

   V &= V_d + K_p\,e + K_d\,(V_d - J \dot q), \qquad
   e = \bigl(p_d - p,\ \log(R_d R^T)^\vee\bigr) \\
   u &= J^+ V + (I - J^\dagger J)\, k\,(q_{posture} - q)

The sources are Lynch & Park, section 11.3.3, and Siciliano, sections 3.5 and 3.7.  J is the tip
Jacobian in world axes, and J^+ its inverse, damped near singularities.  The null space uses the
undamped inverse; with the damped one the posture would move the tip.

If the tip cannot follow, out of reach or at a singularity, the damped inverse chooses speeds that
reduce :math:`|e_p|^2 + \ell^2 |e_o|^2`, and the arm comes to rest at its minimum, where a radian
counts as much as the lever :math:`\ell` in metres.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from labkit import JointVelocity, Model, PoseSample, State, se3
from labkit.shapes import as_gains, as_number

from .singular import Watch, damped_inverse


@dataclass(frozen=True, eq=False)
class WorkspaceVelocityPD:
    """Joint speeds that make the tip follow a trajectory of poses.

    Attributes:
        model: The model of the arm.
        Kp: Gains on the position [1/s] and orientation [1/s] error, shape (6,) or one number.
        Kd: Gains on the error of the twist, shape (6,) or one number, without unit.
        posture: Joint angles to stay near, shape (n,) in [rad]; None is `Robot.ready`.
        pull: The gain of the posture, in [1/s].
        damping: The largest damping, lambda squared.
        lever: The weight of a radian if position and orientation cannot both be reached, in [m];
            the default is that of the compared impedance, the root of 20 N m/rad over 300 N/m.
        watch: Decides when to damp.
    """

    model: Model
    Kp: Any = 5.0
    Kd: Any = 0.0
    posture: Any = None
    pull: float = 1.0
    damping: float = 4e-3
    lever: float = 0.26
    watch: Watch = field(default_factory=Watch)

    def __post_init__(self) -> None:
        object.__setattr__(self, "Kp", as_gains(self.Kp, 6, "Kp"))
        object.__setattr__(self, "Kd", as_gains(self.Kd, 6, "Kd"))
        posture = self.model.robot.ready if self.posture is None else self.posture
        object.__setattr__(self, "posture", self.model.within_limits(posture, "posture"))
        as_number(self.pull, "pull", least=0.0)
        as_number(self.damping, "damping", least=0.0)
        as_number(self.lever, "lever", above=0.0)

    def __call__(self, state: State, target: PoseSample) -> JointVelocity:
        """The command at this tick; the target's samples are poses."""
        J = self.model.tip_jacobian(state.q)
        e = se3.pose_error(target.pose, self.model.pose(state.q))
        V = target.twist + self.Kp * e + self.Kd * (target.twist - J @ state.dq)
        free = self.pull * (self.posture - state.q)
        damping = self.watch.share(J) * self.damping
        if damping == 0.0:
            return JointVelocity(free + damped_inverse(J, 0.0) @ (V - J @ free))
        free = free - np.linalg.pinv(J) @ (J @ free)
        counts = np.repeat((1.0, self.lever), 3)
        return JointVelocity(damped_inverse(counts[:, None] * J, damping) @ (counts * V) + free)
