"""Comparison of the book's live arm in JavaScript with the lab's arm in Python."""

import json
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np

import labkit as lk
from solutions.study import gains, tasks
from solutions.study.baseline.server import RATE, PositionServer

NODE = Path(__file__).parent / "book/live_node.mjs"
LAWS = {
    "workspaceVelocity": "workspace velocity",
    "jointVelocity": "joint velocity",
    "jointTorque": "joint torque",
    "workspaceImpedance": "workspace impedance",
    "jointImpedance": "joint impedance",
}
"""The controllers' names in JavaScript and in `solutions.study.gains`."""
PLANTS = {"ideal": lk.IDEAL, "baxter": lk.BAXTER}


def javascript(*requests):
    """The live arm's answer to each request; see live_node.mjs."""
    done = subprocess.run(["node", str(NODE)], input=json.dumps(requests), capture_output=True,
                          text=True, timeout=600, check=False)  # fmt: skip
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout)


def candidate(plant, controller):
    """A controller of `solutions` with the gains of its plant."""
    if controller == "baxtersOwn":
        return gains.Candidate(PositionServer(), RATE, True)
    return gains.course_controllers(lk.Model("left", plant), plant)[LAWS[controller]]


def python_run(plant, controller, task, duration, things=(), start=None, change=None):
    """Joint angles of the lab's run on MuJoCo without random effects, shape (k, 7) in [rad]."""
    quiet = {"velocity_noise": 0.0, "torque_noise": 0.0, "lost_ticks": 0.0, **(change or {})}
    own = candidate(PLANTS[plant], controller)
    if hasattr(own.controller, "model"):  # the law knows the payload
        own = replace(own, controller=replace(
            own.controller, model=lk.Model("left", replace(PLANTS[plant], **quiet))))  # fmt: skip
    made = getattr(tasks, task)()
    with lk.World(things=things, engine="mujoco") as world:
        arm = lk.Arm("left", replace(PLANTS[plant], **quiet), world=world,
                     q0=lk.robot("left").ready if start is None else start)  # fmt: skip
        target = made.joints if own.joints else made.target
        return lk.run(arm, target, own.controller, rate=own.rate, duration=duration).q


def apart(requests):
    """The largest joint angle between JavaScript's run and Python's, for each request, in [rad]."""
    answers = javascript(*({"ask": "run", **{k: v for k, v in r.items() if k != "scene"}}
                           for r in requests))  # fmt: skip
    found = []
    for request, q in zip(requests, answers, strict=True):
        asked = {k: v for k, v in request.items() if k not in ("scene", "things")}
        expected = python_run(**asked, things=request.get("scene", ()))
        found.append(float(np.abs(np.array(q) - expected).max()))
    return found
