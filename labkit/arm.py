"""The arm: a plant in a physics engine that reports its state and accepts commands."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from .control import COMMANDS, Command, JointPosition, JointTorque, JointVelocity, State
from .errors import Closed, ControllerError, LabkitError, ShapeError, TypeMismatch
from .joints import Joints, Motors, TipForce
from .model import Model
from .plant import IDEAL, Plant
from .robot import Robot, as_robot
from .sensors import Reports, TorqueSensors
from .shapes import Array, as_array, as_random, shown
from .sim import new_arm
from .world import World


class Arm:
    """A robot arm in a world: n bodies, motors with limits, and the imperfections of the plant.

    Attributes:
        robot: Names and limits.
        plant: How the arm differs from the textbook's.
        model: A model that includes this plant's rotors and payload.
        world: The world that the arm is in.
    """

    def __init__(
        self,
        robot: Robot | str = "left",
        plant: Plant = IDEAL,
        seed: int = 0,
        *,
        q0: Any = None,
        world: World | None = None,
    ) -> None:
        """Put an arm into a world, at rest.

        Args:
            robot: A `Robot`, or "left" or "right" for Baxter's.
            plant: `IDEAL`, `BAXTER` or a `Plant` of your own.
            seed: The seed of the measurement noise and of the late ticks.
            q0: Initial joint angles, shape (n,) in [rad]; None means `Robot.neutral`.
            world: The world to put the arm in; None opens an empty one.

        Raises:
            UnknownName: Baxter has no such arm.
            TypeMismatch: ``plant``, ``seed`` or ``world`` has the wrong type.
            Closed: The world is closed.
            LabkitError: The world already has this arm, or the plant fits other robots alone.
            JointLimitExceeded: q0 is outside the joints' range.
            ShapeError: The plant belongs to an arm with a different number of joints.
        """
        self.robot = robot = as_robot(robot)
        self.model = Model(robot, plant)
        self.world = World() if world is None else world
        if not isinstance(self.world, World):
            raise TypeMismatch(f"world is {shown(self.world)}, expected an lk.World")
        self.check_open()
        if robot.name in [arm.robot.name for arm in self.world.arms]:
            raise LabkitError(f"this world has a {robot.name} arm already; make a new World too")
        self._random = as_random(seed)
        if q0 is not None:
            self.model.within_limits(q0, "q")
        self._build(self.model)
        self.reset(q0)
        self.world.arms.append(self)

    def _build(self, model: Model) -> None:
        """Create everything that depends on the plant."""
        robot, plant, dt = self.robot, model.plant, self.world.dt
        self.plant, self.model = plant, model
        self._engine = new_arm(self.world.engine, robot, plant, dt)
        own = Model(robot, replace(plant, payload=0.0))  # the arm does not know its payload
        self._viscous = plant.each("viscous", robot.n)
        self._patience = round(plant.command_timeout / dt)  # in physics steps
        self._motors = Motors(dt, plant, own)
        self._joints = Joints(model, dt)
        self._reports = Reports(plant, robot.n, dt, self._random)
        self._sensors = TorqueSensors(own, plant, dt)

    # For controllers

    def state(self) -> State:
        """The joints as the arm reports them now, with the delay and the noise of the plant."""
        if not self._reports.every:
            return self.truth()
        self.check_open()
        if self._reports.due(self.world.steps):
            self._report()
        return self._reports.newest(self.world.t)

    def apply(self, command: Command) -> None:
        """Follow ``command`` until the next one, or until the plant's command timeout.

        Speeds and torques beyond the limits are clipped to them, as on the real arm.

        Args:
            command: `JointPosition`, `JointVelocity` or `JointTorque`.

        Raises:
            ControllerError: ``command`` is not a command.
            ShapeError: It does not have one number for each joint.
            JointLimitExceeded: A position is outside the joints' range.
        """
        self.check_open()
        if type(command) not in COMMANDS:
            names = ", ".join(kind.__name__ for kind in COMMANDS)
            raise ControllerError(f"{shown(command)} is not a command; give one of {names}")
        if command.value.shape != self.robot.zeros.shape:
            raise ShapeError(type(command).__name__, self.robot.zeros.shape, command.value.shape)
        self.follow(command)

    def follow(self, command: Command) -> None:
        """Do the same as `apply` for a command whose type and shape have been checked."""
        if type(command) is JointPosition:
            self.model.within_limits(command.value, "JointPosition")
        self._motors.follow(command)
        self._deadline = self.world.steps + self._patience

    @property
    def saturated(self) -> bool:
        """Whether a limit has cut the current command at any time since the arm received it."""
        return self._motors.saturated

    def stop(self) -> None:
        """Come to rest and stay there."""
        self.apply(JointVelocity(self.robot.zeros))

    def reset(self, q: Any = None) -> None:
        """Put the arm at rest at ``q``, shape (n,) in [rad]; None means `Robot.neutral`.

        Raises:
            JointLimitExceeded: A joint is outside its range.
        """
        q = self.robot.neutral if q is None else self.model.within_limits(q, "q")
        self.check_open()
        self._start(q, self.robot.zeros)

    def _start(self, q: Array, dq: Array) -> None:
        self._q, self._dq, self._torque = np.array(q), np.array(dq), self.robot.zeros
        self._engine.place(self._q, self._dq)
        self._joints.reset()
        self._touches: list[TipForce] = []
        self._pull: Array | None = None
        self._sensors.reset()
        self._reports.reset(State(self.world.t, self._reports.read(self._q), self._dq))
        self._motors.kind = type(None)
        self.stop()

    def become(self, plant: Plant) -> None:
        """Switch to another plant, keeping angles and speeds, and command the arm to stop.

        Raises:
            ShapeError: The plant belongs to an arm with a different number of joints.
        """
        self.check_open()
        before = self._engine
        self._build(Model(self.robot, plant))
        before.close()
        self._start(self._q, self._dq)

    def recover(self) -> None:
        """Come to rest at once, inside the joints' range: what someone does after a runaway."""
        q = self.truth().q
        lost = not np.isfinite(q).all()
        self.reset(None if lost else np.clip(q, self.robot.lower, self.robot.upper))

    # What only the experimenter may use

    def truth(self) -> State:
        """The joints as they really are."""
        self.check_open()
        felt = self._sensors.felt(self._dq, self.world.steps)
        return State(self.world.t, self._q.copy(), self._dq.copy(), felt.copy())

    @property
    def torque(self) -> Array:
        """The motor torque in the last physics step, including gravity compensation.

        Returns:
            Shape (n,) in [N m].
        """
        self.check_open()
        return self._torque

    def push(self, force: Any, moment: Any = (0.0, 0.0, 0.0)) -> None:
        """Push the tip at its origin, in world axes, during the next physics step.

        For a lasting force, put a `Push` into the world; the torque sensors feel that one too.

        Args:
            force: Shape (3,) in [N].
            moment: Shape (3,) in [N m].

        Raises:
            Closed: The arm's world is closed, or the arm is live in another cell.
        """
        force, moment = as_array(force, (3,), "force"), as_array(moment, (3,), "moment")
        self.touch(TipForce(np.concatenate([force, moment]), np.zeros((3, 3))))

    def touch(self, touch: TipForce) -> None:
        """Let something act on the tip during the next physics step.

        Raises:
            Closed: The arm's world is closed, or the arm is live in another cell.
        """
        self.check_open()
        self._touches.append(touch)

    def pull(self, torque: Any) -> None:
        """Apply external joint torques during the next physics step, as a hand on a link would.

        Args:
            torque: Shape (n,) in [N m]; torques of several calls add up.

        Raises:
            Closed: The arm's world is closed, or the arm is live in another cell.
        """
        torque = as_array(torque, self.robot.zeros.shape, "torque")
        self.check_open()
        self._pull = torque if self._pull is None else self._pull + torque

    def tip(self) -> tuple[Array, Array]:
        """True position [m] and velocity [m/s] of the tip, each of shape (3,)."""
        self.check_open()
        model = self.model.dynamics
        return model.pose(self._q)[:3, 3], model.tip_jacobian(self._q)[:3] @ self._dq

    def check_open(self) -> None:
        """Raise `Closed` if the arm's world was closed, or belongs to another thread."""
        if self.world.closed:
            raise Closed("this arm's world was closed; make a new Arm")
        if self.world.owner is not None:
            self.world.check_owner()

    def lost_ticks(self, ticks: int) -> list[bool]:
        """Draw, from the arm's seed, which of the next control ticks come too late to be used."""
        if not self.plant.lost_ticks:
            return [False] * ticks
        late: list[bool] = (self._random.random(ticks) < self.plant.lost_ticks).tolist()
        return late

    def observe(self) -> tuple[Array, Array, Array, State]:
        """What `run` records: true angles and speeds, not copied, `torque` and `state`."""
        return self._q, self._dq, self._torque, self.state()

    # For the world, once per physics step

    def step(self) -> None:
        """Take a physics step; the world calls it."""
        if self.world.steps > self._deadline:
            self._hold()
        if self._reports.due(self.world.steps):
            self._report()
        q, dq = self._q, self._dq
        drive = self._motors.drive(self._reports.read(q), dq)
        outside = drive if self._pull is None else drive._replace(tau=drive.tau + self._pull)
        given = self._joints.solve(q, dq, outside, self._touches)
        if self.world.things or self.plant.payload:  # otherwise there is no external torque
            joint = drive.tau + given.held - self._viscous * dq
            self._sensors.begin(q, dq, joint, self.world.steps)
        self._torque = drive.tau if self._motors.kind is JointTorque else given.held
        self._q, self._dq = self._engine.step(given.tau, given.ddq)
        self._touches, self._pull = [], None

    def release(self) -> None:
        """Free the engine's resources; the world calls it."""
        self._engine.close()

    def _report(self) -> None:
        steps = self.world.steps
        felt = self._sensors.felt(self._dq, steps)
        self._reports.send(self.world.t, self._q, self._dq, felt, steps)

    def _hold(self) -> None:
        """Hold the current position after a command timeout (Rethink's arm does so after 0.2 s)."""
        if self._motors.kind is JointPosition:
            self._deadline = self.world.steps + self._patience
            return
        q = self._reports.read(self._q)
        self.apply(JointPosition(np.clip(q, self.robot.lower, self.robot.upper)))

    def close(self) -> None:
        """Close the arm's world."""
        self.world.close()

    def __enter__(self) -> Arm:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"Arm({self.robot.name!r}, {self.plant.name})"
