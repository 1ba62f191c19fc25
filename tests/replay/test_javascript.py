"""What the browser computes equals what Pinocchio and NumPy compute."""

import site
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from samples import swing

from labkit.replay.motion import unpack

ARM = ("s0", "s1", "e0", "e1", "w0", "w1", "w2")
SHARE = Path(site.getsitepackages()[0]) / "cmeel.prefix/share"


@pytest.fixture(scope="module")
def baxter():
    return pin.buildModelFromUrdf(
        str(SHARE / "example-robot-data/robots/baxter_description/urdf/baxter.urdf")
    )


@pytest.mark.parametrize("side", ["left", "right"])
def test_kinematics_equal_pinocchio(node, baxter, side):
    """Pose, both Jacobians and manipulability agree to 1e-6 at 100 random angles of each arm."""
    rng = np.random.default_rng(7)
    index = [baxter.idx_qs[baxter.getJointId(f"{side}_{j}")] for j in ARM]
    low, high = baxter.lowerPositionLimit[index], baxter.upperPositionLimit[index]
    angles = rng.uniform(low, high, (100, 7))
    found = node(
        f"x.map((q) => ({{...kinematics.tip(robot, '{side}', q),"
        f" J: kinematics.tipJacobian(robot, '{side}', q),"
        f" B: kinematics.bodyJacobian(robot, '{side}', q),"
        f" w: kinematics.manipulability(kinematics.tipJacobian(robot, '{side}', q))}}))",
        angles.tolist(),
    )
    data, frame = baxter.createData(), baxter.getFrameId(f"{side}_gripper")
    columns = [baxter.idx_vs[baxter.getJointId(f"{side}_{j}")] for j in ARM]
    for q7, js in zip(angles, found, strict=True):
        q = pin.neutral(baxter)
        q[index] = q7
        world = pin.computeFrameJacobian(baxter, data, q, frame, pin.LOCAL_WORLD_ALIGNED)[
            :, columns
        ]
        body = pin.computeFrameJacobian(baxter, data, q, frame, pin.LOCAL)[:, columns]
        pin.framesForwardKinematics(baxter, data, q)
        T = data.oMf[frame]
        np.testing.assert_allclose(np.reshape(js["R"], (3, 3)), T.rotation, rtol=0, atol=1e-6)
        np.testing.assert_allclose(js["p"], T.translation, rtol=0, atol=1e-6)
        np.testing.assert_allclose(np.transpose(js["J"]), world, rtol=0, atol=1e-6)
        np.testing.assert_allclose(np.transpose(js["B"]), body, rtol=0, atol=1e-6)
        measure = np.sqrt(np.linalg.det(world @ world.T))
        assert js["w"] == pytest.approx(measure, abs=1e-6)


def test_logarithm_equals_pinocchio(node):
    """From no turn to 1e-8 rad less than half a turn the vectors come back to 1e-6."""
    rng = np.random.default_rng(9)
    axes = rng.normal(size=(60, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    small = np.array([0, 1e-9, 1e-6, 1e-3])
    nearly_half = np.pi - np.array([1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8])
    lengths = np.concatenate([rng.uniform(0, np.pi, 50), small, nearly_half])
    vectors = axes * lengths[:, None]
    rotations = [pin.exp3(v).ravel().tolist() for v in vectors]
    np.testing.assert_allclose(node("x.map(so3.log)", rotations), vectors, rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    ("expression", "T", "ramp", "a"),
    [
        ("scaling.profile('bang-bang', 2.5, t)", 2.5, 1.25, 4 / 2.5**2),
        ("scaling.trapezoid(0.6, 0.3, 0.5, t)", 0.6 / 0.3 + 0.3 / 0.5, 0.6, 0.5 / 0.6),
        ("scaling.trapezoid(0.1, 5, 0.4, t)", 1.0, 0.5, 4.0),  # too short to cruise
    ],
)
def test_ramped_scalings_are_their_accelerations_integrated(node, expression, T, ramp, a):
    """Bang-bang and trapezoids, one too short to cruise, end at 1 as their ramps add up."""
    t = np.linspace(0, T * (1 - 1e-9), 4001)
    found = np.array(node(f"x.map((t) => {expression})", t.tolist()))
    dds = np.where(t < ramp, a, np.where(t < T - ramp, 0.0, -a))
    inside = np.minimum(np.abs(t - ramp), np.abs(t - T + ramp)) > 1e-6
    np.testing.assert_allclose(found[inside, 2], dds[inside], rtol=0, atol=1e-9)
    first = np.minimum(a * ramp, np.minimum(a * t, a * (T - t)))
    np.testing.assert_allclose(found[:, 1], first, rtol=0, atol=1e-6)
    way = np.concatenate([[0], np.cumsum(0.5 * (first[1:] + first[:-1]) * np.diff(t))])
    np.testing.assert_allclose(found[:, 0], way, rtol=0, atol=1e-5)
    assert found[-1, 0] == pytest.approx(1.0, abs=1e-6)


def test_browser_unpacks_what_python_packs(node):
    """Each channel is what Python reads, and between two rows it is their mean."""
    data = swing(3.0).data()
    read = node("recording.read(x)", data)
    for name in ("q", "target", "tau", "error", "target_quaternion"):
        np.testing.assert_allclose(read[name], unpack(data[name]), rtol=0, atol=1e-12)
    assert read["end"] == pytest.approx(3.0)
    halfway = node("(m => recording.at(m, m.q, 1.5 * m.period))(recording.read(x))", data)
    np.testing.assert_allclose(halfway, np.mean(unpack(data["q"])[1:3], axis=0), rtol=0, atol=1e-12)
