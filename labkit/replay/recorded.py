"""From a log to a motion: a run beside others, drawn as see-through arms."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from .. import metrics
from ..log import Log
from ..trajectory import PoseSample
from .motion import Motion, resampled
from .surroundings import drawn_thing

STOP, AFTER = 0.02, 0.1
"""A joint nearer than this to its limit, in [rad], may have met its stop; torque sensors feel that
for as long as this, in [s]."""


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
    """A run as the viewer shows it.

    Args:
        log: The run.
        title: A few words.
        label: Name of the arm; the controller's by default.
        ghosts: Other runs by name; where one is shorter, its arm waits at the end.
        reference: Draw the arm that follows perfectly as a ghost too, where the target is one of
            joint angles.
        torque: Keep the torques, which take the most room.
        force: Draw the force on the tip, as the arm's torque sensors told it; none while a joint
            is at its stop, which its sensor feels too.
        things: What stood around the arm: the `Wall`, `Table` and `Spring` of its world.

    Returns:
        The motion, the position error of the tip included.
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
        label=label or log.controller,
        target_position=T_wd[:, :3, 3],
        target_rotation=T_wd[:, :3, :3],
        path=T_wd[:: max(1, len(log) // 120), :3, 3],
        error=np.linalg.norm(metrics.tip_error(log)[:, :3], axis=1),
        tau=log.tau if torque else None,
        force=_felt(log) if force else None,
        ghosts=arms,
        things={
            f"{type(x).__name__.lower()} {k}": data
            for k, x in enumerate(things, start=1)
            if (data := drawn_thing(x))
        },
    )


def _felt(log: Log) -> Any:
    """The force on the tip, shape (N, 3) in [N]; zero within `AFTER` of a stop's torque."""
    from scipy.ndimage import binary_dilation

    room = np.minimum(log.q - log.robot.lower, log.robot.upper - log.q).min(axis=1)
    ticks = max(1, round(AFTER * len(log) / max(AFTER, float(np.ptp(log.t)))))
    unknown = binary_dilation(room < STOP, iterations=ticks)
    return np.where(unknown[:, None], 0.0, metrics.felt_wrench(log)[:, :3])
