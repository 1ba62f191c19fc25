"""The questions of notebook 03."""

from __future__ import annotations

import numpy as np

from labkit.course import PUBLIC_ARMS, Call, Close, Letter, OwnArm
from labkit.course.authoring.problem import Problem, Trial, Wrong, call
from labkit.course.judges import UNSAID

from ..warmup.mistakes import euler_subtracted, in_tool_axes
from . import answers, hidden, mistakes, variants
from .answers import damped_inverse
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
    points=3,
    outcomes=("control",),
    asks="Mend equation 17.",
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
        ),
    ),
    hints=(
        "Suppose there is no error at all, neither of the angles nor of the speeds: what should "
        "the command be then?",
        "Look at run H: the target rests and the arm is beside it. Which terms pull it back, and "
        "which one adds what was commanded before?",
        "Three terms are right in number, and two in content. One term should say how fast the "
        "target moves, not how fast the arm does.",
    ),
    terms=mistakes.joint_terms,
    wrong=(
        Wrong(
            "equation 17 as it stands",
            "Your corrections are added to the speed that the joint already has, so they "
            "accumulate two hundred times a second: without kd nothing damps the arm, and it "
            "swings.",
            mistakes.adds_to_the_measured,
            cure="Put the target's speed in place of `state.dq` in the first term.",
        ),
        Wrong(
            "feed-forward lost in mending",
            "The arm follows, but stays behind by the target's speed divided by kp: nothing in "
            "your command says how fast the target moves.",
            mistakes.no_feedforward,
            cure="Add the target's own speed.",
        ),
        Wrong(
            "the error of the angles reversed",
            "kp pushes the arm away from its target. The sign of this term was right.",
            mistakes.pushes_away,
            cure="Use target minus actual.",
        ),
        Wrong(
            "kp on the feed-forward too",
            "The target's speed is multiplied by kp, which gives it another unit.",
            mistakes.kp_on_all,
            cure="Multiply only the error by the gain.",
        ),
    ),
    variants=(variants.joint_in_a_loop, variants.joint_with_matrices, variants.joint_mended),
)

WHAT_SHOWS = Problem(
    name="what_shows",
    points=2,
    outcomes=("control", "experiment"),
    asks='Look at both figures. Return for "H", "P" and "F" of equation 17 the letter of the term '
    'that made the run go wrong, or "-" if it shows nothing wrong; for "tilt" the run of equation '
    "16 in which the tilt does not die. F is done for you.",
    answer=answers.what_shows,
    judge=Letter("abchpf-"),
    trials=(
        Trial("F, which is done for you", (call("F"),), weight=0.0),
        Trial(
            "H, P and the tilt: letters",
            tuple(Call((run,), expected=UNSAID) for run in ("H", "P", "tilt")),
            weight=0.0,
        ),
        Trial("H, P and the tilt: the right ones", (), hidden.runs_of_the_figure),
    ),
    hints=(
        "A run shows a mistake if its error grows, or does not die. Compare the scales.",
        "In H the target rests. Which of the three terms should then vanish with the error, and "
        "which one need not?",
        "Two runs of 16 start upright. Of 17, one run's error stays a hundred times smaller than "
        "the others': corrections that add up can follow a path, too.",
    ),
)

DECAY_RATE = Problem(
    name="decay_rate",
    points=2,
    outcomes=("control",),
    asks="Return the rate at which the error decays under the gains `kp` and `kd`: the r in "
    "exp(-r t).",
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
            "sides of the equation.",
            mistakes.Rate(lambda kp, kd: kp * (1.0 + kd)),
            cure="(1 + kd) de/dt = -kp e.",
        ),
        Wrong(
            "kd left out",
            "kp alone is right only for kd = 0. The measured speed is the commanded one, so the "
            "command depends on itself through kd.",
            mistakes.Rate(lambda kp, kd: kp),
            cure="Solve for the speed.",
        ),
        Wrong(
            "a rate with a minus",
            "exp(-r t) already contains the minus, and yours is a second one.",
            mistakes.Rate(lambda kp, kd: -kp / (1.0 + kd)),
            cure="The rate of an error that decays is positive.",
        ),
        Wrong(
            "kd with the wrong sign",
            "At kd = 1 your rate divides by zero. The target is at rest, so the error of the "
            "speeds is minus the joint's speed.",
            mistakes.Rate(lambda kp, kd: kp / (1.0 - kd)),
            cure="kd brakes: (1 + kd) de/dt = -kp e.",
        ),
        Wrong(
            "the gains added",
            "kp is in 1/s and kd has no unit, so they cannot be added.",
            mistakes.Rate(lambda kp, kd: kp + kd),
            cure="Write down the equation of the error, and collect the terms with de/dt.",
        ),
        Wrong(
            "the fraction upside down",
            "Your rate falls when kp grows.",
            mistakes.Rate(lambda kp, kd: (1.0 + kd) / kp),
            cure="The rate grows with kp, so kp belongs in the numerator.",
        ),
        Wrong(
            "kd subtracted from kp",
            "kd is not subtracted from kp; it belongs to the factor of de/dt.",
            mistakes.Rate(lambda kp, kd: kp - kd),
            cure="(1 + kd) de/dt = -kp e.",
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
    asks="Return the matrix that finds, for a twist V, the joint speeds with the least |V - J "
    "dq|² + `damping` |dq|².",
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
            "This is the plain pseudo-inverse: when the elbow is nearly straight, it commands "
            "speeds that no joint can reach. (As a cut-off for small singular values the damping "
            "changes nothing here.)",
            mistakes.BySingularValues(lambda s, d: 1.0 / s),
            cure="Add the damping times the identity to J Jᵀ.",
        ),
        Wrong(
            "the damping squared",
            "`damping` is already the factor of |dq|², which many books write as λ².",
            mistakes.BySingularValues(lambda s, d: s / (s**2 + d**2)),
            cure="Do not square it.",
        ),
        Wrong(
            "the damping added to every number",
            "numpy adds a number to every entry of a matrix, but the damping belongs only on the "
            "diagonal.",
            mistakes.damping_everywhere,
            cure="Multiply it by an identity matrix.",
        ),
        Wrong(
            "the damping subtracted",
            "You subtract the damping, so J Jᵀ can become singular.",
            mistakes.BySingularValues(lambda s, d: s / (s**2 - d)),
            cure="Add it.",
        ),
        Wrong(
            "the square root of the damping",
            "`damping` is the factor of |dq|² itself; you took its root.",
            mistakes.BySingularValues(lambda s, d: s / (s**2 + d**0.5)),
            cure="Use it as it is.",
        ),
        Wrong(
            "s where s² belongs",
            "Each singular value s becomes 1/(s + damping) in yours, which damps less where s is "
            "small.",
            mistakes.BySingularValues(lambda s, d: 1.0 / (s + d)),
            cure="It must become s/(s² + damping).",
        ),
        Wrong(
            "the pseudo-inverse made smaller",
            "Damping should reduce only the directions that are nearly singular. Yours makes all "
            "directions slower.",
            mistakes.BySingularValues(lambda s, d: 1.0 / (s * (1.0 + d))),
            cure="Add the damping to J Jᵀ before you invert it.",
        ),
        Wrong(
            "twice the damping",
            "Your damping counts twice.",
            mistakes.BySingularValues(lambda s, d: s / (s**2 + 2.0 * d)),
            cure="In the gradient of a sum of squares both factors 2 cancel: add the damping once.",
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
    asks="Return a command that makes the tip move with the target's twist plus `kp` times its "
    "error of position and orientation, by the damped inverse.",
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
            "at 180 degrees. This is the mistake of equation 16.",
            mistakes.WorkspaceLaw(turn=euler_subtracted),
            cure="Use the logarithm, as in notebook 00.",
        ),
        Wrong(
            "the turn in the tool's axes",
            "The tip Jacobian is in world axes, but your error is in the tool's axes. With the "
            "gripper down, two components then have the wrong sign.",
            mistakes.WorkspaceLaw(turn=in_tool_axes),
            cure="Use R_wd R_wtᵀ.",
        ),
        Wrong(
            "the body Jacobian with an error in world axes",
            "The body Jacobian gives the twist in the tool's axes, and with the gripper down the "
            "tool's z axis points down. Your error is in world axes.",
            mistakes.WorkspaceLaw(in_tool=True),
            cure="Use tip_jacobian.",
        ),
        Wrong(
            "the damping ignored",
            "This is the plain pseudo-inverse: when the elbow is straight, it commands speeds "
            "that no joint can reach.",
            mistakes.WorkspaceLaw(inverse=lambda J, d: damped_inverse(J, 0.0)),
            cure="Use the damped inverse.",
        ),
        Wrong(
            "the sine of the turn",
            "Half the cross products of the axes, or half of R - Rᵀ, is the axis times the sine "
            "of the angle: nearly right for small turns, too weak at 90 degrees, zero at 180.",
            mistakes.WorkspaceLaw(turn=mistakes.sine_of_the_turn),
            cure="Take the logarithm, which gives the angle.",
        ),
        Wrong(
            "the turn before the position",
            "Your error has the turn first. In this course a twist is (v, w), and the error and "
            "the Jacobian must have the same order.",
            mistakes.TwistLaw(turn_first=True),
            cure="The error of the position comes first, then the turn.",
        ),
        Wrong(
            "the transpose for the inverse",
            "Jᵀ does not undo J: the tip moves by J Jᵀ times the twist that you wanted, in other "
            "directions and at other speeds.",
            mistakes.WorkspaceLaw(inverse=lambda J, d: J.T),
            cure="Use the damped inverse.",
        ),
        Wrong(
            "kp on the feed-forward too",
            "The target's twist is multiplied by kp, which gives it another unit.",
            mistakes.TwistLaw(on_all=True),
            cure="Multiply only the error by the gain.",
        ),
    ),
    terms=mistakes.workspace_terms,
    variants=(variants.WorkspacePD(), variants.workspace_in_tool_axes),
)

ORTHONORMAL = np.eye(7)[[0, 2, 3, 4, 5, 6]]

FIND_LAG = Problem(
    name="find_lag",
    points=3,
    outcomes=("experiment",),
    asks="Return the time constant of an arm's motors, in s, within 5 ms.",
    answer=answers.find_lag,
    judge=Close(rtol=0.0, atol=0.005),
    expected=lambda arm: arm.lag,
    trials=(
        Trial("the public arm", (call(PUBLIC_ARMS[0]),), weight=0.0),
        Trial(
            "two more public arms, a quick one and a slow one",
            (call(PUBLIC_ARMS[1]), call(OwnArm(0.5, 1.0, 0.088, 0.06))),
            hidden.other_arms,
            "two arms that you have not seen",
        ),
    ),
    hints=(
        "A joint that follows with the time constant τ has reached 63 % of a step of its speed "
        "after τ. In steady motion at the speed v, its angle is v τ behind.",
        "A controller is a function of (state, target) that returns lk.JointVelocity; let one "
        "joint turn at 0.4 rad/s for a second: log = lk.run(arm, lk.Hold(arm.robot.ready, 1.0), "
        "steps). Use log.t, log.q and log.dq.",
        "Average t - (q(t) - q(0)) / v over the second half of the run.",
    ),
    wrong=(
        Wrong(
            "the time to half of the speed",
            "This is the time to half of the step, which is 0.7 time constants.",
            mistakes.Lag(lambda log: mistakes.reaches(log, 0.5)),
            cure="Wait for 63 %: 1 - 1/e.",
        ),
        Wrong(
            "the time to nearly all of the speed",
            "This is the time until the speed is reached, which is three time constants or more.",
            mistakes.Lag(lambda log: mistakes.reaches(log, 0.95)),
            cure="After one time constant 63 % of the step is reached.",
        ),
        Wrong(
            "the time to nine tenths of the speed",
            "This is the time to 90 % of the step, which is 2.3 time constants.",
            mistakes.Lag(lambda log: mistakes.reaches(log, 0.9)),
            cure="After one time constant 63 % of the step is reached.",
        ),
        Wrong(
            "the angles that the controller measured",
            "Your number is 7 ms too large on every arm: `log.measured` is what the controller "
            "saw, and that is old.",
            mistakes.Lag(lambda log: np.mean(mistakes.behind(log, log.measured.q))),
            cure="Use log.q and log.dq, the true angles and speeds.",
        ),
        Wrong(
            "an angle for a time",
            "This is how far the joint is behind, in rad.",
            mistakes.Lag(lambda log: mistakes.STEP * np.mean(mistakes.behind(log, log.q))),
            cure="Divide it by the speed.",
        ),
        Wrong(
            "milliseconds",
            "This is in ms. The question asks for s.",
            mistakes.Lag(lambda log: 1e3 * np.mean(mistakes.behind(log, log.q))),
        ),
    ),
    variants=(variants.lag_by_63_percent, variants.lag_by_logarithm),
)

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
            "test. The rows of the arm's Jacobian are not, so the tip moves.",
            mistakes.transpose_projector,
            cure="Use the pseudo-inverse of J.",
        ),
        Wrong(
            "a damped inverse in the projector",
            "A damped inverse does not undo J exactly, so the tip drifts.",
            mistakes.damped_projector,
            cure="Use the plain pseudo-inverse here.",
        ),
        Wrong(
            "the part that moves the tip",
            "This is the part of the wish that moves the tip.",
            mistakes.the_rest,
            cure="Subtract it from the wish.",
        ),
        Wrong(
            "the tip may turn",
            "You kept only the tip's position still, with the three linear rows.",
            mistakes.place_alone,
            cure="The tip must not turn either: use all six rows.",
        ),
        Wrong(
            "a column of Vᵀ for its last row",
            "np.linalg.svd returns Vᵀ, so the last column of what it returns is no null vector.",
            mistakes.a_column_of_v,
            cure="The null vector is its last row.",
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
    WHAT_SHOWS,
    WORKSPACE_VELOCITY_PD,
    FIND_LAG,
    POSTURE_VELOCITY,
)
