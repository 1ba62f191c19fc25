"""The live arm in the book computes what the lab computes, with the lab's own numbers."""

import importlib.metadata
import json
import re
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from live_reference import LAWS, PLANTS, apart, candidate, javascript

import labkit as lk
from labkit import se3

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "book/_tools")]
PAIR = ("3.14.0", "4.0.0")
"""MuJoCo on npm and on PyPI; the runs below show that both compute the same."""
EXACT, EQUAL = 1e-9, 1e-6  # a command's numbers; a run's joint angles, in [rad]


def test_the_pages_numbers_are_the_labs():
    """`book/live/numbers.js` is what `python book/_tools/make_live.py` would write now.

    To 12 digits: the last ones of an inertia depend on the processor.
    """
    import make_live

    numeral = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")
    stored, now = make_live.OUT.read_text(), make_live.text()
    advice = "run python book/_tools/make_live.py"
    assert numeral.sub("#", stored) == numeral.sub("#", now), advice
    found, expected = (np.array(numeral.findall(text), float) for text in (stored, now))
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14, err_msg=advice)


def test_mujoco_on_npm_and_on_pypi_are_the_tested_pair():
    """Raising one version means looking at both, and at the runs that compare them."""
    wanted = json.loads((ROOT / "book/_tools/vendor/package.json").read_text())["dependencies"]
    assert (wanted["@mujoco/mujoco"], importlib.metadata.version("mujoco")) == PAIR


def moments(count, seed):
    """Random states away from singularities, and targets near them, of poses and of joints."""
    rng, model = np.random.default_rng(seed), lk.Model("left")
    low, high = model.robot.lower, model.robot.upper
    while count:
        q = rng.uniform(low, high)
        if model.nearness_to_singularity(q) < 0.02:
            continue
        state = lk.State(0.0, q, rng.normal(0.0, 0.5, 7))
        turn = se3.pose(se3.rotation(rng.normal(0.0, 0.1, 3)), rng.normal(0.0, 0.05, 3))
        pose = lk.PoseSample(model.pose(q) @ turn, rng.normal(0, 0.3, 6), rng.normal(0, 0.5, 6))
        joint = lk.Sample(q + rng.normal(0, 0.1, 7), rng.normal(0, 0.3, 7), rng.normal(0, 0.5, 7))
        yield state, pose, joint
        count -= 1


def plain(state, target):
    """A state and a target as JavaScript has them."""
    if isinstance(target, lk.PoseSample):
        pose = {"R": target.pose[:3, :3].ravel().tolist(), "p": target.pose[:3, 3].tolist()}
        told = {"pose": pose, "twist": target.twist.tolist(), "dtwist": target.dtwist.tolist()}
    else:
        told = {k: x.tolist() for k, x in target._asdict().items()}
    return [{"t": 0.0, "q": state.q.tolist(), "dq": state.dq.tolist()}, told]


@pytest.mark.filterwarnings("ignore:near a singularity")
def test_commands_equal_those_of_the_solutions():
    """Each law gives the command of `solutions`, to 1e-9 of the largest number in it."""
    cases, requests = [], []
    for plant in PLANTS:
        for name in LAWS:
            own = candidate(PLANTS[plant], name)
            asked = [(s, joint if own.joints else pose) for s, pose, joint in moments(40, seed=5)]
            cases.append([own.controller(*case).value for case in asked])
            states = [plain(*case) for case in asked]
            requests.append(
                {"ask": "commands", "plant": plant, "controller": name, "states": states}
            )
    for request, expected, found in zip(requests, cases, javascript(*requests), strict=True):
        worst = np.abs(np.array(found) - expected).max(axis=1) / np.maximum(
            1.0, np.abs(expected).max(axis=1)
        )
        assert worst.max() < EXACT, (request["plant"], request["controller"], worst.max())


def test_the_equations_of_motion_equal_pinocchios():
    """M, C, g, J and dJ/dt dq of the page are the lab's to 1e-11, with a payload and rotors."""
    plant = lk.Plant(payload=0.7, armature=lk.BAXTER.armature)
    model, rng, requests = lk.Model("left", plant), np.random.default_rng(3), []
    for state, *_ in moments(20, seed=4):
        requests.append({"ask": "model", "payload": 0.7, "armature": list(lk.BAXTER.armature),
                         "q": state.q.tolist(), "dq": state.dq.tolist(),
                         "ddq": rng.normal(size=7).tolist()})  # fmt: skip
    for asked, found in zip(requests, javascript(*requests), strict=True):
        q, dq, ddq = (np.array(asked[k]) for k in ("q", "dq", "ddq"))
        drift = model.tip_jacobian_rate(q, dq) @ dq
        for name, expected in {
            "M": model.mass_matrix(q), "h": model.bias(q, dq), "J": model.tip_jacobian(q),
            "drift": drift,
            "tau": model.inverse_dynamics(q, dq, ddq), "Cd": model.coriolis(q, dq) @ ddq,
        }.items():  # fmt: skip
            np.testing.assert_allclose(found[name], expected, rtol=0, atol=1e-11, err_msg=name)


@pytest.mark.parametrize("plant", PLANTS)
def test_runs_equal_pythons_on_mujoco(plant):
    """Five seconds of line and circle, all six controllers, within 1e-6 rad of the lab's run."""
    requests = [
        {"plant": plant, "controller": name, "task": task, "duration": 5.0}
        for name in [*LAWS, "baxtersOwn"] for task in ("line", "circle")
    ]  # fmt: skip
    worst = apart(requests)
    told = {(r["controller"], r["task"]): x for r, x in zip(requests, worst, strict=True)}
    assert max(worst) < EQUAL, told


def test_contact_payload_and_stops_equal_pythons():
    """A wall with friction, a spring, a payload and a joint stop: within 1e-6 rad."""
    ready = lk.Model("left").pose(lk.robot("left").ready)[:3, 3]
    face = {
        "point": (ready + [0.03, 0.0, 0.0]).tolist(),
        "normal": [-1.0, 0.2, 0.0],
        "friction": 0.3,
    }
    band = {"anchor": (ready + [0.0, 0.2, 0.1]).tolist(), "stiffness": 150.0, "damping": 5.0}
    near = np.array(lk.robot("left").ready)
    near[3] = lk.robot("left").lower[3] + 0.01
    line = {"task": "line", "duration": 2.5}
    requests = [
        {**line, "plant": "ideal", "controller": "workspaceImpedance", "things": [face],
         "scene": [lk.Wall(**face)]},
        {**line, "plant": "baxter", "controller": "jointImpedance", "things": [face, band],
         "scene": [lk.Wall(**face), lk.Spring(**band)]},
        {**line, "plant": "baxter", "controller": "jointVelocity", "things": [face],
         "scene": [lk.Wall(**face)], "change": {"payload": 0.5}},
        {**line, "plant": "baxter", "controller": "jointImpedance", "start": near.tolist()},
    ]  # fmt: skip
    worst = apart(requests)
    assert max(worst) < EQUAL, worst


def test_the_two_poses_of_a_tag_are_opencvs():
    """Of random tags, seen with a pixel of noise: both poses and their order as OpenCV's."""
    rng, size = np.random.default_rng(5), 0.1
    square = size / 2 * np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0.0]])
    images = []
    for _ in range(30):
        R = se3.rotation(rng.uniform(-0.6, 0.6, 3)) @ np.diag([1.0, -1.0, -1.0])
        points = square @ R.T + [*rng.uniform(-0.2, 0.2, 2), rng.uniform(0.4, 1.0)]
        images.append(points[:, :2] / points[:, 2:] + rng.normal(0.0, 1 / 515, (4, 2)))
    answers = javascript(*({"ask": "poses", "size": size, "image": u.tolist()} for u in images))
    for image, found in zip(images, answers, strict=True):
        _, turns, places, errors = cv2.solvePnPGeneric(
            square, image, np.eye(3), None, flags=cv2.SOLVEPNP_IPPE_SQUARE
        )
        for pose, turn, place, error in zip(found, turns, places, errors.ravel(), strict=True):
            R = np.reshape(pose["R"], (3, 3))
            np.testing.assert_allclose(R, cv2.Rodrigues(turn)[0], rtol=0, atol=1e-6)
            np.testing.assert_allclose(pose["p"], place.ravel(), rtol=0, atol=1e-6)
            assert pose["miss"] == pytest.approx(np.sqrt(2.0) * error, rel=1e-4)


def test_half_pixels_flip_a_far_tag_in_the_worst_direction():
    """1 at 1.5 m and 10 degrees, 21 at 0.5 m and 30; with the tilt reversed 36, and never."""
    asked = [
        {"ask": "flip", "distance": distance, "tilt": sign * tilt}
        for sign in (1, -1)
        for distance, tilt in ((1.5, 10), (0.5, 30))
    ]
    assert javascript(*asked) == [1, 21, 36, 100]


def test_without_damping_the_joint_speed_has_no_peak_that_could_be_told():
    """At the pole a reader sees no number of rad/s, which would be that of a grid."""
    undamped, damped = javascript(
        {"ask": "stretched", "lambda2": 0}, {"ask": "stretched", "lambda2": 0.01}
    )
    assert "grows without bound at e1 = 0.16 rad" in undamped
    assert "rad/s" not in undamped
    assert re.search(r"λ² = 0\.01 m²: .* at [\d.]+ rad/s, .* 55 of 100 mm/s", damped)


def test_the_line_under_a_curve_names_what_of_the_arm_was_changed():
    """Payload, friction and latency as set, the gains after them; nothing that is as it was."""
    changed = {"payload": 0.5, "friction": 2, "latency": 60}
    assert javascript(
        {"ask": "described", "plant": "baxter", "gains": {"Kp": 9}},
        {"ask": "described", "plant": "baxter", "gains": {"Kp": 9}, "change": changed},
    ) == [
        "realistic arm, joint velocity, Kp 9",
        "realistic arm, friction × 2, payload 0.5 kg, latency 60 ms, joint velocity, Kp 9",
    ]


def test_the_page_says_how_much_a_click_loads():
    """The size of all scripts, before the click; WebAssembly grows by a third as base64."""
    bundle, viewer = ROOT / "book/live/bundle", ROOT / "labkit/data/viewer"
    plain = [viewer / "viewer.js", viewer / "robot.js", bundle / "mujoco.js", bundle / "live.js"]
    packed = (bundle / "mujoco.wasm.gz").stat().st_size
    size = sum(path.stat().st_size for path in plain) + packed * 4 / 3
    assert f'"{size / 1e6:.0f} MB, from this' in (ROOT / "book/live/boot.js").read_text()
