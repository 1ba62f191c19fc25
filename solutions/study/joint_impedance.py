r"""Joint impedance, with which each joint responds to a push as a mass, damper and spring do.

With the arm's own inertia (`inertia` None) no force has to be measured:

.. math:: \tau = M(q)\,\ddot q_d + C(q, \dot q)\,\dot q_d + g(q) + D\,\dot e + K\,e
   \quad\Rightarrow\quad M \ddot e + (C + D)\,\dot e + K\,e = -\tau_{ext}

This is exactly the augmented PD law of `joint_torque` under another name; its gains are chosen for
how the arm should yield, not for how it should track.

With another inertia the law uses the measured torque:

.. math:: \tau = M \left(\ddot q_d + M_d^{-1}(D\,\dot e + K\,e + \tau_{ext})\right)
   + C \dot q + g - \tau_{ext}
   \quad\Rightarrow\quad M_d\,\ddot e + D\,\dot e + K\,e = -\tau_{ext}

Siciliano, section 9.2; Ott, *Cartesian Impedance Control*, chapter 3; e = q_d - q.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from labkit import JointTorque, Model, Sample, State
from labkit.shapes import as_gains

from .joint_torque import AugmentedPD
from .shaping import as_inertia


@dataclass(frozen=True, eq=False)
class JointImpedance:
    """Torques that give the joints a stiffness, a damping and, if asked, another inertia.

    Attributes:
        model: The model of the arm.
        K: Stiffness, shape (n,) or one number, in [N m/rad].
        D: Damping, shape (n,) or one number, in [N m s/rad].
        inertia: M_d, shape (n,) or (n, n) in [kg m^2]; None keeps the arm's own.
        gravity: Add g(q); False for an arm that carries its own weight, as Baxter does.
    """

    model: Model
    K: Any
    D: Any
    inertia: Any = None
    gravity: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "K", as_gains(self.K, self.model.robot.n, "K"))
        object.__setattr__(self, "D", as_gains(self.D, self.model.robot.n, "D"))
        if self.inertia is not None:
            object.__setattr__(self, "inertia", as_inertia(self.inertia, self.model.robot.n))

    def __call__(self, state: State, target: Sample) -> JointTorque:
        """The command at this tick; the target's samples are joint angles."""
        if self.inertia is None:
            return AugmentedPD(self.model, self.K, self.D, self.gravity)(state, target)
        e, de = target.position - state.q, target.velocity - state.dq
        pull = self.D * de + self.K * e + state.tau_ext
        ddq = target.acceleration + np.linalg.solve(self.inertia, pull)
        tau = self.model.inverse_dynamics(state.q, state.dq, ddq) - state.tau_ext
        return JointTorque(tau if self.gravity else tau - self.model.gravity(state.q))
