r"""Joint torque PD, in both forms of Murray, Li & Sastry (MLS), section 4.5.

MLS write e = actual - desired; here, as everywhere, e = q_d - q, so every sign of e is reversed.

Computed torque (eq. 4.49, Proposition 4.8), whose error obeys a linear equation:

.. math:: \tau = M(q)\,(\ddot q_d + K_d\,\dot e + K_p\,e) + C(q, \dot q)\,\dot q + g(q)

Augmented PD (eq. 4.53, Proposition 4.10), whose energy falls as :math:`-\dot e^T K_d\,\dot e`:

.. math:: \tau = M(q)\,\ddot q_d + C(q, \dot q)\,\dot q_d + g(q) + K_d\,\dot e + K_p\,e

Computed torque with an integral, :math:`K_i \int e\,dt` inside the bracket, is stable in theory for
:math:`K_i < K_p K_d` (Lynch & Park, section 11.4).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from labkit import JointTorque, Model, Sample, State
from labkit.shapes import as_gains


@dataclass(frozen=True, eq=False)
class ComputedTorque:
    """Torques that give every joint the same linear error, whatever its inertia.

    Attributes:
        model: The model of the arm.
        Kp: Gains, shape (n,) or one number, in [1/s^2].
        Kd: Gains, shape (n,) or one number, in [1/s].
        gravity: Add g(q); False for an arm that carries its own weight, as Baxter does.
    """

    model: Model
    Kp: Any = 400.0
    Kd: Any = 40.0
    gravity: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "Kp", as_gains(self.Kp, self.model.robot.n, "Kp"))
        object.__setattr__(self, "Kd", as_gains(self.Kd, self.model.robot.n, "Kd"))

    def __call__(self, state: State, target: Sample) -> JointTorque:
        """The command at this tick; the target's samples are joint angles."""
        e, de = target.position - state.q, target.velocity - state.dq
        ddq = target.acceleration + self.Kd * de + self.Kp * e
        tau = self.model.inverse_dynamics(state.q, state.dq, ddq)  # M ddq + C dq + g
        return JointTorque(tau if self.gravity else tau - self.model.gravity(state.q))


@dataclass(eq=False)
class IntegralTorque:
    """Computed torque with an integral of the error, hence with a memory; see `reset`.

    Attributes:
        model: The model of the arm.
        Kp: Gains, shape (n,) or one number, in [1/s^2].
        Kd: Gains, shape (n,) or one number, in [1/s].
        Ki: Gains, shape (n,) or one number, in [1/s^3].
        gravity: Add g(q); False for an arm that carries its own weight, as Baxter does.
    """

    model: Model
    Kp: Any = 400.0
    Kd: Any = 40.0
    Ki: Any = 1000.0
    gravity: bool = True

    def __post_init__(self) -> None:
        self._without = ComputedTorque(self.model, self.Kp, self.Kd, self.gravity)
        self.Ki = as_gains(self.Ki, self.model.robot.n, "Ki")
        self.reset()

    def reset(self) -> None:
        """Forget the errors so far; `labkit.run` calls this at the start of each run."""
        self._t, self._sum = -1.0, self.model.robot.zeros

    def __call__(self, state: State, target: Sample) -> JointTorque:
        """The command at this tick; the target's samples are joint angles."""
        if self._t >= 0.0:  # the state's own time, which stands still until the arm reports again
            self._sum = self._sum + (state.t - self._t) * (target.position - state.q)
        self._t = state.t
        more = target.acceleration + self.Ki * self._sum
        return self._without(state, target._replace(acceleration=more))


@dataclass(frozen=True, eq=False)
class AugmentedPD:
    """Torques of a spring and a damper at each joint, added to those that the motion needs.

    Attributes:
        model: The model of the arm.
        Kp: Gains, shape (n,) or one number, in [N m/rad].
        Kd: Gains, shape (n,) or one number, in [N m s/rad].
        gravity: Add g(q); False for an arm that carries its own weight, as Baxter does.
    """

    model: Model
    Kp: Any
    Kd: Any
    gravity: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "Kp", as_gains(self.Kp, self.model.robot.n, "Kp"))
        object.__setattr__(self, "Kd", as_gains(self.Kd, self.model.robot.n, "Kd"))

    def __call__(self, state: State, target: Sample) -> JointTorque:
        """The command at this tick; the target's samples are joint angles."""
        q, dq, model = state.q, state.dq, self.model
        e, de = target.position - q, target.velocity - dq
        tau = model.mass_matrix(q) @ target.acceleration + model.coriolis(q, dq) @ target.velocity
        tau += self.Kd * de + self.Kp * e
        return JointTorque(tau + model.gravity(q) if self.gravity else tau)
