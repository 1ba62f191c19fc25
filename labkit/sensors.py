"""The sensors of an arm, which publish its joint states and estimate external torque."""

from __future__ import annotations

from collections import deque

import numpy as np

from .control import State
from .model import Model
from .plant import Plant
from .shapes import Array
from .world import whole_steps


class Reports:
    """States on their way from the joints to the controller: infrequent, late and noisy.

    Attributes:
        every: Physics steps between two reports; 0 for an arm whose state is always available.
    """

    def __init__(self, plant: Plant, n: int, dt: float, random: np.random.Generator) -> None:
        """Report ``n`` joints with the imperfections of ``plant``, in steps of ``dt`` [s]."""
        self._delay, self._random = plant.state_delay, random
        self._noise, self._torque_noise = (
            plant.each(name, n) for name in ("velocity_noise", "torque_noise")
        )
        self._offset, self._step = (
            plant.each(name, n) for name in ("encoder_offset", "encoder_step")
        )
        self._off = bool(self._offset.any() or self._step.any())
        self._noisy = bool(self._noise.any() or self._torque_noise.any())
        self.every = whole_steps(plant.state_rate, dt, "plant.state_rate")
        if not self.every and (self._noisy or self._delay or self._off):
            self.every = 1

    def read(self, q: Array) -> Array:
        """The encoder readings at the joint angles ``q``, shape (n,) in [rad]."""
        if not self._off:
            return q
        read: Array = q + self._offset
        coarse = self._step > 0.0
        read[coarse] = np.round(read[coarse] / self._step[coarse]) * self._step[coarse]
        return read

    def reset(self, state: State) -> None:
        """Forget all reports before ``state``."""
        self._mail, self._last = deque([state]), -1

    def due(self, steps: int) -> bool:
        """Whether a report is to be sent at this physics step."""
        return self.every > 0 and steps % self.every == 0 and steps != self._last

    def send(self, t: float, q: Array, dq: Array, felt: Array, steps: int) -> None:
        """Send a report of the true state, with offset, resolution and noise applied."""
        self._last = steps
        if self._noisy:
            dq = dq + self._noise * self._random.standard_normal(dq.size)
            felt = felt + self._torque_noise * self._random.standard_normal(dq.size)
        self.newest(t)  # drops the reports that nobody asked for
        self._mail.append(State(t, self.read(q), dq, felt))

    def newest(self, t: float) -> State:
        """The newest report that has arrived by time ``t`` [s], in a copy."""
        while len(self._mail) > 1 and self._mail[1].t <= t - self._delay + 1e-9:
            self._mail.popleft()
        t, q, dq, felt = self._mail[0]
        return State(t, q.copy(), dq.copy(), felt.copy())


class TorqueSensors:
    r"""Torque sensors on the output side of the gears, with their estimate of external torque.

    .. math:: \tau_{ext} = M(q)\,\ddot q + C(q, \dot q)\,\dot q + g(q) - \tau_{joint}

    The sensors measure motor torque and friction together, so the estimate is free of friction.
    The terms of gravity, inertia and Coriolis forces come from the arm's model of itself, without
    its payload.  The acceleration is that of the last step.
    """

    def __init__(self, own: Model, plant: Plant, dt: float) -> None:
        """Estimate with the arm's model of itself, ``own``, in physics steps of ``dt`` [s]."""
        self._own, self._dt, self._lag = own, dt, plant.torque_lag
        self.reset()

    def reset(self) -> None:
        """Forget all measurements."""
        self._felt, self._at = self._own.robot.zeros, -1
        self._begun: tuple[Array, Array, Array] | None = None

    def begin(self, q: Array, dq: Array, joint: Array, steps: int) -> None:
        """Store the state at the start of a physics step.

        Args:
            q: Joint angles, shape (n,) in [rad].
            dq: Joint speeds, shape (n,) in [rad/s].
            joint: Torque of motors and friction in this step, shape (n,) in [N m].
            steps: Number of the step.
        """
        if self._lag:  # the average covers every step, not only those asked for
            self.felt(dq, steps)
        self._begun = q, dq, joint

    def felt(self, now: Array, steps: int) -> Array:
        """The external torque, shape (n,) in [N m], before physics step ``steps``.

        Args:
            now: Joint speeds, shape (n,) in [rad/s].
            steps: Number of the step.
        """
        if self._begun is not None and self._at != steps:
            (q, dq, joint), dt = self._begun, self._dt
            felt = self._own.dynamics.inverse_dynamics(q, dq, (now - dq) / dt) - joint
            if self._lag > dt:
                felt = self._felt + dt / self._lag * (felt - self._felt)
            self._felt, self._at = felt, steps
        return self._felt
