"""Who computes the model: Pinocchio and MuJoCo agree, and both with the files of the robots."""

import numpy as np
import pinocchio as pin
import pytest
from arms import DATA, FILES, TIPS, arm
from numpy.testing import assert_allclose

import labkit as lk
from labkit.dynamics import BACKENDS
from solutions.study.gains import course_controllers
from solutions.study.tasks import line

ROBOTS = {
    "left": lambda: lk.robot("left"),
    "ur5": lambda: arm("ur5"),
    "panda": lambda: arm("panda"),
    "kinova": lambda: lk.Robot.from_urdf(  # six joints, of which three are continuous
        DATA / "kinova_description/robots/kinova.urdf", tip="j2s6s200_end_effector",
        ready=[0.0, 2.9, 1.3, 4.2, 1.4, 0.0],
    ),
}  # fmt: skip
OF_Q = (
    "pose", "tip_jacobian", "body_jacobian", "spatial_jacobian", "mass_matrix", "gravity",
    "potential_energy",
)  # fmt: skip
OF_MOTION = ("tip_jacobian_rate", "coriolis", "bias", "kinetic_energy")


def motions(robot, random, count):
    """Joint angles inside the limits, with speeds."""
    q = random.uniform(robot.lower, robot.upper, (count, robot.n))
    return list(zip(q, random.uniform(-robot.speed, robot.speed, q.shape), strict=True))


def by_both(monkeypatch, make):
    """What is made with each backend."""
    made = []
    for name in BACKENDS:
        monkeypatch.setenv("LABKIT_MODEL", name)
        made.append(make())
    return made


@pytest.mark.parametrize("name", ROBOTS)
def test_both_backends_answer_each_question_alike(name, random, monkeypatch):
    """To 1e-9 of its largest number, in 200 states, with rotors and a payload."""
    robot = ROBOTS[name]()
    plant = lk.Plant(armature=np.linspace(0.1, 0.05, robot.n), payload=0.7)
    one, other = by_both(monkeypatch, lambda: lk.Model(robot, plant))
    assert type(one.dynamics) is not type(other.dynamics)
    for q, dq in motions(robot, random, 200):
        x = random.normal(size=robot.n)
        calls = [(ask, (q,)) for ask in OF_Q] + [(ask, (q, dq)) for ask in OF_MOTION]
        for ask, args in [*calls, ("inverse_dynamics", (q, dq, x))]:
            a, b = (np.array(getattr(model, ask)(*args)) for model in (one, other))
            assert_allclose(a, b, rtol=0, atol=1e-9 * np.abs(a).max(), err_msg=ask)
        for a, b in zip(*(m.dynamics.free_motion(q, dq, x) for m in (one, other)), strict=True):
            assert_allclose(a, b, rtol=0, atol=1e-9 * np.abs(a).max())
        p, J = one.point_on(q, robot.n, np.zeros(3))
        assert_allclose(p, one.pose(q)[:3, 3], rtol=0, atol=1e-12)
        assert_allclose(J, one.tip_jacobian(q)[:3], rtol=0, atol=1e-12)


@pytest.mark.parametrize("plant", [lk.IDEAL, lk.BAXTER], ids=lambda plant: plant.name)
def test_closed_loops_are_those_of_the_other_backend(plant, monkeypatch):
    """All five controllers along a short line, to 1e-9 rad."""
    task = line((0.02, -0.03, 0.02))

    def runs():
        model = lk.Model("left", lk.Plant(armature=plant.armature))
        for candidate in course_controllers(model, plant).values():
            target = candidate.target(model, task.target, task.q0)
            with lk.Arm(plant=plant, seed=1, q0=task.start(1)) as arm:
                yield lk.run(arm, target, candidate.controller, candidate.rate, 0.5).q

    one, other = by_both(monkeypatch, lambda: list(runs()))
    for a, b in zip(one, other, strict=True):
        assert_allclose(a, b, rtol=0, atol=1e-9)


def test_an_unknown_backend_is_refused(monkeypatch):
    """The error lists the two."""
    monkeypatch.setenv("LABKIT_MODEL", "drake")
    with pytest.raises(lk.errors.UnknownName) as caught:
        lk.Model()
    assert caught.value.known == ("pinocchio", "mujoco")


@pytest.mark.parametrize("name", FILES)
def test_each_link_is_where_the_file_puts_it_and_weighs_what_it_says(name, random):
    """The lumped arm against the file as it is, its other joints at rest at zero."""
    robot = arm(name)
    model = lk.Model(robot)
    full = pin.buildModelFromUrdf(str(FILES[robot.name]))
    data, tip = full.createData(), full.getFrameId(TIPS[robot.name])
    at = [full.joints[full.getJointId(name)].idx_q for name in robot.joint_names]
    for q, dq in motions(robot, random, 20):
        x, v = np.zeros(full.nq), np.zeros(full.nv)
        x[at], v[at] = q, dq
        pin.framesForwardKinematics(full, data, x)
        assert_allclose(model.pose(q), data.oMf[tip].homogeneous, rtol=0, atol=1e-9)
        assert_allclose(
            model.bias(q, dq), pin.nonLinearEffects(full, data, x, v)[at], rtol=0, atol=1e-9
        )


@pytest.mark.parametrize(
    ("file", "base", "tip"),
    [
        ("tiago_description/robots/tiago.urdf", "torso_lift_link", "arm_tool_link"),
        ("pr2_description/urdf/pr2.urdf", "torso_lift_link", "r_gripper_tool_frame"),
        ("g1_description/urdf/g1_29dof_rev_1_0.urdf", "torso_link", "left_wrist_yaw_link"),
    ],
)
def test_an_arm_of_a_larger_robot_begins_at_its_base(file, base, tip):
    """Tiago's, PR2's and a humanoid's: seven joints, each where it is with the others at zero."""
    middle = [(m["lower"] + m["upper"]) / 2 for m in lk.Robot.from_urdf(
        DATA / file, base=base, tip=tip, ready=np.zeros(7), name="free").bodies]  # fmt: skip
    robot = lk.Robot.from_urdf(DATA / file, base=base, tip=tip, ready=middle, name="an arm")
    full = pin.buildModelFromUrdf(str(DATA / file))
    data, q = full.createData(), pin.neutral(full)
    for name, angle in zip(robot.joint_names, middle, strict=True):
        joint = full.joints[full.getJointId(name)]
        turned = (np.cos(angle), np.sin(angle)) if joint.nq == 2 else angle
        q[joint.idx_q : joint.idx_q + joint.nq] = turned
    pin.framesForwardKinematics(full, data, q)
    T_wt = data.oMf[full.getFrameId(tip)].homogeneous
    assert_allclose(lk.Model(robot).pose(middle), T_wt, rtol=0, atol=1e-9)
