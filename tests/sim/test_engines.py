"""The engines: the same arm, the same motion, whichever integrates it."""

from importlib.util import find_spec

import numpy as np
import pytest
from numpy.testing import assert_allclose

import labkit as lk
from labkit.errors import UnknownName
from labkit.scene import TIP_RADIUS
from labkit.sim import ENGINES

READY = lk.robot("left").ready
ROTORS = lk.Plant(armature=lk.BAXTER.armature)
PLANTS = {"ideal": lk.IDEAL, "rotors": ROTORS, "baxter": lk.BAXTER}
each = pytest.mark.parametrize("engine", [*filter(find_spec, ENGINES)])


class Equations:
    """The protocol by itself: the equations of motion, integrated as it says."""

    def __init__(self, robot, plant, dt):
        self.model, self.dt = lk.Model(robot, plant), dt

    def place(self, q, dq):
        self.q, self.dq = np.array(q), np.array(dq)

    def step(self, tau, ddq):
        M, bias = self.model.mass_matrix(self.q), self.model.bias(self.q, self.dq)
        self.dq = self.dq + self.dt * np.linalg.solve(M, tau - bias)
        self.q = self.q + self.dt * self.dq
        return self.q, self.dq

    def close(self):
        pass


@pytest.fixture
def by_the_equations(monkeypatch):
    """Runs as the equations of motion have them, once on an engine and once without any."""

    def pair(run, engine):
        log = run(engine)
        with monkeypatch.context() as patch:
            patch.setattr("labkit.arm.new_arm", lambda _, *arm: Equations(*arm))
            return log, run(engine)

    return pair


def swing(mode, size, own):
    """A controller that swings all joints in one mode; a large size saturates it."""
    w = np.linspace(1.0, 4.0, 7)

    def swing(state, target):
        s, c = np.sin(w * state.t), np.cos(w * state.t)
        if mode is lk.JointVelocity:
            return mode(0.5 * size * (s if size == 1 else np.sign(s)))
        if mode is lk.JointPosition:
            return mode(READY + 0.2 * np.sign(s))
        e, de = READY + 0.1 * size * s - state.q, 0.1 * size * w * c - state.dq
        M = own.mass_matrix(state.q).diagonal()
        return mode(M * (100.0 * e + 20.0 * de) + own.gravity(state.q))

    return swing


@each
@pytest.mark.parametrize("size", [1, 30], ids=["gentle", "saturated"])
@pytest.mark.parametrize("mode", [lk.JointPosition, lk.JointVelocity, lk.JointTorque])
@pytest.mark.parametrize("plant", PLANTS.values(), ids=PLANTS)
def test_closed_loops_are_those_of_the_equations(by_the_equations, engine, plant, mode, size):
    """To 1e-9 rad over 1 s, so on all engines, in all modes, and at the limits too."""

    def run(engine):
        with lk.Arm("left", plant, 3, q0=READY, world=lk.World(engine=engine)) as arm:
            return lk.run(arm, lk.Hold(READY, 1.0), swing(mode, size, arm.model), rate=1000)

    a, b = by_the_equations(run, engine)
    assert_allclose(a.q, b.q, rtol=0, atol=1e-9)
    assert_allclose(a.tau, b.tau, rtol=0, atol=1e-6)
    assert a.saturated.any() or size == 1
    assert np.ptp(a.q, axis=0).min() > 0.03


@each
def test_wall_band_push_and_payload_are_those_of_the_equations(by_the_equations, engine):
    """What touches the tip is the lab's own, so wall forces agree far within 2 %."""
    tip = lk.Model().pose(READY)[:3, 3]
    wall = lk.Wall(tip + (TIP_RADIUS + 0.01) * np.eye(3)[0], (-1.0, 0.0, 0.0), friction=0.3)
    band = lk.Spring(tip + 0.2 * np.eye(3)[0], 60.0, 2.0)
    push = lk.Push((5.0, 1.0, -2.0), start=0.5)
    plant = lk.Plant(gravity_compensation=True, armature=0.05, stiction=0.1, payload=0.5)

    def soft(state, target):
        return lk.JointTorque(40.0 * (READY - state.q) - 6.0 * state.dq)

    def run(engine):
        world = lk.World(things=[wall, band, push], engine=engine)
        with lk.Arm(plant=plant, q0=READY, world=world) as arm:
            return lk.run(arm, lk.Hold(READY, 2.0), soft, rate=1000)

    a, b = by_the_equations(run, engine)
    depth = TIP_RADIUS - (lk.Model().pose(a.q[-1])[:3, 3] - wall.point) @ wall.normal
    assert depth > 1e-4
    assert_allclose(a.q, b.q, rtol=0, atol=1e-9)
    assert_allclose(a.measured.tau_ext, b.measured.tau_ext, rtol=0, atol=1e-6)


def test_the_environment_or_the_world_chooses_the_engine(monkeypatch, capsys):
    """LABKIT_ENGINE sets it, engine= overrides it, and an unknown name is refused."""
    monkeypatch.setenv("LABKIT_ENGINE", "mujoco")
    assert lk.World().engine == "mujoco"
    lk.ready()
    assert ", mujoco " in capsys.readouterr().out
    monkeypatch.setenv("LABKIT_ENGINE", "bulet")
    with pytest.raises(UnknownName, match="no engine 'bulet'; there is 'pybullet', 'mujoco'"):
        lk.World()
    assert lk.World(engine="mujoco").engine == "mujoco"


def test_without_pybullet_mujoco_moves_the_arm(monkeypatch):
    """MuJoCo is then the default."""
    monkeypatch.delenv("LABKIT_ENGINE", raising=False)
    monkeypatch.setattr("labkit.sim.find_spec", lambda name: name == "mujoco" or None)
    with lk.World() as world:
        assert world.engine == "mujoco"
