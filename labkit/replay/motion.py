"""A motion of one arm and what is around it as data, small enough for a page, and in words."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from .. import metrics
from ..errors import OutOfRange, listed
from ..log import Log
from ..robot import SIDES, Robot, as_robot
from ..scene import Spring, Table, Wall
from ..shapes import Array, as_array
from ..trajectory import PoseSample

STEPS = {"error": 1e-5, "tau": 1e-2, "force": 1e-2}
"""Resolution of channels, in [m], [N m] and [N]; the others have 1e-4, in [m] or [rad]."""


@dataclass(frozen=True, eq=False)
class Motion:
    """A recorded motion of one arm, to be replayed.

    Attributes:
        robot: The arm, as a `Robot`, or "left" or "right" for Baxter's.
        t: Times, shape (N,), increasing, in [s].
        q: Joint angles, shape (N, n), in [rad].
        title: A few words for the heading and for assistive technology.
        label: Name of this arm in the legend and in plots.
        target_position: Position of the target, shape (N, 3), in [m], in the robot's base.
        target_rotation: Orientation of the target, shape (N, 3, 3).
        board_position: Position of the tag's board, shape (N, 3), in [m].
        board_rotation: Orientation of the board, shape (N, 3, 3), the tag facing its own +z.
        path: Points of the desired path, shape (K, 3), in [m].
        error: Distance of the tip from its target, shape (N,), in [m].
        tau: Joint torques, shape (N, n), in [N m].
        force: Force on the tip, shape (N, 3), in [N], in the robot's base; zero where unknown.
        ghosts: Joint angles of other arms by name, each of shape (N, n), in [rad].
        things: Things around the arm, by name, as `drawn_thing` returns them.
    """

    robot: Any
    t: Array
    q: Array
    title: str = "Motion of the arm"
    label: str = "arm"
    target_position: Array | None = None
    target_rotation: Array | None = None
    board_position: Array | None = None
    board_rotation: Array | None = None
    path: Array | None = None
    error: Array | None = None
    tau: Array | None = None
    force: Array | None = None
    ghosts: Mapping[str, Array] = field(default_factory=dict)
    things: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        robot: Robot = as_robot(self.robot)
        object.__setattr__(self, "robot", robot)
        if len(self.t) < 2:
            raise OutOfRange(f"t has {len(self.t)} times, and a motion needs at least two")
        as_array(self.q, (len(self.t), robot.n), "q")  # an arm that ran away may end at NaN

    def data(self, rate: float = 25.0) -> dict[str, Any]:
        """The motion as the viewer reads it: resampled evenly and differenced as whole numbers.

        Args:
            rate: Samples per second.

        Returns:
            The data that `to_json` writes.
        """
        count = max(2, round((self.t[-1] - self.t[0]) * rate) + 1)
        times = np.linspace(self.t[0], self.t[-1], count)

        def even(x: Array, name: str) -> dict[str, Any]:
            even = x if name == "path" else resampled(x, self.t, times)
            return pack(even, STEPS.get(name, 1e-4))

        channels = {name: getattr(self, name) for name in ("q", "path", "error", "tau", "force")}
        for name in ("target", "board"):
            channels[name] = getattr(self, f"{name}_position")
            channels[f"{name}_quaternion"] = _quaternions(getattr(self, f"{name}_rotation"))
        return {
            "kind": "motion",
            "title": self.title,
            "alt": self.alt,
            "label": self.label,
            "side": self.robot.name,
            **({} if self.robot.name in SIDES else {"robot": drawn(self.robot)}),
            "start": round(float(times[0]), 6),
            "period": round(float(times[1] - times[0]), 9),
            **{name: even(x, name) for name, x in channels.items() if x is not None},
            "ghosts": {name: even(q, "q") for name, q in self.ghosts.items()},
            "things": dict(self.things),
        }

    def to_json(self, rate: float = 25.0) -> str:
        """`data(rate)` as compact JSON; ten seconds with torques and two ghosts fit in 40 kB."""
        return compact(self.data(rate))

    @cached_property
    def alt(self) -> str:
        """A sentence for readers who cannot see the picture, with the run's numbers."""
        name = self.robot.name
        whose = f"Baxter's {name} arm" if name in SIDES else f"The arm {name}"
        words = f"{whose} moves for {self.t[-1] - self.t[0]:.1f} s"
        if self.error is not None:
            rms = float(np.sqrt(np.mean(self.error**2)))
            most = float(np.abs(self.error).max())
            words += f"; tip error {1e3 * rms:.1f} mm RMS, {1e3 * most:.1f} mm at most"
        if self.ghosts:
            words += f"; compared with {listed(self.ghosts)}, drawn as see-through arms"
        if self.things:
            words += f"; beside it {listed(self.things)}"
        if self.force is not None:
            words += f"; up to {np.linalg.norm(self.force, axis=1).max():.0f} N act on the tip"
        if self.tau is not None:
            words += f"; torques of up to {np.abs(self.tau).max():.1f} N m"
        return words + "."


def motion_of(
    log: Log,
    title: str,
    *,
    label: str = "",
    ghosts: Mapping[str, Log] | None = None,
    reference: bool = True,
    torque: bool = False,
    force: bool = False,
    things: Iterable[Any] = (),
) -> Motion:
    """Convert a run to the form that the viewer shows.

    Args:
        log: The run.
        title: A title of a few words.
        label: Name of the arm; by default the name of the controller.
        ghosts: Other runs by name; the arm of a shorter run waits at its end.
        reference: Whether to draw an arm that follows perfectly as a ghost, if the target consists
            of joint angles.
        torque: Whether to include the torques, which take the most space.
        force: Whether to draw the force on the tip as the torque sensors estimated it.
        things: The `Wall`, `Table` and `Spring` objects of the arm's world.

    Returns:
        The motion, including the position error of the tip.
    """
    T_wd = metrics.target_poses(log)
    arms = {name: resampled(other.q, other.t, log.t) for name, other in (ghosts or {}).items()}
    if reference and not isinstance(log.target, PoseSample):
        arms["the target"] = log.target.position
    return Motion(
        log.robot,
        log.t,
        log.q,
        title=title,
        label=label or log.controller.replace("_", " "),
        target_position=T_wd[:, :3, 3],
        target_rotation=T_wd[:, :3, :3],
        path=T_wd[:: max(1, len(log) // 120), :3, 3],
        error=np.linalg.norm(metrics.tip_error(log)[:, :3], axis=1),
        tau=log.tau if torque else None,
        force=metrics.felt_wrench(log)[:, :3] if force else None,
        ghosts=arms,
        things={
            f"{type(x).__name__.lower()} {k}": data
            for k, x in enumerate(things, start=1)
            if (data := drawn_thing(x))
        },
    )


def drawn_thing(thing: Any) -> dict[str, Any]:
    """A wall, a table or a band as plain numbers; empty for things that are not visible."""
    if isinstance(thing, Wall | Table):
        size, colour = (list(map(float, x)) for x in (thing.size, thing.colour))
        return placed("face", thing.T_wf) | {"size": size, "colour": colour}
    if isinstance(thing, Spring):
        return {"kind": "band", "position": thing.anchor.tolist()}
    return {}


def placed(kind: str, T: Array) -> dict[str, Any]:
    """A thing of a kind at a pose, shape (4, 4), as plain numbers."""
    position, turn = np.round(T[:3, 3], 4).tolist(), np.round(_turns(T[:3, :3]), 4).tolist()
    return {"kind": kind, "position": position, "quaternion": turn}


def pack(x: Array, step: float) -> dict[str, Any]:
    """Convert a channel to multiples of `step`, differenced along its rows, column after column.

    Rounding precedes differencing, so the error never exceeds step / 2, however long the channel.

    Args:
        x: Shape (N, k).
        step: Size of one unit.

    Returns:
        {"step", "width": k, "data": N * k whole numbers, differenced twice along the rows}.
    """
    whole = np.rint(x / step).astype(np.int64)
    twice = np.diff(np.diff(whole, axis=0, prepend=0), axis=0, prepend=0)
    return {"step": step, "width": whole.shape[1], "data": twice.T.ravel().tolist()}


def unpack(channel: Mapping[str, Any]) -> Array:
    """The inverse of `pack`: shape (N, k)."""
    twice = np.array(channel["data"], dtype=np.int64).reshape(channel["width"], -1)
    whole = np.cumsum(np.cumsum(twice, axis=1), axis=1)
    return np.asarray(whole.T * float(channel["step"]), dtype=np.float64)


def resampled(x: Array, t: Array, times: Array) -> Array:
    """Interpolate rows at times ``t`` to other times; beyond either end they stay constant.

    Args:
        x: Shape (N,) or (N, k).
        t: Increasing, shape (N,) in [s].
        times: Shape (M,) in [s].

    Returns:
        Shape (M, k).
    """
    return np.column_stack([np.interp(times, t, column) for column in x.reshape(len(x), -1).T])


def drawn(robot: Robot) -> dict[str, Any]:
    """The joints of an arm for which the viewer has no meshes, in the form of Baxter's file."""
    names = ("base", *robot.joint_names)
    poses = np.array([*(body["T_parent"] for body in robot.bodies), robot.T_hand_tip])
    turns = np.round(_turns(poses[:, :3, :3]), 9).tolist()
    positions = np.round(poses[:, :3, 3], 9).tolist()
    places = [
        {"parent": parent, "position": position, "quaternion": turn}
        for parent, position, turn in zip(names, positions, turns, strict=True)
    ]
    joints = [{"name": name, **place} for name, place in zip(names[1:], places, strict=False)]
    return {"arm": list(names[1:]), "joints": joints, "tips": {robot.name: places[-1]}}


def _quaternions(R: Array | None) -> Array | None:
    """Convert rotations (N, 3, 3) to unit quaternions x y z w (N, 4) without jumps of sign."""
    if R is None:
        return None
    q = _turns(R)
    flips = np.where(np.sum(q[1:] * q[:-1], axis=1) < 0, -1.0, 1.0)
    return np.asarray(q * np.cumprod([1.0, *flips])[:, None])


def _turns(R: Array) -> Array:
    from scipy.spatial.transform import Rotation  # slow to import

    return np.asarray(Rotation.from_matrix(R).as_quat(), dtype=np.float64)


def compact(data: Any) -> str:
    """Data as JSON without spaces."""
    return json.dumps(data, separators=(",", ":"), ensure_ascii=False)
