"""Any robot: a UR5 of six joints and a Panda of seven do what Baxter's arms do."""

import pickle
import re
from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import pytest
from arms import FILES, READY, TIPS, arm
from curves import slope_along
from numpy.testing import assert_allclose, assert_array_equal

import labkit as lk
from labkit.errors import JointLimitExceeded, LabkitError, ShapeError, TypeMismatch, UnknownName
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


def test_baxters_plant_fits_another_arm_only_when_asked_to():
    """A Panda has seven joints too."""
    panda = arm("panda")
    for make in (lk.Arm, lk.Model):
        with pytest.raises(LabkitError, match="fits="):
            make(panda, lk.BAXTER)
    with lk.Arm(panda, replace(lk.BAXTER, fits=())) as asked:
        assert asked.plant.stiction == lk.BAXTER.stiction


def test_the_mass_matrix_is_symmetric_and_positive_definite(model, motions):
    """At twenty random angles the mass matrix is symmetric to the bit and positive definite."""
    for q, _ in motions:
        M = model.mass_matrix(q)
        assert M.shape == (model.robot.n, model.robot.n)
        assert (M == M.T).all()
        assert np.linalg.eigvalsh(M)[0] > 0.0


def test_mdot_minus_2c_is_skew(model, motions):
    """The slope of M along the motion less 2 C is antisymmetric to 1e-7."""
    for q, dq in motions:
        S = slope_along(model.mass_matrix, q, dq) - 2.0 * model.coriolis(q, dq)
        assert_allclose(S + S.T, np.zeros_like(S), rtol=0, atol=1e-7)


def test_gravity_is_the_slope_of_the_potential_energy(model, motions):
    """The potential energy rises at g(q) dq, to 1e-6 W."""
    for q, dq in motions:
        slope = slope_along(model.potential_energy, q, dq)
        assert slope == pytest.approx(model.gravity(q) @ dq, abs=1e-6)


def test_the_jacobian_is_the_slope_of_the_tip(model, motions):
    """The tip moves at the velocity that the first three rows of the Jacobian give."""
    for q, dq in motions:
        slope = slope_along(lambda q: model.pose(q)[:3, 3], q, dq)
        assert_allclose(model.tip_jacobian(q)[:3] @ dq, slope, rtol=0, atol=1e-7)


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


def test_a_push_finds_the_arm_by_the_name_of_its_robot(robot):
    """Of two arms in one world, only the arm that the push names feels its 20 N."""
    with lk.World(things=[lk.Push((0.0, 0.0, 20.0), side=robot.name)]) as world:
        one, other = lk.Arm(robot, world=world), lk.Arm("left", world=world)
        world.step(50)
        assert np.abs(one.truth().tau_ext).max() > 1.0
        assert np.abs(other.truth().tau_ext).max() < 1e-6


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
    assert log.tau[-1][0] == -2.0


def test_the_joints_of_a_gripper_stand_still(tmp_path):
    """A finger that slides and mimics beyond the tip adds no joint to the arm."""
    finger = """<link name="finger"/><joint name="close" type="prismatic"><parent link="hand"/>
        <child link="finger"/><mimic joint="turn"/></joint></robot>"""
    assert read(tmp_path, ONE.replace("</robot>", finger)).joint_names == ("turn", "bend")


BAD = {
    "no such tip": (
        (ONE, "claw"),
        "no link in one.urdf 'claw'; there is 'arm', 'base', 'hand', 'rod'",
    ),
    "the base as tip": ((ONE, "base"), "no joint that moves the link 'base'"),
    "one joint": ((ONE, "rod"), "one joint that moves the link 'rod', and an arm has"),
    "it slides": (
        (ONE.replace("revolute", "prismatic", 1),),
        "joint turn of one.urdf is prismatic",
    ),
    "it mimics": ((ONE.replace("<limit", '<mimic joint="x"/><limit'),), "mimics another joint"),
    "no inertia": (
        (re.sub("<inertial>.*?</inertial>", "", ONE, flags=re.S),),
        "turn of one.urdf moves .* 0 kg.*write one into a link that has none",
    ),
    "no such body": (
        (ONE.replace('ixx="0.01"', 'ixx="0.0113"'),),
        r"moments of inertia of 0\.001, 0\.01 and 0\.0113 kg m\^2; .* sum of the other two: ",
    ),
    "no axis": (
        (ONE.replace('xyz="0 1 0"', 'xyz="0 0 0"'),),
        "turn of one.urdf has the axis 0 0 0",
    ),
    "no links": (("<robot/>",), "no link in one.urdf 'hand'; there is none"),
    "xacro": (
        ('<robot xmlns:xacro="http://ros.org/wiki/xacro"><xacro:include filename="x"/></robot>',),
        "one.urdf is a xacro file; the command xacro makes a URDF",
    ),
    "no limits": ((re.sub("<limit[^>]*>", "", ONE),), "joint turn of one.urdf needs limits"),
    "no effort": ((ONE.replace('effort="20"', ""),), "0 N m; write"),
    "an empty range": ((ONE.replace('upper="2"', 'upper="-2"'),), "from -2 to -2 rad"),
    "a word": ((ONE.replace('"20"', '"much"'),), "is not a number.*much"),
    "a limit of NaN": ((ONE.replace('"20"', '"nan"'),), "needs limits"),
    "text": (("pendulum",), "one.urdf is not XML"),
    "another tree": (("<mujoco/>",), "holds a <mujoco>, expected the <robot>"),
    "a ring": ((ONE.replace('parent link="base"', 'parent link="hand"'),), "no chain of joints"),
    "Baxter's name": ((ONE.replace('"one"', '"left"'),), "give this robot another name="),
}


@pytest.mark.parametrize("case", BAD)
def test_what_an_arm_here_cannot_have_is_a_sentence(tmp_path, case):
    """Each URDF that cannot be an arm is refused in words that say what is wrong with it."""
    (args, words) = BAD[case]
    with pytest.raises(LabkitError, match=words):
        read(tmp_path, *args)


def test_bad_arguments_are_sentences(tmp_path):
    """The error for a wrong file, ready pose, arm or plant says what is expected."""
    with pytest.raises(LabkitError, match=r"no\.urdf cannot be read: No such file"):
        lk.Robot.from_urdf(tmp_path / "no.urdf", tip="hand", ready=[0.0])
    with pytest.raises(LabkitError, match=r"^<robot.{100,250}$"):
        lk.Robot.from_urdf(ONE.replace("\n", ""), tip="hand", ready=[0.0])
    with pytest.raises(TypeMismatch, match=r"file is None .*, expected the path of a URDF file"):
        lk.Robot.from_urdf(None, tip="hand", ready=[0.0])
    with pytest.raises(ShapeError, match=r"ready .*give 2 numbers, not 3"):
        read(tmp_path, ONE, ready=[0.0, 0.0, 0.0])
    with pytest.raises(JointLimitExceeded, match="ready: joint turn at 3"):
        read(tmp_path, ONE, ready=[3.0, 0.0])
    with pytest.raises(UnknownName, match="no arm 'ur5'; there is 'left', 'right'"):
        lk.Model("ur5")
    with pytest.raises(ShapeError, match=r"armature.*give 6 numbers, not 7"):
        lk.Arm(arm("ur5"), replace(lk.BAXTER, fits=()))
    assert len(READY["panda"]) == arm("panda").n
