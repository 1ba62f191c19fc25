"""Motions for the tests, made without the rest of the lab."""

import numpy as np

from labkit.replay import Motion

NEUTRAL = np.array([0.0, -0.55, 0.0, 0.75, 0.0, 1.26, 0.0])
STARTS = {"left": [0.66, 0.80, 0.08], "right": [0.66, -0.80, 0.08]}


def swing(
    seconds: float = 10.0, side: str = "left", ghosts: int = 2, rate: float = 200.0
) -> Motion:
    """The motion of an arm that swings about its neutral pose, with a target on a circle."""
    t = np.arange(0.0, seconds + 1e-9, 1 / rate)
    w = 2 * np.pi / 5
    shape = np.array([0.5, 0.25, 0.3, -0.3, 0.4, 0.25, 0.5])
    q = NEUTRAL + shape * np.sin(w * t[:, None] + np.arange(7))
    circle = np.column_stack([0 * t, 0.12 * np.cos(w * t), 0.12 * np.sin(w * t)])
    target = np.array(STARTS[side]) + circle
    turn = np.array([[np.cos(w * t), -np.sin(w * t), 0 * t], [np.sin(w * t), np.cos(w * t), 0 * t],
                     [0 * t, 0 * t, 0 * t + 1]]).transpose(2, 0, 1)  # fmt: skip
    names = ["joint torque PD", "workspace PD", "impedance", "MoveIt"]
    return Motion(
        robot=side,
        t=t,
        q=q,
        title="Circle with the joint velocity PD controller",
        label="joint velocity PD",
        target_position=target,
        target_rotation=turn,
        path=target[:: max(1, len(t) // 120)],
        error=0.004 + 0.003 * np.cos(3 * w * t),
        tau=20 * np.sin(w * t[:, None] + np.arange(7)) * np.array([1, 2, 0.6, 0.8, 0.1, 0.2, 0.05]),
        ghosts={names[k]: q + 0.08 * (k + 1) * np.sin(2 * w * t)[:, None] for k in range(ghosts)},
    )
