"""The questions of notebook 00."""

from __future__ import annotations

import numpy as np

import labkit as lk
from labkit.course import Close
from labkit.course.authoring.problem import Problem, Trial, Wrong, call

from . import answers, hidden, mistakes, variants

READY = lk.robot("left").ready
REST = np.zeros(7)


def _state(q: object, dq: object = REST) -> lk.State:
    return lk.State(0.7, np.asarray(q, dtype=float), np.asarray(dq, dtype=float))


def _sample(q: object, dq: object = REST) -> lk.Sample:
    return lk.Sample(np.asarray(q, dtype=float), np.asarray(dq, dtype=float), REST)


JOINT_ERROR = Problem(
    name="joint_error",
    points=2,
    outcomes=("frames",),
    asks="Return the errors of the seven joint angles, target minus actual, in rad, as an array "
    "of shape (7,).",
    answer=answers.joint_error,
    judge=Close(rtol=1e-9, atol=1e-12),
    trials=(
        Trial(
            "one joint 0.1 rad short of its target",
            (call(_sample(READY + 0.1 * np.eye(7)[1]), _state(READY)),),
            weight=0.0,
        ),
        Trial(
            "seven different errors on a moving arm; a wrist that must turn from one stop to the "
            "other",
            (
                call(
                    _sample(READY + 0.01 * np.arange(-3, 4), 0.2 * np.ones(7)),
                    _state(READY, 0.1 * np.ones(7)),
                ),
                call(_sample(2.9 * np.eye(7)[4]), _state(-2.9 * np.eye(7)[4])),
            ),
            hidden.errors,
            "any targets and states",
        ),
    ),
    hints=(
        "Where should the joints be, and where are they? Look at what `target` and `state` hold: "
        "both answers are in their named arrays.",
        "The desired angles are `target.position` and the actual angles are `state.q`, each of "
        "shape (7,).",
        "Combine the two arrays in the order in which the course's definition of an error names "
        "them. Nothing else is needed: no reshape, no sum.",
    ),
    wrong=(
        Wrong(
            "actual minus target",
            "The sign is wrong: a gain times this error drives the arm away from its target.",
            mistakes.actual_minus_target,
            cure="Subtract the actual angles from the target's.",
        ),
        Wrong(
            "a table of 49 numbers",
            "A (7, 1) column minus a (7,) vector is a 7 by 7 table of all differences, because "
            "numpy stretches both without a warning. Keep vectors 1-D.",
            mistakes.a_column,
        ),
        Wrong(
            "the error of the speeds",
            "You subtracted the speeds.",
            mistakes.of_the_speeds,
            cure="The angles are `target.position` and `state.q`.",
        ),
        Wrong(
            "the error wrapped to half a turn",
            "A joint has stops: from -2.9 to 2.9 rad it can only turn back through zero, by 5.8 "
            "rad, because the shorter turn would run into a stop.",
            mistakes.wrapped,
            cure="Do not wrap the error.",
        ),
        Wrong(
            "without its sign",
            "The absolute value of the error does not say in which direction the joint must turn.",
            mistakes.without_its_sign,
            cure="Keep the sign.",
        ),
    ),
    variants=(variants.error_list,),
)

SHIFT = lk.se3.pose(np.eye(3), [0.6, 0.2, 0.1])
AHEAD = lk.se3.pose(np.eye(3), [0.05, 0.02, 0.3])
IN_HAND = lk.se3.pose(lk.se3.rotation([0.2, -0.4, 1.5]), [0.04, 0.01, -0.14])
TILTED = lk.se3.pose([[0, 0, 1], [1, 0, 0], [0, 1, 0]], [0.3, -0.4, 0.5])
SEEN = lk.se3.pose(lk.se3.rotation([0.5, 2.4, -0.3]), [0.05, -0.08, 0.35])

TAG_IN_WORLD = Problem(
    name="tag_in_world",
    points=2,
    outcomes=("frames",),
    asks="Return the tag's pose in the world, `T_wm`, of shape (4, 4): from the tip's pose in the "
    "world, the camera's in the tip's frame and the tag's in the camera's frame.",
    answer=answers.tag_in_world,
    judge=Close(rtol=1e-9, atol=1e-9),
    trials=(
        Trial(
            "a camera exactly at the tip, which sees a tag that is not turned",
            (call(SHIFT, np.eye(4), AHEAD),),
            hidden.chains_of_shifts,
            weight=0.0,
        ),
        Trial(
            "three general poses",
            (call(TILTED, IN_HAND, SEEN), call(SEEN, TILTED, IN_HAND)),
            hidden.chains,
            "any poses",
        ),
    ),
    hints=(
        "Walk from the world to the tag: world, tip, camera, tag. Each step is one of the three "
        "matrices.",
        "Write the subscripts in a row. Where two matrices meet, the letters must be equal.",
        "T_wm begins with w and ends with m. Only one order of w-t, t-c and c-m makes all "
        "neighbours equal. The product of matrices is `@`.",
    ),
    wrong=(
        Wrong(
            "the product in the opposite order",
            "You multiplied from the tag to the world: m meets t, and c meets w. Where two poses "
            "meet, the letters must be equal.",
            mistakes.Chain(lambda wt, tc, cm: cm @ tc @ wt),
            cure="The product is T_wt T_tc T_cm.",
        ),
        Wrong(
            "the camera taken for the tip",
            "T_tc is left out, so the tag is where it would be if the camera were at the tip.",
            mistakes.Chain(lambda wt, tc, cm: wt @ cm),
            cure="Put T_tc between the other two.",
        ),
        Wrong(
            "the tip in the camera's frame",
            "You used the inverse of T_tc: that is the tip seen from the camera.",
            mistakes.Chain(lambda wt, tc, cm: wt @ np.linalg.inv(tc) @ cm),
            cure="Use T_tc itself.",
        ),
        Wrong(
            "the camera seen from the tag",
            "You used the inverse of T_cm: that is the camera's pose in the tag's frame.",
            mistakes.Chain(lambda wt, tc, cm: wt @ tc @ np.linalg.inv(cm)),
            cure="Use T_cm itself.",
        ),
        Wrong(
            "the world seen from the tip",
            "You used the inverse of T_wt: that is the world's pose in the tip's frame.",
            mistakes.Chain(lambda wt, tc, cm: np.linalg.inv(wt) @ tc @ cm),
            cure="Use T_wt itself.",
        ),
        Wrong(
            "entries multiplied, not matrices",
            "`*` multiplies entry by entry.",
            mistakes.Chain(lambda wt, tc, cm: wt * tc * cm),
            cure="The product of matrices is `@`.",
        ),
        Wrong(
            "positions added without turning them",
            "You added the three positions as they are, but each is given in other axes.",
            mistakes.positions_added,
            cure="Let the product of the matrices turn them.",
        ),
        Wrong(
            "the pose of the tag in the tip's frame",
            "This is T_tm, the tag seen from the tip, not from the world.",
            mistakes.Chain(lambda wt, tc, cm: tc @ cm),
            cure="Begin with T_wt.",
        ),
    ),
    variants=(variants.chain_by_parts, variants.chain_as_lists),
)


def _turned(degrees: float, axis: int) -> np.ndarray:
    return lk.se3.rotation(np.radians(degrees) * np.eye(3)[axis])


DOWN = hidden.DOWN
SIDE = lk.se3.rotation([0.0, 0.0, 0.5]) @ DOWN

ORIENTATION_ERROR = Problem(
    name="orientation_error",
    points=4,
    outcomes=("frames",),
    asks="Return the rotation that turns the tip from its actual orientation `R_wt` to the "
    "desired orientation `R_wd`, as a rotation vector in world axes: shape (3,), in rad.",
    answer=answers.orientation_error,
    judge=Close(rtol=1e-5, atol=1e-5),
    trials=(
        Trial(
            "a level tool turned about the vertical by 20 degrees, and a gripper without error",
            (call(_turned(30.0, 2), _turned(10.0, 2)), call(DOWN, DOWN)),
            hidden.turns_about_z,
            "other angles, and none",
            weight=0.0,
        ),
        Trial(
            "gripper down, 5 degrees of roll; then also turned about the vertical, -5 degrees of "
            "roll",
            (call(DOWN, DOWN @ _turned(5.0, 0)), call(SIDE, SIDE @ _turned(-5.0, 0))),
            hidden.rolls,
            "rolls at other yaws",
        ),
        Trial(
            "gripper down and turned about the vertical, 5 degrees of pitch",
            (call(SIDE, SIDE @ _turned(5.0, 1)),),
            hidden.pitches,
            "pitches at other yaws, beyond 90 degrees too",
        ),
        Trial(
            "big turns between tilted orientations, one of them beyond 90 degrees",
            tuple(
                call(lk.se3.rotation(turn) @ _turned(40.0, 0), _turned(40.0, 0))
                for turn in ([0.3, -1.2, 0.9], [-1.5, 1.2, 1.3])
            ),
            hidden.big_turns,
            "turns of up to 160 degrees",
            weight=2.0,
        ),
    ),
    withheld=("labkit.se3.orientation_error", "labkit.se3.pose_error", "labkit.Model.pose_error"),
    hints=(
        "For numbers, the error is target minus actual. For rotations, a product replaces the "
        "subtraction: undo the actual rotation, then apply the desired one. Which product of "
        "R_wd and R_wt does that?",
        "Find the rotation E, in world axes, with E R_wt = R_wd. Solve this for E; the inverse "
        "of a rotation is its transpose. lk.se3.rotation_log then returns the rotation vector of "
        "E.",
        "Solve E R_wt = R_wd for E; the inverse of a rotation is its transpose. To see on which "
        "side the transpose belongs, try two orientations that are both tilted: if one of them "
        "is not turned at all, both products are the same.",
    ),
    wrong=(
        Wrong(
            "roll, pitch and yaw subtracted",
            "Euler angles are not a vector. With the gripper down and a yaw beyond 90 degrees, "
            "as in the ready pose, feedback of roll and pitch tips the hand over, and at ±180 "
            "degrees the angles jump.",
            mistakes.euler_subtracted,
            cure="Take the logarithm of one rotation, the one that takes R_wt to R_wd.",
        ),
        Wrong(
            "the turn in the tool's axes",
            "The turn is right, but its components are along the tool's axes, and the question "
            "asks for world axes.",
            mistakes.in_tool_axes,
            cure="Write the subscripts of your product: which frame does the first letter name? "
            "R_wd R_wtᵀ begins and ends with w.",
        ),
        Wrong(
            "the turn from the desired to the actual orientation",
            "The turn has the wrong direction.",
            mistakes.from_wanted_to_actual,
            cure="It should lead from the actual orientation to the desired one.",
        ),
        Wrong(
            "the sine of the angle",
            "The skew part of a rotation matrix gives the axis times the sine of the angle. For "
            "small angles the difference is too small to notice; at 90 degrees it is large, and "
            "beyond that the sine decreases again.",
            mistakes.sine_of_the_angle,
            cure="Use the angle itself: the logarithm gives it.",
        ),
        Wrong(
            "two rotation vectors subtracted",
            "The difference of two logarithms is not a rotation vector.",
            mistakes.logarithms_subtracted,
            cure="Multiply the rotations first, then take one logarithm.",
        ),
        Wrong(
            "0/0 where there is no turn",
            "The angle divided by its sine is 0/0 as soon as the arm has arrived, and every "
            "command after that is not a number.",
            mistakes.zero_by_zero,
            cure="Return zero where there is no turn, as lk.se3.rotation_log does.",
        ),
        Wrong(
            "the arcsine of the turn",
            "An arcsine never exceeds 90 degrees: 133 degrees come out as 47.",
            mistakes.TurnOf(lambda angle: np.arcsin(np.sin(angle))),
            cure="Use lk.se3.rotation_log, or compute the angle from its sine and cosine with "
            "np.arctan2.",
        ),
        Wrong(
            "the quaternion's vector",
            "sin(θ/2) times the axis is the vector part of the quaternion, and twice that is "
            "nearly right for small turns only.",
            mistakes.TurnOf(lambda angle: np.sin(angle / 2.0)),
            cure="The rotation vector is the angle times the axis.",
        ),
    ),
    variants=(variants.OrientationError(), variants.by_quaternion),
)

PROBLEMS = (
    JOINT_ERROR,
    TAG_IN_WORLD,
    ORIENTATION_ERROR,
)
