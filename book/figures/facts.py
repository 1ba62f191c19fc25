"""Numbers of the prose that are not results of runs: constants of the arm, and arithmetic."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

import labkit as lk
from labkit.plant import EVIDENCE
from labkit.scene import TIP_STIFFNESS
from solutions.study import experiments, report_gains, speed_gains
from solutions.study.gains import KD, KP, TIP_SPRING
from solutions.study.workspace_velocity import WorkspaceVelocityPD

from .claims import holds, shows

CLAIMS, LEVEL, RATE = 8, 0.95, 200.0
"""Number of claims about tracking; level of an interval; rate of the report's control [Hz]."""


def velocity() -> None:
    """Numbers of the chapter on velocity control."""
    shows("= 30 ms", 0.03, lk.BAXTER.velocity_lag)
    shows("Its state arrives 4 ms late", 0.004, lk.BAXTER.state_delay)
    shows("is about 11.5 ms", 0.0115, 0.004 + 0.5 / 100.0 + 0.5 / 200.0)
    shows("until a step took away less than 2 % of the error; that gave 0.6", (0.02, 0.6),
          (speed_gains.PAYS, KD))  # fmt: skip
    lever = math.sqrt(TIP_SPRING[3] / TIP_SPRING[0])
    shows("If a radian counts as 0.26 m", 0.26, WorkspaceVelocityPD.lever)
    shows("The length of 0.26 m comes from the [impedance](impedance.md) of 300 N/m and 20 N m/rad",
        (0.26, 300.0, 20.0), (lever, TIP_SPRING[0], TIP_SPRING[3]), 0.02)  # fmt: skip
    shows("in a shift of $\\sqrt{20/300} = 0.26$ m", 0.26, lever, 0.02)


def comparison() -> None:
    """Numbers of the comparison."""
    holds((KP, KD) == (3.0, 0.6), "3 1/s and a $K_d$ of 0.6")
    server = lk.BAXTER.position_gain
    shows("this arm is given 20 1/s, which makes 50 ms", (20.0, 50.0), (server, 1e3 / server))
    shows("With eight claims about tracking, each with an interval of 95 %, the chance of at "
        "least one wrong verdict would be about one in three",
        (8.0, 0.95, 1.0 / 3.0), (CLAIMS, LEVEL, 1.0 - LEVEL**CLAIMS), 0.02)  # fmt: skip


def model() -> None:
    """Numbers of the chapter on the model."""
    robot = lk.robot("left")
    shows("has none either and allows s1 100 N m", 100.0, robot.effort[1])
    shows("50 N m is right for that machine", 50.0, robot.effort[0])
    bare = lk.Model("left").mass_matrix(robot.ready)[6, 6]
    holds(lk.BAXTER.armature[6] > bare > 0.0, "which is more than the last links have themselves")


def impedance() -> None:
    """Numbers of the chapter on impedance."""
    dry, lever, push = lk.BAXTER.stiction[0], 0.5, 10.0
    shows("dry friction of 1 N m and a lever of half a metre holds against 2 N at the hand, so of "
        "10 N only about 8", (1.0, 0.5, 2.0, 10.0, 8.0),
        (dry, lever, dry / lever, push, push - dry / lever))  # fmt: skip
    shows("friction holds these 2 N of each push, and a push below 2 N does not", 2.0,
        dry / lever)  # fmt: skip
    shows("viscous friction of 0.7 N m s/rad", 0.7, lk.BAXTER.viscous[0])
    shows("The arm has 300 N/m, the contact", 300.0, TIP_SPRING[0])
    shows("The workspace impedance of 300 N/m presses with", 300.0, TIP_SPRING[0])
    wall = experiments.the_wall()
    k = [wall.stiffness, TIP_STIFFNESS]
    holds(
        k == (5000.0, 10000.0) or list(k) == [5000.0, 10000.0],
        "The wall has 5,000 N/m and the finger's pad 10,000 N/m",
    )


def report() -> None:
    """Numbers of the page on the report."""
    shows(
        "24.5 rad/s for the report's gain $k_p = 3$ at 200 Hz",
        (24.5, 3.0, 200.0),
        (math.sqrt(KP * RATE), KP, RATE),
        0.002,
    )
    shows("fixes the mean speed at 0.2 m/s", 0.2, 1.0 / 5.0)
    shows("0.4 m/s by equation 1", 0.4, 2.0 / 5.0)
    lag, age = lk.BAXTER.velocity_lag, 0.0115
    w = brentq(lambda w: math.atan(w * lag) + w * age - math.pi, 1.0, 500.0)
    holds(
        math.isclose(lag, 0.03) and 3.0 < math.hypot(1.0, w * lag) < 12.0,
        "a drive that obeys within a tick allows 1, one with a lag of 30 ms allows more",
    )
    law = report_gains.TABLE_1["workspace impedance"](lk.Model("left", lk.BAXTER)).controller
    shows("With a stiffness of 0.5 N/m a push of 1 N would move the hand 2 m", (0.5, 1.0, 2.0),
        (law.D[0], 1.0, 1.0 / law.D[0]))  # fmt: skip
    shows("dry friction of about 1 N m explains it", 1.0, lk.BAXTER.stiction[0])
    spring, wrist = law.K[3], lk.BAXTER.stiction[6]
    shows("0.3 N m/rad overcomes the dry friction of the wrist, 0.3 N m, only after a turn of one "
        "radian", (0.3, 0.3, 1.0), (spring, wrist, wrist / spring))  # fmt: skip
    shows('has 0.5 to 0.1 N/m under "proportional gain" and 45 N/m under', (0.5, 0.1, 45.0),
        (law.D[0], law.D[-1], law.K[0]))  # fmt: skip
    shows("45 N/m with a damping of 0.5 N s/m is an arm", (45.0, 0.5), (law.K[0], law.D[0]))


def plant() -> None:
    """Numbers of the page on what is known about the arm."""
    model = lk.Model("left", lk.BAXTER)
    q = np.array(model.robot.ready)
    inertia = float(model.mass_matrix(q)[0, 0])
    off = model.pose(q + np.array(EVIDENCE["encoder_offset"].most))[:3, 3] - model.pose(q)[:3, 3]
    shows("the hand is then about 5 mm from where", 5.0, 1e3 * np.linalg.norm(off), 0.1)
    springs = report_gains.TABLE_1["joint torque"](model).controller.Kp
    shows("its gains of 8 to 12 N m/rad", (8.0, 12.0), (min(springs), max(springs)))
    dry = lk.BAXTER.stiction[0]
    holds(dry / min(springs) == 0.125, "may stop a joint an eighth of a radian from its target")
    shows("225 1/s² times 2.17 kg m²", (225.0, 2.17), (225.0, inertia), 0.01)
    shows("about 60 times as stiff at the shoulder", 60.0, 225.0 * inertia / 8.0, 0.1)
