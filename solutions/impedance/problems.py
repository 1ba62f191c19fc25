"""The questions of notebook 05."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import labkit as lk
from labkit.course import PUBLIC_ARMS, AtTip, Call, Close, Loop, TipTorque
from labkit.course.authoring.problem import Problem, Trial, Wrong, call

from . import answers, hidden, mistakes, variants

PLANT = lk.Plant(name="textbook", armature=0.05, viscous=0.7)
MODEL = lk.Model("left", PLANT)
READY = MODEL.robot.ready
BENT = READY + [0.1, 0.2, -0.1, -0.3, 0.2, 0.1, 0.3]
T_WT = MODEL.pose(BENT)
K = np.array([200.0, 300.0, 450.0, 15.0, 20.0, 30.0])
EVEN = np.array([300.0, 300.0, 300.0, 20.0, 20.0, 20.0])
D = np.array([35.0, 35.0, 70.0, 4.0, 4.0, 2.0])
SPEED = np.array([0.8, -0.5, 0.4, 1.0, -1.2, 0.9, 1.5])
TWIST = np.array([0.2, -0.1, 0.3, 0.4, -0.2, 0.5])
DTWIST = np.array([1.0, -2.0, 1.5, 2.0, 1.0, -1.0])
PUSH = np.array([8.0, -5.0, 10.0, 0.5, 0.4, -0.3])
FELT = MODEL.tip_jacobian(BENT).T @ PUSH
SIX = np.delete(np.arange(7), 2)


def _target(shift: object, turn: object, moving: float) -> lk.PoseSample:
    R = lk.se3.rotation(turn) @ T_WT[:3, :3]
    return lk.PoseSample(
        lk.se3.pose(R, T_WT[:3, 3] + np.array(shift)), moving * TWIST, moving * DTWIST
    )


def _law(shift: object, turn: object, *, speed: float = 0.0, moving: float = 0.0) -> Call:
    state = lk.State(0.7, BENT, speed * SPEED, FELT)
    return call(state, _target(shift, turn, moving), MODEL, stiffness=K, damping=D)


def _shaped(inertia: object, wrench: object, *, moving: float = 0.0) -> Call:
    state = lk.State(0.7, BENT, moving * SPEED)
    target = _target([0.03, -0.02, 0.04], [0.1, -0.2, 0.1], moving)
    return call(state, target, wrench, MODEL, inertia=inertia, stiffness=K, damping=D)


def _at_tip(answer: Callable[..., lk.JointTorque]) -> Callable[..., TipTorque]:
    """The torque that an answer returns, and the effect of a torque on the tip there."""

    def expected(state: lk.State, *args: Any, **gains: Any) -> TipTorque:
        model: lk.Model = args[-1]
        M, J = model.mass_matrix(state.q), model.tip_jacobian(state.q)
        accelerates = np.asarray(np.linalg.solve(M, J.T).T, dtype=np.float64)
        elbow = np.linalg.svd(J)[2][-1]
        return TipTorque(answer(state, *args, **gains).value, accelerates, elbow)

    return expected


NOWHERE = [0.0, 0.0, 0.0]
ASIDE = [0.03, -0.02, 0.04]
LAMBDA = MODEL.operational_inertia(BENT)
M_D = np.diag([5.0, 5.0, 5.0, 0.3, 0.3, 0.3])


OPERATIONAL_INERTIA = Problem(
    name="operational_inertia",
    points=4,
    outcomes=(
        "contact",
        "model",
    ),
    asks="Give the inertia Λ that a hand feels at the tip of an arm with the mass matrix `M`, "
    "shape (n, n), and the Jacobian `J`, shape (6, n) or (3, n). It is the matrix with F = Λ · "
    "(acceleration of the tip) when the arm is at rest and its motors are off.",
    answer=answers.operational_inertia,
    judge=Close(rtol=1e-5, atol=1e-9),
    trials=(
        Trial(
            "six joints (the third is locked)",
            (call(MODEL.mass_matrix(BENT)[np.ix_(SIX, SIX)], MODEL.tip_jacobian(BENT)[:, SIX]),),
            hidden.six_joints,
            "other poses",
            weight=0.0,
        ),
        Trial(
            "all seven joints",
            (
                call(MODEL.mass_matrix(BENT), MODEL.tip_jacobian(BENT)),
                call(MODEL.mass_matrix(READY), MODEL.tip_jacobian(READY)),
            ),
            hidden.seven_joints,
            "both arms",
            weight=3.0,
        ),
        Trial(
            "the position of the tip alone",
            (call(MODEL.mass_matrix(BENT), MODEL.tip_jacobian(BENT)[:3]),),
            hidden.positions_only,
        ),
    ),
    withheld=("labkit.Model.operational_inertia",),
    hints=(
        "Follow a push through the arm. A wrench F at the tip gives the joint torques Jᵀ F. What "
        "joint acceleration do these torques cause, and what acceleration of the tip does that "
        "give?",
        "q̈ = M⁻¹ Jᵀ F, and the tip's acceleration is J q̈ (at rest). So acceleration = (J M⁻¹ "
        "Jᵀ) F. The question asks for the force, given the acceleration.",
        "Follow a force through three steps: to torques, to joint accelerations, to the tip's "
        "acceleration. The matrix of these steps gives the acceleration that a force causes. The "
        "question asks for the force that an acceleration takes.",
    ),
    wrong=(
        Wrong(
            "J M Jᵀ",
            "J M Jᵀ has the right shape but the wrong unit: with J in m/rad it grows with the "
            "length of the lever, while the mass felt at the end of a longer lever gets smaller.",
            mistakes.j_m_jt,
            "Follow a push through the arm instead of guessing a product that fits.",
            cure="Begin with the inverse of M.",
        ),
        Wrong(
            "pseudo-inverses of J on both sides",
            "With six joints this is right. With seven it keeps the elbow out of the motion, and "
            "the arm seems heavier than it is.",
            mistakes.pseudo_inverses,
            "pinv(J) chooses the smallest joint speeds; the arm itself chooses those with the "
            "least energy.",
            cure="Follow the push instead: Jᵀ F, then M⁻¹, then J.",
        ),
        Wrong(
            "the last inverse left out",
            "Your matrix says how easily the tip moves. The question asks how heavy it feels.",
            mistakes.mobility,
            cure="Invert it.",
        ),
        Wrong(
            "1 / M, number by number",
            "1 / M takes the reciprocal of each number: that is not the inverse of a matrix.",
            mistakes.inverse_by_element,
            cure="np.linalg.inv, or better a solve.",
        ),
        Wrong(
            "only the diagonal of M",
            "You use the diagonal of M alone, but the joints accelerate each other.",
            mistakes.diagonal_only,
        ),
        Wrong(
            "the inverse of J M Jᵀ",
            "You inverted the whole product, in which M is not inverted: the unit is not kg.",
            mistakes.inverse_of_the_wrong,
            "Check the unit: the result must be in kg.",
            cure="Follow the push: Jᵀ F, then M⁻¹, then J.",
        ),
        Wrong(
            "1 over each number",
            "1 / A takes the reciprocal of each number: that is not the inverse of a matrix.",
            mistakes.numbers_turned_over,
            cure="np.linalg.inv.",
        ),
        Wrong(
            "the mass matrix left out",
            "The inverse of J Jᵀ knows nothing of masses.",
            mistakes.MassesOf(lambda M, J: np.linalg.inv(J @ J.T)),
            "Say what each factor does to a wrench.",
            cure="Put M⁻¹ between J and Jᵀ, then invert.",
        ),
    ),
    variants=(variants.inertia_by_inverse, variants.inertia_by_root),
)

WORKSPACE_IMPEDANCE = Problem(
    name="workspace_impedance",
    points=6,
    outcomes=("contact",),
    asks="Give the `lk.JointTorque` that makes the tip respond to a push as if it were tied to "
    "its target by springs `stiffness` and dampers `damping`, one for each of x, y, z and the "
    "three rotations, in world axes. The tip keeps its own inertia Λ. The arm does not carry its "
    "own weight: add g(q). Torque that has no effect at the tip does not count; choose that part "
    "as you like.",
    answer=answers.workspace_impedance,
    expected=_at_tip(answers.workspace_impedance),
    judge=AtTip(),
    trials=(
        Trial(
            "at rest, off in position",
            (_law(ASIDE, NOWHERE),),
            hidden.off_in_position,
            "both arms, any pose",
            weight=0.0,
        ),
        Trial(
            "turned off its target, about each axis",
            tuple(_law(NOWHERE, turn) for turn in (0.2 * np.eye(3)).tolist()),
            hidden.off_in_orientation,
            weight=0.5,
        ),
        Trial(
            "a moving arm",
            (_law(NOWHERE, NOWHERE, speed=1.0),),
            hidden.moving_tip,
        ),
        Trial(
            "a target that moves off and speeds up",
            (_law(NOWHERE, NOWHERE, moving=1.0),),
            hidden.leading_target,
        ),
        Trial(
            "everything at once",
            (_law(ASIDE, [0.1, -0.2, 0.1], speed=1.0, moving=1.0),),
            hidden.everything_at_the_tip,
            "everything at once",
            weight=2.5,
        ),
        Trial(
            "a run: from an offset, then pushed",
            (
                Loop(
                    lk.Hold(MODEL.pose(READY), 2.0),
                    {"model": MODEL, "stiffness": EVEN, "damping": D},
                    plant=PLANT,
                    things=(lk.Push((0.0, 9.0, 0.0), start=0.5),),
                    q0=READY + 0.05,
                    settle=1.2,
                    expected={"max_mm": 40.0, "max_deg": 5.0},
                ),
            ),
            hidden.pushed_arms,
            "pushes in any direction",
        ),
    ),
    hints=(
        "Say what force the tip should feel (spring, damper, and what the target's motion takes), "
        "then turn that force into joint torques with Jᵀ. Weight and Coriolis torques are added "
        "at the joints.",
        "e = lk.se3.pose_error(target.pose, model.pose(q)), ė = target.twist - J q̇. The motion "
        "takes Λ times the acceleration that the joints must provide: target.dtwist minus J̇ "
        "q̇, because J̇ q̇ is there without any joint acceleration.",
        "First find the force at the tip: that of the springs and dampers, plus Λ times the "
        "acceleration that the motors must provide, which is the target's minus the part that "
        "comes by itself. Then map this force to the joints, and add the torques that the arm "
        "itself needs.",
    ),
    wrong=(
        Wrong(
            "the spring's sign reversed",
            "The spring drives the tip away from its target: after any disturbance the arm leaves "
            "its workspace.",
            mistakes.plus_in_front,
            "One convention: e = target - actual, and a plus before every gain.",
            cure="With e as target minus actual, the stiffness has a plus.",
        ),
        Wrong(
            "the springs multiplied by Λ",
            "The springs are multiplied by the inertia, so that a stiffness in N/m has no meaning: this is "
            "computed torque at the tip.",
            mistakes.springs_inside,
            cure="Keep springs and dampers outside Λ.",
        ),
        Wrong(
            "a pseudo-inverse for Jᵀ",
            "The pseudo-inverse is for speeds, and you map a force with it.",
            mistakes.inverse_for_transpose,
            cure="A force F at the tip takes the joint torques Jᵀ F.",
        ),
    ),
    terms=mistakes.tip_terms,
    variants=(
        variants.impedance_by_terms,
        variants.impedance_by_parts,
        variants.impedance_by_khatib,
        variants.impedance_by_pseudo_inverse,
        variants.impedance_with_braked_elbow,
    ),
)

TIP_SPRING = Problem(
    name="tip_spring",
    points=2,
    outcomes=("contact",),
    asks="Mend `equation_21`. Change what is wrong, nothing else.",
    answer=answers.tip_spring,
    judge=Close(rtol=1e-6, atol=1e-6),
    trials=(
        Trial(
            "at rest, beside its target",
            (_law(ASIDE, NOWHERE), _law(NOWHERE, [0.1, -0.2, 0.1])),
            hidden.springs,
            "other poses",
            0.0,
        ),
        Trial(
            "while the arm moves",
            (_law(ASIDE, [0.1, -0.2, 0.1], speed=1.0),),
            hidden.moving_springs,
            "other motions",
        ),
        Trial(
            "a run, let go beside the target",
            (hidden.held("left", np.full(7, 0.04)),),
            hidden.let_go,
            "other starts, both arms",
        ),
    ),
    hints=(
        "Put the tip 1 cm to the left of its target. In which direction does each term push?",
        "One convention: e = target - actual. Which of the terms contradicts it?",
        "A spring pulls towards its end. The damper's sign is right.",
    ),
    terms=mistakes.spring_terms,
    wrong=(
        Wrong(
            "as printed",
            "The spring still drives the tip away from its target. (The team's program had the "
            "other sign than its report.)",
            mistakes.as_printed,
            cure="With e as target minus actual, the stiffness has a plus.",
        ),
    ),
    variants=(variants.spring_by_parts,),
)

JOINT_IMPEDANCE = Problem(
    name="joint_impedance",
    points=4,
    outcomes=("contact", "model"),
    asks="Give the stiffness of the joints, `K_q` of shape (7, 7), with which the torques K_q (q_d - q) "
    "feel at the tip like springs `stiffness`, shape (6,), near the pose of `J`. The one motion of the "
    "joints that the tip does not feel has a spring of its own, `elbow` in N m/rad.",
    answer=answers.joint_impedance,
    judge=Close(rtol=1e-6, atol=1e-7),
    trials=(
        Trial(
            "the ready pose",
            (call(MODEL.tip_jacobian(READY), EVEN, 10.0),),
            hidden.joint_springs,
            "other poses",
            0.0,
        ),
        Trial(
            "six different springs in a bent pose",
            (call(MODEL.tip_jacobian(BENT), K, 4.0),),
            hidden.joint_springs,
            "other poses and springs, both arms",
        ),
    ),
    hints=(
        "Turn the joints by a little: how far does the tip go, which force do its springs give, which "
        "torques balance it?",
        "e = J (q_d - q) for small angles, F = K e, and a force at the tip takes the torques of the "
        "transposed Jacobian. What is left is the direction n with J n = 0.",
        "np.linalg.svd(J)[2][-1] is that direction, with length 1. A spring along it alone is the outer "
        "product of n with itself, times its stiffness.",
    ),
    wrong=(
        Wrong(
            "no spring for the elbow",
            "Nothing holds the elbow: your matrix has a direction without stiffness.",
            mistakes.JointSprings(lambda J, K, k, n: J.T @ K @ J),
            "Seven joints, six springs: count rows.",
            "Add a spring along the direction that the tip does not feel.",
        ),
        Wrong(
            "a spring in every joint",
            "Your elbow's spring acts in all joints, so the tip feels it, too.",
            mistakes.JointSprings(lambda J, K, k, n: J.T @ K @ J + k * np.eye(7)),
            cure="Let it act along n alone: the outer product of n with itself.",
        ),
        Wrong(
            "a pseudo-inverse for the transpose",
            "Pseudo-inverses map speeds; you map a force to torques with one.",
            mistakes.JointSprings(
                lambda J, K, k, n: np.linalg.pinv(J) @ K @ np.linalg.pinv(J).T + k * n
            ),
            cure="From turn to torque: J, then K, then the transposed J.",
        ),
        Wrong(
            "compliance",
            "You used 1/K, the compliance: a stiffer tip makes your joints softer.",
            mistakes.JointSprings(lambda J, K, k, n: J.T @ np.linalg.inv(K) @ J + k * n),
            "Springs in a row add compliances, side by side stiffnesses.",
        ),
        Wrong(
            "only the diagonal",
            "You kept the diagonal. The joints' springs are coupled: one joint's turn needs torques in "
            "the others.",
            mistakes.JointSprings(lambda J, K, k, n: np.diag(np.diag(J.T @ K @ J + k * n))),
            "Springs in single joints give a slanted ellipse at the tip.",
        ),
        Wrong(
            "the elbow's spring of 1 N m/rad",
            "The elbow is held, but not with `elbow`.",
            mistakes.JointSprings(lambda J, K, k, n: J.T @ K @ J + n),
            "An argument that is not used is a warning.",
        ),
    ),
    variants=(variants.joint_springs_by_projector,),
)

WEIGH = Problem(
    name="weigh",
    points=3,
    outcomes=("experiment",),
    asks="Find out what is in the gripper of `arm`, in kg, by an experiment of at most 8 s in torque "
    "mode. Your function gets an arm at rest in its ready pose; it moves it with `lk.run(arm, ...)` and reads "
    "the logs. `arm.model` knows nothing of the load. It must be right to 70 g on arms that "
    "you have not seen.",
    answer=answers.weigh,
    expected=lambda arm: arm.payload,
    judge=Close(rtol=0.0, atol=0.07),
    trials=(
        Trial(
            "a public arm, to 70 g", (call(PUBLIC_ARMS[0]),), hidden.other_arms, "other arms", 0.0
        ),
        Trial("another one", (call(PUBLIC_ARMS[1]),), hidden.other_arms, "two other arms"),
    ),
    hints=(
        "At rest the torque that you must command is that of the load plus dry friction. Which of the "
        "two changes its sign when you come from the other side?",
        "Let s1 and e1 swing slowly with `lk.control.springs`, in opposite directions and by at most "
        "0.12 rad, or the tip meets a wall. Average the command over whole swings.",
        "Compare the averages of s1 and e1 with the torques that one kilogram takes, by least squares, "
        "with the Jacobian at the mean of `log.q`.",
    ),
    wrong=(
        Wrong(
            "newtons",
            "This is the load's weight, in N.",
            lambda arm: 9.81 * answers.weigh(arm),
        ),
        Wrong(
            "one pose at rest",
            "Dry friction is in your number: at rest it carries a part of the load, and it opposes "
            "every motion.",
            mistakes.at_rest,
            "Friction always opposes: come from both sides.",
            "Come to the pose from both sides, or swing, so that friction cancels.",
        ),
    ),
    variants=(variants.weigh_from_both_sides,),
)

SHAPED_IMPEDANCE = Problem(
    name="shaped_impedance",
    points=4,
    core=False,
    outcomes=("contact",),
    asks="As `workspace_impedance`, but the tip should feel as heavy as `inertia`, M_d of shape "
    "(6, 6). For this the law receives the measured `wrench` of the hand on the arm, shape (6,), "
    "in world axes.",
    answer=answers.shaped_impedance,
    expected=_at_tip(answers.shaped_impedance),
    judge=AtTip(),
    trials=(
        Trial(
            "nobody pushes",
            (_shaped(M_D, np.zeros(6)),),
            hidden.untouched,
            "other inertias",
            weight=0.0,
        ),
        Trial(
            "M_d = Λ: the measured wrench must not matter",
            (_shaped(LAMBDA, PUSH),),
            hidden.as_heavy_as_it_is,
            weight=0.5,
        ),
        Trial(
            "M_d = 2 Λ: now it must",
            (_shaped(2.0 * LAMBDA, PUSH),),
            hidden.twice_as_heavy,
            "lighter than it is",
        ),
        Trial(
            "everything at once",
            (_shaped(M_D, PUSH, moving=1.0),),
            hidden.everything_shaped,
            weight=2.5,
        ),
    ),
    hints=(
        "First find an acceleration: the one that a body M_d would have under spring, damper and "
        "hand. Then find the force of the motors that makes the real tip, with its own Λ, move "
        "like that.",
        "M_d (a - dV_d) = D ė + K e + F. And Λ (a - J̇ q̇) = F_motors + F, because the hand "
        "provides a part of the force.",
        "Solve the desired behaviour for the tip's acceleration; the hand's wrench appears in it. "
        "Then find the force that gives the real Λ this acceleration, and subtract the part that "
        "the hand provides itself.",
    ),
    wrong=(
        Wrong(
            "the inertia ignored",
            "This is the law with the arm's own inertia: M_d and the wrench do not matter in it.",
            mistakes.own_inertia,
            "With M_d = Λ the two laws agree.",
            cure="Divide springs, dampers and wrench by M_d, multiply by Λ, and subtract the wrench.",
        ),
        Wrong(
            "the hand's share left in",
            "Your motors provide all the force that the motion takes, and the hand pushes as well.",
            mistakes.hand_works_twice,
            "Λ a = F_motors + F_hand.",
            cure="Subtract the hand's wrench.",
        ),
        Wrong(
            "the wrench inside reversed",
            "Your tip accelerates against the push.",
            mistakes.ShapedLaw(inside=-1.0),
            "Follow one push through the law, sign by sign.",
            cure="The wrench has a plus in M_d⁻¹ (D ė + K e + F).",
        ),
        Wrong(
            "the hand's share added",
            "The hand provides a part of the force, but your motors provide more for it, not less.",
            mistakes.ShapedLaw(outside=-1.0),
            cure="Subtract the wrench.",
        ),
        Wrong(
            "the wrench subtracted, and no more",
            "In your law the wrench does not accelerate the tip.",
            mistakes.ShapedLaw(inside=0.0),
            cure="Add M_d⁻¹ F to the acceleration.",
        ),
        Wrong(
            "M_d where Λ belongs",
            "The motors have to move the arm's own inertia; M_d only determines how large the "
            "acceleration should be.",
            mistakes.ShapedLaw(for_own=True),
            "First find the desired acceleration, then the force that it takes.",
            cure="Multiply the acceleration by Λ.",
        ),
        Wrong(
            "J̇ q̇ left out",
            "The tip accelerates even if the joints turn at constant speed; your law does not know it.",
            mistakes.ShapedLaw(drift=0.0),
            cure="Subtract J̇ q̇ before you multiply by Λ.",
        ),
    ),
    variants=(variants.shaped_by_factor, variants.shaped_by_pseudo_inverse),
)


PROBLEMS = (
    OPERATIONAL_INERTIA,
    TIP_SPRING,
    WORKSPACE_IMPEDANCE,
    JOINT_IMPEDANCE,
    WEIGH,
    SHAPED_IMPEDANCE,
)
