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
    asks="Command joint speeds that follow a joint trajectory: the target's own speed, plus `kp` "
    "times the error of the angles, plus `kd` times the error of the speeds. Gains are numbers or "
    "arrays of shape (7,).",
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
            "a target that moves, a gain for each joint",
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
            weight=2.0,
        ),
        Trial(
            "closed loop: it catches up from a wrong start and stays on",
            (
                joint_run(
                    0.1 * np.array([1, -1, 1, 1, -1, 1, 1]),
                    0.6 * np.array([1, 0.4, 0, -0.7, 0, 0.3, 0.5]),
                ),
            ),
            hidden.joint_runs,
            "other starts and paths",
        ),
    ),
    hints=(
        "Suppose there is no error at all: what should the arm do then? And which way should an "
        "error push? (Target minus actual, always.)",
        "e = target.position - state.q and de = target.velocity - state.dq. The command starts from "
        "the target's speed, not from the measured one.",
        "Three terms, each seven numbers. One needs no gain. The result is a command, not an "
        "array.",
    ),
    wrong=(
        Wrong(
            "the error with the other sign",
            "Actual minus target pushes the arm away from its target; take target minus actual. "
            "With feed-forward and a start on the path, the arm would hide this for a while.",
            mistakes.pushes_away,
            "Start from an offset; feed-forward hides broken feedback.",
        ),
        Wrong(
            "a correction of the measured speed",
            "The corrections are added to the measured speed, so they pile up two hundred times a "
            "second: without kd the arm swings, and nothing damps it. Add them to the target's speed. The report's "
            "equation 17 has this mistake.",
            mistakes.adds_to_the_measured,
            "An integrator too many.",
        ),
        Wrong(
            "no feed-forward",
            "The arm follows, but stays behind by the target's speed over kp. The target says how "
            "fast it moves: add its speed to the command.",
            mistakes.no_feedforward,
            "Feedback waits for an error; feed-forward does not.",
        ),
        Wrong(
            "damping of the motion, not of its error",
            "kd brakes the arm even where the target moves equally fast. Multiply kd with the "
            "error of the speeds.",
            mistakes.damps_the_motion,
            "D acts on the derivative of the error.",
        ),
        Wrong(
            "kp and kd swapped",
            "kp multiplies the error of the angles, and kd that of the speeds.",
            mistakes.gains_swapped,
            "Units tell: kp is in 1/s, kd has none.",
        ),
        Wrong(
            "the error of the angles reversed",
            "The error of the angles has the wrong sign, so kp pushes the arm away. Take target "
            "minus actual.",
            mistakes.JointLaw(e=-1.0),
            "One sign for every error.",
        ),
        Wrong(
            "the error of the speeds reversed",
            "The error of the speeds has the wrong sign, so kd drives what it should brake. Take "
            "target minus actual.",
            mistakes.JointLaw(de=-1.0),
            "One sign for every error.",
        ),
        Wrong(
            "kd left out",
            "The error of the speeds is missing. Add kd times this error.",
            mistakes.JointLaw(de=0.0),
            "Try every gain by itself.",
        ),
        Wrong(
            "the target's acceleration added",
            "The command is a speed, and an acceleration has another unit. Leave the target's "
            "acceleration out.",
            mistakes.JointLaw(ddq=1.0),
            "Only like units may be added.",
        ),
        Wrong(
            "kp on the feed-forward too",
            "The gain belongs to the error. The target's speed is commanded as it is.",
            mistakes.Fed(lambda ff, e, de, kp, kd, *_: kp * (ff + e) + kd * de),
            "A gain with a unit turns a speed into something else.",
        ),
        Wrong(
            "the feed-forward twice",
            "The target's speed is added once as feed-forward, apart from the one inside the error of the speeds.",
            mistakes.Fed(lambda ff, e, de, kp, kd, *_: 2.0 * ff + kp * e + kd * de),
            "Write each term once.",
        ),
        Wrong(
            "the feed-forward taken off",
            "The target's speed is what the joint should do without any error: it is added.",
            mistakes.Fed(lambda ff, e, de, kp, kd, *_: -ff + kp * e + kd * de),
            "With no error, the command is the target's speed.",
        ),
        Wrong(
            "helps the motion",
            "kd times the arm's own speed, with a plus, drives it on. The error of the speeds is target minus actual.",
            mistakes.Fed(lambda ff, e, de, kp, kd, state, target: ff + kp * e + kd * state.dq),
            "One convention for the whole course: target minus actual.",
        ),
        Wrong(
            "the speeds added",
            "The error of the speeds is target minus actual; yours is their sum.",
            mistakes.Fed(
                lambda ff, e, de, kp, kd, state, target: ff + kp * e + kd * (ff + state.dq)
            ),
            "One convention for the whole course: target minus actual.",
        ),
        Wrong(
            "a position in a speed",
            "The target's position is not a speed: the feed-forward is target.velocity.",
            mistakes.Fed(
                lambda ff, e, de, kp, kd, state, target: target.position + kp * e + kd * de
            ),
            "Units: rad is not rad/s.",
        ),
        Wrong(
            "the gains multiplied",
            "kd multiplies the error of the speeds by itself, without kp.",
            mistakes.Fed(lambda ff, e, de, kp, kd, *_: ff + kp * e + kp * kd * de),
            "Say which form of PD you write: kp e + kd de.",
        ),
        Wrong(
            "half of the feed-forward",
            "The target's speed is commanded as it is, without a half.",
            mistakes.Fed(lambda ff, e, de, kp, kd, *_: 0.5 * ff + kp * e + kd * de),
            "With no error, the command is the target's speed.",
        ),
        Wrong(
            "the gain squared",
            "kp comes once.",
            mistakes.Fed(lambda ff, e, de, kp, kd, *_: ff + kp**2 * e + kd * de),
            "Units: kp is in 1/s.",
        ),
        Wrong(
            "a scalar product for the gains",
            "np.dot and @ add the seven joints to one number. * multiplies each joint by its own gain.",
            mistakes.Fed(lambda ff, e, de, kp, kd, *_: ff + np.dot(kp * np.ones(7), e) + kd * de),
            "Gains go joint by joint.",
        ),
        Wrong(
            "the error of the speeds once more",
            "The error of the speeds is added without its gain as well.",
            mistakes.Fed(lambda ff, e, de, kp, kd, *_: ff + de + kp * e + kd * de),
            "Write each term once.",
        ),
    ),
    variants=(variants.joint_in_a_loop, variants.joint_with_matrices),
)

DECAY_RATE = Problem(
    name="decay_rate",
    points=2,
    outcomes=("control",),
    asks="A joint moves at exactly the speed that is commanded, and its target stands still. Give the "
    "rate, in 1/s, at which the error dies away under the gains `kp` and `kd`: the r in exp(-r t).",
    answer=answers.decay_rate,
    judge=Close(rtol=1e-6, atol=1e-9),
    trials=(
        Trial("no D", (call(4.0, 0.0),), hidden.rates_without_d, weight=0.0),
        Trial(
            "kd = 1 and kd = 3",
            (call(4.0, 1.0), call(4.0, 3.0), call(2.0, 0.5)),
            hidden.rates,
            "other gains",
        ),
    ),
    hints=(
        "The target stands still, so the speed of the joint is minus the rate of the error. Put the "
        "command into that.",
        "dq = kp e + kd (0 - dq), and dq = -de/dt. The speed is on both sides: collect it.",
        "The joint moves at the commanded speed: put dq = u into the law, with a target at "
        "rest, and collect all terms with de/dt on one side.",
    ),
    wrong=(
        Wrong(
            "kd making the decay faster",
            "It is the other way round: here kd slows the decay. The speed is on both sides: "
            "(1 + kd) de/dt = -kp e.",
            mistakes.faster_with_d,
            "In a velocity loop D brakes the very speed that closes the error.",
        ),
        Wrong(
            "the frequency of a mass on a spring",
            "√kp is the frequency of a second-order system. Here the speed itself is commanded: "
            "write the equation of the error, which is of first order.",
            mistakes.second_order,
            "Count the integrators between command and angle.",
        ),
        Wrong(
            "kd left out",
            "kp alone is right only for kd = 0. The measured speed is the commanded one, so kd "
            "feeds the command back into itself: solve for the speed.",
            mistakes.without_d,
            "Write down the whole loop.",
        ),
        Wrong(
            "a rate with a minus",
            "exp(-r t) already contains the minus, so the rate of an error that dies away is "
            "positive.",
            mistakes.minus_the_rate,
            "A pole and a decay rate differ by their sign.",
        ),
        Wrong(
            "kd with the wrong sign",
            "The target is at rest, so the error of the speed is minus the speed, and kd brakes; "
            "at kd = 1 your rate divides by zero.",
            mistakes.d_turned_round,
            "Write down de/dt before you collect it.",
        ),
        Wrong(
            "the gains added",
            "kp is in 1/s and kd has no unit, so they cannot be added. Write down the equation of the "
            "error.",
            mistakes.gains_added,
            "Units forbid sums.",
        ),
        Wrong(
            "the part that is left after one second",
            "This is exp(-r) itself. Give the r in it.",
            mistakes.what_is_left,
            "Read what is asked: a rate, in 1/s.",
        ),
        Wrong(
            "turned over",
            "The rate grows with kp: kp is in the numerator.",
            mistakes.Rate(lambda kp, kd: (1.0 + kd) / kp),
            "Put kd = 0: what is left is kp.",
        ),
        Wrong(
            "the gains multiplied",
            "Put kd = 0: the rate is then kp, and a product would be 0.",
            mistakes.Rate(lambda kp, kd: kp * kd),
            "Put kd = 0: what is left is kp.",
        ),
        Wrong(
            "kd over kp",
            "Put kd = 0: the rate is then kp, and kd/kp would be 0.",
            mistakes.Rate(lambda kp, kd: kd / kp),
            "Put kd = 0: what is left is kp.",
        ),
        Wrong(
            "a damping ratio",
            "kd/(2 √kp) is the damping ratio of a mass on a spring. Here nothing has mass: the equation is of first order.",
            mistakes.Rate(lambda kp, kd: kd / (2.0 * np.sqrt(kp))),
            "Count the derivatives: one derivative, one rate.",
        ),
        Wrong(
            "a one too many above",
            "Collect what stands before de/dt, 1 + kd, and what stands before e, which is kp alone.",
            mistakes.Rate(lambda kp, kd: (1.0 + kp) / (1.0 + kd)),
            "Collect the terms of de/dt and of e.",
        ),
        Wrong(
            "the root of it",
            "A root belongs to an equation of second order. de/dt = -r e has r itself.",
            mistakes.Rate(lambda kp, kd: np.sqrt(kp / (1.0 + kd))),
            "Count the derivatives: one derivative, one rate.",
        ),
        Wrong(
            "the bracket squared",
            "1 + kd comes once.",
            mistakes.Rate(lambda kp, kd: kp / (1.0 + kd) ** 2),
            "Collect the terms of de/dt and of e.",
        ),
        Wrong(
            "D taken off",
            "D does not act against P as a difference; it stands before de/dt: (1 + kd) de/dt = -kp e.",
            mistakes.Rate(lambda kp, kd: kp - kd),
            "Collect the terms of de/dt and of e.",
        ),
        Wrong(
            "the one forgotten",
            "Before de/dt stand 1 and kd. With kd alone the rate would be infinite without D; at "
            "kd = 0 yours divides by zero.",
            mistakes.Rate(lambda kp, kd: kp / kd),
            "Put kd = 0: what is left is kp.",
        ),
        Wrong(
            "the gains for the whole",
            "kp is in 1/s and kd has no unit, so they cannot be added. Collect what stands before de/dt: 1 + kd.",
            mistakes.Rate(lambda kp, kd: kp / (kp + kd)),
            "Units: a rate is in 1/s.",
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
    asks="Give the damped pseudo-inverse of a Jacobian of shape (6, 7), of shape (7, 6): the matrix "
    "that finds, for a twist V, the joint speeds with the least |V - J dq|² + `damping` |dq|².",
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
        "Without damping it is the pseudo-inverse Jᵀ (J Jᵀ)⁻¹, which explodes where J Jᵀ has an "
        "eigenvalue near zero. What could you add to J Jᵀ so that it has none?",
        "Add damping times the identity of size 6 to J Jᵀ before you invert it.",
        "Set the gradient to zero and solve. Of the two forms, one inverts a 7 by 7 matrix "
        "and one a 6 by 6; both are right, and the damping belongs on the diagonal.",
    ),
    wrong=(
        Wrong(
            "the transpose instead of the inverse",
            "Jᵀ turns forces at the tip into joint torques; it does not undo J. Use the damped "
            "pseudo-inverse.",
            mistakes.transposed,
            "Jᵀ maps forces, J⁺ maps speeds.",
        ),
        Wrong(
            "no damping",
            "This gives the plain pseudo-inverse, np.linalg.pinv(J), which asks for speeds that no "
            "joint has when the elbow is nearly straight. Add the damping times the "
            "identity to J Jᵀ; as a cut-off for small singular values it changes nothing here.",
            mistakes.undamped,
            "Where no exact inverse exists, its formula does not help.",
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
            "numpy adds a number to every entry of a matrix. The damping belongs on the diagonal "
            "alone: multiply it by an identity matrix.",
            mistakes.damping_everywhere,
            "λ is not λ I.",
        ),
        Wrong(
            "the damping subtracted",
            "With a minus the damping can make J Jᵀ singular. Add it.",
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
            "the inverse forgotten",
            "J Jᵀ + damping I is multiplied where it should be inverted.",
            mistakes.no_inverse,
            "Test an inverse by multiplying.",
        ),
        Wrong(
            "s forgotten above",
            "Each singular value becomes s/(s² + damping). Yours is 1/(s² + damping).",
            mistakes.BySingularValues(lambda s, d: 1.0 / (s**2 + d)),
            "Put the damping to 0: 1/s must remain.",
        ),
        Wrong(
            "s where s² belongs",
            "Each singular value becomes s/(s² + damping). Yours is 1/(s + damping): that damps less where s is small.",
            mistakes.BySingularValues(lambda s, d: 1.0 / (s + d)),
            "Units: a damping is added to s².",
        ),
        Wrong(
            "the pseudo-inverse made smaller",
            "Damping makes only what is nearly singular smaller. Dividing everything by 1 + damping slows all directions down.",
            mistakes.BySingularValues(lambda s, d: 1.0 / (s * (1.0 + d))),
            "Damping acts where s is small.",
        ),
        Wrong(
            "twice the damping",
            "The damping is added once.",
            mistakes.BySingularValues(lambda s, d: s / (s**2 + 2.0 * d)),
            "From the gradient of a sum of squares both twos drop out.",
        ),
        Wrong(
            "half of the damping",
            "The twos of the gradient drop out on both sides: the damping is added whole.",
            mistakes.BySingularValues(lambda s, d: s / (s**2 + 0.5 * d)),
            "From the gradient of a sum of squares both twos drop out.",
        ),
        Wrong(
            "a transpose, made smaller",
            "This is the transpose with a factor. An inverse has s/(s² + damping) for each singular value.",
            mistakes.BySingularValues(lambda s, d: s / (1.0 + d)),
            "A transpose is not an inverse.",
        ),
        Wrong(
            "the damping in the place of J Jᵀ",
            "The damping is added to J Jᵀ before the inverse, and not multiplied or used alone.",
            mistakes.BySingularValues(lambda s, d: d / s),
            "Put the damping to 0: 1/s must remain.",
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
    asks="Command joint speeds that make the tip follow a target of poses: the tip should move with "
    "the target's twist plus `kp` times its error of position and orientation, both in world axes. "
    "`kp` is a number or an array of shape (6,). Use the damped inverse of the tip Jacobian.",
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
            weight=2.0,
        ),
        Trial(
            "a target that moves, on it and off it",
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
            weight=2.0,
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
        ),
        Trial(
            "closed loop: from a shifted and tilted start after a circle",
            (pose_run(CENTIMETRES, (0.15, 0.1, -0.1)),),
            hidden.pose_runs,
            "other starts",
            weight=2.0,
        ),
    ),
    withheld=("labkit.Model.pose_error",),
    hints=(
        "First say how the *tip* should move: six numbers, linear and angular. Only then ask which "
        "joint speeds do that.",
        "e has six numbers: target.pose[:3, 3] minus the tip's place, then the turn "
        "lk.se3.orientation_error(R_wd, R_wt) of notebook 00. V = target.twist + kp * e.",
        "Work from the outside in: the twist that you want, six numbers, its feedback in "
        "world axes in the order (v, w); then the joint speeds that give it, with the damped "
        "inverse of this Jacobian.",
    ),
    wrong=(
        Wrong(
            "roll, pitch and yaw subtracted",
            "With the gripper down and a yaw beyond 90 degrees, as in the ready pose, their difference "
            "drives roll and pitch the wrong way, and it jumps at 180 degrees. Use the logarithm, as in notebook 00.",
            mistakes.euler_error,
            "Orientations are compared by a product.",
        ),
        Wrong(
            "the turn in the tool's axes",
            "The tip Jacobian is in world axes, and this error is in the tool's. With the gripper "
            "down, two components then have the wrong sign. Use R_wd R_wtᵀ.",
            mistakes.turn_in_tool_axes,
            "Error and Jacobian must speak of the same axes.",
        ),
        Wrong(
            "the body Jacobian with an error in world axes",
            "The body Jacobian gives the twist in the tool's axes, so with the gripper down z is "
            "upside down. Use tip_jacobian, in world axes like the error.",
            mistakes.body_jacobian,
            "Three Jacobians exist; use the one of your axes.",
        ),
        Wrong(
            "the orientation left to itself",
            "The last three numbers of the error are zero, so the hand keeps any tilt. Fill them "
            "with orientation_error; several teams left them out because their orientation error was wrong.",
            mistakes.position_only,
            "A gain of zero hides a wrong sign.",
        ),
        Wrong(
            "no feed-forward",
            "The target's twist is missing, so the tip stays behind by about the target's speed "
            "over kp. What is added to the correction is target.twist itself, not target.dtwist.",
            mistakes.no_twist,
            "Feedback waits for an error; feed-forward does not.",
        ),
        Wrong(
            "an error of the twist for the feed-forward",
            "The measured twist, J q̇, is subtracted from the target's, so in steady motion the "
            "tip is told to stand still. Command target.twist as it is; this law has no D.",
            mistakes.Measured(lambda J_inv, V, e, J, dq: J_inv @ (V - J @ dq + e)),
            "A difference of speeds is feedback, and needs a gain.",
        ),
        Wrong(
            "a D without a gain",
            "The error of the twist, target.twist - J q̇, is added with the factor 1, which halves "
            "how fast the error dies away. This law has no D: leave it out.",
            mistakes.Measured(lambda J_inv, V, e, J, dq: J_inv @ (2.0 * V - J @ dq + e)),
            "In a velocity loop D brakes the very speed that closes the error.",
        ),
        Wrong(
            "the measured speed for the feed-forward",
            "The correction is added to the measured joint speeds, so it piles up at every tick. "
            "The tip should move with the target's twist, not with the speed it has already.",
            mistakes.Measured(lambda J_inv, V, e, J, dq: dq + J_inv @ e),
            "An integrator too many.",
        ),
        Wrong(
            "the measured speed added",
            "state.dq is added to the command, so the command piles up at every tick. The "
            "target's twist already says how fast to move.",
            mistakes.Measured(lambda J_inv, V, e, J, dq: dq + J_inv @ (V + e)),
            "An integrator too many.",
        ),
        Wrong(
            "the Jacobian of the ready pose",
            "The Jacobian is taken at the ready pose, but it changes with the angles: take it at "
            "state.q in every call.",
            mistakes.jacobian_of_ready,
            "A Jacobian belongs to one pose.",
        ),
        Wrong(
            "the damping ignored",
            "This is the plain pseudo-inverse, which asks for speeds that no joint has when the "
            "elbow is straight. Use the damped inverse.",
            mistakes.damping_ignored,
            "Damping trades a little of the tip's error for possible speeds.",
        ),
        Wrong(
            "the error of position reversed",
            "The error of the position has the wrong sign, so the tip moves away from its target. "
            "Take target minus actual.",
            mistakes.WorkspaceLaw(place=-1.0),
            "One sign for every error.",
        ),
        Wrong(
            "the turn reversed",
            "This is the turn from the target to the tip. The target comes first: "
            "orientation_error(R_wd, R_wt), and R_wd is on the left of the product.",
            mistakes.WorkspaceLaw(turn=mistakes.turned_back),
            "Say from where to where a rotation turns.",
        ),
        Wrong(
            "the turn reversed, in the tool's axes",
            "R_wdᵀ R_wt turns from the target to the tip, and its components are along the "
            "target's axes. Take the turn to the target, in the world's axes: R_wd R_wtᵀ.",
            mistakes.WorkspaceLaw(turn=mistakes.turned_back_in_tool_axes),
            "Frames that cancel: R_wd R_tw is a turn in world axes.",
        ),
        Wrong(
            "position and turn both reversed",
            "The feedback has the wrong sign in all six numbers. The error is target minus actual, "
            "and kp times the error is added to the target's twist.",
            mistakes.WorkspaceLaw(place=-1.0, turn=mistakes.turned_back),
            "One sign for every error.",
        ),
        Wrong(
            "logarithms subtracted",
            "The difference of two rotation vectors is a rotation vector only if both turn about the "
            "same axis. First the product of the rotations, then its logarithm.",
            mistakes.WorkspaceLaw(turn=mistakes.logarithms_subtracted),
            "Orientations are compared by a product.",
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
            "the arcsine of the turn",
            "The sine cannot tell 120 degrees from 60, so its arcsine is wrong beyond 90 degrees. "
            "Use the logarithm, which gives the angle up to 180.",
            mistakes.WorkspaceLaw(turn=mistakes.arcsine_of_the_turn),
            "sin x is the same for x and 180° - x.",
        ),
        Wrong(
            "the transpose for the inverse",
            "Jᵀ turns forces into torques. To get joint speeds from a twist, use the damped "
            "inverse.",
            mistakes.by_the_transpose,
            "Jᵀ maps forces, J⁺ maps speeds.",
        ),
        Wrong(
            "the error in the tool's axes",
            "Both parts of the error are in the tool's axes, while the twist and the tip Jacobian "
            "are in the world's. Turn the error into world axes.",
            mistakes.InToolAxes(body=False),
            "Error and Jacobian must speak of the same axes.",
        ),
        Wrong(
            "everything in the tool's axes but the target's twist",
            "Error and Jacobian are in the tool's axes, but the target's twist is in the world's. "
            "Use world axes for all three.",
            mistakes.InToolAxes(body=True),
            "Add only vectors of the same axes.",
        ),
        Wrong(
            "the damping squared",
            "`damping` is already the factor of |dq|², as in damped_inverse. Do not square it.",
            mistakes.WorkspaceLaw(power=2.0),
            "Is it λ or λ²? Look at what is minimised.",
        ),
        Wrong(
            "the error of position in the tool's axes",
            "The place's error is in world axes already. Turned into the tool's axes it does not fit the Jacobian.",
            mistakes.TwistLaw(tool=True),
            "Error and Jacobian in the same axes.",
        ),
        Wrong(
            "the turn before the place",
            "A twist is (v, w) in this course: place first, then turn. Error and Jacobian must have the same order.",
            mistakes.TwistLaw(turn_first=True),
            "Rows (v, w).",
        ),
        Wrong(
            "kp on the feed-forward too",
            "The gain belongs to the error. The target's twist is commanded as it is.",
            mistakes.TwistLaw(on_all=True),
            "A gain with a unit turns a speed into something else.",
        ),
        Wrong(
            "the feed-forward taken off",
            "The target's twist is what the tip should do without any error: it is added.",
            mistakes.TwistLaw(feed=(-1.0, -1.0)),
            "With no error, the command is the target's twist.",
        ),
        Wrong(
            "the feed-forward twice",
            "The target's twist comes once.",
            mistakes.TwistLaw(feed=(2.0, 2.0)),
            "With no error, the command is the target's twist.",
        ),
        Wrong(
            "half of the feed-forward: turning alone",
            "The target's twist has six numbers. Yours uses the angular velocity alone.",
            mistakes.TwistLaw(feed=(0.0, 1.0)),
            "A twist is (v, w).",
        ),
        Wrong(
            "the inverse forgotten",
            "J Jᵀ + damping I is multiplied where it should be inverted.",
            mistakes.TwistLaw(inverse=mistakes.no_inverse),
            "Test an inverse by multiplying.",
        ),
        Wrong(
            "the gain squared",
            "kp comes once.",
            mistakes.TwistLaw(gain=2.0),
            "Units: kp is in 1/s.",
        ),
        Wrong(
            "no gain",
            "The error is added without kp.",
            mistakes.TwistLaw(gain=0.0),
            "Units: an error is in m, a twist in m/s.",
        ),
        Wrong(
            "twice the quaternion's vector",
            "2 sin(θ/2) times the axis is close to the turn for small angles only. The angle itself is asked for.",
            mistakes.TwistLaw(turn=mistakes.twice_the_quaternion),
            "sin x and x agree only for small x.",
        ),
        Wrong(
            "the matrices subtracted",
            "R_wd - R_wt is not a rotation, and its skew part is not the turn between them.",
            mistakes.TwistLaw(turn=mistakes.matrices_subtracted),
            "Orientations are compared by a product.",
        ),
        Wrong(
            "Euler angles of the turn",
            "Roll, pitch and yaw of the right rotation are not a rotation vector: read it with lk.se3.rotation_log.",
            mistakes.TwistLaw(turn=mistakes.euler_of_the_turn),
            "A rotation vector is angle times axis.",
        ),
        Wrong(
            "the twist in the tool's axes",
            "target.twist is in world axes already, as the Jacobian is.",
            mistakes.TwistLaw(twist_in_tool=True),
            "Error and Jacobian in the same axes.",
        ),
    ),
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
    asks="The joints would like to turn at `dq_wish`. Give the part of that wish, of shape (7,), that "
    "does not move the tip at all, as near to the wish as can be.",
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
        "Let the wish run: the tip would move with J dq_wish. Take away just the joint speeds that "
        "make that motion, and nothing else.",
        "The smallest joint speeds that give a twist V are pinv(J) V. Here V = J dq_wish.",
        "First ask how the wish would move the tip. Then find the smallest joint speeds that "
        "move the tip in just that way, and take them off the wish.",
    ),
    wrong=(
        Wrong(
            "the transpose for the inverse",
            "I - Jᵀ J is a projector only if the rows of J are orthonormal, as in the first test. "
            "The arm's are not, and the tip moves: use the pseudo-inverse of J.",
            mistakes.transpose_projector,
            "Test a projector: applied twice it does the same.",
        ),
        Wrong(
            "a damped inverse in the projector",
            "A damped inverse does not undo J exactly, so the tip drifts. Use the plain "
            "pseudo-inverse here.",
            mistakes.damped_projector,
            "Two inverses for two purposes.",
        ),
        Wrong(
            "the part that the tip feels",
            "This is the part of the wish that the tip does feel. Subtract it from the wish.",
            mistakes.the_rest,
            "Wish = felt part + free part.",
        ),
        Wrong(
            "the whole wish",
            "The whole wish moves the tip. Subtract the part of it that the tip feels.",
            mistakes.all_of_it,
            "J times the answer must be zero.",
        ),
        Wrong(
            "the number 1 for the identity matrix",
            "numpy applies the number 1 to every entry. Write np.eye(7) for the identity matrix.",
            mistakes.one_for_the_identity,
            "1 is not I.",
        ),
        Wrong(
            "no motion at all",
            "The tip does not feel an arm at rest, but the joints then ignore the wish. Keep as "
            "much of the wish as the tip allows.",
            mistakes.no_motion,
            "Two conditions: not felt, and as near as can be.",
        ),
        Wrong(
            "the answer scaled to length one",
            "The direction is right. Its length is part of the answer: do not divide by it.",
            mistakes.length_one,
            "A projection shortens; it does not normalise.",
        ),
        Wrong(
            "the free part with the other sign",
            "Subtract the part that the tip feels from the wish, not the wish from that part.",
            mistakes.minus_the_free_part,
            "Wish = felt part + free part.",
        ),
        Wrong(
            "the tip may turn",
            "Only the three linear rows are held. The tip must not turn either: all six rows.",
            mistakes.place_alone,
            "The tip has six numbers.",
        ),
        Wrong(
            "a column of Vᵀ for its last row",
            "np.linalg.svd gives Vᵀ: the null vector is its last row, not its last column.",
            mistakes.a_column_of_v,
            "Test a null vector: J n = 0.",
        ),
        Wrong(
            "the length for the component",
            "The part of the wish along n is n (n · wish). Yours has the length of the whole wish.",
            mistakes.length_for_component,
            "A projection is never longer than what is projected.",
        ),
        Wrong(
            "two freedoms",
            "Seven joints and six numbers of the tip leave one freedom: one singular vector.",
            mistakes.two_freedoms,
            "Count: n minus rank.",
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
