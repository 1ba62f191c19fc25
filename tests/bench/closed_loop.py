"""Computed torque at 1 kHz, by `run` and by a plain loop over the same two callables."""

from statistics import median
from time import perf_counter

import numpy as np

import labkit as lk
from solutions.study.joint_torque import ComputedTorque

from .hand_loop import hand_loop, open_arm

SECONDS = 5.0
PAIRS = 25
WAY = np.array([0.4, 0.2, -0.3, 0.3, 0.2, -0.3, 0.4])


def task():
    """A new target and a new controller, the same for every loop."""
    q = lk.robot("left").neutral
    target = lk.Trajectory(lk.Line(q, q + WAY), lk.Quintic(SECONDS))
    return target, ComputedTorque(lk.Model("left"), Kp=100.0, Kd=20.0)


def timed(loop):
    """The time of a call, in [s], and its result."""
    start = perf_counter()
    result = loop()
    return perf_counter() - start, result


def measure():
    """Speed of `run`, with its log and checks, as a fraction of the plain loop's speed."""
    target, controller = task()
    client, body = open_arm(lk.robot("left").urdf())
    ratios, by_hand = [], []
    with lk.Arm("left", world=lk.World(engine="pybullet")) as arm:
        for _ in range(PAIRS):
            arm.reset(target(0.0).position)
            labkit_s, log = timed(lambda: lk.run(arm, target, controller, rate=1000))
            hand_s, q = timed(lambda: hand_loop(client, body, target, controller, SECONDS))
            if np.abs(q - log.q[-1]).max() > 1e-12:
                raise AssertionError("the two loops did not do the same work")
            ratios.append(hand_s / labkit_s)
            by_hand.append(SECONDS / hand_s)
    return {"closed_loop_vs_hand": median(ratios), "hand_loop_rtf": median(by_hand)}
