"""Chapter "Tags and cameras": results that follow from geometry and time alone."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML

import labkit as lk
from labkit.replay import motion_of
from labkit.tags.detection import detect_tags
from solutions.study.gains import course_controllers
from solutions.study.sensing import Setup, consistency
from solutions.study.tag_scenes import circling_board
from solutions.study.tag_task import OFFSET, closed_loop, staged
from solutions.study.tasks import ready_pose
from solutions.study.visual_servoing import SequentialServoing
from solutions.tags.following import TagFollower

from .claims import holds
from .embed import motion_html
from .page import Question, address, figure, framed, number, numbers, poster, quiz

SEED = 8
FOCAL = 600.0
SIZE = 0.08
NOISE, PERIOD, AGE = 0.001, 0.1, 0.1
"""Readings of the swaying target: their noise [m], their period [s] and their age [s]."""
LOST = 0.3
TILT = (0.26, 1.05)


def seen() -> HTML:
    """A picture of the simulated camera with the detected tag."""
    scene = circling_board(noise=2.0, seed=SEED)
    image, lens = scene.camera.image(), scene.camera.intrinsics
    (found,) = detect_tags(image, scene.camera, scene.board.tag.size)
    truth = lk.se3.inverse(scene.camera.T_wc) @ scene.board.T_wm
    off = 1e3 * np.linalg.norm(found.T_cm[:3, 3] - truth[:3, 3])
    turned = np.degrees(lk.se3.angle_between(truth[:3, :3], found.T_cm[:3, :3]))
    distance = float(truth[2, 3])
    holds(off < 3.0 and turned < 2.0, "the pose from the picture is good to millimetres")
    numbers({"tag_off": off, "tag_turned": turned, "tag_distance": distance}, ".2g")
    number("tag_pixels", found.noise, ".1g")
    points = " ".join(f"{u:.1f},{v:.1f}" for u, v in found.corners)
    middle = found.corners.mean(axis=0)
    dots = "".join(
        f'<text x="{u:.0f}" y="{v + 4:.0f}" font-size="11" text-anchor="middle" fill="#0b3d91">'
        f"{k}</text>"
        for k, (u, v) in enumerate(middle + 1.35 * (found.corners - middle))
    )
    alt = (
        f"The hand of Baxter's left arm above a tag, {distance:.2g} m from the camera. "
        f"The outline that was found lies on the black square; its pose is {off:.2g} mm and "
        f"{turned:.2g} degrees from the truth, and fits the corners to {found.error:.2g} pixels."
    )
    drawing = (
        f'<svg class="lab-svg" role="img" aria-label="{alt}" '
        f'viewBox="280 40 280 240" xmlns="http://www.w3.org/2000/svg">'
        f'<image href="{address(image)}" width="{lens.width}" '
        f'height="{lens.height}"/><polygon points="{points}" fill="none" stroke="#0b3d91" '
        f'stroke-width="1.2"/>{dots}</svg>'
    )
    caption = "Hand and tag, seen by the simulated camera. The corners found are numbered from 0."
    return HTML(framed(drawing, caption, alt))


def corners_seen(tilt: float, distance: float) -> np.ndarray:
    """Pixels of a tag's corners, turned by ``tilt`` about the camera's y axis."""
    square = 0.5 * SIZE * np.array(((-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)))
    p = square @ lk.se3.rotation((0.0, tilt, 0.0)).T + (0.0, 0.0, distance)
    return FOCAL * p[:, :2] / p[:, 2:]


def ambiguity_gap(tilt: float, distance: float) -> float:
    """The RMS distance in pixels between the corners at a tilt and the best opposite tilt."""
    seen = corners_seen(tilt, distance)
    best = np.inf
    for other in np.linspace(-1.4, -0.02, 60):
        for z in distance * np.linspace(0.96, 1.04, 41):
            off = corners_seen(other, z) - seen
            off = off - off.mean(axis=0)
            best = min(best, float(np.sqrt((off**2).sum(axis=1).mean())))
    return best


def ambiguity() -> HTML:
    """How well a picture distinguishes the two tilts."""
    distances = np.linspace(0.25, 2.5, 16)
    _, ax = plt.subplots(figsize=(6.0, 3.2))
    curves = {}
    for k, (degrees, style) in enumerate(((10.0, "-"), (30.0, "--"), (50.0, "-."))):
        curves[degrees] = [ambiguity_gap(np.radians(degrees), z) for z in distances]
        ax.plot(distances, curves[degrees], f"C{k}{style}", label=f"tilted by {degrees:.0f}°")
    ax.axhline(0.3, color="C5", linestyle=":")
    ax.text(0.2, 0.2, "0.3 pixels", fontsize="small")
    ax.set(xlabel="distance [m]", ylabel="misfit of the wrong tilt [pixels]", yscale="log")
    ax.legend()
    holds(
        all(
            0.0 < a < b < c
            for a, b, c in zip(curves[10.0], curves[30.0], curves[50.0], strict=True)
        ),
        "The curve in the middle is for a tilt of 30°",
    )
    near, far = curves[30.0][0], curves[30.0][-1]
    holds(
        near > 10.0 * 0.3 and 0.0 < far < 0.6 * 0.3,
        "A corner finder with a noise of 0.3 pixels, the dotted line, tells the two",
    )
    numbers({"near": distances[0], "far": distances[-1], "gap_near": near, "gap_far": far}, ".2g")
    return figure(
        "How badly the opposite tilt fits the corners of a tag of 8 cm, at a focal length of 600 "
        "pixels. Below the noise of the corners (dotted) the two tilts look alike.",
        f"Three falling curves. For a tilt of 30 degrees the misfit is {near:.2g} pixels at "
        f"{distances[0]:.2g} m and {far:.2g} pixels at {distances[-1]:.2g} m; for 10 degrees it is "
        f"{curves[10.0][0]:.2g} and {curves[10.0][-1]:.2g}. A noise of 0.3 pixels is marked.",
    )


def _blended(p: float, v: float, a: float, goal: float, T: float) -> np.ndarray:
    """Coefficients of the quintic from (p, v, a) to the goal at rest."""
    A = np.array(
        ((T**3, T**4, T**5), (3 * T**2, 4 * T**3, 5 * T**4), (6 * T, 12 * T**2, 20 * T**3))
    )
    b = np.array((goal - p - v * T - 0.5 * a * T**2, -v - a * T, -a))
    return np.array((p, v, 0.5 * a, *np.linalg.solve(A, b)))


def blend() -> HTML:
    """A goal that moves half-way: the motion restarts from rest, or it continues."""
    first, change, T = lk.Trajectory(lk.Line([0.0], [0.2]), lk.Quintic(2.0)), 1.0, 2.0
    t = np.linspace(0.0, 3.2, 1281)
    p, v, a = (float(x[0]) for x in first(change))
    again = lk.Trajectory(lk.Line([p], [0.3]), lk.Quintic(T))
    curve = np.polynomial.Polynomial(_blended(p, v, a, 0.3, T))
    restarted, blended = [], []
    for x in t:
        if x < change:
            pv = tuple(float(y[0]) for y in first(x)[:2])
            restarted.append(pv)
            blended.append(pv)
        else:
            restarted.append(tuple(float(y[0]) for y in again(x - change)[:2]))
            s = min(x - change, T)
            blended.append((curve(s), curve.deriv()(s)))
    _, (above, below) = plt.subplots(2, 1, figsize=(6.0, 4.0), sharex=True)
    for rows, style, name in ((restarted, "C0--", "restarted"), (blended, "C1-", "blended")):
        x, dx = np.array(rows).T
        above.plot(t, x, style, label=name)
        below.plot(t, dx, style, label=name)
    above.set_ylabel("reference [m]")
    below.set(xlabel="time [s]", ylabel="its speed [m/s]")
    above.legend()
    speed = np.array(blended)[:, 1]
    holds(np.abs(np.diff(speed)).max() < 0.01 < v, "the blended speed has no jump")
    number("jump", v, ".2g")
    return figure(
        "A reference whose goal moves half-way, from 0.2 m to 0.3 m. Restarted, it stops first.",
        f"Reference and its speed over three seconds. The restarted one drops from {v:.2g} m/s to "
        "zero at t = 1 s and begins anew; the blended one passes without a corner and ends at the "
        "same place at the same time.",
    )


class Sway(NamedTuple):
    """A swaying target, and two estimates of its position, each shape (n,), in [s] and [m]."""

    t: np.ndarray
    truth: np.ndarray
    last: np.ndarray
    ahead: np.ndarray

    def rms(self, belief: np.ndarray) -> float:
        """The error of an estimate after the filter has settled, in [mm]."""
        late = self.t > 1.5
        return 1e3 * float(np.sqrt(np.mean((belief - self.truth)[late] ** 2)))


@cache
def swaying(seed: int = SEED) -> Sway:
    """The target seen in pictures at 10 Hz, 100 ms old on arrival, with 1 mm of noise."""
    random = np.random.default_rng(seed)
    period, age, noise = PERIOD, AGE, NOISE
    t = np.arange(0.0, 8.0, 0.005)
    shots = np.arange(0.0, 8.0, period)
    seen = 0.1 * np.sin(1.2 * shots) + noise * random.standard_normal(shots.size)
    R, q = noise**2, 0.05**2
    x, P = np.array((seen[0], 0.0)), np.diag((R, 0.04))
    states = [x]
    for z in seen[1:]:
        A = np.array(((1.0, period), (0.0, 1.0)))
        Q = q * np.array(((period**3 / 3, period**2 / 2), (period**2 / 2, period)))
        x, P = A @ x, A @ P @ A.T + Q
        gain = P[:, 0] / (P[0, 0] + R)
        x, P = x + gain * (z - x[0]), P - np.outer(gain, P[0])
        states.append(x)
    k = np.clip(((t - age) / period).astype(int), 0, len(shots) - 1)
    ahead = [states[i][0] + (now - shots[i]) * states[i][1] for i, now in zip(k, t, strict=True)]
    return Sway(t, 0.1 * np.sin(1.2 * t), seen[k], np.array(ahead))


def predict() -> HTML:
    """Compare the last picture of a swaying target with a prediction."""
    sway, ten = swaying(), [swaying(seed) for seed in range(10)]
    found = {"stale": [x.rms(x.last) for x in ten], "predicted": [x.rms(x.ahead) for x in ten]}
    rms = {name: float(np.mean(x)) for name, x in found.items()}
    holds(rms["predicted"] < 0.4 * rms["stale"], "prediction removes most of the error of age")
    numbers(rms, ".1f")
    numbers({f"{name}_sd": np.std(x, ddof=1) for name, x in found.items()}, ".1g")
    _, ax = plt.subplots(figsize=(6.0, 3.0))
    show = (sway.t > 2.0) & (sway.t < 5.0)
    t = sway.t[show]
    ax.plot(t, sway.truth[show], color="#999999", linewidth=5, label="where it is")
    ax.plot(t, sway.last[show], "C0--", label="last picture")
    ax.plot(t, sway.ahead[show], "C1-", label="predicted")
    ax.set(xlabel="time [s]", ylabel="target [m]")
    ax.legend(fontsize="small")
    return figure(
        "A target that sways, with its last picture and its prediction, which overshoots the turn.",
        f"Position over three seconds: the last picture is a staircase that trails behind with "
        f"{rms['stale']:.2g} mm RMS error; the prediction follows with {rms['predicted']:.2g} mm.",
    )


def following() -> HTML:
    """The arm above a circling board and, see-through, an arm that looks first and then moves."""
    logs, misses, unseen = {}, {}, {}
    start = ready_pose()
    law = course_controllers(lk.Model("left", lk.BAXTER))["workspace velocity"]
    for name, follower, dials in (
        ("predicts", TagFollower(start, OFFSET), {}),
        ("loses readings", TagFollower(start, OFFSET), {"dropout": LOST}),
        ("looks, then moves", SequentialServoing(start, OFFSET), {"rate": 0.2, "delay": 1.0}),
    ):
        made = closed_loop(SEED, law.controller, follower, **dials)
        logs[name], misses[name], unseen[name] = made
    late = logs["predicts"].t >= 2.0
    rms = {name: 1e3 * lk.metrics.rms(miss[late]) for name, miss in misses.items()}
    holds(rms["predicts"] < 0.3 * rms["looks, then moves"], "prediction follows, looking lags")
    holds(rms["loses readings"] < 6.0, "still keeps its error below 6 mm")
    holds(unseen["predicts"] == 0, "the arm does not hide the tag from this camera")
    numbers({"follow_rms": rms["predicts"], "lookups_rms": rms["looks, then moves"]}, ".1g")
    log, ghost = logs["predicts"], {"looks, then moves": logs["looks, then moves"]}
    with lk.World() as world:
        board, _ = staged(world, SEED)
        poses = np.array([board.pose_at(t) for t in log.t])
    goal = poses[:, :3, 3] + OFFSET
    motion = replace(
        motion_of(log, "Following a tag", label="predicts", ghosts=ghost, reference=False),
        board_position=poses[:, :3, 3],
        board_rotation=poses[:, :3, :3],
        target_position=goal,
        path=goal[:: len(goal) // 120],
        error=misses["predicts"],
    )
    caption = (
        "Two arms above a tag that goes round; the see-through one looks and then moves. The error "
        "is the distance of the tip from the place 20 cm above the true tag."
    )
    return HTML(motion_html(motion, caption=caption, poster=poster(motion)))


PICTURES = 40
SETUPS = {
    "sharp": Setup(tilt=TILT),
    "noise 10": Setup(tilt=TILT, optics={"noise": 10.0}),
    "light falls 60 %": Setup(tilt=TILT, optics={"noise": 2.0, "shade": 0.6}),
    "blur 1 px": Setup(tilt=TILT, optics={"noise": 2.0, "blur": 1.0}),
    "blur 2 px": Setup(tilt=TILT, optics={"noise": 2.0, "blur": 2.0}),
    "smear 6 px": Setup(tilt=TILT, optics={"noise": 2.0}, smear=6.0),
    "JPEG 60": Setup(tilt=TILT, optics={"noise": 2.0, "jpeg": 60}),
    "corner 10 %": Setup(tilt=TILT, cover=0.1),
    "2 m, noise 2": Setup(tilt=TILT, optics={"noise": 2.0}, distance=2.0),
}
"""Changes made to a picture of a tag 0.7 m away, tilted by 15 to 60 degrees."""


def trust() -> HTML:
    """Test whether the errors are as large as the detector says, for each kind of picture."""
    found = {name: consistency(setup, PICTURES, seed=5) for name, setup in SETUPS.items()}
    trusted = [x for _, x in found.values()]
    holds(min(share for share, _ in found.values()) > 0.8, "the detector is not blind")
    holds(min(trusted) > 1.0 and max(trusted) < 8.0, "between 1 and 8 in all of them")
    number("afar_seen", 100.0 * found["2 m, noise 2"][0], ".0f")
    _, ax = plt.subplots(figsize=(6.0, 3.2))
    ax.axvspan(1.0, 8.0, color="#999999", alpha=0.25)
    ax.axvline(3.0, color="#999999")
    ax.plot(trusted, range(len(found)), "o", color="C1")
    ax.set_yticks(range(len(found)), found)
    ax.set(xlabel="mean of $e^TP^{-1}e$ for the position", xlim=(0.0, 9.0))
    ax.invert_yaxis()
    said = "; ".join(f"{name} {x:.2g}" for name, (_, x) in found.items())
    return figure(
        f"The detector's covariance, tested with {PICTURES} pictures of each kind. The right value "
        "is 3; the band is from 1 to 8.",
        f"A point for each kind of picture. {said}.",
    )


def check_yourself() -> HTML:
    """The quiz of the chapter."""
    return quiz(
        Question(
            "A program reports tags 1.25 times too far, always, and the focal length has been "
            "checked. What should be checked next?",
            [
                (
                    "The distortion of the lens",
                    "That bends lines. It does not scale all distances alike.",
                ),
                (
                    "Whether the size includes the white border",
                    "A square taken for larger appears farther, by the same factor.",
                ),
                ("The principal point", "That shifts the pose sideways."),
            ],
            1,
        ),
        Question(
            "The hand camera sees the tag. Which pose of the camera belongs in "
            r"\(T_{wm} = T_{wc} T_{cm}\)?",
            [
                ("The one when the result arrives", "The hand has moved since the exposure."),
                ("The one at the exposure", "Keep a short history of joint angles for it."),
            ],
            1,
        ),
        Question(
            "A target moves at 0.2 m/s and the picture is 50 ms old. How far is it from where it "
            "was seen?",
            [
                ("1 mm", "That would be right for a picture that is 5 ms old."),
                ("10 mm", "0.2 m/s times 0.05 s is 0.01 m."),
                ("It depends on the gain", "The gain does not affect the target's motion."),
            ],
            1,
        ),
    )
