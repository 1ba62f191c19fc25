"""Any robot: a UR5 of six joints and a Panda of seven do what Baxter's arms do."""

import pickle
import re
from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import pytest
from arms import FILES, TIPS, arm
from numpy.testing import assert_allclose, assert_array_equal

import labkit as lk
from labkit.errors import JointLimitExceeded, LabkitError, ShapeError, UnknownName
from labkit.robot import as_robot
from labkit.sim import ENGINES
from solutions.study.joint_impedance import JointImpedance
from solutions.study.joint_torque import ComputedTorque
from solutions.study.joint_velocity import JointVelocityPD
from solutions.study.workspace_impedance import WorkspaceImpedance
from solutions.study.workspace_velocity import WorkspaceVelocityPD


@pytest.fixture(scope="module", params=FILES)
def robot(request):
    """Each of the two."""
    return arm(request.param)


@pytest.fixture
def model(robot):
    """Its model."""
    return lk.Model(robot)


@pytest.fixture
def motions(robot, random):
    """Twenty joint angles inside the limits, with speeds."""
    q = random.uniform(robot.lower, robot.upper, (20, robot.n))
    return list(zip(q, random.uniform(-robot.speed, robot.speed, q.shape), strict=True))


def target(model, kind):
    """A line or a circle of the tip, from where exercises start."""
    T_wt = model.pose(model.robot.ready)
    p, R_wt = T_wt[:3, 3], T_wt[:3, :3]
    path = {
        "line": lk.Line(p, p + [0.05, 0.1, 0.1]),
        "circle": lk.Circle(p, p + [0.0, 0.06, 0.0]),
    }[kind]
    return lk.Trajectory(lk.PosePath(path, R_wt), lk.Quintic(1.5))


def laws(model):
    """The five controllers of the course: each with how often it is asked, and for joint angles."""
    m = model.mass_matrix(model.robot.ready).diagonal()
    return {
        "workspace velocity": (WorkspaceVelocityPD(model, Kp=10.0), 200.0, False),
        "joint velocity": (JointVelocityPD(Kp=10.0), 200.0, True),
        "joint torque": (ComputedTorque(model), 1000.0, True),
        "workspace impedance": (WorkspaceImpedance(model, K=300.0), 1000.0, False),
        "joint impedance": (JointImpedance(model, 100.0 * m, 20.0 * m), 1000.0, True),
    }


LAWS = tuple(laws(lk.Model()))


def test_without_a_tip_the_error_lists_the_links_and_a_wrong_base_is_a_sentence():
    """Also a base that is not behind the tip."""
    with pytest.raises(UnknownName) as caught:
        lk.Robot.from_urdf(FILES["panda"])
    assert {"panda_link0", "panda_hand_tcp"} <= set(caught.value.known)
    with pytest.raises(UnknownName):
        lk.Robot.from_urdf(FILES["panda"], tip=TIPS["panda"], base="torso")
    with pytest.raises(LabkitError, match="panda_rightfinger"):
        lk.Robot.from_urdf(FILES["panda"], tip=TIPS["panda"], base="panda_rightfinger")


@pytest.mark.parametrize("engine", [*filter(find_spec, ENGINES)])
@pytest.mark.parametrize("kind", ["line", "circle"])
@pytest.mark.parametrize("law", LAWS)
def test_all_five_controllers_follow_line_and_circle(robot, model, engine, kind, law):
    """On each engine each controller keeps the tip within 1 mm and 0.1 degrees of its target."""
    controller, rate, joints = laws(model)[law]
    way = target(model, kind)
    if joints:
        way = model.joint_trajectory(way, robot.ready)
    with lk.Arm(robot, q0=robot.ready, world=lk.World(engine=engine)) as arm:
        log = lk.run(arm, way, controller, rate)
    assert lk.metrics.summary(log).max_mm < 1.0
    assert lk.metrics.summary(log).max_deg < 0.1


@pytest.mark.pybullet
def test_friction_limits_and_rotors_are_as_many_as_the_joints(robot):
    """The same torque on both engines moves the arm alike, cut, stuck and geared."""
    n = robot.n
    plant = lk.Plant(
        armature=np.linspace(0.1, 0.05, n), stiction=np.linspace(2.0, 0.5, n), viscous=0.5,
        gravity_compensation=True,
    )  # fmt: skip
    ends = []
    for engine in ENGINES:
        with lk.Arm(robot, plant, q0=robot.ready, world=lk.World(engine=engine)) as arm:
            arm.apply(lk.JointTorque(np.where(np.arange(n) % 2, 0.3, 3.0)))
            arm.world.step(200)
            ends.append(arm.truth().q)
    assert_allclose(ends[0], ends[1], rtol=0, atol=1e-9)
    moved = np.abs(ends[0] - robot.ready) > 1e-6
    assert moved[::2].any()
    assert not moved[1::2].all()


def test_a_log_of_any_robot_is_saved_and_loaded(robot, model, tmp_path):
    """Its robot, plant, controller, columns and summary come back from the file as they were."""
    with lk.Arm(robot, q0=robot.ready) as arm:
        log = lk.run(arm, lk.Hold(robot.ready, 0.1), JointVelocityPD(5.0))
    log.save(tmp_path / "run.npz")
    back = lk.Log.load(tmp_path / "run.npz")
    assert (back.robot.name, back.plant, back.controller) == (robot.name, log.plant, log.controller)
    for name in ("t", "q", "dq", "tau", "command", "saturated"):
        assert_array_equal(getattr(back, name), getattr(log, name))
    assert lk.metrics.summary(back) == lk.metrics.summary(log)


def test_a_robot_is_a_value_that_travels(robot):
    """It comes back equal from pickle and from its own data, and is not copied when it is given."""
    back = pickle.loads(pickle.dumps(robot))
    assert back.data() == robot.data() == lk.Robot(**robot.data()).data()
    assert as_robot(robot) is robot


def test_a_replay_carries_the_joints_of_an_arm_without_meshes(robot, model):
    """The viewer gets what it needs to draw capsules, and puts the tip where the model has it."""
    q = np.array([robot.ready, robot.ready + 0.1])
    motion = lk.replay.Motion(robot, np.array([0.0, 1.0]), q)
    drawn = motion.data()["robot"]
    assert drawn["arm"] == list(robot.joint_names)
    assert list(drawn["tips"]) == [robot.name]
    assert f"The arm {robot.name} moves" in motion.alt
    assert "robot" not in lk.replay.Motion("left", np.array([0.0, 1.0]), np.zeros((2, 7))).data()


LINK = """<link name="{0}"><inertial><mass value="1"/><origin xyz="0 0 0.2"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
ONE = f"""<robot name="one"><link name="base"/>{LINK.format("rod")}{LINK.format("arm")}
  <link name="hand"/>
  <joint name="turn" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="3" effort="20"/></joint>
  <joint name="bend" type="revolute"><parent link="rod"/><child link="arm"/><axis xyz="0 -1 0"/>
    <origin xyz="0 0 0.4"/><limit lower="-1" upper="1" velocity="4" effort="10"/></joint>
  <joint name="grip" type="fixed"><parent link="arm"/><child link="hand"/>
    <origin xyz="0 0 0.4"/></joint>
</robot>"""


def read(tmp_path, text, tip="hand", ready=(0.5, 0.0)):
    path = tmp_path / "one.urdf"
    path.write_text(text)
    return lk.Robot.from_urdf(path, tip=tip, ready=ready)


def test_a_double_pendulum_is_a_robot_too(tmp_path):
    """Its axes are y and -y, and its tip goes where they turn it: forwards, and back."""
    robot = read(tmp_path, ONE)
    model, q = lk.Model(robot), np.array([0.5, 0.2])
    at = 0.4 * np.array([np.sin(0.5) + np.sin(0.3), 0.0, np.cos(0.5) + np.cos(0.3)])
    assert_allclose(model.pose(q)[:3, 3], at, rtol=0, atol=1e-12)
    weight = -9.81 * 0.2 * np.array([3.0 * np.sin(0.5) + np.sin(0.3), -np.sin(0.3)])
    assert_allclose(model.gravity(q), weight, rtol=0, atol=1e-12)
    assert robot.effort.tolist() == [20.0, 10.0]
    with pytest.raises(LabkitError, match="2 joints of one cannot put the tip at any pose"):
        model.inverse_kinematics(model.pose(q), q)


def test_a_continuous_joint_turns_once_either_way(tmp_path):
    """Its limits are -2 pi and 2 pi rad, whether the file writes limits of angle or not."""
    text = ONE.replace('"turn" type="revolute"', '"turn" type="continuous"')
    assert_allclose(read(tmp_path, text).upper, [2.0 * np.pi, 1.0])
    unlimited = text.replace('lower="-2" upper="2" ', "")
    assert_allclose(read(tmp_path, unlimited).lower, [-2.0 * np.pi, -1.0])


@pytest.mark.filterwarnings("error")
def test_an_arm_too_weak_for_its_weight_sinks(tmp_path):
    """It asks its motors for all that they have, and no square root of a negative number."""
    robot = read(tmp_path, ONE.replace('effort="20"', 'effort="2"'))
    with lk.Arm(robot, q0=robot.ready) as arm:
        log = lk.run(arm, lk.Hold(robot.ready, 0.2), lk.control.hold(robot.ready))
    assert log.q[-1][0] > 0.55
    assert log.tau[-1][0] == pytest.approx(-2.0)


def test_the_joints_of_a_gripper_stand_still(tmp_path):
    """A finger that slides and mimics beyond the tip adds no joint to the arm."""
    finger = """<link name="finger"/><joint name="close" type="prismatic"><parent link="hand"/>
        <child link="finger"/><mimic joint="turn"/></joint></robot>"""
    assert read(tmp_path, ONE.replace("</robot>", finger)).joint_names == ("turn", "bend")


BAD = (
    "pendulum", "<robot/>", ONE.replace("revolute", "prismatic", 1),
    re.sub("<inertial>.*?</inertial>", "", ONE, flags=re.S),
    ONE.replace('ixx="0.01"', 'ixx="0.0113"'), ONE.replace('xyz="0 1 0"', 'xyz="0 0 0"'),
    re.sub("<limit[^>]*>", "", ONE), ONE.replace('effort="20"', ""),
    ONE.replace('upper="2"', 'upper="-2"'), ONE.replace('"20"', '"much"'),
    ONE.replace('"20"', '"nan"'), ONE.replace('parent link="base"', 'parent link="hand"'),
    ONE.replace('"one"', '"left"'),
)  # fmt: skip


@pytest.mark.parametrize("text", BAD)
def test_what_an_arm_here_cannot_have_is_refused(tmp_path, text):
    """Each URDF that cannot be an arm is a LabkitError."""
    with pytest.raises(LabkitError):
        read(tmp_path, text)


def test_bad_arguments_are_refused(tmp_path):
    """A wrong tip, file, ready pose or plant."""
    for tip in ("claw", "base", "rod"):
        with pytest.raises(LabkitError):
            read(tmp_path, ONE, tip)
    with pytest.raises(LabkitError):
        lk.Robot.from_urdf(tmp_path / "no.urdf", tip="hand", ready=[0.0])
    with pytest.raises(ShapeError):
        read(tmp_path, ONE, ready=[0.0, 0.0, 0.0])
    with pytest.raises(JointLimitExceeded):
        read(tmp_path, ONE, ready=[3.0, 0.0])
    with pytest.raises(LabkitError):  # a Panda has seven joints too, but is no Baxter
        lk.Model(arm("panda"), lk.BAXTER)
    with pytest.raises(ShapeError):
        lk.Arm(arm("ur5"), replace(lk.BAXTER, fits=()))
