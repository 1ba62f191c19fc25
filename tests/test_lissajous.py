"""A Lissajous figure, which a planar arm of two joints draws with its pen."""

from importlib.util import find_spec
from math import cos, pi, sin

import numpy as np
import pytest
from curves import assert_slopes
from numpy.testing import assert_allclose

import labkit as lk
from labkit.sim import ENGINES

LINK = """<link name="{0}"><inertial><mass value="{1}"/><origin xyz="0 0 0.25"/>
  <inertia ixx="0.02" iyy="0.02" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = """<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/>
  <axis xyz="0 1 0"/><origin xyz="0 0 {3}"/>
  <limit lower="-3" upper="3" velocity="6" effort="60"/></joint>"""
PLANAR = f"""<robot name="planar"><link name="base"/>{LINK.format("upper", 2)}
  {LINK.format("fore", 1)}<link name="pen"/>{JOINT.format("shoulder", "base", "upper", 0)}
  {JOINT.format("elbow", "upper", "fore", 0.5)}
  <joint name="tip" type="fixed"><parent link="fore"/><child link="pen"/>
    <origin xyz="0 0 0.5"/></joint></robot>"""


class Lissajous:
    """The figure of 3 : 2 about a centre, in the plane y = 0."""

    def __init__(self, centre):
        self.centre = np.asarray(centre)

    def __call__(self, s):
        x, dx, ddx = np.zeros((3, 3))
        for axis, turns, size in ((0, 3, 0.15), (2, 2, 0.1)):
            w = 2.0 * pi * turns
            x[axis], dx[axis] = size * sin(w * s), size * w * cos(w * s)
            ddx[axis] = -w * w * x[axis]
        return lk.Sample(self.centre + x, dx, ddx)


class InThePlane:
    """Computed torque for the pen: the error of its x and z decays like a critical spring."""

    def __init__(self, model, w=30.0):
        self.model, self.w = model, w

    def __call__(self, state, target):
        q, dq, plane = state.q, state.dq, [0, 2]
        J = self.model.tip_jacobian(q)[plane]
        e = (target.position - self.model.pose(q)[:3, 3])[plane]
        de = target.velocity[plane] - J @ dq
        drift = self.model.tip_jacobian_rate(q, dq)[plane] @ dq
        ddx = target.acceleration[plane] + 2.0 * self.w * de + self.w**2 * e
        ddq = np.linalg.solve(J, ddx - drift)
        return lk.JointTorque(self.model.inverse_dynamics(q, dq, ddq))


@pytest.fixture
def planar(tmp_path):
    """The arm, its elbow bent at a right angle."""
    path = tmp_path / "planar.urdf"
    path.write_text(PLANAR)
    return lk.Robot.from_urdf(path, tip="pen", ready=(0.2, 1.6))


def test_the_derivatives_of_the_figure_are_its_slopes():
    """Velocity and acceleration are derivatives with respect to s, all along the figure."""
    for s in np.linspace(0.05, 0.95, 7):
        assert_slopes(Lissajous([0.1, 0.2, 0.3]), s)


@pytest.mark.parametrize("engine", [*filter(find_spec, ENGINES)])
def test_the_pen_draws_the_figure_on_each_engine(planar, engine):
    """From a start 25 mm away: after 0.5 s within 0.2 mm of it, in its plane, in full size."""
    model = lk.Model(planar)
    centre = model.pose(planar.ready)[:3, 3]
    target = lk.Trajectory(Lissajous(centre), lk.Quintic(6.0))
    with lk.Arm(planar, q0=planar.ready + [0.05, -0.05], world=lk.World(engine=engine)) as arm:
        log = lk.run(arm, target, InThePlane(model), rate=1000.0)
    tip = lk.metrics.tip_poses(log)[:, :3, 3]
    off = np.linalg.norm(log.target.position - tip, axis=1)
    late = log.t > 0.5
    assert off[0] > 0.02
    assert off[late].max() < 2e-4
    assert np.abs(tip[:, 1]).max() < 1e-12
    assert_allclose(np.ptp(tip[late], axis=0), [0.3, 0.0, 0.2], rtol=0, atol=2e-4)
    assert not log.saturated.any()
