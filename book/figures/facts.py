"""Numbers of the prose that no run gives: constants of the arm, and arithmetic with them."""

from __future__ import annotations

import math

import numpy as np

import labkit as lk
from labkit.plant import EVIDENCE, SPRINGS
from labkit.scene import TIP_STIFFNESS
from solutions.study import experiments
from solutions.study.gains import KD, KP

from .claims import claim
from .claims import shows as _is


def velocity() -> None:
    """Of the chapter on velocity control."""
    _is("= 30 ms", 0.03, lk.BAXTER.velocity_lag)
    _is("Its state arrives 4 ms late", 0.004, lk.BAXTER.state_delay)
    _is("is about 11.5 ms", 0.0115, 0.004 + 0.5 / 100.0 + 0.5 / 200.0)
    _is("that ends at 0.6", 0.6, KD)


def comparison() -> None:
    """Of the comparison."""
    claim("3 1/s and a $K_d$ of 0.6", lambda p, d: (p, d) == (3.0, 0.6), p=KP, d=KD)
    _is("would decide one of three by luck alone", 1.0 / 3.0, 1.0 - 0.95**8, 0.02)


def model() -> None:
    """Of the chapter on the model."""
    robot = lk.robot("left")
    _is("has none either, allows it: 100 N m", 100.0, robot.effort[1])
    _is("50 N m is right for that machine", 50.0, robot.effort[0])
    bare = lk.Model("left").mass_matrix(robot.ready)[6, 6]
    claim(
        "which is more than the last links have themselves",
        lambda rotor, link: rotor > link > 0.0,
        rotor=lk.BAXTER.armature[6],
        link=float(bare),
    )


def impedance() -> None:
    """Of the chapter on impedance."""
    _is("a critically damped spring has 2 % to go", 0.02, 6.8 * math.exp(-5.8), 0.05)
    _is("holds against 2 N at the hand", 2.0, lk.BAXTER.stiction[0] / 0.5)
    _is("viscous friction of 0.7 N m s/rad", 0.7, lk.BAXTER.viscous[0])
    wall = experiments.the_wall()
    claim(
        "The wall has 5,000 N/m and the finger's pad 10,000 N/m",
        lambda k: k == (5000.0, 10000.0) or list(k) == [5000.0, 10000.0],
        k=[wall.stiffness, TIP_STIFFNESS],
    )


def report() -> None:
    """Of the page on the report."""
    _is("24.5 rad/s for the report's gain", 24.5, math.sqrt(3.0 * 200.0), 0.002)
    _is("fixes the mean speed at 0.2 m/s", 0.2, 1.0 / 5.0)
    _is("0.4 m/s by equation 1", 0.4, 2.0 / 5.0)
    _is("a push of 1 N would move the hand 2 m", 2.0, 1.0 / 0.5)
    _is("dry friction of about 1 N m explains it", 1.0, lk.BAXTER.stiction[0])
    _is("0.3 N m/rad is as large as the dry friction of the wrist", 0.3, lk.BAXTER.stiction[6])
    _is("and 45 N/m under", 45.0, 3.0 * 15.0)


def plant() -> None:
    """Of the page on what is true of the arm."""
    model = lk.Model("left", lk.BAXTER)
    q = np.array(model.robot.ready)
    inertia = float(model.mass_matrix(q)[0, 0])
    off = model.pose(q + np.array(EVIDENCE["encoder_offset"].most))[:3, 3] - model.pose(q)[:3, 3]
    _is("the hand is then about 5 mm from where", 5.0, 1e3 * np.linalg.norm(off), 0.1)
    _is("may stop 0.12 rad from its target", 0.125, lk.BAXTER.stiction[0] / 8.0)
    _is("times 2.1 kg m²", 2.1, inertia, 0.05)
    _is("about 60 times as stiff at the shoulder", 60.0, 225.0 * inertia / 8.0, 0.1)
    swing = math.sqrt(SPRINGS["joint_stiffness"][0] / inertia)
    _is("on the other side at some 20 rad/s", 20.0, swing, 0.1)
