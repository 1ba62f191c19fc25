"""The questions of notebook 05."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import labkit as lk
from labkit.course import AtTip, Call, Close, Loop, TipTorque
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

MSD = Problem(
    name="msd",
    points=2,
    outcomes=("contact",),
    asks="Give the acceleration of a mass `m` that is tied to its target by a spring `k` and a damper "
    "`b`, while somebody pushes it with `force`.",
    answer=answers.msd,
    judge=Close(rtol=1e-6, atol=1e-9),
    trials=(
        Trial(
            "at rest on its target, pushed",
            (call((0.0, 0.0), (0.0, 0.0, 0.0), 6.0, m=2.0, b=8.0, k=100.0),),
            hidden.pushed,
            weight=0.0,
        ),
        Trial(
            "let go beside its target",
            (call((0.05, 0.0), (0.0, 0.0, 0.0), 0.0, m=2.0, b=8.0, k=100.0),),
            hidden.let_go,
            "other masses and springs",
        ),
        Trial(
            "pushed while it follows a moving target",
            (call((0.05, 0.1), (0.03, 0.3, 0.5), 6.0, m=2.0, b=8.0, k=100.0),),
            hidden.everything_of_one_mass,
            "targets that move and speed up",
            weight=2.0,
        ),
    ),
    hints=(
        "Three forces act on the mass: those of the hand, the spring and the damper. Draw them "
        "for a mass to the right of its target.",
        "With e = x_d - x the spring pulls with k e and the damper with b ė. If nobody pushes and the "
        "error is zero, the mass must move just as its target does.",
        "Write Newton's law for the error, not for the mass: with nobody pushing, the error "
        "obeys the damped spring. Then solve for ddx, and check the sign of the hand's force "
        "with a target at rest.",
    ),
    wrong=(
        Wrong(
            "a spring that pushes away",
            "The spring drives the mass away from its target. It should pull back: k (x_d - x).",
            mistakes.spring_pushes_away,
            "The report's equation 21 has this sign.",
        ),
        Wrong(
            "the force counted twice",
            "The push is counted twice: once divided by m, and once as if it were an "
            "acceleration, as in the report's equation 19. Keep the first.",
            mistakes.force_twice,
            "Check units term by term.",
        ),
        Wrong(
            "the force of the mass on the hand",
            "`force` is what the hand does to the mass: a push to the right accelerates it to the "
            "right.",
            mistakes.hand_pushed_back,
            "Always say whose force it is, and on what it acts.",
        ),
        Wrong(
            "a damper tied to the room",
            "The damper brakes all motion, so the mass drags behind a moving target. Tie it to the "
            "target: b (dx_d - dx).",
            mistakes.damps_all_motion,
            "What are the two ends of the damper tied to?",
        ),
        Wrong(
            "the target's acceleration left out",
            "Without an error and without a push the mass must move as its target does. Add the "
            "target's acceleration.",
            mistakes.forgets_the_targets_acceleration,
            "Feed-forward.",
        ),
        Wrong(
            "a force, not an acceleration",
            "This is the sum of the forces. Divide it by the mass to get an acceleration.",
            mistakes.force_not_acceleration,
            "Newton's law: force = mass times acceleration.",
        ),
        Wrong(
            "all springs and dampers reversed",
            "The mass is driven away from its target. With e as target minus actual, every gain "
            "has a plus.",
            mistakes.OneMass(spring=-1.0, damper=-1.0),
            "One sign for every error.",
        ),
        Wrong(
            "the damper reversed",
            "The sign of the damper is wrong, so it drives the mass. Take b (dx_d - dx).",
            mistakes.OneMass(damper=-1.0),
            "One sign for every error.",
        ),
        Wrong(
            "spring and damper swapped",
            "k multiplies the error of the position, b that of the speed.",
            mistakes.OneMass(swapped=True),
            "The units tell which is which: stiffness is in N/m, damping in N s/m.",
        ),
        Wrong(
            "the target left out",
            "The target is missing. Tie the spring and the damper to the target, not to the "
            "origin, with x_d - x and dx_d - dx; and add the target's acceleration.",
            mistakes.OneMass(follows=0.0),
            "Draw the mass to the right of its target.",
        ),
        Wrong(
            "the target's acceleration divided by the mass",
            "ddx_d is an acceleration already: divide only forces by m.",
            mistakes.OneMass(feed=0.0, per_mass=1.0),
            "Check the units: N or m/s²?",
        ),
        Wrong(
            "the target's acceleration reversed",
            "Without an error and without a push the mass must move as its target does. Check the "
            "sign of the target's acceleration.",
            mistakes.OneMass(feed=-1.0),
            "Draw the mass to the right of its target.",
        ),
        Wrong(
            "a spring tied to the origin",
            "The spring pulls to the target's place, not to x = 0: k (x_d - x).",
            mistakes.spring_to_the_origin,
            "What are the two ends of the spring tied to?",
        ),
        Wrong(
            "the force of the hand left out",
            "The hand's force is missing. Add it to the forces of the spring and the damper.",
            mistakes.OneMass(force=0.0),
            "Count the forces: spring, damper, hand.",
        ),
        Wrong(
            "not divided by the mass",
            "The forces are not divided by the mass. Divide them all by m.",
            mistakes.OneMass(power=0.0),
            "Check the units: N or m/s²?",
        ),
        Wrong(
            "springs and force beside the mass",
            "The brackets are missing: the force, the damper and the spring are all divided by "
            "the mass.",
            mistakes.Hanging(lambda f, d, s, m, a: a + f + d + s / m),
            "A force divided by a mass is an acceleration.",
        ),
        Wrong(
            "only the force divided by the mass",
            "The brackets are missing: the damper and the spring are divided by the mass as well.",
            mistakes.Hanging(lambda f, d, s, m, a: a + f / m + d + s),
            "A force divided by a mass is an acceleration.",
        ),
        Wrong(
            "the hand's force not divided by the mass",
            "The hand's force is a force like the spring's: divide it by the mass too.",
            mistakes.Hanging(lambda f, d, s, m, a: a + f + (d + s) / m),
            "A force divided by a mass is an acceleration.",
        ),
        Wrong(
            "multiplied by the mass",
            "Divide the forces by the mass to get an acceleration; do not multiply them.",
            mistakes.Hanging(lambda f, d, s, m, a: a + (f + d + s) * m),
            "A force divided by a mass is an acceleration.",
        ),
        Wrong(
            "half of the spring",
            "The factor 1/2 belongs to the spring's energy. Its force is k times the error.",
            mistakes.Hanging(lambda f, d, s, m, a: a + (f + d + 0.5 * s) / m),
            "A force is the slope of an energy.",
        ),
        Wrong(
            "the energy of the spring",
            "½ k e² is the spring's energy. Its force is k e, whose sign changes with that of the "
            "error.",
            mistakes.energy_for_force,
            "A force is the slope of an energy.",
        ),
        Wrong(
            "no damper",
            "The damper is missing: add b times the difference of the speeds.",
            mistakes.Hanging(lambda f, d, s, m, a: a + (f + s) / m),
            "Each term has a task: say which.",
        ),
        Wrong(
            "no spring",
            "The spring is missing: add k times the difference of the positions.",
            mistakes.Hanging(lambda f, d, s, m, a: a + (f + d) / m),
            "Each term has a task: say which.",
        ),
    ),
    variants=(variants.msd_by_error, variants.Mass()),
)

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
            "length of the lever, while the mass felt at the end of a longer lever gets smaller. "
            "Begin with the inverse of M.",
            mistakes.j_m_jt,
            "Follow a push through the arm instead of guessing a product that fits.",
        ),
        Wrong(
            "pseudo-inverses of J on both sides",
            "With six joints this is right. With seven it keeps the elbow out of the motion, and "
            "the arm seems heavier than it is. Follow the push instead: Jᵀ F, then M⁻¹, then J.",
            mistakes.pseudo_inverses,
            "pinv(J) chooses the smallest joint speeds; the arm itself chooses those with the "
            "least energy.",
        ),
        Wrong(
            "the last inverse left out",
            "J M⁻¹ Jᵀ says how easily the tip moves. The question asks how heavy the tip feels, "
            "which is the inverse.",
            mistakes.mobility,
            "Mobility and inertia are inverse to each other.",
        ),
        Wrong(
            "1 / M, number by number",
            "1 / M takes the reciprocal of each number. The inverse of a matrix is np.linalg.inv, "
            "or better a solve.",
            mistakes.inverse_by_element,
            "In numpy, / divides element by element.",
        ),
        Wrong(
            "only the diagonal of M",
            "The joints accelerate each other, so the numbers off the diagonal of M matter. Use "
            "the whole matrix.",
            mistakes.diagonal_only,
            "The mass matrix couples the joints.",
        ),
        Wrong(
            "the inverse of J M Jᵀ",
            "M must be inverted first. Follow the push: Jᵀ F, then M⁻¹, then J.",
            mistakes.inverse_of_the_wrong,
            "Check the unit: the result must be in kg.",
        ),
        Wrong(
            "each axis by itself",
            "A push along x may move the tip along y, so the numbers off the diagonal belong to Λ.",
            mistakes.each_axis_alone,
            "Λ is a matrix.",
        ),
        Wrong(
            "1 over each number",
            "1 / A takes the reciprocal of each number. The inverse of a matrix is np.linalg.inv.",
            mistakes.numbers_turned_over,
            "1 / A is not A⁻¹.",
        ),
        Wrong(
            "the mass matrix left out",
            "The inverse of J Jᵀ knows nothing of masses. Put M⁻¹ between J and Jᵀ, then invert.",
            mistakes.MassesOf(lambda M, J: np.linalg.inv(J @ J.T)),
            "Say what each factor does to a wrench.",
        ),
        Wrong(
            "the transposes exchanged",
            "Jᵀ M⁻¹ J has the transpose on the wrong side, so with seven joints the sizes do not "
            "fit. Jᵀ turns a wrench into torques, so it is the factor on the right: J M⁻¹ Jᵀ.",
            mistakes.MassesOf(lambda M, J: np.linalg.inv(J.T @ np.linalg.inv(M) @ J)),
            "Say what each factor does to a wrench.",
        ),
        Wrong(
            "M⁻¹ twice",
            "Invert M only once between J and Jᵀ.",
            mistakes.MassesOf(lambda M, J: np.linalg.inv(J @ np.linalg.inv(M @ M) @ J.T)),
            "Say what each factor does to a wrench.",
        ),
        Wrong(
            "a root",
            "This is the square root of the right matrix. Give the matrix itself.",
            mistakes.MassesOf(
                lambda M, J: mistakes.root(np.linalg.inv(J @ np.linalg.inv(M) @ J.T))
            ),
            "Check the units: kg and kg m².",
        ),
        Wrong(
            "J M⁻¹ with a pseudo-inverse",
            "The last factor should be Jᵀ, because the transpose turns a wrench at the tip into "
            "torques. Then invert the whole product.",
            mistakes.MassesOf(lambda M, J: J @ np.linalg.inv(M) @ np.linalg.pinv(J)),
            "Forces go through the transpose.",
        ),
        Wrong(
            "pseudo-inverses and M⁻¹",
            "Inverting M and the two Jacobians one by one does not invert their product. Form "
            "J M⁻¹ Jᵀ, then invert the whole of it.",
            mistakes.MassesOf(
                lambda M, J: np.linalg.pinv(J).T @ np.linalg.inv(M) @ np.linalg.pinv(J)
            ),
            "Say what each factor does to a wrench.",
        ),
        Wrong(
            "a negative inertia",
            "Your inertia is negative. An inertia is positive: check the sign.",
            mistakes.MassesOf(lambda M, J: -answers.operational_inertia(M, J)),
            "An inertia is positive.",
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
            "the felt push cancelled",
            "Your law subtracts what the torque sensors feel, so the arm does not give way: a "
            "person who pushes it meets a wall. An impedance needs no sensor: the push moves the "
            "tip, and the springs and dampers respond.",
            mistakes.WithTorque(lambda state: -state.tau_ext),
            "What does the arm do under a push if this torque cancels the push?",
        ),
        Wrong(
            "the felt push added",
            "Your law adds what the torque sensors feel, so the push counts twice and the tip goes "
            "twice as far. The push acts on the arm by itself.",
            mistakes.WithTorque(lambda state: state.tau_ext),
            "The push is there already, and the sensors only report it.",
        ),
        Wrong(
            "the spring's sign reversed",
            "The spring drives the tip away from its target: after any disturbance the arm leaves "
            "its workspace. With e as target minus actual, the stiffness has a plus. (In the "
            "report that this lab grew out of, the equation has your sign, and the program does "
            "not.)",
            mistakes.plus_in_front,
            "One convention: e = target - actual, and a plus before every gain.",
        ),
        Wrong(
            "M Jᵀ for the acceleration of the tip",
            "M Jᵀ ẍ is not a torque: check its unit. The tip's inertia is Λ, and Jᵀ turns the "
            "force Λ ẍ into joint torques: Jᵀ Λ ẍ. A target at rest does not show this mistake.",
            mistakes.joint_inertia_for_tip,
            "The report's program has this mistake; a check of the units shows it.",
        ),
        Wrong(
            "J̇ q̇ left out",
            "The tip accelerates even if the joints turn at constant speed (think of a circle). "
            "Subtract this part, J̇ q̇, before you multiply by Λ.",
            mistakes.no_drift,
            "ẍ = J q̈ + J̇ q̇ has two terms.",
        ),
        Wrong(
            "the weight left out",
            "The weight is missing, and in this question the arm does not carry it. Add g(q) to "
            "the torque.",
            mistakes.weightless,
            "A spring holds a weight only where it is stretched.",
        ),
        Wrong(
            "the body Jacobian",
            "The errors are in world axes, but the body Jacobian is in the tool's axes. With the "
            "gripper down, the wrench is turned by 180 degrees about a horizontal axis, so that "
            "up becomes down. Use tip_jacobian.",
            mistakes.body_jacobian,
            "Always say which Jacobian you mean.",
        ),
        Wrong(
            "Euler angles subtracted",
            "The difference of roll, pitch and yaw is not a rotation vector. With the gripper "
            "down and a yaw beyond 90 degrees, as in the ready pose, it even drives the hand "
            "away. Use lk.se3.pose_error, which takes the logarithm.",
            mistakes.euler_subtraction,
            "Tests with position errors alone never show this mistake.",
        ),
        Wrong(
            "the springs multiplied by Λ",
            "The springs are multiplied by the inertia, so that a stiffness in N/m has no "
            "meaning. Keep springs and dampers outside Λ; inside, the law is computed torque at "
            "the tip.",
            mistakes.springs_inside,
            "In an impedance the stiffness is in N/m, outside the inertia.",
        ),
        Wrong(
            "a damper tied to the room",
            "The damper brakes all motion, so the tip drags behind a moving target. Damp "
            "target.twist - J q̇.",
            mistakes.brakes_the_motion,
            "What are the two ends of the damper tied to?",
        ),
        Wrong(
            "springs and dampers reversed",
            "The tip is driven away from its target. With e and ė as target minus actual, every "
            "gain has a plus.",
            mistakes.TipLaw(e=-1.0, de=-1.0),
            "One sign for every error.",
        ),
        Wrong(
            "the dampers reversed",
            "The sign of ė is wrong, so the dampers drive the tip. Take the target's twist minus "
            "J q̇.",
            mistakes.TipLaw(de=-1.0),
            "One sign for every error.",
        ),
        Wrong(
            "the target's acceleration left out",
            "Λ times target.dtwist is missing, so the tip lags behind a target that speeds up. "
            "Add it.",
            mistakes.TipLaw(feed=0.0),
            "What does the motion itself take?",
        ),
        Wrong(
            "J̇ q̇ with the other sign",
            "J̇ q̇ is the part of the acceleration that comes by itself: subtract it from what "
            "the joints have to provide.",
            mistakes.TipLaw(drift=-1.0),
            "ẍ = J q̈ + J̇ q̇: solve for J q̈.",
        ),
        Wrong(
            "no Coriolis torques",
            "C q̇ is missing. Add it, although at low speed its effect is hard to see.",
            mistakes.TipLaw(coriolis=0.0),
            "A small effect is not zero: try a fast motion.",
        ),
        Wrong(
            "the weight subtracted",
            "g(q) is what the motors must give to hold the arm: add it.",
            mistakes.TipLaw(weight=-1.0),
            "In the equation of motion g is on the left and the motors are on the right.",
        ),
        Wrong(
            "no inertia at the tip",
            "Λ is missing. Multiply the acceleration by it to get a force.",
            mistakes.TipLaw(power=0),
            "Check the units: N or m/s²?",
        ),
        Wrong(
            "the inverse of Λ",
            "Λ itself turns an acceleration into a force. Do not invert it.",
            mistakes.TipLaw(power=-1),
            "Check the units: N or m/s²?",
        ),
        Wrong(
            "a pseudo-inverse for Jᵀ",
            "The pseudo-inverse is for speeds. A force F at the tip takes exactly the joint "
            "torques Jᵀ F.",
            mistakes.TipLaw(pinv=True),
            "Jᵀ maps forces, J⁺ maps speeds.",
        ),
        Wrong(
            "the body Jacobian everywhere",
            "Twists and wrenches are in world axes, but this Jacobian is in the tool's axes. Use "
            "tip_jacobian.",
            mistakes.TipLaw(body=True),
            "Always say which Jacobian you mean.",
        ),
        Wrong(
            "stiffness and damping swapped",
            "Multiply the error by stiffness and its rate by damping.",
            mistakes.TipLaw(swapped=True),
            "The units tell which is which: stiffness is in N/m, damping in N s/m.",
        ),
        Wrong(
            "the turn in the tool's axes",
            "The rotation from tip to target must be in world axes, as the Jacobian is: "
            "lk.se3.pose_error gives it.",
            mistakes.TipLaw(turn_in_tool=True),
            "Error and Jacobian must be in the same axes.",
        ),
        Wrong(
            "the error in the tool's axes",
            "Both parts of the error are in the tool's axes, but the Jacobian is in the world's. "
            "lk.se3.pose_error gives both parts in world axes.",
            mistakes.TipLaw(place_in_tool=True, turn_in_tool=True),
            "Error and Jacobian must be in the same axes.",
        ),
        Wrong(
            "the position error in the tool's axes",
            "The position error is in the tool's axes, but the Jacobian is in the world's. "
            "lk.se3.pose_error gives it in world axes.",
            mistakes.TipLaw(place_in_tool=True),
            "Error and Jacobian must be in the same axes.",
        ),
        Wrong(
            "no springs for the rotation",
            "The last three numbers of the error are missing, so the hand keeps any tilt. Use all "
            "six.",
            mistakes.TipLaw(turn=0.0),
            "A gain of zero hides a wrong sign of the error.",
        ),
        Wrong(
            "the weight twice",
            "Add the weight once. `Model.bias` contains it already.",
            mistakes.TipLaw(weight=2.0),
            "Ask of each term whether another term contains it already.",
        ),
        Wrong(
            "half of the weight",
            "model.gravity is the whole weight: add all of it.",
            mistakes.TipLaw(weight=0.5),
            "Use each term of the model as it is.",
        ),
        Wrong(
            "no springs",
            "The springs are missing: nothing pulls the tip back.",
            mistakes.TipLaw(e=0.0),
            "Each term has a task: say which.",
        ),
        Wrong(
            "no dampers",
            "The dampers are missing: the tip swings about its target.",
            mistakes.TipLaw(de=0.0),
            "Each term has a task: say which.",
        ),
        Wrong(
            "the turn reversed",
            "The error of orientation has the wrong sign, so its springs drive the hand away. The "
            "rotation must go from the tip to the target.",
            mistakes.TipLaw(turn=-1.0),
            "One convention for the whole course: target minus actual.",
        ),
        Wrong(
            "the Coriolis torques reversed",
            "Add C q̇: the arm needs this torque, whatever the law.",
            mistakes.TipLaw(coriolis=-1.0),
            "The law is the equation of motion, plus springs and dampers.",
        ),
        Wrong(
            "J̇ q̇ twice",
            "Subtract J̇ q̇, the acceleration that comes by itself, only once.",
            mistakes.TipLaw(drift=2.0),
            "Differentiate V = J q̇ with the product rule.",
        ),
        Wrong(
            "the springs inside the inertia",
            "K e is a wrench already. Add it to Λ times the acceleration; do not multiply it by Λ.",
            mistakes.TipTerms(lambda J, L, a, D, K, C, g, M: J.T @ (L @ (a + K) + D) + C + g),
            "Units: K e is a wrench.",
        ),
        Wrong(
            "the dampers inside the inertia",
            "D ė is a wrench already. Add it to Λ times the acceleration; do not multiply it by Λ.",
            mistakes.TipTerms(lambda J, L, a, D, K, C, g, M: J.T @ (L @ (a + D) + K) + C + g),
            "Units: D ė is a wrench.",
        ),
        Wrong(
            "J M Jᵀ for the inertia at the tip",
            "The tip's inertia is (J M⁻¹ Jᵀ)⁻¹, which model.operational_inertia gives. J M Jᵀ is "
            "another matrix.",
            mistakes.TipTerms(
                lambda J, L, a, D, K, C, g, M: J.T @ (J @ M @ J.T @ a + D + K) + C + g
            ),
            "Say what each factor does to a wrench.",
        ),
        Wrong(
            "the weight through the Jacobian",
            "g(q) is a torque at the joints already: add it there, not to the wrench at the tip.",
            mistakes.TipTerms(lambda J, L, a, D, K, C, g, M: J.T @ (L @ a + D + K + J @ g) + C),
            "A torque is not a wrench.",
        ),
        Wrong(
            "springs along the tool's axes",
            "R K Rᵀ e turns the springs into the tool's axes. `stiffness` is along the world's "
            "axes, as the error is: K e.",
            mistakes.AlongTheTool(),
            "A stiffness belongs to axes: say which.",
        ),
        Wrong(
            "springs and dampers along the tool's axes",
            "R K Rᵀ e and R D Rᵀ ė turn springs and dampers into the tool's axes. `stiffness` and "
            "`damping` are along the world's axes, as the errors are: K e and D ė.",
            mistakes.AlongTheTool(dampers=True),
            "A stiffness belongs to axes: say which.",
        ),
        Wrong(
            "a damper at the joints",
            "-q̇ brakes every joint, and the tip feels this in addition to the dampers of the "
            "question. To brake the elbow alone, project the torque: (I - Jᵀ J̄ᵀ) τ, with J̄ = "
            "M⁻¹ Jᵀ Λ.",
            mistakes.WithTorque(lambda state: -state.dq),
            "Ask of each torque whether the tip feels it.",
        ),
        Wrong(
            "a damper of 2 N m s/rad at the joints",
            "-2 q̇ brakes every joint, and the tip feels this in addition to the dampers of the "
            "question. To brake the elbow alone, project the torque: (I - Jᵀ J̄ᵀ) τ, with J̄ = "
            "M⁻¹ Jᵀ Λ.",
            mistakes.WithTorque(lambda state: -2.0 * state.dq),
            "Ask of each torque whether the tip feels it.",
        ),
        Wrong(
            "a torque behind the projector of speeds",
            "The tip feels what you add for the elbow. The projector I - J⁺ J is for joint "
            "speeds, but a torque acts on the speeds through M⁻¹. For torques the projector is I "
            "- Jᵀ J̄ᵀ, with J̄ = M⁻¹ Jᵀ Λ.",
            mistakes.brakes_behind_speeds,
            "There are two null spaces: one of speeds, one of torques.",
        ),
    ),
    variants=(
        variants.impedance_by_terms,
        variants.impedance_by_parts,
        variants.impedance_by_khatib,
        variants.impedance_by_pseudo_inverse,
        variants.impedance_with_braked_elbow,
    ),
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
            "the wrench added as it is",
            "If you add the wrench as it is, the motors always help the hand as much as it "
            "pushes. Multiply the wrench by Λ M_d⁻¹ - I, which is zero if M_d = Λ.",
            mistakes.force_added_plainly,
            "Test the special case M_d = Λ.",
        ),
        Wrong(
            "the wrench of the robot on the hand",
            "The sign of the wrench is wrong, so a tip that should feel heavy feels light, and a "
            "light one heavy. `wrench` is what the hand does to the arm.",
            mistakes.wrench_of_the_robot,
            "Always say whose force it is, and on what it acts.",
        ),
        Wrong(
            "the wrench left out",
            "Without the measured wrench the hand still feels the arm's own inertia. The wrench "
            "belongs in two places: in the acceleration that M_d shapes, and in the hand's part "
            "of the force.",
            mistakes.force_forgotten,
            "Shaping the inertia needs a sensor of the wrench; plain impedance does not.",
        ),
        Wrong(
            "the inertia ignored",
            "This is the law with the arm's own inertia. Divide springs, dampers and wrench by "
            "M_d, then multiply by Λ; and subtract the wrench, which is the hand's part of the "
            "force.",
            mistakes.own_inertia,
            "With M_d = Λ the two laws agree.",
        ),
        Wrong(
            "the report's equation 19",
            "The wrench is outside the braces as a force and inside as an acceleration, as in the "
            "report's equation 19. Divide the one inside by M_d and subtract the one outside, so "
            "that the wrench cancels if M_d = Λ.",
            mistakes.the_reports_equation,
            "Check the units and the special case M_d = Λ.",
        ),
        Wrong(
            "the hand's share left in",
            "Your motors provide all the force that the motion takes, and the hand pushes as "
            "well. Subtract the hand's wrench.",
            mistakes.hand_works_twice,
            "Λ a = F_motors + F_hand.",
        ),
        Wrong(
            "the wrench inside reversed",
            "The tip should yield to the push: the wrench has a plus in M_d⁻¹ (D ė + K e + F).",
            mistakes.ShapedLaw(inside=-1.0),
            "Follow one push through the law, sign by sign.",
        ),
        Wrong(
            "the hand's share added",
            "The hand provides a part of the force, so the motors must provide less. Subtract the "
            "wrench instead of adding it.",
            mistakes.ShapedLaw(outside=-1.0),
            "Which part of the force comes from whom?",
        ),
        Wrong(
            "the wrench subtracted, and no more",
            "The wrench must also accelerate the tip: add M_d⁻¹ F to the acceleration.",
            mistakes.ShapedLaw(inside=0.0),
            "Follow one push through the law, sign by sign.",
        ),
        Wrong(
            "M_d where Λ belongs",
            "The motors have to move the arm's own inertia, so multiply the acceleration by Λ. "
            "M_d only determines how large this acceleration should be.",
            mistakes.ShapedLaw(for_own=True),
            "First find the desired acceleration, then the force that it takes.",
        ),
        Wrong(
            "J̇ q̇ left out",
            "The tip accelerates even if the joints turn at constant speed. Subtract this part, "
            "J̇ q̇, before you multiply by Λ.",
            mistakes.ShapedLaw(drift=0.0),
            "ẍ = J q̈ + J̇ q̇ has two terms.",
        ),
        Wrong(
            "the weight left out",
            "The weight is missing, and in this question the arm does not carry it. Add g(q) to "
            "the torque.",
            mistakes.ShapedLaw(weight=0.0),
            "A spring holds a weight only where it is stretched.",
        ),
        Wrong(
            "no Coriolis torques",
            "C q̇ is missing. Add it, although at low speed its effect is hard to see.",
            mistakes.ShapedLaw(coriolis=0.0),
            "A small effect is not zero: try a fast motion.",
        ),
        Wrong(
            "springs and dampers reversed",
            "The tip is driven away from its target. With e and ė as target minus actual, every "
            "gain has a plus.",
            mistakes.ShapedLaw(e=-1.0),
            "One sign for every error.",
        ),
        Wrong(
            "the target's acceleration left out",
            "target.dtwist is missing, so the tip lags behind a target that speeds up. Add it.",
            mistakes.ShapedLaw(feed=0.0),
            "What does the motion itself take?",
        ),
        Wrong(
            "a pseudo-inverse for Jᵀ",
            "The pseudo-inverse is for speeds. A force F at the tip takes exactly the joint "
            "torques Jᵀ F.",
            mistakes.ShapedLaw(pinv=True),
            "Jᵀ maps forces, J⁺ maps speeds.",
        ),
        Wrong(
            "the springs reversed",
            "The springs push the tip away from its target: the error is target minus actual.",
            mistakes.ShapedTerms(
                lambda J, L, M, a, v, D, K, F, C, g: mistakes.shaped(J, L, M, a, v, D - K, F, C, g)
            ),
            "One convention for the whole course: target minus actual.",
        ),
        Wrong(
            "the dampers reversed",
            "The dampers drive the tip instead of braking it: the error of the twist is target "
            "minus actual.",
            mistakes.ShapedTerms(
                lambda J, L, M, a, v, D, K, F, C, g: mistakes.shaped(J, L, M, a, v, K - D, F, C, g)
            ),
            "One convention for the whole course: target minus actual.",
        ),
        Wrong(
            "no springs",
            "The springs are missing: nothing pulls the tip back.",
            mistakes.ShapedTerms(
                lambda J, L, M, a, v, D, K, F, C, g: mistakes.shaped(J, L, M, a, v, D, F, C, g)
            ),
            "Each term has a task: say which.",
        ),
        Wrong(
            "no dampers",
            "The dampers are missing: the tip swings about its target.",
            mistakes.ShapedTerms(
                lambda J, L, M, a, v, D, K, F, C, g: mistakes.shaped(J, L, M, a, v, K, F, C, g)
            ),
            "Each term has a task: say which.",
        ),
        Wrong(
            "the turn in the tool's axes",
            "The error of orientation is in the tool's axes, but the Jacobian and the stiffness "
            "are in the world's.",
            mistakes.ShapedTerms(
                lambda J, L, M, a, v, D, K, F, C, g: mistakes.shaped(J, L, M, a, v, D + K, F, C, g),
                tool=1,
            ),
            "Error and Jacobian must be in the same axes.",
        ),
        Wrong(
            "the error in the tool's axes",
            "The error is in the tool's axes, but the Jacobian and the stiffness are in the "
            "world's.",
            mistakes.ShapedTerms(
                lambda J, L, M, a, v, D, K, F, C, g: mistakes.shaped(J, L, M, a, v, D + K, F, C, g),
                tool=2,
            ),
            "Error and Jacobian must be in the same axes.",
        ),
        Wrong(
            "the wanted inertia not inverted",
            "Multiply the forces by the inverse of the desired inertia, not by the inertia itself.",
            mistakes.ShapedTerms(
                lambda J, L, M, a, v, D, K, F, C, g: (
                    J.T @ (L @ (a + M @ (D + K + F) - v) - F) + C + g
                )
            ),
            "A force divided by an inertia is an acceleration.",
        ),
        Wrong(
            "the ratio of the inertias upside down",
            "The arm's own inertia belongs outside the bracket, and the inverse of the desired "
            "one inside. You have exchanged the two.",
            mistakes.ShapedTerms(
                lambda J, L, M, a, v, D, K, F, C, g: (
                    J.T @ (M @ (a + np.linalg.inv(L) @ (D + K + F) - v) - F) + C + g
                )
            ),
            "Say which inertia the arm has and which it should show.",
        ),
        Wrong(
            "the factor upside down",
            "The factor before springs, dampers and wrench is Λ M_d⁻¹. Yours is M_d Λ⁻¹, so a "
            "tip that should feel heavy feels light.",
            mistakes.ShapedTerms(
                lambda J, L, M, a, v, D, K, F, C, g: (
                    J.T @ (L @ (a - v) + M @ np.linalg.inv(L) @ (D + K + F) - F) + C + g
                )
            ),
            "Say which inertia the arm has and which it should show.",
        ),
        Wrong(
            "only the diagonal of the wanted inertia",
            "The desired inertia is a matrix: invert the whole matrix.",
            mistakes.ShapedTerms(
                lambda J, L, M, a, v, D, K, F, C, g: mistakes.shaped(
                    J, L, np.diag(np.diag(M)), a, v, D + K, F, C, g
                )
            ),
            "1/diag(M) is not the inverse of M.",
        ),
        Wrong(
            "no inertia at the tip",
            "You multiply an acceleration by Jᵀ, which needs a wrench: the tip's own inertia is "
            "missing.",
            mistakes.ShapedTerms(
                lambda J, L, M, a, v, D, K, F, C, g: (
                    J.T @ (a + np.linalg.inv(M) @ (D + K + F) - v - F) + C + g
                )
            ),
            "Units: an acceleration is not a wrench.",
        ),
        Wrong(
            "the inverse of the tip's inertia",
            "The tip's inertia turns an acceleration into a wrench; its inverse does the opposite.",
            mistakes.ShapedTerms(
                lambda J, L, M, a, v, D, K, F, C, g: (
                    J.T @ (np.linalg.inv(L) @ (a + np.linalg.inv(M) @ (D + K + F) - v) - F) + C + g
                )
            ),
            "Units: an acceleration is not a wrench.",
        ),
        Wrong(
            "the target's acceleration divided by the inertia",
            "The target's acceleration is an acceleration already: do not multiply it by the "
            "inverse of M_d.",
            mistakes.ShapedTerms(
                lambda J, L, M, a, v, D, K, F, C, g: (
                    J.T @ (L @ (np.linalg.inv(M) @ (a + D + K + F) - v) - F) + C + g
                )
            ),
            "Units: divide forces, not accelerations.",
        ),
        Wrong(
            "the weight twice",
            "Add the weight once. `Model.bias` contains it already.",
            mistakes.ShapedLaw(weight=2.0),
            "Ask of each term whether another term contains it already.",
        ),
        Wrong(
            "the weight subtracted",
            "Gravity pulls down and the motors hold against it, so add model.gravity.",
            mistakes.ShapedLaw(weight=-1.0),
            "model.gravity is the torque that holds the arm.",
        ),
        Wrong(
            "the Coriolis torques reversed",
            "Add C q̇: the arm needs this torque, whatever the law.",
            mistakes.ShapedLaw(coriolis=-1.0),
            "The law is the equation of motion, plus springs and dampers.",
        ),
        Wrong(
            "J̇ q̇ with the other sign",
            "Subtract J̇ q̇, the acceleration that comes by itself.",
            mistakes.ShapedLaw(drift=-1.0),
            "Differentiate V = J q̇ with the product rule.",
        ),
    ),
    variants=(variants.shaped_by_factor, variants.shaped_by_pseudo_inverse),
)

_random = np.random.default_rng(5)
_x = _random.uniform(-0.04, 0.04, (12, 3))
_straight = np.diag([300.0, 150.0, 450.0])
_coupled = np.array([[300.0, 60.0, -20.0], [50.0, 150.0, 10.0], [-30.0, 0.0, 450.0]])
_offset = np.array([2.0, -1.0, 4.0])

APPARENT_STIFFNESS = Problem(
    name="apparent_stiffness",
    points=4,
    core=False,
    outcomes=(
        "contact",
        "experiment",
    ),
    asks="Somebody pushed the arm N times and waited each time until the arm rested. Fit `force` "
    "= K · `displacement` + offset by least squares of the force (only the force has noise; the "
    "displacements are exact), and give K of shape (3, 3). Row i of `force` and of "
    "`displacement`, both of shape (N, 3), belongs to push i.",
    answer=answers.apparent_stiffness,
    judge=Close(rtol=1e-5, atol=1e-6),
    trials=(
        Trial(
            "springs along the axes",
            (call(_x @ _straight.T, _x),),
            hidden.straight_springs,
            "other stiffnesses",
            weight=0.0,
        ),
        Trial(
            "a push along x that also moves the tip along y",
            (call(_x @ _coupled.T, _x),),
            hidden.coupled_springs,
            "matrices that are not quite symmetric",
        ),
        Trial(
            "a force that is there at rest",
            (call(_x @ _straight.T + _offset, _x),),
            hidden.springs_with_offset,
        ),
        Trial(
            "measured data",
            (call(_x @ _coupled.T + _offset + 0.5 * _random.standard_normal((12, 3)), _x),),
            hidden.measured_springs,
            "more and fewer pushes",
            weight=3.0,
        ),
    ),
    hints=(
        "Nine numbers of K and three of the offset are unknown, and each push gives three "
        "equations. All of these equations are linear.",
        "np.linalg.lstsq solves A X = B for X. With one row for each push, A holds the "
        "displacement and a 1, and B the force. What does each row of X hold?",
        "A column of ones beside the displacements accounts for the offset. numpy solves for all "
        "three force components at once; check what the rows and the columns of its answer belong "
        "to.",
    ),
    wrong=(
        Wrong(
            "force over displacement, axis by axis",
            "A push along x may move the tip along y, and where a displacement is nearly zero the "
            "ratio means nothing. Fit all nine numbers together.",
            mistakes.element_by_element,
            "A stiffness is a matrix.",
        ),
        Wrong(
            "a fit through the origin",
            "The force at rest is not zero (a tool's weight, a sensor's offset), and without a "
            "term for it the stiffness has to explain it. Fit an offset too.",
            mistakes.through_the_origin,
            "An offset that is not fitted spoils the stiffness.",
        ),
        Wrong(
            "the compliance",
            "This is the compliance, in metres per newton. The stiffness is its inverse, in "
            "newtons per metre.",
            mistakes.compliance,
            "Check the unit of the result.",
        ),
        Wrong(
            "K transposed",
            "lstsq works with rows, so it returns the transpose of K. Transpose it. A symmetric K "
            "does not show this mistake.",
            mistakes.transposed,
            "With one row for each push, F = x Kᵀ.",
        ),
        Wrong(
            "a fit with the noise in the displacement",
            "This fit assumes noise in the displacement, but the noise is in the force. Fit the "
            "force to the displacement by ordinary least squares.",
            mistakes.other_regression,
            "Least squares is not symmetric: it puts all of the noise on one side of the equation.",
        ),
        Wrong(
            "a stiffness below zero",
            "`force` is that of the hand on the arm, so the arm moves in its direction and the "
            "stiffness is positive. Check the sign.",
            mistakes.arm_against_hand,
            "Always say whose force it is, and on what it acts.",
        ),
        Wrong(
            "no offset, and K transposed",
            "lstsq works with rows, so K comes out transposed. Besides, the force at rest is not "
            "zero, so the fit needs an offset.",
            mistakes.transposed_through_the_origin,
            "Try a fit on numbers whose answer you know.",
        ),
        Wrong(
            "a fit of the displacement",
            "This fit gives metres per newton. Give newtons per metre, from a fit in which the "
            "force has the noise.",
            mistakes.regression_of_the_displacement,
            "Look at the unit of the result.",
        ),
        Wrong(
            "the diagonal alone",
            "A push along x may move the tip along y. Give the numbers off the diagonal too.",
            mistakes.diagonal_of_the_fit,
            "K is a matrix.",
        ),
        Wrong(
            "made symmetric",
            "A measured stiffness need not be symmetric. Leave the fit as it is.",
            mistakes.made_symmetric,
            "Do not assume what you want to see.",
        ),
        Wrong(
            "newtons for a millimetre",
            "These numbers are in N/mm. Give N/m.",
            mistakes.in_millimetres,
            "Compute in SI units; use millimetres only in print.",
        ),
        Wrong(
            "a line for each axis",
            "Three fits, each of one axis alone, miss the force along y that belongs to a "
            "displacement along x. Fit all nine numbers together.",
            mistakes.axis_by_axis_fit,
            "K is a matrix: one fit for all.",
        ),
        Wrong(
            "measured from the first push",
            "You measure everything from the first push, so the noise of that push enters all the "
            "others. Measure from the mean.",
            mistakes.FitOf(lambda F, x: mistakes.solved(x - x[0], F - F[0])),
            "The line of a fit with an offset goes through the mean.",
        ),
        Wrong(
            "only the force about its mean",
            "You subtract the mean from the force alone. Subtract the displacement's mean from "
            "the displacement too.",
            mistakes.FitOf(lambda F, x: mistakes.solved(x, mistakes.about(F))),
            "The line of a fit with an offset goes through the mean.",
        ),
        Wrong(
            "one mean for all axes",
            "Each axis has its own mean: mean(axis=0).",
            mistakes.FitOf(lambda F, x: mistakes.solved(x - x.mean(), F - F.mean())),
            "Say over which axis you take a mean.",
        ),
        Wrong(
            "differences of neighbours",
            "Each difference contains the noise of two pushes. Fit all pushes at once, about "
            "their mean.",
            mistakes.FitOf(lambda F, x: mistakes.solved(np.diff(x, axis=0), np.diff(F, axis=0))),
            "A fit uses all data.",
        ),
        Wrong(
            "three pushes only",
            "Three pushes are just enough for a matrix without an offset, and their noise goes "
            "into it in full. Fit all pushes.",
            mistakes.FitOf(lambda F, x: mistakes.solved(x[:3], F[:3])),
            "A fit uses all data.",
        ),
        Wrong(
            "a ratio of means",
            "The means of force and displacement are mostly offset. Fit how the force changes "
            "with the displacement.",
            mistakes.FitOf(lambda F, x: np.diag(F.mean(axis=0) / x.mean(axis=0))),
            "A stiffness is a slope.",
        ),
        Wrong(
            "each push divided, and the mean",
            "Ratios of small numbers are mostly noise, and an offset spoils them. Fit all pushes at once.",
            mistakes.FitOf(lambda F, x: np.nanmean(F[:, :, None] / x[:, None, :], axis=0)),
            "A stiffness is a slope.",
        ),
        Wrong(
            "a covariance",
            "A covariance of force and displacement is not yet a slope: multiply it by the inverse covariance of the displacement.",
            mistakes.FitOf(lambda F, x: np.cov(F.T, x.T)[:3, 3:]),
            "A slope is a covariance divided by a variance.",
        ),
        Wrong(
            "covariances in the wrong order",
            "K = cov(F, x) cov(x, x)⁻¹, in this order: matrices do not commute.",
            mistakes.FitOf(lambda F, x: np.linalg.inv(np.cov(x.T)) @ np.cov(F.T, x.T)[:3, 3:]),
            "Matrices do not commute.",
        ),
        Wrong(
            "the offset taken for a column",
            "With a column of ones, one row of the solution is the offset. You return this row as "
            "a part of K.",
            mistakes.FitOf(
                lambda F, x: (
                    np.linalg.lstsq(np.column_stack([np.ones(len(x)), x]), F, rcond=None)[0][:3].T
                )
            ),
            "Say which row of a solution belongs to which unknown.",
        ),
        Wrong(
            "the signs of the stiffness dropped",
            "Numbers in a stiffness matrix may be negative: keep their signs.",
            mistakes.FitOf(
                lambda F, x: np.abs(mistakes.solved(mistakes.about(x), mistakes.about(F)))
            ),
            "A stiffness matrix has signed numbers.",
        ),
        Wrong(
            "half of the matrix",
            "The numbers below the diagonal are missing. Give the whole matrix.",
            mistakes.FitOf(
                lambda F, x: np.triu(mistakes.solved(mistakes.about(x), mistakes.about(F)))
            ),
            "A matrix has nine numbers.",
        ),
    ),
    variants=(variants.stiffness_with_ones, variants.stiffness_by_covariances),
)

PROBLEMS = (
    MSD,
    OPERATIONAL_INERTIA,
    WORKSPACE_IMPEDANCE,
    SHAPED_IMPEDANCE,
    APPARENT_STIFFNESS,
)
