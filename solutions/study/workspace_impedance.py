r"""Workspace impedance, with which the tip responds to a push as a mass, damper and spring do.

Operational space (Khatib 1987; Siciliano, section 9.2), with J the tip Jacobian in world axes:

.. math::

   \Lambda = (J M^{-1} J^T)^{-1}, \qquad \bar J = M^{-1} J^T \Lambda, \qquad
   e = \bigl(p_d - p,\ \log(R_d R^T)^\vee\bigr)

With the arm's own inertia (`inertia` None) no force has to be measured:

.. math:: a = \dot V_d + \Lambda^{-1}(D\,\dot e + K\,e)
   \quad\Rightarrow\quad \Lambda \ddot e + D\,\dot e + K\,e = -F_{ext}

With another inertia the law uses the measured force:

.. math:: a = \dot V_d + M_d^{-1}(D\,\dot e + K\,e + F_{ext}) - \Lambda^{-1} F_{ext}
   \quad\Rightarrow\quad M_d\,\ddot e + D\,\dot e + K\,e = -F_{ext}

A force measured h seconds late acts as :math:`F + h\,(M_d \Lambda^{-1} - I)\,\dot F`, so the
further M_d is from Lambda, the fresher the measurement must be.

The torque is then, with the elbow drawn to a posture in the dynamically consistent null space,

.. math:: \tau = J^T \Lambda\,(a - \dot J \dot q) + C \dot q + g
   + (I - J^T \bar J^T)\, M\,(k_p\,(q_{posture} - q) - k_d\,\dot q)

The default damping makes every direction critically damped for its inertia:
:math:`D = \zeta\,(\Lambda^{1/2} K^{1/2} + K^{1/2} \Lambda^{1/2})` (Albu-Schäffer et al. 2003).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from labkit import JointTorque, Model, PoseSample, State, se3
from labkit.shapes import Array, as_gains, as_number

from .shaping import as_inertia
from .singular import Watch


@dataclass(frozen=True, eq=False)
class WorkspaceImpedance:
    """Torques that give the tip a stiffness, a damping and, if asked, another inertia.

    Attributes:
        model: The model of the arm.
        K: Stiffness, shape (6,) or one number, in [N/m] and [N m/rad], world axes.
        D: Damping, shape (6,) or one number, in [N s/m] and [N m s/rad]; None takes `zeta`.
        zeta: The damping ratio if D is None.
        inertia: M_d, shape (6,) or (6, 6) in [kg] and [kg m^2]; None keeps the arm's own.
        gravity: Add g(q); False for an arm that carries its own weight, as Baxter does.
        posture: Joint angles to stay near, shape (n,) in [rad]; None is `Robot.ready`.
        pull: Stiffness of the posture for each unit of inertia, in [1/s^2]; critically damped.
        damping: The largest lambda squared by which the inverse of Lambda grows near a
            singularity, in [1/kg].
        watch: Decides when to damp.
    """

    model: Model
    K: Any
    D: Any = None
    zeta: float = 1.0
    inertia: Any = None
    gravity: bool = True
    posture: Any = None
    pull: float = 20.0
    damping: float = 0.02
    watch: Watch = field(default_factory=Watch)

    def __post_init__(self) -> None:
        object.__setattr__(self, "K", as_gains(self.K, 6, "K"))
        if self.D is not None:
            object.__setattr__(self, "D", as_gains(self.D, 6, "D"))
        if self.inertia is not None:
            object.__setattr__(self, "inertia", as_inertia(self.inertia, 6))
        posture = self.model.robot.ready if self.posture is None else self.posture
        object.__setattr__(self, "posture", self.model.within_limits(posture, "posture"))
        for name in ("zeta", "pull", "damping"):
            as_number(getattr(self, name), name, least=0.0)

    def __call__(self, state: State, target: PoseSample) -> JointTorque:
        """The command at this tick; the target's samples are poses."""
        q, dq, tau_ext = state.q, state.dq, state.tau_ext
        T_wt, J, M = self.model.pose(q), self.model.tip_jacobian(q), self.model.mass_matrix(q)
        drift, g = self.model.tip_jacobian_rate(q, dq) @ dq, self.model.gravity(q)
        c = self.model.bias(q, dq) - g
        MJ = np.linalg.solve(M, J.T)  # M^-1 J^T
        mobility = J @ MJ  # the inverse of Lambda
        mobility.flat[::7] += self.watch.share(J) * self.damping
        L = np.linalg.inv(mobility)

        e, de = se3.pose_error(target.pose, T_wt), target.twist - J @ dq
        F = self.K * e + self._damper(L if self.inertia is None else self.inertia) @ de
        if self.inertia is None:
            a = target.dtwist + mobility @ F
        else:
            F_ext = L @ (MJ.T @ tau_ext)
            a = target.dtwist + np.linalg.solve(self.inertia, F + F_ext) - mobility @ F_ext

        free = self.pull * (self.posture - q) - 2.0 * np.sqrt(self.pull) * dq
        wrench = L @ (a - drift - J @ free)
        tau = J.T @ wrench + M @ free + c
        return JointTorque(tau + g if self.gravity else tau)

    def _damper(self, inertia: Array) -> Array:
        if self.D is not None:
            return np.diag(self.D)
        values, axes = np.linalg.eigh(inertia)
        A = (axes * np.sqrt(np.maximum(values, 0.0))) @ axes.T * np.sqrt(self.K)
        return np.asarray(self.zeta * (A + A.T))
