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
    asks="Return the Jacobian of the tip in world axes, of shape (6, 7): column k contains the "
    "velocity of the tip (the first 3 numbers) and its angular velocity (the last 3) while "
    "joint k alone turns at 1 rad/s.",
    answer=answers.jacobian,
    judge=Close(rtol=1e-8, atol=1e-9),
    trials=(
        Trial(
            "the ready pose: six rows, seven columns, the angular rows last",
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
        "Freeze six joints and turn one. The whole hand then turns about that joint's axis like "
        "a door on its hinge. In which direction, and how fast, does the tip move?",
        "If a joint turns about its axis z, a point at the vector r from the axis moves with z × "
        "r. This vector, the moment arm, goes from the axis to the tip: r = tip - origins[k]. "
        "The angular velocity of the hand is z itself.",
        "Each column has two parts of three numbers: like a door that turns, it has the velocity "
        "of the handle and the angular velocity of the door. Build one column, then put seven "
        "side by side.",
    ),
    wrong=(
        Wrong(
            "the moment arm from the world's origin",
            "Your linear rows are the velocity of the point of the hand that is passing the "
            "world's origin: that is the spatial Jacobian.",
            mistakes.arm_from_the_base,
            cure="Measure the moment arm from the joint to the tip.",
        ),
        Wrong(
            "the cross product reversed",
            "The linear rows have the wrong sign.",
            mistakes.product_reversed,
            cure="Take z × r, not r × z, with r from the joint to the tip.",
        ),
        Wrong(
            "rows (w, v)",
            "Your angular rows come first. In this course a twist is (v, w), with the linear "
            "part first; books differ.",
            mistakes.turns_first,
        ),
        Wrong(
            "every axis through the origin",
            "Your moment arms all begin at the world's origin, as if every axis went through it.",
            mistakes.arm_of_the_tip,
            cure="The moment arm r goes from the joint's axis to the tip: tip minus the joint's "
            "origin.",
        ),
        Wrong(
            "moment arms scaled to length 1",
            "The farther the tip is from the axis, the faster it moves; your moment arms all "
            "have the length 1.",
            mistakes.unit_arms,
            cure="Do not divide the moment arm by its length.",
        ),
    ),
    variants=(variants.jacobian_by_rows, variants.jacobian_by_hat),
)

MASS_MATRIX = Problem(
    name="mass_matrix",
    points=4,
    outcomes=("model",),
    asks="Return the mass matrix M of the arm, of shape (7, 7): the matrix for which ½ dqᵀ M dq "
    "is the arm's kinetic energy, summed over the seven links. Each link both moves and "
    "turns.",
    answer=answers.mass_matrix,
    judge=Close(rtol=1e-8, atol=1e-9),
    trials=(
        Trial(
            "links that are points, without inertia of their own",
            (call(*(0.0 * x if k == 1 else x for k, x in enumerate(bodies(READY)))),),
            hidden.points_of_mass,
            weight=0.0,
        ),
        Trial("a bent elbow", (call(*bodies(BENT)),), hidden.mass_matrices, weight=1.5),
        Trial(
            "any pose",
            (call(*bodies(READY)), call(*bodies(REACHING))),
            hidden.mass_matrices,
            "any poses",
            weight=2.5,
        ),
    ),
    withheld=("labkit.Model.mass_matrix", "labkit.Model.kinetic_energy", "pinocchio"),
    hints=(
        "A link's kinetic energy is ½ m |v|² for the motion of its centre of mass plus ½ wᵀ I w "
        "for its rotation. Both v and w are a Jacobian times dq. Insert that, and collect what "
        "is between dqᵀ and dq.",
        "With J the Jacobian of the centre of mass, v = J[:3] dq and w = J[3:] dq. So the link "
        "adds m J[:3]ᵀ J[:3] + J[3:]ᵀ I J[3:], with I and w in the same axes.",
        "Write the kinetic energy of one link as ½ dqᵀ (...) dq. Both of its parts have a "
        "Jacobian on each side. Between the Jacobians is the mass in one part, and in the other "
        "the inertia, which needs a rotation on both sides to be in world axes.",
    ),
    wrong=(
        Wrong(
            "the inertia left in the link's axes",
            "w is in world axes and the inertia is in the link's axes.",
            mistakes.Kinetic(inertia=lambda I_l, R: I_l),
            cure="Turn the inertia first, with R I Rᵀ.",
        ),
        Wrong(
            "the inertia turned the wrong way",
            "Rᵀ I R turns an inertia from world axes into the link's axes.",
            mistakes.Kinetic(inertia=lambda I_l, R: R.T @ I_l @ R),
            cure="Turn it in the other direction, with R I Rᵀ.",
        ),
        Wrong(
            "links treated as points",
            "The kinetic energy of the links' rotation is missing, so the last joint, which "
            "turns the hand about itself, has almost no inertia.",
            mistakes.Kinetic(inertia=lambda I_l, R: 0.0 * I_l),
            cure="Add the part with the angular velocities.",
        ),
        Wrong(
            "half of the mass matrix",
            "The factor one half belongs to the energy, not to the matrix.",
            mistakes.half_of_it,
            cure="Leave it out.",
        ),
        Wrong(
            "the rows swapped",
            "You multiplied the angular velocity by the mass, and the velocity by the inertia.",
            mistakes.rows_swapped,
            cure="Rows 0 to 2 of each Jacobian are the velocity and go with the mass; rows 3 to "
            "5 go with the inertia.",
        ),
        Wrong(
            "R I without the second R",
            "You multiplied the inertia only on the left.",
            mistakes.Kinetic(inertia=lambda I_l, R: R @ I_l),
            cure="To change the axes of a matrix, multiply it on both sides: R I Rᵀ.",
        ),
        Wrong(
            "the inertia multiplied by the mass",
            "The inertia of a link, in kg m², already includes its mass.",
            mistakes.Kinetic(mass=True),
            cure="Do not multiply it by the mass.",
        ),
        Wrong(
            "rotation alone",
            "The links' centres of mass move as well, and their part of the energy is missing.",
            mistakes.Kinetic(linear=0.0),
            cure="Add m Jᵥᵀ Jᵥ.",
        ),
        Wrong(
            "the last link only",
            "Your result contains only the last link.",
            mistakes.last_link_only,
            cure="Start from zeros and add each link with +=.",
        ),
        Wrong(
            "the diagonal only",
            "Each joint's motion affects the other joints, but beside your diagonal there are "
            "zeros.",
            mistakes.beside_left_out,
            cure="The entries beside the diagonal belong to M.",
        ),
    ),
    variants=(variants.mass_matrix_vectorised, variants.MassMatrix()),
)

GRAVITY = Problem(
    name="gravity",
    points=4,
    outcomes=("model",),
    asks="Return the torques, of shape (7,) and in N m, that hold the arm still where a free body "
    "falls with the acceleration `g_w`.",
    answer=answers.gravity,
    judge=Close(rtol=1e-8, atol=1e-9),
    trials=(
        Trial(
            "the ready pose on a level floor",
            (call(*weights(READY)), call(*weights(BENT))),
            hidden.gravities,
            weight=0.0,
        ),
        Trial(
            "an arm on a wall, and one on a slope on the moon",
            (
                call(*weights(BENT, (-9.81, 0.0, 0.0))),
                call(*weights(REACHING, (0.3, -0.5, -1.5))),
            ),
            hidden.tilted_gravities,
            "any poses, directions and sizes of gravity",
        ),
    ),
    withheld=("labkit.Model.gravity", "labkit.Model.bias", "pinocchio"),
    hints=(
        "What work does it take to turn joint k a little? Each centre of mass moves by a column "
        "of its Jacobian, and its weight is the force m g_w.",
        "The force of gravity on a link is m g_w. A force at a point is felt at the joints by "
        "the transpose of the point's Jacobian.",
        "From each link's Jacobian you need the three linear rows, transposed, times its weight. "
        "Add all links. Which sign holds the arm, and which lets it fall?",
    ),
    wrong=(
        Wrong(
            "the sign reversed",
            "These are the torques of gravity itself; the arm falls twice as fast with them.",
            mistakes.Weights(lambda m, masses, J, g: m * J[:3].T @ g),
            cure="Return the torques that hold the arm against gravity: the opposite sign.",
        ),
        Wrong(
            "9.81 along z, whatever g_w is",
            "Your answer is right only where z points up and a body falls with 9.81 m/s²: it "
            "does not depend on `g_w`.",
            mistakes.Weights(lambda m, masses, J, g: 9.81 * m * J[2]),
            cure="Use all three linear rows: -m J[:3]ᵀ g_w.",
        ),
        Wrong(
            "the z component alone",
            "You used only the z component of `g_w`, but on a wall gravity acts along x or y.",
            mistakes.Weights(lambda m, masses, J, g: -m * J[2] * g[2]),
            cure="Use all three linear rows: -m J[:3]ᵀ g_w.",
        ),
        Wrong(
            "the size of g_w along z",
            "You used the length of `g_w` as if it always pointed down along z.",
            mistakes.Weights(lambda m, masses, J, g: m * J[2] * np.linalg.norm(g)),
            cure="Use all three linear rows: -m J[:3]ᵀ g_w.",
        ),
        Wrong(
            "all the weight at the hand",
            "You put all the weight at the hand, so the arm seems heavier than it is.",
            mistakes.all_at_the_hand,
            cure="Every link has its own centre of mass and its own Jacobian: use each.",
        ),
        Wrong(
            "masses in place of weights",
            "These numbers are in kg m, not in N m.",
            mistakes.Weights(lambda m, masses, J, g: -m * J[:3].T @ g / np.linalg.norm(g)),
            cure="The weight of a mass is the mass times `g_w`, with its size.",
        ),
        Wrong(
            "the angular rows",
            "Rows 3 to 5 are angular, but weight does work where a centre of mass moves.",
            mistakes.Weights(lambda m, masses, J, g: -m * J[3:].T @ g),
            cure="Use the linear rows, J[:3].",
        ),
        Wrong(
            "the masses left out",
            "The masses are missing: each link counts as 1 kg.",
            mistakes.Weights(lambda m, masses, J, g: -J[:3].T @ g),
            cure="A weight is m g: multiply by the masses.",
        ),
        Wrong(
            "without the last link",
            "Your sum ends one link too early.",
            mistakes.Weights(lambda m, masses, J, g: -m * J[:3].T @ g, last=-1),
            cure="Include the last link.",
        ),
    ),
    variants=(variants.gravity_joint_by_joint, variants.gravity_by_einsum),
)

SPIN = np.array([0.5, -0.4, 0.3, 0.6, -0.8, 0.7, 1.0])

CORIOLIS = Problem(
    name="coriolis",
    points=5,
    core=False,
    outcomes=("model",),
    asks="Return the Coriolis matrix C of shape (7, 7), computed from Christoffel's symbols, at "
    "the angles `q` and speeds `dq`. You are given a function `mass_matrix(q)`; find its "
    "slopes by central differences.",
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
        "small h, once up and once down. The rest is choosing the right indices.",
        "C_ij = ½ Σ_k (∂M_ij/∂q_k + ∂M_ik/∂q_j - ∂M_jk/∂q_i) dq_k. You can use three loops; h = "
        "1e-5 rad is a good step.",
        "Make one array with three indices that contains all slopes of M. The three terms are "
        "this array with its indices exchanged. Add them with their signs, and sum over the last "
        "index with the speeds.",
    ),
    wrong=(
        Wrong(
            "half of the rate of M",
            "C = Ṁ/2 passes the skew test, because Ṁ - 2C is then zero, and zero is skew. But C "
            "dq is then not the Coriolis torque.",
            mistakes.Slopes((1.0, 0.0, 0.0)),
            cure="Use Christoffel's symbols.",
        ),
        Wrong(
            "the right torque, but not skew",
            "C dq is right, but many matrices give this product, and for yours Ṁ - 2C is not "
            "skew. The proofs of notebook 04 need it to be skew.",
            mistakes.Slopes((2.0, 0.0, -1.0)),
            cure="Use Christoffel's symbols.",
        ),
        Wrong(
            "twice the right matrix",
            "Either the factor in front of Christoffel's symbols is missing, or you divided a "
            "difference between q + h and q - h by h.",
            mistakes.Slopes((2.0, 2.0, -2.0)),
            cure="The factor is 1/2, and the difference spans 2h.",
        ),
        Wrong(
            "the transpose of C",
            "This is the transpose of C. Either you stored the entry in C[j, i], or the minus is "
            "on the wrong term.",
            mistakes.Slopes((1.0, -1.0, 1.0)),
            cure="The minus belongs to the slope along the row's own joint, ∂M_jk/∂q_i.",
        ),
        Wrong(
            "all three slopes added",
            "You added all three slopes, but one of them comes from the kinetic energy, on the "
            "other side of Lagrange's equation.",
            mistakes.Slopes((1.0, 1.0, 1.0)),
            cure="Subtract the third slope, ∂M_jk/∂q_i.",
        ),
        Wrong(
            "two of three slopes: the second is missing",
            "Christoffel's symbol has three slopes, and the second is missing.",
            mistakes.Slopes((1.0, 0.0, -1.0)),
            cure="They are those of M_ij along k, of M_ik along j, minus that of M_jk along i.",
        ),
        Wrong(
            "two of three slopes: the third is missing",
            "Christoffel's symbol has three slopes, and the third is missing.",
            mistakes.Slopes((1.0, 1.0, 0.0)),
            cure="They are those of M_ij along k, of M_ik along j, minus that of M_jk along i.",
        ),
        Wrong(
            "multiplied by the speed of j",
            "You multiplied the symbol of i, j, k by the speed of joint j.",
            mistakes.Slopes(along="j"),
            cure="Multiply it by the speed of joint k, and sum over k.",
        ),
    ),
    variants=(variants.coriolis_in_loops,),
)

POWER_BALANCE = Problem(
    name="power_balance",
    points=3,
    core=False,
    outcomes=("model",),
    asks="Return, at each tick of a run, the rate of change of the arm's total energy minus the "
    "power of its motors, in W and of shape (N,). This difference is the power from other "
    "sources. `np.gradient(x, log.t)` computes slopes.",
    answer=answers.power_balance,
    judge=Close(rtol=0.0, atol=1.5),
    trials=(
        Trial(
            "a slow lift with friction and a helping hand",
            (call(lift(0.35, 0.8, 400.0, 10.0), ROUGH_MODEL),),
            hidden.gentle_lifts,
            "other lifts, helped and hindered",
            weight=0.0,
        ),
        Trial(
            "a quick lift during which the torque limits act",
            (call(lift(0.55, 0.42, 400.0), ROUGH_MODEL),),
            hidden.lifts,
            "quick lifts",
        ),
    ),
    hints=(
        "The arm has two kinds of energy. The power of the motors is torque times speed, summed "
        "over the joints. Which torque in the log did the motors give, and which was only "
        "commanded?",
        "For each row of the log, compute model.kinetic_energy(q, dq) + "
        "model.potential_energy(q). Its slope over time is np.gradient(energy, log.t).",
        "Compute two curves over time: how fast the energy grows (numpy has a gradient that uses "
        "the times), and the power of the motors, summed over the joints.",
    ),
    wrong=(
        Wrong(
            "kinetic energy only",
            "Lifting the arm stores energy too; without it the balance includes the power that "
            "gravity takes.",
            mistakes.Balance(potential=0.0),
            cure="Add the potential energy.",
        ),
        Wrong(
            "the torque that was commanded",
            "`log.command` is the torque that the controller commanded. Where a limit reduced "
            "it, the motors gave less.",
            mistakes.commanded_torque,
            cure="Use `log.tau`.",
        ),
        Wrong(
            "the sign reversed",
            "In your balance friction is a gain and a helping hand a loss.",
            mistakes.motors_minus_energy,
            cure="Compute the growth of the energy minus the power of the motors.",
        ),
        Wrong(
            "a slope that is not per second",
            "Your energy hardly seems to grow, so its slope is not per second.",
            mistakes.steps_not_seconds,
            cure="Also pass the log's times, in seconds, to np.gradient.",
        ),
        Wrong(
            "the motors' power added",
            "You added what the motors supply to the growth of the energy, but it explains part "
            "of that growth.",
            mistakes.Balance(power=-1.0),
            cure="Subtract their power.",
        ),
        Wrong(
            "the motors' power left out",
            "This is the growth of the energy alone.",
            mistakes.Balance(power=0.0),
            cure="Subtract the power of the motors.",
        ),
        Wrong(
            "potential energy only",
            "The moving links have kinetic energy as well.",
            mistakes.Balance(kinetic=0.0),
            cure="Add it.",
        ),
        Wrong(
            "the Lagrangian",
            "Kinetic minus potential energy is the Lagrangian.",
            mistakes.Balance(potential=-1.0),
            cure="The energy is their sum.",
        ),
        Wrong(
            "torque times angle",
            "Torque times angle is no power: it is in joules.",
            mistakes.Balance(by=lambda log: log.q),
            cure="Power is torque times speed: use log.dq.",
        ),
        Wrong(
            "the powers without their signs",
            "A motor that brakes removes energy from the arm: its power is below zero.",
            mistakes.sizes_of_power,
            cure="Keep the signs.",
        ),
    ),
    variants=(variants.balance_in_loops, variants.balance_from_theory),
)

PROBLEMS = (
    JACOBIAN,
    MASS_MATRIX,
    GRAVITY,
    CORIOLIS,
    POWER_BALANCE,
)
