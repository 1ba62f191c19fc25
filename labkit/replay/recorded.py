"""Conversion of a log to a motion, with other runs as see-through arms."""

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
"""Distance from a limit at which a joint may have met its stop, in [rad], and how long the torque
sensors feel that, in [s]."""


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
        force: Whether to draw the force on the tip as the torque sensors estimated it, except
            while a joint is at its stop, which its sensor also feels.
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
    """Force on the tip, shape (N, 3) in [N], set to zero within `AFTER` of contact with a stop."""
    from scipy.ndimage import binary_dilation

    room = np.minimum(log.q - log.robot.lower, log.robot.upper - log.q).min(axis=1)
    ticks = max(1, round(AFTER * len(log) / max(AFTER, float(np.ptp(log.t)))))
    unknown = binary_dilation(room < STOP, iterations=ticks)
    return np.where(unknown[:, None], 0.0, metrics.felt_wrench(log)[:, :3])
