"""The loop of `closed_loop` on both engines: the difference of the results, and the speeds."""

from statistics import median

import mujoco
import numpy as np

import labkit as lk

from .closed_loop import SECONDS, task, timed
from .hand_loop import hand_loop_mujoco

PAIRS = 15


def measure():
    """Difference of angles [rad]; speed on MuJoCo relative to PyBullet and to a plain loop."""
    target, controller = task()
    model = mujoco.MjModel.from_xml_string(lk.robot("left").urdf())
    model.opt.timestep = 1e-3
    data, rows, apart = mujoco.MjData(model), [], 0.0
    arms = [lk.Arm("left", world=lk.World(engine=name)) for name in ("pybullet", "mujoco")]
    for _ in range(PAIRS):
        times, logs = [], []
        for arm in arms:
            arm.reset(target(0.0).position)
            seconds, log = timed(lambda arm=arm: lk.run(arm, target, controller, rate=1000))
            times.append(seconds)
            logs.append(log)
        hand_s, q = timed(lambda: hand_loop_mujoco(model, data, target, controller, SECONDS))
        apart = max(apart, np.abs(logs[0].q - logs[1].q).max(), np.abs(q - logs[1].q[-1]).max())
        rows.append((times[0] / times[1], hand_s / times[1]))
    for arm in arms:
        arm.close()
    against_pybullet, against_hand = zip(*rows, strict=True)
    return {
        "engines_joint_diff": apart,
        "mujoco_vs_pybullet": median(against_pybullet),
        "mujoco_vs_hand": median(against_hand),
    }
