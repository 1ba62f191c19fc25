"""The questions of notebook 03."""

from __future__ import annotations

import numpy as np

from labkit.course import Close
from labkit.course.authoring.problem import Problem, Trial, Wrong, call

from . import answers, hidden, mistakes, variants
from .hidden import (
    MODEL,
    READY,
    STRETCHED,
    joint_run,
    pose_run,
    pose_sample,
    sample,
    state,
)

MOVING = 0.1 * np.arange(1, 8)
ASKEW = READY + np.array([0.2, -0.1, 0.3, 0.2, -0.4, 0.3, 0.5])
"""A tilted gripper; one straight down has R = R^T, which would hide a transposed R."""
COMMAND = Close(rtol=1e-6, atol=1e-8)

JOINT_VELOCITY_PD = Problem(
    name="joint_velocity_pd",
    points=5,
    outcomes=("control",),
    asks="Return a command of joint speeds that follows a joint trajectory: the target's own "
    "speed, plus `kp` times the error of the angles, plus `kd` times the error of the "
    "speeds. Gains are numbers or arrays of shape (7,).",
    answer=answers.joint_velocity_pd,
    judge=COMMAND,
    trials=(
        Trial(
            "at rest, 0.1 rad from a target at rest",
            (call(state(READY), sample(READY + 0.1 * np.eye(7)[1]), kp=4.0, kd=0.0),),
            hidden.joint_offsets,
            weight=0.0,
        ),
        Trial(
            "moving, with no error of the angles: kd brakes",
            (call(state(READY, 0.2 * np.ones(7)), sample(READY), kp=4.0, kd=0.5),),
            hidden.joint_speeds,
            "other speeds",
        ),
        Trial(
            "a target that moves, and a gain for each joint",
            (
                call(state(READY), sample(READY, MOVING, 2.0 * MOVING), kp=4.0, kd=0.5),
                call(
                    state(READY + 0.1, MOVING),
                    sample(READY, 0.3 - MOVING),
                    kp=8.0 - 5.0 * MOVING,
                    kd=MOVING,
                ),
            ),
            hidden.joint_targets,
            "any states, targets and gains",
            weight=2.5,
        ),
        Trial(
            "closed loop: the arm starts with an error, reaches the path and stays on it",
            (
                joint_run(
                    0.1 * np.array([1, -1, 1, 1, -1, 1, 1]),
                    0.6 * np.array([1, 0.4, 0, -0.7, 0, 0.3, 0.5]),
                ),
            ),
            hidden.joint_runs,
            "other starts and paths",
            weight=1.5,
        ),
    ),
    hints=(
        "Suppose there is no error at all: what should the arm do then? And in which direction "
        "should an error push the arm? (The error is always target minus actual.)",
        "e = target.position - state.q and de = target.velocity - state.dq. The first term of "
        "the command is the target's speed, not the measured one.",
        "Add three terms of seven numbers each; one of them needs no gain. Return a command, not "
        "an array.",
    ),
    terms=mistakes.joint_terms,
    wrong=(
        Wrong(
            "a correction of the measured speed",
            "You add the corrections to the measured speed, so they accumulate two hundred times "
            "a second: without kd nothing damps the arm, and it swings. Add them to the target's "
            "speed. The report's equation 17 has this mistake.",
            mistakes.adds_to_the_measured,
            "Adding to the measured speed puts one more integrator in the loop.",
        ),
        Wrong(
            "no feed-forward",
            "The arm follows, but stays behind by the target's speed divided by kp. The target "
            "includes its own speed: add this speed to the command.",
            mistakes.no_feedforward,
            "Feedback waits for an error; feed-forward does not.",
        ),
        Wrong(
            "damping of the motion, not of its error",
            "Your kd brakes the arm even where the target moves at the same speed. Multiply kd "
            "by the error of the speeds.",
            mistakes.damps_the_motion,
            "D acts on the derivative of the error.",
        ),
        Wrong(
            "kp and kd swapped",
            "Multiply the error of the angles by kp, and the error of the speeds by kd.",
            mistakes.gains_swapped,
            "The units show it: kp is in 1/s, kd has none.",
        ),
        Wrong(
            "the error of the angles reversed",
            "Your error of the angles has the wrong sign, so kp pushes the arm away. Use target "
            "minus actual.",
            mistakes.JointLaw(e=-1.0),
            "Every error has the same sign convention: target minus actual.",
        ),
        Wrong(
            "the error of the speeds reversed",
            "Your error of the speeds has the wrong sign, so kd accelerates what it should "
            "brake. Use target minus actual.",
            mistakes.JointLaw(de=-1.0),
            "Every error has the same sign convention: target minus actual.",
        ),
        Wrong(
            "kd left out",
            "The error of the speeds is missing. Add kd times this error.",
            mistakes.JointLaw(de=0.0),
            "Test each gain by itself.",
        ),
        Wrong(
            "kp on the feed-forward too",
            "Multiply only the error by the gain. The target's speed is commanded as it is.",
            mistakes.Fed(lambda ff, e, de, kp, kd, *_: kp * (ff + e) + kd * de),
            "A gain with a unit changes the unit of what it multiplies.",
        ),
    ),
    variants=(variants.joint_in_a_loop, variants.joint_with_matrices),
)

DECAY_RATE = Problem(
    name="decay_rate",
    points=2,
    outcomes=("control",),
    asks="A joint moves at exactly the commanded speed, and its target stands still. Return the "
    "rate, in 1/s, at which the error decays under the gains `kp` and `kd`: the r in exp(-r "
    "t).",
    answer=answers.decay_rate,
    judge=Close(rtol=1e-6, atol=1e-9),
    trials=(
        Trial("kd = 0", (call(4.0, 0.0),), hidden.rates_without_d, weight=0.0),
        Trial(
            "kd = 1 and kd = 3",
            (call(4.0, 1.0), call(4.0, 3.0), call(2.0, 0.5)),
            hidden.rates,
            "other gains",
        ),
    ),
    hints=(
        "The target stands still, so the joint's speed is minus the derivative of the error. "
        "Insert the command for the speed.",
        "dq = kp e + kd (0 - dq), and dq = -de/dt. The speed is on both sides: collect its terms.",
        "The joint moves at the commanded speed: insert dq = u into the law, for a target at "
        "rest, and collect all terms with de/dt on one side.",
    ),
    wrong=(
        Wrong(
            "kd making the decay faster",
            "kd does not make the decay faster: here it slows the decay. The speed is on both "
            "sides: (1 + kd) de/dt = -kp e.",
            mistakes.faster_with_d,
            "In a velocity loop, D brakes the very speed that reduces the error.",
        ),
        Wrong(
            "kd left out",
            "kp alone is right only for kd = 0. The measured speed is the commanded one, so the "
            "command depends on itself through kd: solve for the speed.",
            mistakes.without_d,
            "Write down the whole loop.",
        ),
        Wrong(
            "a rate with a minus",
            "exp(-r t) already contains the minus, so the rate of an error that decays is "
            "positive.",
            mistakes.minus_the_rate,
            "A pole and a decay rate differ by their sign.",
        ),
        Wrong(
            "kd with the wrong sign",
            "The target is at rest, so the error of the speeds is minus the joint's speed, and "
            "kd brakes. At kd = 1 your rate divides by zero.",
            mistakes.d_turned_round,
            "Write down de/dt before you collect its terms.",
        ),
        Wrong(
            "the gains added",
            "kp is in 1/s and kd has no unit, so they cannot be added. Write down the equation of the "
            "error.",
            mistakes.gains_added,
            "Quantities of different units cannot be added.",
        ),
        Wrong(
            "the fraction upside down",
            "The rate grows with kp, so kp belongs in the numerator.",
            mistakes.Rate(lambda kp, kd: (1.0 + kd) / kp),
            "Check the formula at kd = 0: the rate must be kp.",
        ),
        Wrong(
            "kd subtracted from kp",
            "kd is not subtracted from kp; it belongs to the factor of de/dt: (1 + kd) de/dt = "
            "-kp e.",
            mistakes.Rate(lambda kp, kd: kp - kd),
            "Collect the terms of de/dt and of e.",
        ),
    ),
    variants=(variants.rate_from_the_root,),
)

DAMPED_INVERSE = Problem(
    name="damped_inverse",
    points=3,
    outcomes=(
        "control",
        "model",
    ),
    asks="Return the damped pseudo-inverse, of shape (7, 6), of a Jacobian of shape (6, 7). For "
    "a twist V, this matrix finds the joint speeds with the least |V - J dq|² + `damping` "
    "|dq|².",
    answer=answers.damped_inverse,
    judge=COMMAND,
    trials=(
        Trial(
            "no damping, far from singularities",
            (call(MODEL.tip_jacobian(READY), 0.0),),
            hidden.inverses_plain,
            weight=0.0,
        ),
        Trial(
            "damping 0.0025 with the elbow almost straight",
            (call(MODEL.tip_jacobian(STRETCHED), 0.0025),),
            hidden.inverses_stretched,
        ),
        Trial(
            "any pose and damping",
            (call(MODEL.tip_jacobian(READY), 0.01),),
            hidden.inverses,
            "any poses and dampings",
        ),
    ),
    hints=(
        "Without damping, the answer is the pseudo-inverse Jᵀ (J Jᵀ)⁻¹, whose entries become "
        "huge where J Jᵀ has an eigenvalue near zero. What could you add to J Jᵀ so that no "
        "eigenvalue is near zero?",
        "Add damping times the identity of size 6 to J Jᵀ before you invert it.",
        "Set the gradient to zero and solve. The solution has two forms, one with the inverse of "
        "a 7 by 7 matrix and one with that of a 6 by 6 matrix. Both are right, and in both the "
        "damping belongs on the diagonal.",
    ),
    wrong=(
        Wrong(
            "no damping",
            "This is the plain pseudo-inverse, np.linalg.pinv(J): when the elbow is nearly "
            "straight, it commands speeds that no joint can reach. Add the damping times the "
            "identity to J Jᵀ. As a cut-off for small singular values the damping changes "
            "nothing here.",
            mistakes.undamped,
            "Where no exact inverse exists, a formula for it does not help.",
        ),
        Wrong(
            "the damping squared",
            "`damping` is already the factor of |dq|², which many books write as λ². Do not "
            "square it.",
            mistakes.damping_squared,
            "Is it λ or λ²? Look at what is minimised.",
        ),
        Wrong(
            "the damping added to every number",
            "numpy adds a number to every entry of a matrix. The damping belongs only on the "
            "diagonal: multiply it by an identity matrix.",
            mistakes.damping_everywhere,
            "λ is not λ I.",
        ),
        Wrong(
            "the damping subtracted",
            "If you subtract the damping, J Jᵀ can become singular. Add it.",
            mistakes.damping_taken_off,
            "Damping pushes eigenvalues away from zero.",
        ),
        Wrong(
            "the square root of the damping",
            "`damping` is the factor of |dq|² itself. Do not take its root.",
            mistakes.damping_rooted,
            "Is it λ or λ²? Look at what is minimised.",
        ),
        Wrong(
            "s where s² belongs",
            "Each singular value s must become s/(s² + damping). Yours becomes 1/(s + damping), "
            "which damps less where s is small.",
            mistakes.BySingularValues(lambda s, d: 1.0 / (s + d)),
            "The damping has the unit of s².",
        ),
        Wrong(
            "the pseudo-inverse made smaller",
            "Damping should reduce only the directions that are nearly singular. Dividing "
            "everything by 1 + damping makes all directions slower.",
            mistakes.BySingularValues(lambda s, d: 1.0 / (s * (1.0 + d))),
            "Damping acts where s is small.",
        ),
        Wrong(
            "twice the damping",
            "Add the damping only once.",
            mistakes.BySingularValues(lambda s, d: s / (s**2 + 2.0 * d)),
            "In the gradient of a sum of squares, both factors 2 cancel.",
        ),
    ),
    variants=(variants.inverse_the_other_way, variants.inverse_by_svd),
)

CENTIMETRES = (0.03, -0.02, 0.01)
GAINS = np.array([2.0, 3.0, 4.0, 5.0, 4.0, 3.0])

WORKSPACE_VELOCITY_PD = Problem(
    name="workspace_velocity_pd",
    points=6,
    outcomes=("control",),
    asks="Return a command of joint speeds that makes the tip follow a target of poses. The tip "
    "should move with the target's twist plus `kp` times the error of the tip's position "
    "and orientation, both in world axes. `kp` is a number or an array of shape (6,). Use "
    "the damped inverse of the tip Jacobian.",
    answer=answers.workspace_velocity_pd,
    judge=COMMAND,
    trials=(
        Trial(
            "at rest, a few centimetres off",
            (call(state(READY), pose_sample(READY, CENTIMETRES), MODEL, kp=2.0, damping=0.0),),
            hidden.pose_shifts,
            weight=0.0,
        ),
        Trial(
            "roll, pitch and yaw offsets, one by one, and a turn of 120 degrees",
            tuple(
                call(state(READY), pose_sample(READY, turn=turn), MODEL, kp=2.0, damping=0.003)
                for turn in (*0.2 * np.eye(3), np.radians(120.0) * np.eye(3)[1])
            ),
            hidden.pose_turns,
            "turns at other poses, small ones and large ones",
            weight=1.0,
        ),
        Trial(
            "a target that moves, with the tip on the target and off it",
            (
                call(
                    state(READY),
                    pose_sample(READY, twist=(0.1, 0.0, -0.05, 0.0, 0.2, 0.3)),
                    MODEL,
                    kp=2.0,
                    damping=0.003,
                ),
                call(
                    state(ASKEW, MOVING),
                    pose_sample(
                        ASKEW, CENTIMETRES, (0.3, -0.2, 0.25), (0.1, 0.0, -0.05, 0.0, 0.2, 0.3)
                    ),
                    MODEL,
                    kp=GAINS,
                    damping=0.003,
                ),
            ),
            hidden.pose_moves,
            "other twists and errors",
            weight=3.0,
        ),
        Trial(
            "the elbow almost straight",
            (
                call(
                    state(STRETCHED, MOVING),
                    pose_sample(STRETCHED, CENTIMETRES),
                    MODEL,
                    kp=2.0,
                    damping=0.0025,
                ),
            ),
            hidden.pose_stretched,
            "other stretched poses",
            weight=0.5,
        ),
        Trial(
            "closed loop: the tip follows a circle from a shifted and tilted start",
            (pose_run(CENTIMETRES, (0.15, 0.1, -0.1)),),
            hidden.pose_runs,
            "other starts",
            weight=1.5,
        ),
    ),
    withheld=("labkit.Model.pose_error",),
    hints=(
        "First say how the tip should move: six numbers, linear and angular. Only then ask "
        "which joint speeds produce this motion.",
        "e has six numbers: target.pose[:3, 3] minus the tip's position, then the turn "
        "lk.se3.orientation_error(R_wd, R_wt) of notebook 00. V = target.twist + kp * e.",
        "Begin with the six numbers of the twist that the tip should have; its feedback is in "
        "world axes, in the order (v, w). Then find the joint speeds that produce this twist, "
        "with the damped inverse of this Jacobian.",
    ),
    wrong=(
        Wrong(
            "roll, pitch and yaw subtracted",
            "With the gripper down and a yaw beyond 90 degrees, as in the ready pose, the "
            "difference of the angles drives roll and pitch in the wrong direction, and it jumps "
            "at 180 degrees. Use the logarithm, as in notebook 00.",
            mistakes.euler_error,
            "Orientations are compared by a product.",
        ),
        Wrong(
            "the turn in the tool's axes",
            "The tip Jacobian is in world axes, but your error is in the tool's axes. With the "
            "gripper down, two components then have the wrong sign. Use R_wd R_wtᵀ.",
            mistakes.turn_in_tool_axes,
            "The error and the Jacobian must be in the same axes.",
        ),
        Wrong(
            "the body Jacobian with an error in world axes",
            "The body Jacobian gives the twist in the tool's axes, and with the gripper down the "
            "tool's z axis points down. Use tip_jacobian, which is in world axes like the error.",
            mistakes.body_jacobian,
            "There are three Jacobians; use the one that is in the axes of your error.",
        ),
        Wrong(
            "the damping ignored",
            "This is the plain pseudo-inverse: when the elbow is straight, it commands speeds "
            "that no joint can reach. Use the damped inverse.",
            mistakes.damping_ignored,
            "Damping accepts a small error of the tip in exchange for speeds that the joints can "
            "reach.",
        ),
        Wrong(
            "the sine of the turn",
            "Half the cross products of the axes, or half of R - Rᵀ, is the axis times the sine "
            "of the angle: nearly right for small turns, too weak at 90 degrees, zero at 180. "
            "Take the logarithm, which gives the angle.",
            mistakes.WorkspaceLaw(turn=mistakes.sine_of_the_turn),
            "sin x is x only for small x.",
        ),
        Wrong(
            "the turn before the position",
            "In this course a twist is (v, w), so the error of the position comes first, then "
            "the turn. The error and the Jacobian must have the same order.",
            mistakes.TwistLaw(turn_first=True),
            "The rows are (v, w), linear part first.",
        ),
        Wrong(
            "kp on the feed-forward too",
            "Multiply only the error by the gain. The target's twist is commanded as it is.",
            mistakes.TwistLaw(on_all=True),
            "A gain with a unit changes the unit of what it multiplies.",
        ),
    ),
    terms=mistakes.workspace_terms,
    variants=(variants.WorkspacePD(), variants.workspace_in_tool_axes),
)

ORTHONORMAL = np.eye(7)[[0, 2, 3, 4, 5, 6]]

POSTURE_VELOCITY = Problem(
    name="posture_velocity",
    points=4,
    core=False,
    outcomes=(
        "control",
        "model",
    ),
    asks="The joints should turn at `dq_wish` if they can. Return the part of this wish, of "
    "shape (7,), that does not move the tip at all and is as close to the wish as possible.",
    answer=answers.posture_velocity,
    judge=Close(rtol=1e-6, atol=1e-8),
    trials=(
        Trial(
            "a Jacobian with orthonormal rows",
            (call(ORTHONORMAL, np.array([0.1, 0.5, 0.0, -0.2, 0.0, 0.3, 0.0])),),
            hidden.postures_orthonormal,
            weight=0.0,
        ),
        Trial(
            "the arm at its ready pose",
            (
                call(MODEL.tip_jacobian(READY), np.eye(7)[2]),
                call(MODEL.tip_jacobian(READY + 0.2), -MOVING),
            ),
            hidden.postures,
            "other poses and wishes",
        ),
    ),
    hints=(
        "If the joints turned at dq_wish, the tip would move with J dq_wish. Subtract only the "
        "joint speeds that cause this motion, and nothing else.",
        "The smallest joint speeds that give a twist V are pinv(J) V. Here V = J dq_wish.",
        "First ask how the wish would move the tip. Then find the smallest joint speeds that "
        "move the tip in just this manner, and subtract them from the wish.",
    ),
    wrong=(
        Wrong(
            "the transpose in place of the inverse",
            "I - Jᵀ J is a projector only if the rows of J are orthonormal, as in the first "
            "test. The rows of the arm's Jacobian are not, so the tip moves: use the "
            "pseudo-inverse of J.",
            mistakes.transpose_projector,
            "Test a projector: applied twice it does the same.",
        ),
        Wrong(
            "a damped inverse in the projector",
            "A damped inverse does not undo J exactly, so the tip drifts. Use the plain "
            "pseudo-inverse here.",
            mistakes.damped_projector,
            "The two inverses serve two purposes.",
        ),
        Wrong(
            "the part that moves the tip",
            "This is the part of the wish that moves the tip. Subtract it from the wish.",
            mistakes.the_rest,
            "Wish = part that moves the tip + free part.",
        ),
        Wrong(
            "the tip may turn",
            "You kept only the tip's position still, with the three linear rows. The tip must "
            "not turn either: use all six rows.",
            mistakes.place_alone,
            "The motion of the tip has six numbers.",
        ),
        Wrong(
            "a column of Vᵀ for its last row",
            "np.linalg.svd returns Vᵀ: the null vector is its last row, not its last column.",
            mistakes.a_column_of_v,
            "Test a null vector: J n = 0.",
        ),
    ),
    variants=(
        variants.posture_by_projector,
        variants.posture_by_null_vector,
        variants.posture_by_least_squares,
    ),
)

PROBLEMS = (
    JOINT_VELOCITY_PD,
    DECAY_RATE,
    DAMPED_INVERSE,
    WORKSPACE_VELOCITY_PD,
    POSTURE_VELOCITY,
)
