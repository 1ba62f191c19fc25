"""Chapter "Paths and time scaling"."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML

import labkit as lk
from labkit import metrics, plotting
from solutions.study.joint_velocity import JointVelocityPD

from .claims import holds, shows
from .page import Question, figure, number, numbers, quiz, replay, table, tracking

SEED = 1
DURATION = 4.0
WAY = (0.10, -0.20, 0.15)
KP = 5.0


@cache
def line_task(
    side: str = "left", duration: float = DURATION
) -> tuple[lk.Trajectory, lk.Trajectory]:
    """The line of this chapter as a trajectory of poses and as one of joint angles."""
    model = lk.Model(side)  # type: ignore[arg-type]
    T_wt = model.pose(model.robot.ready)
    way = np.array(WAY) * ((1.0, 1.0, 1.0) if side == "left" else (1.0, -1.0, 1.0))
    line = lk.PosePath(lk.Line(T_wt[:3, 3], T_wt[:3, 3] + way), T_wt[:3, :3])
    target = lk.Trajectory(line, lk.Quintic(duration))
    return target, model.joint_trajectory(target, model.robot.ready)


@cache
def line_run(kp: float = KP, plant: lk.Plant = lk.BAXTER, side: str = "left") -> lk.Log:
    """Run the joint velocity PD along the line."""
    _, joints = line_task(side)
    with lk.Arm(side, plant, SEED, q0=lk.robot(side).ready) as arm:  # type: ignore[arg-type]
        return lk.run(arm, joints, JointVelocityPD(kp))


def _scalings() -> list[tuple[str, lk.BangBang | lk.Cubic | lk.Quintic | lk.Trapezoid]]:
    """Four schedules for the same metre in the same two seconds."""
    return [
        ("bang-bang", lk.BangBang(2.0)),
        ("trapezoid", lk.Trapezoid(1.0, 0.75, 0.75 / (2.0 - 1.0 / 0.75))),
        ("cubic", lk.Cubic(2.0)),
        ("quintic", lk.Quintic(2.0)),
    ]


def scalings() -> HTML:
    """Distance, speed and acceleration of four time scalings."""
    _, axes = plt.subplots(3, 1, figsize=(6.0, 5.4), sharex=True)
    plotting.scaling(*_scalings(), axes=axes)
    peaks = {
        name: np.abs([s(t) for t in np.linspace(0.0, 2.0, 4001)[:-1]]).max(0)
        for name, s in _scalings()
    }
    told = "; ".join(
        f"{name}: speed {v:.3g} per second, acceleration {a:.4g} per second squared"
        for name, (_, v, a) in peaks.items()
    )
    axes[0].legend(ncols=2, fontsize="small", loc="upper left")
    return figure(
        "Four time scalings of the same distance in the same time. Only the quintic starts and "
        "ends without a jump of the acceleration.",
        f"Three panels over two seconds: s, its speed and its acceleration. Peaks: {told}.",
    )


def peak_table() -> HTML:
    """Peak factors, computed and compared with the formulas of the text."""
    rows = []
    for kind, speed, acceleration in (
        (lk.BangBang, 2.0, 4.0),
        (lk.Cubic, 1.5, 6.0),
        (lk.Quintic, 1.875, 10.0 / np.sqrt(3.0)),
    ):
        _, v, a = np.abs([kind(1.0)(t) for t in np.linspace(0.0, 1.0, 100001)[:-1]]).max(0)
        holds(abs(v - speed) < 1e-6 and abs(a - acceleration) < 1e-4, f"peaks of {kind.__name__}")
        jump = "none" if kind is lk.Quintic else f"{abs(kind(1.0)(0.0)[2]):.3g}\u00a0D/T²"
        rows.append((kind.__name__, f"{v:.4g}\u00a0D/T", f"{a:.4g}\u00a0D/T²", jump))
    return table(
        ("Time scaling", "largest speed", "largest acceleration", "jump of acceleration at start"),
        rows,
        "Peaks on a path of length D, covered in time T",
    )


def line_tracking() -> HTML:
    """The line, followed by the joint velocity PD on the realistic arm."""
    return tracking(
        line_run(),
        f"The line with Kp = {KP:g} 1/s on the realistic arm. The tip's curves cover its target's.",
    )


def line_replay() -> HTML:
    """The same run in 3-D, with a see-through arm for feed-forward alone."""
    return replay(
        line_run(),
        "Baxter's left arm follows a line",
        f"The line with feedback, Kp = {KP:g} 1/s, and see-through without. Feedback makes the "
        "error smaller until just before the end. Drag to turn the view, or use the arrow keys.",
        label=f"Kp = {KP:g}",
        ghosts={"Kp = 0": line_run(0.0)},
    )


def line_numbers() -> None:
    """Numbers of the prose, and its conclusions from them."""
    target, _ = line_task()
    with_feedback, without = (metrics.summary(line_run(kp)) for kp in (KP, 0.0))
    ideal = metrics.summary(line_run(KP, lk.IDEAL))
    length = float(np.linalg.norm(WAY))
    numbers(
        {
            "line_cm": 100.0 * length,
            "peak_speed": 1.875 * length / DURATION,
            "ideal_rms": ideal.rms_mm,
            "gain": without.rms_mm / with_feedback.rms_mm,
        },
        ".2g",
    )
    numbers({"ff_rms": without.rms_mm, "pd_rms": with_feedback.rms_mm}, ".2g")
    number("duration", target.duration, ".0f")
    holds(with_feedback.rms_mm < 0.5 * without.rms_mm, "feedback more than halves the RMS error")
    holds(ideal.rms_mm < 0.1 * with_feedback.rms_mm, "most of the error is the plant's")
    _shapes()


def _behind(kp: float, plant: lk.Plant = lk.BAXTER) -> tuple[np.ndarray, np.ndarray]:
    """Times, and the distance of the tip behind its target along the line, in [mm]."""
    log = line_run(kp, plant)
    way = np.array(WAY) / np.linalg.norm(WAY)
    return log.t, 1e3 * metrics.tip_error(log)[:, :3] @ way


def _shapes() -> None:
    """Explain the curves of the error by the parts of the lag and of the age."""
    t, without = _behind(0.0)
    _, late = _behind(KP)
    _, lag = _behind(KP, replace(lk.BAXTER, name="without delay", state_delay=0.0))
    _, age = _behind(KP, replace(lk.BAXTER, name="without lag", velocity_lag=0.0))
    half, early = int(np.argmin(abs(t - DURATION / 2))), t < DURATION / 2
    speed = 1.875 * float(np.linalg.norm(WAY)) / DURATION
    shows("here 30 ms times 0.126 m/s, which is 3.8 mm", (30.0, 0.126, 3.8),
          (1e3 * lk.BAXTER.velocity_lag, speed, 1e3 * lk.BAXTER.velocity_lag * speed),
          0.01)  # fmt: skip
    small = {
        "lag_first": lag[early].max(), "age_middle": -age[half],
        "lag_second": -lag[~early].min(), "bump_first": late[early].max(), "pd_end": abs(late[-1]),
    }  # fmt: skip
    numbers({name: float(x) for name, x in small.items()}, ".1g")
    numbers({"ff_most": float(without.max()), "bump_second": float(-late.min())}, ".2g")
    holds(abs(without[-1]) < 0.02, "caught up with it by itself, to a fiftieth of a millimetre")
    holds(
        0.0 < small["bump_first"] < 0.8 * small["lag_second"]
        and -late.min() > 1.3 * small["lag_second"] > 0.0
        and (small["age_middle"] > 0.0),
        "In the first half one error is behind and the other ahead, and they cancel;",
    )


def check_yourself() -> HTML:
    """The quiz of the chapter."""
    return quiz(
        Question(
            r"A move of D = 0.10 m is to stay below v = 0.20 m/s and a = 0.50 m/s². "
            r"Which limit decides the duration of the bang-bang schedule?",
            [
                ("The speed: T = 1.0 s", "T = 2D/v = 1.0 s is longer than √(4D/a) = 0.89 s."),
                ("The acceleration: T = 0.89 s",
                 "√(4D/a) = 0.89 s, but then the peak speed is 2D/T = 0.22 m/s: above the limit."),
                ("Both give the same", "2D/v = 1.0 s and √(4D/a) = 0.89 s differ."),
            ],
            0,
        ),
        Question(
            r"On a straight line, what is lost if the term with \(x'(s)\,\ddot s\) is left out of "
            "the acceleration?",
            [
                ("Nothing: a line does not bend",
                 r"It is \(x''\) that vanishes on a line; \(x'\,\ddot s\) is all the acceleration "
                 "there is."),
                ("All of it", r"\(x'' = 0\) on a line, so only \(x'\,\ddot s\) remains."),
                ("Only the part at the corners", "A line has no corners."),
            ],
            1,
        ),
        Question(
            "The duration on the same path is doubled. What becomes of the largest acceleration?",
            [
                ("Half", "That is the speed. Acceleration has the time squared below it."),
                ("A quarter", "It is proportional to 1 / T²."),
                ("The same", r"\(\ddot s\) is proportional to 1 / T², so it shrinks."),
            ],
            1,
        ),
    )  # fmt: skip
