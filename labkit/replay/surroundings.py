"""The surroundings of a live arm: target, walls, bands and tags, which the page shows and moves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..arm import Arm
from ..scene import Spring, Table, Wall
from ..shapes import Array, as_array
from ..trajectory import PoseSample, Sample

TARGET = "target"
POINTS = 121
"""Number of points on the drawn path of the target."""
FASTEST = 2.0
"""Largest speed of dragged walls and bands, in [m/s], so that no wall jumps over the tip."""


class Surroundings:
    """The target and the things of an arm's world, by name.

    Attributes:
        since: The target's time at which the present run began, in [s].
    """

    def __init__(self, arm: Arm, target: Any) -> None:
        """Take the target and the things in the world of ``arm``."""
        self._arm, self._target, self.since, self._made = arm, target, 0.0, arm.world.t
        self._shift: Array = np.zeros(3)
        self._latest: Any = None
        self._goals: dict[int, Array] = {}
        duration = getattr(target, "duration", None)
        self._round = duration if duration and _closed(target, duration) else None

    def begin_run(self) -> None:
        """Let a target without an end, such as a tag's, go on with the time of the world."""
        if not hasattr(self._target, "duration"):
            self.since = self._arm.world.t - self._made

    def begin_again(self) -> None:
        """Go back to the target's start, if it has one; a tag's target continues with its tag."""
        if hasattr(self._target, "duration"):
            self.since = 0.0

    def go_on(self, seconds: float) -> None:
        """Let the next run begin ``seconds`` later in the target's time."""
        self.since += seconds

    def target(self, t: float) -> Any:
        """The target, shifted by the user's dragging; a closed path repeats for ever."""
        t += self.since
        self._latest = self._target(t % self._round if self._round else t)
        return self._shifted()

    def _shifted(self) -> Any:
        """The latest sample, shifted by the user's dragging."""
        sample = self._latest
        if isinstance(sample, PoseSample) and self._shift.any():
            pose = np.array(sample.pose)
            pose[:3, 3] += self._shift
            sample = sample._replace(pose=pose)
        return sample

    def wanted(self) -> Array | None:
        """The desired pose of the tip, shape (4, 4); None if the target is only a point."""
        return self._pose(self.target(0.0) if self._latest is None else self._shifted())

    def _pose(self, sample: Any) -> Array | None:
        if isinstance(sample, PoseSample):
            return np.asarray(sample.pose)
        if isinstance(sample, Sample) and sample.position.size == self._arm.robot.n:
            return self._arm.model.pose(sample.position)
        return None

    def path(self) -> list[list[float]]:
        """Path of a moving target without dragging, in [m]; empty if it is not known in advance."""
        times = np.linspace(0.0, getattr(self._target, "duration", 0.0), POINTS)
        poses = [self._pose(self._target(t)) for t in times] if times[-1] else []
        places = [T[:3, 3] for T in poses if T is not None]
        moves = bool(places) and np.ptp(places, axis=0).max() > 1e-3
        return np.round(places, 4).tolist() if moves else []

    def seen(self) -> dict[str, Any]:
        """The arm and its surroundings as plain numbers, for the page to draw."""
        arm, T_wd = self._arm, self.wanted()
        most = arm.robot.effort * (1.0 - 1e-9)
        return {
            "t": round(arm.world.t, 4),
            "q": arm.truth().q.round(5).tolist(),
            "error": None if T_wd is None else float(np.linalg.norm(arm.tip()[0] - T_wd[:3, 3])),
            "spent": np.flatnonzero(np.abs(arm.torque) >= most).tolist(),
            "things": self.things(),
        }

    def things(self) -> dict[str, Any]:
        """The things that the page draws, by name."""
        found: dict[str, Any] = {}
        T_wd = self.wanted()
        if T_wd is not None:
            fixed = not isinstance(self._latest, PoseSample)
            about = {"fixed": fixed, "shift": self._shift.tolist()}
            found[TARGET] = placed("target", T_wd) | about
        for i, thing in enumerate(self._arm.world.things):
            if data := drawn_thing(thing):
                found[f"thing {i}"] = data
        if camera := getattr(getattr(self._target, "lookups", None), "camera", None):
            lens = camera.intrinsics
            found["camera"] = placed("camera", camera.T_wc) | {
                "field": float(np.degrees(2.0 * np.arctan(lens.height / 2.0 / lens.fy))),
                "ratio": lens.width / lens.height,
                "fixed": True,  # a camera cannot be dragged
            }
        shown: list[Any] = self._arm.world.shown
        for i, board in enumerate(shown):
            if hasattr(board, "T_wm"):
                found[f"tag {i}"] = placed("tag", board.T_wm) | {"size": float(board.tag.paper)}
        return found

    def move(self, name: str, position: Any) -> None:
        """Move a thing so that its drawn middle is at ``position``, shape (3,) in [m]."""
        position = as_array(position, (3,), "position")
        kind, _, number = name.partition(" ")
        if name == TARGET:
            T_wd = self.wanted()
            if T_wd is not None and isinstance(self._latest, PoseSample):
                self._shift = self._shift + position - T_wd[:3, 3]
        elif kind == "tag":
            board: Any = self._arm.world.shown[int(number)]
            T = np.array(board.T_wm)
            T[:3, 3] = position
            board.place(T)
        elif kind == "thing":
            self._goals[int(number)] = position

    def approach(self, seconds: float) -> None:
        """Move dragged things towards their goals for ``seconds``, at `FASTEST` at most."""
        world = self._arm.world
        for number, goal in list(self._goals.items()):
            old: Any = world.things[number]
            way = goal - _middle(old)
            share = FASTEST * seconds / max(1e-9, float(np.linalg.norm(way)))
            if share >= 1.0:
                del self._goals[number]
            world.things[number] = _moved(old, _middle(old) + min(1.0, share) * way)


def drawn_thing(thing: Any) -> dict[str, Any]:
    """A wall, a table or a band as plain numbers; empty for things that are not visible."""
    if isinstance(thing, Wall | Table):
        size, colour = (list(map(float, x)) for x in (thing.size, thing.colour))
        return placed("face", thing.T_wf) | {"size": size, "colour": colour}
    if isinstance(thing, Spring):
        return {"kind": "band", "position": thing.anchor.tolist()}
    return {}


def outline(drawn: Mapping[str, Any], tips: Array) -> Array:
    """The rim of a face, or a band from its anchor to the middle one of the tips, shape (K, 3)."""
    if drawn["kind"] == "band":
        return np.array([drawn["position"], tips[len(tips) // 2]])
    from scipy.spatial.transform import Rotation

    corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1], [1, 1]]) * drawn["size"] / 2.0
    turned = Rotation.from_quat(drawn["quaternion"]).apply(np.pad(corners, ((0, 0), (0, 1))))
    return np.asarray(turned + drawn["position"])


def faces(things: Mapping[str, Any]) -> list[tuple[Any, float]]:
    """Walls and tables as surfaces, each with its opacity as in the viewer."""
    from ..tags.drawing import in_colour

    drawn = [x for x in things.values() if x["kind"] == "face"]
    halves = [outline(x, np.empty(0))[[[0, 1, 2], [2, 3, 0]]] for x in drawn]
    colours = [x["colour"] for x in drawn]
    return [(in_colour(h, c), min(0.55, c[3])) for h, c in zip(halves, colours, strict=True)]


def _middle(thing: Any) -> Array:
    return np.asarray(thing.anchor if isinstance(thing, Spring) else thing.T_wf[:3, 3])


def _moved(thing: Any, position: Array) -> Any:
    if isinstance(thing, Wall):
        return replace(thing, point=position)
    if isinstance(thing, Table):
        return replace(thing, height=float(position[2]), centre=position[:2])
    return replace(thing, anchor=position)


def placed(kind: str, T: Array) -> dict[str, Any]:
    """A thing of a kind at a pose, shape (4, 4), as plain numbers."""
    from scipy.spatial.transform import Rotation  # slow to import

    turn = Rotation.from_matrix(T[:3, :3]).as_quat()
    return {
        "kind": kind,
        "position": np.round(T[:3, 3], 4).tolist(),
        "quaternion": np.round(turn, 4).tolist(),
    }


def _closed(target: Any, duration: float) -> bool:
    """Whether a target moves and ends where it began."""
    first, middle, last = (target(t)[0] for t in (0.0, 0.5 * duration, duration))
    return bool(np.allclose(first, last, atol=1e-6) and not np.allclose(first, middle, atol=1e-6))
