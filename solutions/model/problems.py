"""The questions of notebook 02."""

from __future__ import annotations

import numpy as np

from labkit.course import Close
from labkit.course.authoring.problem import Problem, Trial, Wrong, call

from . import answers, hidden, mistakes, variants
from .hidden import MODEL, ROUGH_MODEL, bodies, joints, lift, weights

READY = MODEL.robot.ready
BENT = np.array([0.4, -0.6, 0.5, 1.3, -0.7, 0.9, 0.3])
REACHING = np.array([-0.2, 0.3, -1.0, 0.4, 1.2, -0.6, -1.0])

JACOBIAN = Problem(
    name="jacobian",
    points=4,
    outcomes=("model",),
    asks="Give the Jacobian of the tip in world axes, of shape (6, 7): column k holds the velocity "
    "of the tip (3 numbers, first) and the angular velocity (3 numbers) while joint k alone turns "
    "at 1 rad/s.",
    answer=answers.jacobian,
    judge=Close(rtol=1e-8, atol=1e-9),
    trials=(
        Trial(
            "the ready pose: six rows, seven columns, the angular rows below",
            (call(*joints(READY)),),
            hidden.jacobians,
            weight=0.0,
        ),
        Trial(
            "two bent poses",
            (call(*joints(BENT)), call(*joints(REACHING))),
            hidden.jacobians,
        ),
        Trial("any pose", (call(*joints(np.zeros(7))),), hidden.jacobians, "any poses"),
    ),
    withheld=(
        "labkit.Model.tip_jacobian",
        "labkit.Model.body_jacobian",
        "labkit.Model.spatial_jacobian",
        "pinocchio",
    ),
    hints=(
        "Freeze six joints and turn one. The whole hand then turns about that joint's axis like a "
        "door on its hinge. Which way, and how fast, does the tip go?",
        "A point at the arm r from the axis z moves with z × r. The arm goes from the axis to the "
        "tip: r = tip - origins[k]. The angular velocity of the hand is z itself.",
        "Each column has two parts of three numbers, as a door's handle and the door. Build "
        "one column, then put seven side by side.",
    ),
    wrong=(
        Wrong(
            "the moment arm from the world's origin",
            "The linear rows are the velocity of a point of the hand that is passing the world's "
            "origin: that is the spatial Jacobian. Measure the arm from the joint to the tip.",
            mistakes.arm_from_the_base,
            "Three Jacobians exist; say which.",
        ),
        Wrong(
            "the cross product reversed",
            "The linear rows have the wrong sign. Take z × r, not r × z, with r from the joint to "
            "the tip.",
            mistakes.product_reversed,
            "A cross product changes its sign with the order.",
        ),
        Wrong(
            "rows (w, v)",
            "The angular rows come first. In this course a twist is (v, w), with the linear part "
            "first; books differ.",
            mistakes.turns_first,
            "Twist order is a convention: settle it once.",
        ),
        Wrong(
            "columns of sliding joints",
            "These are the columns of joints that slide along their axes. Baxter's joints turn: "
            "the linear part is z × r, the angular part is z.",
            mistakes.axis_for_velocity,
            "A revolute joint's linear part is z × r.",
        ),
        Wrong(
            "every axis through the origin",
            "The arm r goes from the joint's axis to the tip, so it is tip minus the joint's "
            "origin, not the tip alone.",
            mistakes.arm_of_the_tip,
            "A moment arm begins at the axis.",
        ),
        Wrong(
            "the origin of the joint before",
            "Joint k turns about its own axis, through origins[k]. Yours takes the origin of the joint before it.",
            mistakes.origin_before,
            "Say which index belongs to which joint.",
        ),
        Wrong(
            "a distance for the cross product",
            "A turning joint moves the tip across its axis: z × (tip - p). Yours moves it along the axis.",
            mistakes.distance_for_product,
            "Turning about an axis moves nothing along it.",
        ),
        Wrong(
            "the product element by element",
            "* multiplies element by element. The tip moves by the cross product z × (tip - p), np.cross.",
            mistakes.product_by_element,
            "Turning about an axis moves nothing along it.",
        ),
        Wrong(
            "moment arms made one long",
            "The farther the tip is from the axis, the faster it goes. Do not divide the arm by its length.",
            mistakes.unit_arms,
            "Speed is angular speed times distance.",
        ),
        Wrong(
            "every axis vertical",
            "Only the first axis is vertical in every pose. Each joint has its own, axes[k].",
            mistakes.vertical_axes,
            "Say which index belongs to which joint.",
        ),
        Wrong(
            "the joints in the other order",
            "Column k belongs to joint k, from the base on. Yours begins at the hand.",
            mistakes.joints_reversed,
            "Say which index belongs to which joint.",
        ),
    ),
    variants=(variants.jacobian_by_rows, variants.jacobian_by_hat),
)

MASS_MATRIX = Problem(
    name="mass_matrix",
    points=4,
    outcomes=("model",),
    asks="Give the mass matrix M of the arm, of shape (7, 7): the matrix with kinetic energy "
    "½ dqᵀ M dq, summed over the seven links, each of which moves and turns.",
    answer=answers.mass_matrix,
    judge=Close(rtol=1e-8, atol=1e-9),
    trials=(
        Trial(
            "links that are points: no inertia of their own",
            (call(*(0.0 * x if k == 1 else x for k, x in enumerate(bodies(READY)))),),
            hidden.points_of_mass,
            weight=0.0,
        ),
        Trial("a bent elbow", (call(*bodies(BENT)),), hidden.mass_matrices),
        Trial(
            "any pose",
            (call(*bodies(READY)), call(*bodies(REACHING))),
            hidden.mass_matrices,
            "any poses",
            weight=2.0,
        ),
    ),
    withheld=("labkit.Model.mass_matrix", "labkit.Model.kinetic_energy", "pinocchio"),
    hints=(
        "A link's kinetic energy is ½ m |v|² of its centre of mass plus ½ wᵀ I w of its turning. "
        "Both v and w are a Jacobian times dq. Put that in, and read off what stands between dqᵀ "
        "and dq.",
        "With J the Jacobian of the centre, v = J[:3] dq and w = J[3:] dq. So the link adds "
        "m J[:3]ᵀ J[:3] + J[3:]ᵀ I J[3:], with I and w in the same axes.",
        "Write the energy of one body as ½ dq' (...) dq. Both of its parts have a Jacobian on "
        "each side; between them stands a mass, or an inertia that must be turned into world "
        "axes on both sides.",
    ),
    wrong=(
        Wrong(
            "the inertia left in the link's axes",
            "w is in world axes and the inertia in the link's: turn it with R I Rᵀ first.",
            mistakes.inertia_not_turned,
            "A product needs both factors in the same axes.",
        ),
        Wrong(
            "the inertia turned the wrong way",
            "Rᵀ I R takes an inertia from the world into the link. Take it the other way, with R "
            "I Rᵀ.",
            mistakes.inertia_turned_back,
            "R_wl takes vectors from the link to the world, so I_w = R I_l Rᵀ.",
        ),
        Wrong(
            "links treated as points",
            "The links' own turning is left out, so the last joint, which turns the hand about "
            "itself, has almost no inertia. Add the part of the angular velocities.",
            mistakes.points_only,
            "The smallest eigenvalue of M tells: it is close to zero.",
        ),
        Wrong(
            "half of the mass matrix",
            "The factor one half belongs to the energy, not to the matrix. Leave it out.",
            mistakes.half_of_it,
            "T = ½ dqᵀ M dq.",
        ),
        Wrong(
            "the rows swapped",
            "Rows 0 to 2 of each Jacobian are the velocity and go with the mass; rows 3 to 5 are "
            "the angular velocity and go with the inertia.",
            mistakes.rows_swapped,
            "A twist is (v, w), linear part first.",
        ),
        Wrong(
            "R I without the second R",
            "A matrix changes its axes by R I Rᵀ: one rotation on each side. Yours has only the left one.",
            mistakes.Kinetic(inertia=lambda I_l, R: R @ I_l),
            "Vectors turn with one R, matrices with two.",
        ),
        Wrong(
            "Rᵀ I without the second R",
            "A matrix changes its axes by R I Rᵀ: one rotation on each side.",
            mistakes.Kinetic(inertia=lambda I_l, R: R.T @ I_l),
            "Vectors turn with one R, matrices with two.",
        ),
        Wrong(
            "the masses left out",
            "The linear part is m Jᵥᵀ Jᵥ: each link's velocity counts with its mass.",
            mistakes.Kinetic(power=0.0),
            "Kinetic energy: m v²/2.",
        ),
        Wrong(
            "the masses squared",
            "The linear part is m Jᵥᵀ Jᵥ, with the mass once.",
            mistakes.Kinetic(power=2.0),
            "Kinetic energy: m v²/2.",
        ),
        Wrong(
            "the mass on the inertia",
            "The inertia of a link holds its mass already, in kg m².",
            mistakes.Kinetic(mass=True),
            "Units: kg m² times kg is not an inertia.",
        ),
        Wrong(
            "rotation alone",
            "The links' centres of mass move as well: m Jᵥᵀ Jᵥ is missing.",
            mistakes.Kinetic(linear=0.0),
            "Kinetic energy has two parts.",
        ),
        Wrong(
            "half of the linear part",
            "The one half of m v²/2 is that of the quadratic form; it does not enter the matrix.",
            mistakes.Kinetic(linear=0.5),
            "T = q̇ᵀ M q̇ / 2.",
        ),
        Wrong(
            "half of the angular part",
            "The one half of ω·Iω/2 is that of the quadratic form; it does not enter the matrix.",
            mistakes.Kinetic(angular=0.5),
            "T = q̇ᵀ M q̇ / 2.",
        ),
        Wrong(
            "the two parts subtracted",
            "Both parts of the kinetic energy are added.",
            mistakes.Kinetic(angular=-1.0),
            "Kinetic energy has two parts.",
        ),
        Wrong(
            "the mass with all six rows",
            "The mass goes with the linear rows J[:3] alone. For the angular ones there is the inertia.",
            mistakes.Kinetic(whole=True),
            "Kinetic energy has two parts.",
        ),
        Wrong(
            "the inertia as a number",
            "A link's inertia differs from axis to axis: keep the matrix, do not take its trace or mean.",
            mistakes.Kinetic(inertia=lambda I_l, R: np.trace(I_l) / 3.0 * np.eye(3)),
            "An inertia is a matrix.",
        ),
        Wrong(
            "the last link only",
            "The sum over the links keeps only its last one: add with += and start from zeros.",
            mistakes.last_link_only,
            "Every link moves.",
        ),
        Wrong(
            "the diagonal only",
            "The joints shake one another: what is beside the diagonal belongs to M.",
            mistakes.beside_left_out,
            "A mass matrix couples the joints.",
        ),
    ),
    variants=(variants.mass_matrix_vectorised, variants.MassMatrix()),
)

GRAVITY = Problem(
    name="gravity",
    points=4,
    outcomes=("model",),
    asks="Give the torques, of shape (7,) and in N m, that hold the arm still against its weight: the "
    "slope of the potential energy along each joint. The world's z axis points up; take 9.81 m/s².",
    answer=answers.gravity,
    judge=Close(rtol=1e-8, atol=1e-9),
    trials=(
        Trial("the ready pose", (call(*weights(READY)),), weight=0.0),
        Trial(
            "two bent poses, and any other",
            (call(*weights(BENT)), call(*weights(REACHING))),
            hidden.gravities,
            "any poses",
        ),
    ),
    withheld=("labkit.Model.gravity", "labkit.Model.bias", "pinocchio"),
    hints=(
        "The potential energy is the sum of m·9.81·height over the links. How does the height of one "
        "centre of mass change when joint k turns a little?",
        "The slope of the height of a centre along the joints is a row of its Jacobian: the third, "
        "that of z.",
        "Of each body's Jacobian only the row of its height matters. Weigh each by what the "
        "body weighs, in newtons, and add.",
    ),
    wrong=(
        Wrong(
            "the sign reversed",
            "These are the torques of gravity itself. The question asks for those that hold "
            "against it: positive where raising the arm takes work.",
            mistakes.falls_faster,
            "g(q) = +∂V/∂q is on the same side of the equation as the motors' torque.",
        ),
        Wrong(
            "all the weight at the hand",
            "With all the weight at the hand the arm seems heavier than it is. Every link has its "
            "own centre of mass and its own Jacobian: use each.",
            mistakes.all_at_the_hand,
            "Each link pulls where it is.",
        ),
        Wrong(
            "only the hand has weight",
            "Gravity pulls at the hand alone here, as in the report's formula. The hand has less than "
            "a twentieth of the arm's mass: sum over all links.",
            mistakes.only_the_hand,
            "Sum over all links.",
        ),
        Wrong(
            "a tenth of the torques",
            "The torques are ten times too small. The report has 0.981 where 9.81 belongs.",
            mistakes.a_tenth,
            "Print a number with its unit, and ask whether you believe it.",
        ),
        Wrong(
            "masses for weights",
            "These numbers are in kg m, not in N m. The weight of a mass is the mass times 9.81 "
            "m/s².",
            mistakes.without_g,
            "Write the unit of every factor.",
        ),
        Wrong(
            "the row of x",
            "Weight pulls along z: the third row of each Jacobian, J[2]. Yours is the row of x.",
            mistakes.Weights(lambda J: J[0]),
            "Only height has potential energy.",
        ),
        Wrong(
            "the row of y",
            "Weight pulls along z: the third row of each Jacobian, J[2]. Yours is the row of y.",
            mistakes.Weights(lambda J: J[1]),
            "Only height has potential energy.",
        ),
        Wrong(
            "an angular row, the first",
            "Rows 3 to 5 are angular. Weight does work along z, row J[2].",
            mistakes.Weights(lambda J: J[3]),
            "Rows (v, w).",
        ),
        Wrong(
            "the angular row of z",
            "Row 5 is the turning about z. Weight does work along z, row J[2].",
            mistakes.Weights(lambda J: J[5]),
            "Rows (v, w).",
        ),
        Wrong(
            "all rows added",
            "Weight pulls along z only: take the row J[2], not the sum of rows.",
            mistakes.Weights(lambda J: J.sum(axis=0)),
            "Only height has potential energy.",
        ),
        Wrong(
            "the length of the velocity",
            "How fast a link moves does not matter to its weight, only how fast it rises: the row J[2].",
            mistakes.Weights(lambda J: np.linalg.norm(J[:3], axis=0)),
            "Only height has potential energy.",
        ),
        Wrong(
            "the whole mass on every link",
            "Each link carries its own mass at its own centre of mass.",
            mistakes.Weights(mass=lambda m, masses: float(np.sum(masses))),
            "Every link has its own weight.",
        ),
        Wrong(
            "the mean mass for every link",
            "Each link has its own mass.",
            mistakes.Weights(mass=lambda m, masses: float(np.mean(masses))),
            "Every link has its own weight.",
        ),
        Wrong(
            "the masses left out",
            "A weight is m g: the masses are missing.",
            mistakes.Weights(mass=lambda m, masses: 1.0),
            "Every link has its own weight.",
        ),
        Wrong(
            "the masses squared",
            "A weight is m g, with the mass once.",
            mistakes.Weights(mass=lambda m, masses: m**2),
            "Every link has its own weight.",
        ),
        Wrong(
            "9.8 for g",
            "g is 9.81 m/s² here, and yours is 9.8.",
            mistakes.Weights(g=9.8),
            "Constants: take them from where they are defined.",
        ),
        Wrong(
            "10 for g",
            "g is 9.81 m/s² here, and yours is 10.",
            mistakes.Weights(g=10.0),
            "Constants: take them from where they are defined.",
        ),
        Wrong(
            "g squared",
            "A weight is m g, with g once.",
            mistakes.Weights(g=9.81**2),
            "A weight is m g.",
        ),
        Wrong(
            "the sizes added",
            "Weights on both sides of an axis balance each other: keep the signs.",
            mistakes.Weights(size=True),
            "A torque has a sign.",
        ),
        Wrong(
            "without the last link",
            "The sum ends one link too early.",
            mistakes.Weights(last=-1),
            "Every link has its own weight.",
        ),
    ),
    variants=(variants.gravity_as_forces, variants.gravity_by_dot),
)

SPIN = np.array([0.5, -0.4, 0.3, 0.6, -0.8, 0.7, 1.0])

CORIOLIS = Problem(
    name="coriolis",
    points=5,
    core=False,
    outcomes=("model",),
    asks="Give the Coriolis matrix C of shape (7, 7), made of Christoffel's symbols, at the angles "
    "`q` and speeds `dq`, from a function `mass_matrix(q)`; take its slopes by central differences.",
    answer=answers.coriolis,
    judge=Close(rtol=1e-4, atol=2e-5),
    trials=(
        Trial(
            "one joint turns: the shoulder",
            (call(MODEL.mass_matrix, BENT, 0.5 * np.eye(7)[0]),),
            weight=0.0,
        ),
        Trial(
            "all joints turn",
            (call(MODEL.mass_matrix, BENT, SPIN), call(MODEL.mass_matrix, REACHING, SPIN)),
            hidden.coriolis_any,
            "any states",
        ),
    ),
    withheld=("labkit.Model.coriolis", "labkit.Model.bias", "pinocchio"),
    hints=(
        "First make the table of slopes dM[i, j, k] = ∂M_ij/∂q_k: shift one joint at a time by a "
        "small h, both ways. Then it is bookkeeping.",
        "C_ij = ½ Σ_k (∂M_ij/∂q_k + ∂M_ik/∂q_j - ∂M_jk/∂q_i) dq_k. Three loops will do; h = 1e-5 rad "
        "is a good step.",
        "Make one array of three indices with all slopes of M. The three terms are that array "
        "with its indices exchanged; add them with their signs, and let the speeds take away "
        "the last index.",
    ),
    wrong=(
        Wrong(
            "half of the rate of M",
            "C = Ṁ/2 passes the skew test, because Ṁ - 2C is then zero, and zero is skew. But C "
            "dq is not the Coriolis torque. Use Christoffel's symbols.",
            mistakes.half_the_rate,
            "A test that zero passes says little.",
        ),
        Wrong(
            "the right torque, but not skew",
            "C dq is right, but there are many such matrices, and for this one Ṁ - 2C is not "
            "skew, on which the proofs of notebook 04 rely. Use Christoffel's symbols.",
            mistakes.not_skew,
            "C dq does not fix C; Christoffel's choice does.",
        ),
        Wrong(
            "twice the right matrix",
            "Either Christoffel's one half is missing, or a difference between q + h and q - h was "
            "divided by h: it spans 2h.",
            mistakes.without_the_half,
            "The half comes from the kinetic energy; the 2h from a difference taken both ways.",
        ),
        Wrong(
            "the minus on the wrong term",
            "This is the transpose of C. Either the entry is stored in C[j, i], or the minus is on the "
            "wrong term: it belongs to the slope along the row's own joint, ∂M_jk/∂q_i.",
            mistakes.signs_mixed,
            "The minus is the slope of the kinetic energy along q_i.",
        ),
        Wrong(
            "all three slopes added",
            "The third slope, ∂M_jk/∂q_i, must be subtracted: it comes from the kinetic energy, "
            "on the other side of Lagrange's equation.",
            mistakes.all_signs_plus,
            "The signs are +, +, -.",
        ),
        Wrong(
            "two of three slopes: the second is missing",
            "Christoffel's symbol has three slopes: of M_ij along k, of M_ik along j, minus that of M_jk along i. The second is missing.",
            mistakes.Slopes((1.0, 0.0, -1.0)),
            "Three slopes, one minus.",
        ),
        Wrong(
            "two of three slopes: the third is missing",
            "Christoffel's symbol has three slopes: of M_ij along k, of M_ik along j, minus that of M_jk along i. The third is missing.",
            mistakes.Slopes((1.0, 1.0, 0.0)),
            "Three slopes, one minus.",
        ),
        Wrong(
            "two of three slopes: the first is missing",
            "Christoffel's symbol has three slopes: of M_ij along k, of M_ik along j, minus that of M_jk along i. The first is missing.",
            mistakes.Slopes((0.0, 1.0, -1.0)),
            "Three slopes, one minus.",
        ),
        Wrong(
            "both others with a minus",
            "Only the slope of M_jk along i has a minus.",
            mistakes.Slopes((1.0, -1.0, -1.0)),
            "Three slopes, one minus.",
        ),
        Wrong(
            "times the speed of j",
            "The symbol of i, j, k is multiplied with the speed of k, and summed over k.",
            mistakes.Slopes(along="j"),
            "Sum over the index that is not left.",
        ),
        Wrong(
            "times the speed of i",
            "The symbol of i, j, k is multiplied with the speed of k, and summed over k.",
            mistakes.Slopes(along="i"),
            "Sum over the index that is not left.",
        ),
        Wrong(
            "steps too large",
            "The differences are taken over steps so large that M is not a straight line there. Take about 1e-5 rad.",
            mistakes.Slopes(h=0.3),
            "A difference is a slope for small steps only.",
        ),
    ),
    variants=(variants.coriolis_in_loops,),
)

POWER_BALANCE = Problem(
    name="power_balance",
    points=3,
    core=False,
    outcomes=("model",),
    asks="Give, at each tick of a run, the rate of change of the arm's total energy minus the power of its "
    "motors, in W and of shape (N,). The remainder is power from other sources. `np.gradient(x, log.t)` "
    "takes slopes.",
    answer=answers.power_balance,
    judge=Close(rtol=0.0, atol=1.5),
    trials=(
        Trial(
            "a slow lift with friction, and a hand that helps",
            (call(lift(0.35, 0.8, 400.0, 10.0), ROUGH_MODEL),),
            hidden.gentle_lifts,
            "other lifts, helped and hindered",
            weight=0.0,
        ),
        Trial(
            "a quick lift, cut by the torque limits",
            (call(lift(0.55, 0.42, 400.0), ROUGH_MODEL),),
            hidden.lifts,
            "quick lifts",
        ),
    ),
    hints=(
        "Energy comes in two kinds. What the motors do per second is torque times speed, summed over "
        "the joints. Which torque does the log hold, and which is only wished for?",
        "At each row: model.kinetic_energy(q, dq) + model.potential_energy(q). Its slope over time is "
        "np.gradient(energy, log.t).",
        "Two curves over time: how fast the energy grows (numpy has a gradient that knows the "
        "times), and what the motors give, joint by joint, summed.",
    ),
    wrong=(
        Wrong(
            "kinetic energy only",
            "Lifting the arm stores energy too. Add the potential energy; without it the balance "
            "shows the power that gravity takes.",
            mistakes.kinetic_only,
            "Energy is T + V.",
        ),
        Wrong(
            "the torque that was commanded",
            "`log.command` is what the controller asked for. Where a limit cut it, the motors "
            "gave less: use `log.tau`.",
            mistakes.commanded_torque,
            "What was commanded is not what was done.",
        ),
        Wrong(
            "the sign reversed",
            "Take the growth of the energy minus the power of the motors: friction then shows as "
            "a loss, below zero, and a helping hand as a gain.",
            mistakes.motors_minus_energy,
            "Say in words what a positive number means.",
        ),
        Wrong(
            "a slope that is not per second",
            "The energy seems hardly to grow, so its slope is not per second. Give np.gradient the "
            "log's times as well, in seconds.",
            mistakes.steps_not_seconds,
            "J and W differ by seconds.",
        ),
        Wrong(
            "the absolute value",
            "An absolute value hides whether energy came or went. Keep the sign: friction is a "
            "loss, below zero, and a helping hand a gain.",
            mistakes.absolute,
            "Say in words what a positive number means.",
        ),
        Wrong(
            "the power of friction instead",
            "This is the power of the plant's friction alone; a helping hand is missing in it. "
            "Subtract the motors' power from the growth of the energy.",
            mistakes.friction_alone,
            "A balance finds what nobody told you of.",
        ),
        Wrong(
            "the power of only some joints",
            "The wrist turns too, and its motor works: sum torque times speed over all seven joints.",
            mistakes.without_the_last_joint,
            "Count the motors.",
        ),
        Wrong(
            "the motors' power added",
            "What grows in the arm without what the motors put in: their power is taken off.",
            mistakes.Balance(power=-1.0),
            "Energy balance: growth minus what comes in.",
        ),
        Wrong(
            "the motors' power left out",
            "This is the growth of the energy alone. Take off what the motors put in.",
            mistakes.Balance(power=0.0),
            "Energy balance: growth minus what comes in.",
        ),
        Wrong(
            "potential energy only",
            "The moving links have kinetic energy as well.",
            mistakes.Balance(kinetic=0.0),
            "Energy has two parts.",
        ),
        Wrong(
            "the Lagrangian",
            "Kinetic minus potential energy is the Lagrangian. The energy is their sum.",
            mistakes.Balance(potential=-1.0),
            "T - U is for equations of motion, T + U is conserved.",
        ),
        Wrong(
            "the energy, not its growth",
            "The energy itself is not a power. Take its slope over time, np.gradient(energy, log.t).",
            mistakes.Balance(growth=lambda energy, t: energy),
            "Units: joules are not watts.",
        ),
        Wrong(
            "torque times angle",
            "A power is torque times speed: log.dq, not log.q.",
            mistakes.Balance(by=lambda log: log.q),
            "Units: joules are not watts.",
        ),
        Wrong(
            "half of the kinetic energy",
            "model.kinetic_energy holds its one half already.",
            mistakes.Balance(kinetic=0.5),
            "Energy has two parts.",
        ),
        Wrong(
            "the mean of the joints' powers",
            "The powers of the joints are added, not averaged.",
            mistakes.mean_power,
            "Power adds up.",
        ),
        Wrong(
            "the powers without their signs",
            "A motor that brakes takes energy out: its power is below zero. Keep the signs.",
            mistakes.sizes_of_power,
            "A power has a sign.",
        ),
        Wrong(
            "energies, not powers",
            "This is the growth since the start without the work since the start. The rate at each time is asked for.",
            mistakes.as_energies,
            "Units: joules are not watts.",
        ),
    ),
    variants=(variants.balance_in_loops, variants.balance_from_theory),
)

PROBLEMS = (JACOBIAN, MASS_MATRIX, GRAVITY, CORIOLIS, POWER_BALANCE)
