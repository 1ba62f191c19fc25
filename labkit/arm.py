"""The arm: the plant in PyBullet.  Read its state, give it a command."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from operator import le
from typing import Any

import numpy as np

from .baxter import robot
from .body import load
from .control import (
    COMMANDS,
    NOTHING,
    Command,
    JointPosition,
    JointTorque,
    JointVelocity,
    State,
    still,
)
from .errors import Closed, ControllerError, LabkitError, TypeMismatch
from .model import Model
from .plant import IDEAL, Plant
from .quiet import quiet
from .robot import DOF, Robot, Side
from .sensors import Reports, TorqueSensors, angles, motor_torques
from .shapes import Array, as_array, locked, shown
from .world import World

with quiet():
    import pybullet as bullet

_JOINTS = tuple(range(DOF))
_ZERO = [0.0] * DOF

BRAKING = 0.5
"""Share of the torque left by gravity that the position mode plans to brake with."""


class Arm:
    """One of Baxter's arms in a world: seven bodies, motors with limits, and the plant's realism.

    Attributes:
        robot: Names and limits.
        plant: How it differs from the textbook.
        model: A model that knows of this plant's rotors and payload.
        world: Where it stands.
        saturated: Whether a limit cut the command that the arm follows, at any time since it came.
    """

    def __init__(
        self,
        side: Side = "left",
        plant: Plant = IDEAL,
        seed: int = 0,
        *,
        q0: Any = None,
        world: World | None = None,
    ) -> None:
        """Put an arm into a world, at rest.

        Args:
            side: "left" or "right".
            plant: `IDEAL`, `BAXTER` or a `Plant` of your own.
            seed: Of the measurement noise and of the ticks that come late.
            q0: Joint angles at the start, shape (7,) in [rad]; None is Rethink's neutral pose.
            world: Where to put it; None opens an empty world of its own.

        Raises:
            UnknownName: Baxter has no such arm.
            TypeMismatch: Plant, seed or world is something else.
            Closed: The world is closed.
            LabkitError: The world has this arm already.
            JointLimitExceeded: q0 is outside the joints' range.
        """
        self.robot: Robot = robot(side)
        self.plant = plant
        self.model = Model(side, plant)
        self.world = World() if world is None else world
        self._check_place()
        try:
            self._random = np.random.default_rng(seed)
        except (TypeError, ValueError):
            raise TypeMismatch(
                f"seed is {shown(seed)}, expected a whole number from 0 up"
            ) from None
        self._client = self.world.client
        self._body = load(self._client, side, plant)
        hand, com = self.robot.T_hand_tip, bullet.getDynamicsInfo(self._body, 6, self._client)[3]
        self._lever = hand[:3, :3].T @ (hand[:3, 3] - com)  # from the hand's centre to the tip
        # The arm knows its own weight, not what it carries.
        self._own = Model(side, replace(plant, payload=0.0))
        self._patience = round(plant.command_timeout / self.world.dt)  # in physics steps
        self._reports = Reports(plant, self.world.dt, self._random)
        self._sensors = TorqueSensors(self._own, plant, self.world.dt)
        self._effort, self._speed = self.robot.effort.tolist(), self.robot.speed.tolist()
        self._stiction, self._laden = list(plant.stiction), plant.payload > 0.0
        self.reset(q0)
        self.world.add(self._act)
        self.world.arms.append(self)

    def _check_place(self) -> None:
        if not isinstance(self.world, World):
            raise TypeMismatch(f"world is {shown(self.world)}, expected an lk.World")
        self.check_open()
        side = self.robot.side
        if side in [arm.robot.side for arm in self.world.arms]:
            raise LabkitError(
                f"this world has a {side} arm already, and two would stand in one place; use that "
                "one, or make a new World too"
            )

    # What a controller may use

    def state(self) -> State:
        """The joints as the arm reports them now: as old and as noisy as the plant makes them."""
        return self._reported(None)

    def apply(self, command: Command) -> None:
        """Follow ``command`` until the next one, or until the plant's command timeout.

        Speeds and torques beyond the limits are cut to them, as the real arm does.

        Args:
            command: `JointPosition`, `JointVelocity` or `JointTorque`.

        Raises:
            ControllerError: It is no command.
            JointLimitExceeded: A position outside the joints' range.
        """
        kind, world = type(command), self.world
        if world.client < 0:
            self.check_open()
        if kind is JointTorque:
            wanted = command.value
            allowed = _cut(wanted, self._effort)
        elif kind is JointVelocity:
            wanted = command.value
            allowed = _cut(wanted, self._speed)
        elif kind is JointPosition:
            wanted = allowed = self.model.within_limits(command.value, "JointPosition")
        else:
            names = ", ".join(kind.__name__ for kind in COMMANDS)
            raise ControllerError(f"{shown(command)} is no command; give one of {names}")
        self._wanted, self.saturated = allowed, allowed is not wanted
        if kind is not self._kind:
            self._enter(kind)
        self._fresh = True
        self._deadline = world._steps + self._patience

    def stop(self) -> None:
        """Come to rest and stay."""
        self.apply(still())

    def reset(self, q: Any = None) -> None:
        """Put the arm at rest at ``q``, shape (7,) in [rad]; None is Rethink's neutral pose.

        Raises:
            JointLimitExceeded: A joint is out of its range.
        """
        q = self.robot.neutral if q is None else self.model.within_limits(q, "q")
        self.check_open()
        for i in _JOINTS:
            bullet.resetJointState(self._body, i, q[i], 0.0, physicsClientId=self._client)
        self._sensors.reset()
        self._reports.reset(State(self.world.t, locked(np.array(q)), NOTHING))
        self._lagged = np.zeros(7)
        self._total = np.zeros(7)
        self._kind: type = type(None)
        self.stop()

    def recover(self) -> None:
        """Come to rest at once, inside the joints' range: what someone does after a runaway."""
        q = self.truth().q
        lost = not np.isfinite(q).all()
        self.reset(None if lost else np.clip(q, self.robot.lower, self.robot.upper))

    # What only the experimenter may use

    def truth(self) -> State:
        """The joints as they really are."""
        return self._exact(self._read())

    @property
    def torque(self) -> Array:
        """What the motors gave in the last physics step, gravity compensation included.

        Returns:
            Shape (7,) in [N m].
        """
        if self._kind is JointTorque:
            return self._total
        return motor_torques(self._read())

    def push(self, force: Any, moment: Any = (0.0, 0.0, 0.0)) -> None:
        """Push the tip during the next physics step; world axes, at the tip's origin.

        A force that lasts is a `Push` in the world, which the arm can also feel.

        Args:
            force: Shape (3,) in [N].
            moment: Shape (3,) in [N m].
        """
        f, m = as_array(force, (3,), "force"), as_array(moment, (3,), "moment")
        R_wt = self.model.pose(angles(self._read()))[:3, :3]
        # PyBullet's idea of where the link is lags a step behind: count the lever from there.
        centre = bullet.getLinkState(self._body, 6, physicsClientId=self._client)[0]
        at = (R_wt @ self._lever + centre).tolist()
        bullet.applyExternalForce(
            self._body, 6, f.tolist(), at, bullet.WORLD_FRAME, physicsClientId=self._client
        )
        if m.any():
            bullet.applyExternalTorque(
                self._body, 6, m.tolist(), bullet.WORLD_FRAME, physicsClientId=self._client
            )

    def check_open(self) -> None:
        """Raise `Closed` if the world it stands in was closed."""
        if self.world.client < 0:
            raise Closed("this arm's world was closed; make a new Arm")

    def lost_ticks(self, ticks: int) -> list[bool]:
        """Which of the next control ticks come too late to be used: drawn from the arm's seed."""
        if not self.plant.lost_ticks:
            return [False] * ticks
        late: list[bool] = (self._random.random(ticks) < self.plant.lost_ticks).tolist()
        return late

    def observe(self) -> tuple[State, State, Array]:
        """What `run` writes down: the truth, the state as reported, and `torque`, read at once.

        The world must be open: `run` sees to that, and asks a thousand times a second.
        """
        rows = bullet.getJointStates(self._body, _JOINTS, self._client)
        truth = self._exact(rows)
        torque = self._total if self._kind is JointTorque else motor_torques(rows)
        return truth, self._reported(rows) if self._reports.every else truth, torque

    # The machinery, once per physics step

    def _act(self) -> None:
        """Set motors and torques for the next physics step; the world calls it."""
        steps = self.world._steps
        if steps > self._deadline:
            self._hold()
        touchable = self.world.things or self._laden  # else no torque comes from outside
        rows = self._read() if touchable or self._looks else None
        if self._reports.every:
            self._report(rows)
        self._drive(rows)
        self._fresh = False
        if touchable:
            driven = self._total if self._kind is JointTorque else NOTHING
            self._sensors.begin(rows, driven, steps)

    def _exact(self, rows: Any) -> State:
        steps = self.world._steps
        columns = zip(*rows)  # noqa: B905  # angles, speeds, reactions, torques
        both = np.array(next(columns) + next(columns))  # one array is quicker made than two
        both.setflags(False)  # type: ignore[call-arg]  # as in `locked`
        return State(steps * self.world.dt, both[:DOF], both[DOF:], self._sensors.felt(rows, steps))

    def _reported(self, rows: Any) -> State:
        if not self._reports.every:
            return self.truth()
        self._report(rows)
        return self._reports.newest(self.world.t)

    def _report(self, rows: Any) -> None:
        if self._reports.due(self.world._steps):
            truth = self.truth() if rows is None else self._exact(rows)
            self._reports.send(truth, self.world._steps)

    def _drive_torque(self, rows: Any) -> None:
        if self._looks:  # it carries its own weight
            wanted = self._wanted + self._own.gravity(angles(rows))
            self._total = _cut(wanted, self._effort)
            self.saturated |= self._total is not wanted
        elif self._fresh:
            self._total = self._wanted
        bullet.setJointMotorControlArray(
            self._body,
            _JOINTS,
            bullet.TORQUE_CONTROL,
            forces=self._total.tolist(),
            physicsClientId=self._client,
        )

    def _drive_speed(self, rows: Any) -> None:
        if self.plant.velocity_lag:
            share = min(1.0, self.world.dt / self.plant.velocity_lag)
            self._lagged += (self._wanted - self._lagged) * share
            self._spin(self._lagged)
        elif self._fresh:  # PyBullet's motors keep their target
            self._spin(self._wanted)

    def _approach(self, rows: Any) -> None:
        """Turn towards the wanted angles, never faster than the motors can brake before them.

        Braking evenly from v takes v^2 / 2a (Lynch & Park, section 9.2.2).
        """
        q = angles(rows)
        if self._fresh:
            M, g = self._own.mass_matrix(q), self._own.gravity(q)
            self._braking = BRAKING * (self.robot.effort - np.abs(g)) / M.diagonal()
        gain = min(self.plant.position_gain or np.inf, 1.0 / self.world.dt)
        gap = self._wanted - q
        stops = np.sqrt(2.0 * self._braking * np.abs(gap))
        wanted = np.clip(gain * gap, -stops, stops)
        allowed = _cut(wanted, self._speed)
        self.saturated |= allowed is not wanted
        self._spin(allowed)

    def _spin(self, speeds: Array) -> None:
        """Let the motors hold these speeds with whatever torque it takes, up to the limits."""
        bullet.setJointMotorControlArray(
            self._body,
            _JOINTS,
            bullet.VELOCITY_CONTROL,
            targetVelocities=speeds.tolist(),
            forces=self._effort,
            physicsClientId=self._client,
        )

    def _enter(self, kind: type) -> None:
        """Change the mode: in torque mode the motors' only duty is to be the dry friction."""
        self._kind = kind
        modes: dict[type, tuple[Callable[[Any], None], bool]] = {
            JointTorque: (self._drive_torque, self.plant.gravity_compensation),
            JointVelocity: (self._drive_speed, False),
            JointPosition: (self._approach, True),
        }
        self._drive, self._looks = modes[kind]  # what drives the motors, and whether it must see
        if kind is JointTorque:
            bullet.setJointMotorControlArray(
                self._body,
                _JOINTS,
                bullet.VELOCITY_CONTROL,
                targetVelocities=_ZERO,
                forces=self._stiction,
                physicsClientId=self._client,
            )
        else:
            self._lagged = np.array(self.truth().dq)

    def _hold(self) -> None:
        """The command ran out: stay at the place reached (Rethink's arm does so after 0.2 s)."""
        if self._kind is JointPosition:
            self._deadline = self.world._steps + self._patience
            return
        q = np.clip(self.truth().q, self.robot.lower, self.robot.upper)
        self.apply(JointPosition(q))

    def _read(self) -> Any:
        self.check_open()
        return bullet.getJointStates(self._body, _JOINTS, self._client)

    def close(self) -> None:
        """Close the world it stands in."""
        self.world.close()

    def __enter__(self) -> Arm:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"Arm({self.robot.side!r}, {self.plant.name})"


def _cut(x: Array, limit: list[float]) -> Array:
    """``x`` itself if it is within ±limit, else a copy that is."""
    if all(map(le, map(abs, x.tolist()), limit)):  # NumPy is slow with seven numbers
        return x
    return np.clip(x, np.negative(limit), limit)
