"""The questions of notebook 06."""

from __future__ import annotations

import numpy as np

from labkit import Sample, se3
from labkit.course import Close
from labkit.course.authoring.problem import Problem, Trial, Wrong, call

from . import answers, following, hidden, mistakes, variants

_RANDOM = np.random.default_rng(6)
_ZERO = np.zeros(3)
_STILL = Sample(np.array([0.1, 0.2, 0.3]), _ZERO, _ZERO)
_THERE = Sample(np.array([0.4, 0.1, 0.3]), _ZERO, _ZERO)
_MOVING = Sample(np.array([0.1, 0.2, 0.3]), np.array([0.1, 0.0, -0.05]), np.array([0.2, -0.1, 0.0]))
_GOING = Sample(np.array([0.3, 0.25, 0.2]), np.array([0.0, 0.1, 0.02]), _ZERO)
_TURNING = _GOING._replace(acceleration=np.array([0.1, 0.0, -0.3]))
_SEVEN = np.random.default_rng(7).uniform(-0.4, 0.4, (2, 3, 7)).round(2)
_JOINTS, _THEIR_GOAL = Sample(*_SEVEN[0]), Sample(*_SEVEN[1])
_BELIEF = hidden.believed(_RANDOM)
_AGES = call(*_BELIEF, 0.1, 0.01), call(*_BELIEF, 0.4, 0.05)
_OTHER_AGES = "other ages and noises"

TAG_CORNERS = Problem(
    name="tag_corners",
    points=2,
    core=False,
    outcomes=("frames",),
    asks="Give the four corners of the black square in the tag's own frame: origin in the middle, x to "
    "the right, y up, z out of the paper; clockwise as one looks at it, from the upper left; shape (4, 3).",
    answer=answers.tag_corners,
    trials=(Trial("a tag of 10 cm", (call(0.1), call(0.16)), hidden.sizes, "other sizes"),),
    withheld=("labkit.tags.tag.tag_corners",),
    hints=(
        "Draw the square, mark the middle, and write the coordinates of the upper left corner first.",
        "Half a side to the left is -size/2 in x, half a side up is +size/2 in y. The tag is in the plane z = 0.",
        "Draw the square with x to the right and y upwards, and write down half a side with "
        "its sign for each corner, beginning upper left and going round as the hands of a "
        "clock.",
    ),
    wrong=(
        Wrong(
            "the corners counter-clockwise",
            "With the corners in this order the tag is seen from behind, and z points into the "
            "paper. Go clockwise.",
            mistakes.counter_clockwise,
            "The order of the corners is part of the measurement.",
        ),
        Wrong(
            "the white border included",
            "The size is that of the black square. With the border included everything seems a "
            "quarter too far away: leave it out.",
            mistakes.border_counted,
            "Measure the black square, not the paper.",
        ),
        Wrong(
            "the origin in a corner",
            "The origin should be in the middle of the tag, so coordinates have both signs.",
            mistakes.from_a_corner,
            "Say where a frame sits before using it.",
        ),
        Wrong(
            "counter-clockwise from the upper left",
            "The upper left corner is right, but the next one is wrong. Go clockwise as you look "
            "at the tag: to the upper right.",
            mistakes.Reordered((0, 3, 2, 1)),
            "The order of the corners is part of the measurement.",
        ),
        Wrong(
            "y pointing down",
            "That is right in a picture. In the tag's frame y points up.",
            mistakes.Reordered(scale=(1.0, -1.0, 1.0)),
            "Picture and tag have axes of their own.",
        ),
        Wrong(
            "the lower left corner first",
            "The corners are clockwise but begin at the wrong one, so the tag seems turned by a "
            "quarter. Begin at the upper left.",
            mistakes.Reordered((3, 0, 1, 2)),
            "The order of the corners is part of the measurement.",
        ),
        Wrong(
            "the upper right corner first",
            "The corners are clockwise but begin at the wrong one, so the tag seems turned by a "
            "quarter. Begin at the upper left.",
            mistakes.Reordered((1, 2, 3, 0)),
            "The order of the corners is part of the measurement.",
        ),
        Wrong(
            "a square twice as large",
            "The corners lie half a side from the middle, not a whole one.",
            mistakes.Reordered(scale=(2.0, 2.0, 1.0)),
            "Side or half a side: draw it.",
        ),
    ),
    variants=(variants.corners_list,),
)


def _seen(
    tilt: float, azimuth: float, distance: float = 0.7, size: float = 0.1
) -> tuple[object, ...]:
    T = hidden.seen(distance, tilt, azimuth, 0.3, x=0.05)
    return hidden.pixels_of(T, size), hidden.K, size


TAG_POSE = Problem(
    name="tag_pose",
    points=5,
    outcomes=("frames",),
    asks="From the four corners in the picture give the pose of the tag in the camera's frame, `T_cm`, "
    "shape (4, 4). `K` is the camera's matrix. OpenCV is allowed: `cv2.solvePnPGeneric` with "
    "`cv2.SOLVEPNP_IPPE_SQUARE` gives two candidates and how badly each fits.",
    answer=answers.tag_pose,
    judge=Close(rtol=0.0, atol=2e-4),
    trials=(
        Trial("a tag seen at 45 degrees", (call(*_seen(0.8, 0.4)),), weight=0.0),
        Trial(
            "tags seen from aside",
            (call(*_seen(0.6, 2.0, 0.5)), call(*_seen(0.9, -1.5, 1.1, 0.16))),
            hidden.oblique,
            "near and far, other sizes",
            weight=2.0,
        ),
        Trial(
            "a tag that nearly faces the camera",
            (call(*_seen(0.25, -0.7, 0.6)),),
            hidden.nearly_frontal,
            "other ways of facing it",
        ),
    ),
    withheld=("labkit.tags.detection", "labkit.detect_tags"),
    hints=(
        "solvePnPGeneric wants the corners in the tag's frame, in the order of the pixels, the pixels, "
        "the camera's matrix and None for the distortion.",
        "It returns (count, rotation vectors, translations, errors). Take the candidate with the smallest "
        "error; cv2.Rodrigues turns a rotation vector into a matrix.",
        "IPPE gives lists of rotation vectors, translations and errors. Find the index of the "
        "best fit, turn its rotation vector into a matrix with Rodrigues, and beware of "
        "columns of shape (3, 1).",
    ),
    wrong=(
        Wrong(
            "the camera in the tag's frame",
            "This is T_mc, the inverse: its translation does not point along the camera's view. "
            "Invert it.",
            mistakes.camera_in_the_tag,
            "T_cm takes points of the tag to the camera: the subscripts say so.",
        ),
        Wrong(
            "the size of the paper",
            "With the white border in the size everything seems 1.25 times too far away. Use the "
            "size of the black square.",
            mistakes.border_in_the_pose,
            "Measure the black square, not the paper.",
        ),
        Wrong(
            "a rotation vector read as Euler angles",
            "The three numbers are an axis times an angle. cv2.Rodrigues turns them into a matrix.",
            mistakes.vector_as_euler_angles,
            "Three numbers for a rotation: always ask which three.",
        ),
        Wrong(
            "the candidate that fits worse",
            "A flat square looks nearly the same tilted one way or the other. Choose the "
            "candidate with the smaller error.",
            mistakes.the_worse_answer,
            "A flat tag has two poses; look at the error.",
        ),
        Wrong(
            "corners the other way round",
            "The corners run counter-clockwise, so a tag seen from behind is fitted to the "
            "picture. Use those of tag_corners, clockwise.",
            mistakes.PoseOf(mistakes.Reordered((0, 3, 2, 1))),
            "The order of the corners is part of the measurement.",
        ),
        Wrong(
            "twice the size of the square",
            "Everything seems twice as far away as it is. The corners lie half a side from the "
            "middle.",
            mistakes.PoseOf(scale=2.0),
            "Side or half a side: draw it.",
        ),
        Wrong(
            "half the size of the square",
            "Everything seems half as far away as it is. `size` is the whole side.",
            mistakes.PoseOf(scale=0.5),
            "Side or half a side: draw it.",
        ),
        Wrong(
            "the rotation transposed",
            "The translation is right, but the rotation is that of the camera in the tag's frame. "
            "Transpose it.",
            mistakes.rotation_transposed,
            "R_cm takes directions of the tag to the camera.",
        ),
        Wrong(
            "no rotation",
            "The rotation is left as the identity: cv2.Rodrigues makes a matrix of the rotation vector.",
            mistakes.Seen(pose=lambda T: se3.pose(np.eye(3), T[:3, 3])),
            "A pose has two parts.",
        ),
        Wrong(
            "no translation",
            "The translation is left at zero: it is the second vector that OpenCV gives.",
            mistakes.Seen(pose=lambda T: se3.pose(T[:3, :3], np.zeros(3))),
            "A pose has two parts.",
        ),
        Wrong(
            "the translation with a minus",
            "OpenCV gives where the tag is in the camera's frame: take it as it is.",
            mistakes.Seen(pose=lambda T: se3.pose(T[:3, :3], -T[:3, 3])),
            "z is in front of the camera: it is above zero.",
        ),
        Wrong(
            "millimetres",
            "The translation has the unit of the corners, which is metres.",
            mistakes.Seen(pose=lambda T: se3.pose(T[:3, :3], 1000.0 * T[:3, 3])),
            "Say the unit of every number.",
        ),
        Wrong(
            "u and v exchanged",
            "A pixel is (u, v): along the row first, then down. Yours has the two exchanged.",
            mistakes.Seen(pixels=lambda p: p[:, ::-1]),
            "u along x, v along y.",
        ),
        Wrong(
            "the pixels one corner late",
            "The first pixel belongs to the first corner. Yours begins with another one, so that the tag is turned by 90 degrees.",
            mistakes.Seen(pixels=lambda p: np.roll(p, 1, axis=0)),
            "Say which pixel belongs to which corner.",
        ),
        Wrong(
            "the pixels one corner early",
            "The first pixel belongs to the first corner. Yours begins with another one, so that the tag is turned by 90 degrees.",
            mistakes.Seen(pixels=lambda p: np.roll(p, -1, axis=0)),
            "Say which pixel belongs to which corner.",
        ),
        Wrong(
            "the principal point taken off twice",
            "The camera's matrix takes the principal point off already: give the pixels as they are.",
            mistakes.Seen(pixels=lambda p: p - np.array([320.0, 240.0])),
            "Say who does which step.",
        ),
    ),
    variants=(variants.pose_by_iteration,),
)

QUALITY = Problem(
    name="sensor_quality",
    points=3,
    core=False,
    outcomes=("sensing",),
    asks="From many estimates `T_cm` of one tag and the truth give `(bias, covariance)` of the error, "
    "truth minus estimate: three numbers of position and the rotation vector of R_truth R_estimate^T, "
    "together shape (6,) and (6, 6).",
    answer=answers.sensor_quality,
    judge=Close(rtol=1e-6, atol=1e-10, parts=("bias", "covariance")),
    trials=(
        Trial(
            "an offset and a little noise",
            (call(*hidden.scattered(_RANDOM, 6, [0.002, 0, 0.004, 0, 0.01, 0], 1e-4)),),
            hidden.offsets,
            "other offsets",
            0.4,
            "bias",
        ),
        Trial(
            "noise",
            (call(*hidden.scattered(_RANDOM, 8, np.zeros(6), 0.003)),),
            hidden.noises,
            "noise and offset together",
            0.6,
            "covariance",
        ),
    ),
    hints=(
        "First one error vector of six numbers for each estimate. Then their mean and their covariance.",
        "se3.rotation_log(R_truth @ R_estimate.T) is the turn from the estimate to the truth.",
        "First make n rows of six errors, each with the function for the error of a pose, "
        "truth first. Then numpy has a mean along an axis, and a covariance that wants its "
        "variables in rows.",
    ),
    wrong=(
        Wrong(
            "the spread about zero",
            "The covariance is taken about zero, so a constant offset counts as spread. Take it "
            "about the mean: averaging reduces the spread and never an offset.",
            mistakes.spread_about_zero,
            "Bias and spread need different cures.",
        ),
        Wrong(
            "estimate minus truth",
            "The sign is wrong: in this course an error is target minus actual, here truth minus "
            "estimate.",
            mistakes.the_other_sign,
            "One sign of the error, said loudly.",
        ),
        Wrong(
            "Euler angles subtracted",
            "A tag that faces the camera is turned by half a turn, exactly where Euler angles "
            "jump. Use the logarithm of one rotation.",
            mistakes.euler_subtracted,
            "Never subtract Euler angles.",
        ),
        Wrong(
            "n instead of n - 1 in the denominator",
            "You divided by n. The mean comes from the same numbers, so divide by n - 1.",
            mistakes.n_in_the_denominator,
            "n or n - 1: who gave you the mean?",
        ),
        Wrong(
            "the covariance of the mean",
            "This is how sure the mean is. Give the covariance of a single picture: do not divide "
            "by the number of pictures.",
            mistakes.of_the_mean,
            "Standard deviation and standard error are two things.",
        ),
        Wrong(
            "the variances alone",
            "The errors go together: a tag that seems tilted also seems moved. Give the whole "
            "covariance, as np.cov does.",
            mistakes.diagonal_only,
            "What is beside the diagonal says what goes together.",
        ),
        Wrong(
            "the turn in the tag's axes",
            "R_estimateᵀ R_truth is a turn in the tag's axes. Position and turn should both be in "
            "the camera's: R_truth R_estimateᵀ.",
            mistakes.turn_in_tag_axes,
            "Which axes does a rotation vector speak of?",
        ),
        Wrong(
            "the turn reversed",
            "This is the turn from the truth to the estimate. Put the truth on the left of the "
            "product.",
            mistakes.turn_backwards,
            "One sign of the error, said loudly.",
        ),
        Wrong(
            "logarithms subtracted",
            "The difference of two rotation vectors is not a rotation vector, least of all near "
            "half a turn, where they jump. Multiply the rotations, then take one logarithm.",
            mistakes.logarithms_subtracted,
            "Orientations are compared by a product.",
        ),
        Wrong(
            "the turn before the position",
            "Put the position first, then the turn.",
            mistakes.turn_first,
            "(v, w), in this course.",
        ),
        Wrong(
            "everything in the tag's axes",
            "The inverse of the estimate times the truth has all six numbers in the tag's axes. "
            "Give them in the camera's.",
            mistakes.everything_in_the_tag,
            "Which axes does an error speak of?",
        ),
        Wrong(
            "about zero, with n - 1",
            "The covariance is about the mean: take the mean off each error first. np.cov does.",
            mistakes.Quality(spread=lambda e: e.T @ e / (len(e) - 1)),
            "Bias and spread are two things.",
        ),
        Wrong(
            "degrees",
            "The turn is in radians here.",
            mistakes.Quality((1.0, 180.0 / np.pi)),
            "Say the unit of every number.",
        ),
        Wrong(
            "millimetres",
            "The place is in metres here.",
            mistakes.Quality((1000.0, 1.0)),
            "Say the unit of every number.",
        ),
        Wrong(
            "correlations",
            "np.corrcoef divides by the deviations. A covariance has units.",
            mistakes.Quality(spread=lambda e: np.corrcoef(e.T)),
            "A correlation has no size.",
        ),
        Wrong(
            "a median",
            "The bias is the mean of the errors.",
            mistakes.Quality(centre=lambda e: np.median(e, axis=0)),
            "Mean and median are two things.",
        ),
        Wrong(
            "an RMS for the mean",
            "An RMS has no sign, and the spread is in it. The bias is the mean.",
            mistakes.Quality(centre=lambda e: np.sqrt((e**2).mean(axis=0))),
            "Bias and spread are two things.",
        ),
        Wrong(
            "the mean of sizes",
            "Errors of opposite sign cancel in a bias: keep the signs.",
            mistakes.Quality(centre=lambda e: np.abs(e).mean(axis=0)),
            "A bias has a sign.",
        ),
        Wrong(
            "the sum of the errors",
            "The bias is the mean: divide by their number.",
            mistakes.Quality(centre=lambda e: e.sum(axis=0)),
            "A mean does not grow with n.",
        ),
        Wrong(
            "no transpose",
            "R_truth R_estimate is not a turn between the two. Undo the estimate with its transpose.",
            mistakes.Quality(turn=lambda R, S: se3.rotation_log(R @ S)),
            "Orientations are compared by R Sᵀ.",
        ),
        Wrong(
            "the place in the tag's axes",
            "The error of position is asked for in the camera's axes.",
            mistakes.Quality(tag=True),
            "Every vector has axes.",
        ),
    ),
    variants=(variants.quality_by_loops,),
)

BLEND = Problem(
    name="blend",
    points=5,
    outcomes=("motion",),
    asks="Join a moving reference to a moving goal by a polynomial of fifth order: at `t` = 0 it has the "
    "reference's position, velocity and acceleration, at `t` = `duration` the goal's. After that it goes "
    "on with the goal's velocity, without acceleration. Give an `lk.Sample`.",
    answer=following.blend,
    judge=Close(rtol=1e-6, atol=1e-8, parts=("position", "velocity", "acceleration")),
    trials=(
        Trial(
            "from rest to rest in one second",
            tuple(call(t, _STILL, _THERE, 1.0) for t in (0.3, 0.7)),
            hidden.blends_from_rest,
            "other places",
            weight=0.0,
        ),
        Trial(
            "from motion to motion, of a point and of seven joints",
            (
                *(call(t, _MOVING, _GOING, 1.6) for t in (0.0, 0.5, 1.1, 1.6)),
                call(1.1, _MOVING, _TURNING, 1.6),  # at 1.6 both are right
                call(0.5, _JOINTS, _THEIR_GOAL, 1.6),
            ),
            hidden.blends_in_motion,
            "other durations, seven joints and a single number",
            0.6,
        ),
        Trial(
            "after the end it goes on with the goal's velocity",
            (
                *(call(2.2, _MOVING, goal, 1.6) for goal in (_GOING, _TURNING)),
                call(2.2, _JOINTS, _THEIR_GOAL, 1.6),
            ),
            hidden.blends_after_the_end,
            "other durations, seven joints and a single number",
            0.4,
        ),
    ),
    hints=(
        "Six conditions fix six coefficients. Write position, velocity and acceleration of "
        "c0 + c1 t + ... + c5 t^5 at both ends.",
        "c0, c1 and c2 come from the start at once: p, v and a/2. The other three solve a 3 x 3 system "
        "with the rows [T³, T⁴, T⁵], [3T², 4T³, 5T⁴], [6T, 12T², 20T³].",
        "The first three coefficients follow from the start. The goal gives three equations "
        "for the others: what it demands, less what the known three make of it at the end. "
        "Solve them for all axes at once.",
    ),
    wrong=(
        Wrong(
            "a new start from rest",
            "Every new goal stops the reference dead, and the arm with it: the report's Algorithm 1. Take "
            "over the velocity that it has.",
            mistakes.restarts_at_rest,
            "A reference that jumps makes an arm jerk.",
        ),
        Wrong(
            "rates of t used for x = t/T",
            "In x = t/T a velocity is T times as large, and an acceleration T² times. Convert "
            "both; T = 1 does not show this.",
            mistakes.rates_not_scaled,
            "Scale derivatives when you scale time.",
        ),
        Wrong(
            "a stop at the goal",
            "The goal moves on, and the reference arrives at rest, so it will always lag behind. "
            "End with the goal's velocity.",
            mistakes.stops_at_the_goal,
            "Meet a moving goal with its velocity.",
        ),
        Wrong(
            "a cubic polynomial",
            "A cubic matches position and velocity, but the acceleration jumps at every new goal, "
            "and the torque with it. Use fifth order to match it as well.",
            mistakes.without_the_bend,
            "Count conditions, then coefficients.",
        ),
        Wrong(
            "the start's velocity left out",
            "The reference moves when the blend begins. At t = 0 the blend must have the same "
            "velocity.",
            mistakes.Blended(start=(0.0, 1.0)),
            "Check both ends, all three derivatives.",
        ),
        Wrong(
            "the start's acceleration left out",
            "At t = 0 the acceleration must be the reference's: the coefficient of t² is half of it.",
            mistakes.Blended(start=(1.0, 0.0)),
            "Check both ends, all three derivatives.",
        ),
        Wrong(
            "the goal's velocity left out",
            "The goal moves on. At t = duration the blend must have the goal's velocity.",
            mistakes.Blended(end=(0.0, 1.0)),
            "Check both ends, all three derivatives.",
        ),
        Wrong(
            "the goal's acceleration left out",
            "At t = duration the blend must have the goal's acceleration, which is not always "
            "zero.",
            mistakes.Blended(end=(1.0, 0.0)),
            "Check both ends, all three derivatives.",
        ),
        Wrong(
            "from rest to rest",
            "This blend begins and ends at rest. Take over the velocities and accelerations of "
            "start and goal.",
            mistakes.Blended(start=(0.0, 0.0), end=(0.0, 0.0)),
            "Check both ends, all three derivatives.",
        ),
        Wrong(
            "a polynomial without end",
            "After `duration` the polynomial runs away. Go on with the goal's velocity there.",
            mistakes.never_ends,
            "A polynomial is good between its ends only.",
        ),
        Wrong(
            "a wait at the goal",
            "After the end your blend stands still. The position must go on with the velocity of "
            "the goal.",
            mistakes.waits_at_the_goal,
            "Velocity is the slope of position, or somebody lies.",
        ),
        Wrong(
            "an acceleration that never ends",
            "After the end the acceleration is zero, whatever the goal's was. Set it to zero "
            "there.",
            mistakes.speeds_up_for_ever,
            "Read the sentence about the end.",
        ),
        Wrong(
            "an acceleration without effect",
            "After the end the velocity is constant, so the acceleration is zero.",
            mistakes.acceleration_kept,
            "Acceleration is the slope of velocity, or somebody lies.",
        ),
        Wrong(
            "derivatives with respect to t/T",
            "These are derivatives with respect to t/T. Divide the first by T and the second by "
            "T².",
            mistakes.derivatives_by_share,
            "Scale derivatives when you scale time.",
        ),
        Wrong(
            "a mixture of start and goal",
            "A mixture in proportion to time gives a velocity that is not the derivative of the "
            "position. Use one polynomial of fifth order.",
            mistakes.the_ends_mixed,
            "Velocity is the slope of position, or somebody lies.",
        ),
        Wrong(
            "three coordinates, however many there are",
            "A sample may hold a point, seven joint angles or a single number, of shape (n,). Do "
            "not assume three.",
            mistakes.three_alone,
            "Read the shape in the docstring; then try another n.",
        ),
        Wrong(
            "reference and goal exchanged",
            "The blend begins at the reference and ends at the goal. Yours goes the other way.",
            mistakes.Ends(lambda a, b: (b, a)),
            "Put t = 0 into every reference.",
        ),
        Wrong(
            "a crossfade",
            "Two motions mixed with a smooth weight: the derivatives of the weight are missing, so that velocity and place do not fit together.",
            mistakes.Ends(made=mistakes.crossfade),
            "Check that the velocity is the slope of the place.",
        ),
        Wrong(
            "counts from the start after the end",
            "After the end the goal has moved for t - duration, not for t.",
            mistakes.Ends(
                late=lambda b, t, T: Sample(
                    b.position + b.velocity * t, b.velocity, 0.0 * b.velocity
                )
            ),
            "Say for each time from where it is counted.",
        ),
        Wrong(
            "stands still after the end",
            "After the end the goal moves on with its velocity, and the reference with it.",
            mistakes.Ends(
                late=lambda b, t, T: Sample(b.position, 0.0 * b.velocity, 0.0 * b.velocity)
            ),
            "A moving goal does not wait.",
        ),
        Wrong(
            "no velocity",
            "The velocity is not filled in before the end.",
            mistakes.Ends(
                made=lambda x, t, a, b, T: Sample(x.position, 0.0 * x.velocity, x.acceleration)
            ),
            "Check that the velocity is the slope of the place.",
        ),
        Wrong(
            "no acceleration",
            "The acceleration is not filled in before the end.",
            mistakes.Ends(
                made=lambda x, t, a, b, T: Sample(x.position, x.velocity, 0.0 * x.velocity)
            ),
            "Check that the acceleration is the slope of the velocity.",
        ),
        Wrong(
            "the velocity not divided by the duration",
            "The velocity is by t/duration: by t it is divided by the duration.",
            mistakes.Ends(
                made=lambda x, t, a, b, T: Sample(x.position, x.velocity * T, x.acceleration)
            ),
            "A derivative has a variable; say it aloud.",
        ),
        Wrong(
            "the acceleration not divided by the duration",
            "The acceleration is by t/duration: by t it is divided by the duration squared.",
            mistakes.Ends(
                made=lambda x, t, a, b, T: Sample(x.position, x.velocity, x.acceleration * T**2)
            ),
            "A derivative has a variable; say it aloud.",
        ),
        Wrong(
            "the acceleration divided by the duration once",
            "The acceleration is the second derivative by t/duration: divide by the duration squared.",
            mistakes.Ends(
                made=lambda x, t, a, b, T: Sample(x.position, x.velocity, x.acceleration * T)
            ),
            "A derivative has a variable; say it aloud.",
        ),
    ),
    variants=(variants.blend_by_bernstein,),
)

PREDICT = Problem(
    name="carry_forward",
    points=5,
    outcomes=("sensing",),
    asks="A tag is believed at `mean` (position and velocity) with `covariance`. Give both `age` seconds "
    "later, for constant velocity under continuous white acceleration of power `accel_noise`.",
    answer=following.carry_forward,
    judge=Close(rtol=1e-6, atol=1e-12, parts=("mean", "covariance")),
    trials=(
        Trial(
            "no time at all changes nothing",
            (call(*_BELIEF, 0.0, 0.01),),
            hidden.no_age,
            weight=0.0,
        ),
        Trial(
            "the mean of a picture that is 100 ms old", _AGES, hidden.ages, _OTHER_AGES, 0.4, "mean"
        ),
        Trial("how sure one is of it", _AGES, hidden.ages, _OTHER_AGES, 0.6, "covariance"),
    ),
    hints=(
        "Position grows by age times velocity, velocity stays: a matrix F. How does a covariance go "
        "through a matrix?",
        "mean' = F mean and covariance' = F P F^T + Q. Q is what the pushes add, and it must vanish with "
        "age: two half steps have to make one whole.",
        "Multiply F(s) diag(0, q) F(s)ᵀ out for one axis: four entries, powers of s. "
        "Integrate each from 0 to the age. The three axes do not mix; numpy's kron spreads "
        "them.",
    ),
    wrong=(
        Wrong(
            "the age of the picture ignored",
            "At 0.1 m/s a picture that is 100 ms old is 10 mm wrong. Carry the mean forward.",
            mistakes.ignores_the_age,
            "A measurement is of when it was taken.",
        ),
        Wrong(
            "noise that does not know of time",
            "The noise is the same whatever the step, so ten short steps add ten times the noise of "
            "one long one. Let Q grow with `age`.",
            mistakes.noise_without_time,
            "Two half steps must make one step.",
        ),
        Wrong(
            "a covariance that stays the same",
            "The mean moves on, but the covariance does not, so the filter soon believes only "
            "itself. Carry it forward too, and add the noise.",
            mistakes.certain_for_ever,
            "What is not seen becomes less sure.",
        ),
        Wrong(
            "the cross terms left out",
            "A push changes the velocity and, through it, the position, so the two errors go "
            "together. Keep the terms between them.",
            mistakes.noise_on_the_diagonal,
            "Derive Q, do not guess its diagonal.",
        ),
        Wrong(
            "one push in each step",
            "age⁴/4, age³/2, age² belong to a single push that is held for the whole step: two half "
            "steps then do not make one. White noise gives age³/3, age²/2, age.",
            mistakes.Predicted(((4, 0.25), (3, 0.5), (2, 1.0))),
            "Held noise and white noise have other powers of the step.",
        ),
        Wrong(
            "Q left out",
            "Q is missing, so the belief never becomes less sure of its velocity and soon ignores "
            "every picture. Add Q.",
            mistakes.Predicted(((0, 0.0), (0, 0.0), (0, 0.0))),
            "What is not seen becomes less sure.",
        ),
        Wrong(
            "pushes on the velocity alone",
            "A push at the beginning of the step has moved the position by its end. Integrate "
            "F(s) too.",
            mistakes.Predicted(((0, 0.0), (0, 0.0), (1, 1.0))),
            "Derive Q, do not guess its diagonal.",
        ),
        Wrong(
            "the same on place and velocity",
            "accel_noise · age has the wrong unit for the position. Integrate F(s) diag(0, q) "
            "F(s)ᵀ.",
            mistakes.Predicted(((1, 1.0), (0, 0.0), (1, 1.0))),
            "Units tell: m² for the place.",
        ),
        Wrong(
            "the noise squared",
            "accel_noise is a power already, in m²/s³. Do not square it.",
            mistakes.Predicted(((3, 1 / 3), (2, 0.5), (1, 1.0)), power=2.0),
            "Variance or deviation? Look at the unit.",
        ),
        Wrong(
            "F P without Fᵀ",
            "A covariance goes through a matrix from both sides: F P Fᵀ.",
            mistakes.half_the_product,
            "A covariance is symmetric: look whether yours is.",
        ),
        Wrong(
            "Fᵀ P F instead of F P Fᵀ",
            "Write the transpose on the right.",
            mistakes.product_turned_round,
            "y = F x has the covariance F P Fᵀ.",
        ),
        Wrong(
            "back in time",
            "Carry the mean forward by `age`, from the picture to now.",
            mistakes.back_in_time,
            "Say when each number is of.",
        ),
        Wrong(
            "the mean not moved",
            "The mean moves as well: the place goes on with the velocity, F m.",
            mistakes.Carried(mean=False),
            "Mean and covariance both move.",
        ),
        Wrong(
            "the noise before the motion",
            "The pushes come during the step: Q is added after F P Fᵀ.",
            mistakes.Carried(order="Q first"),
            "F P Fᵀ + Q.",
        ),
        Wrong(
            "the covariance not moved",
            "The covariance moves with F: what is unknown of the velocity becomes unknown of the place.",
            mistakes.Carried(order="no F"),
            "F P Fᵀ + Q.",
        ),
        Wrong(
            "the noise taken off",
            "Pushes make the belief less sure: Q is added.",
            mistakes.Carried(noise=-1.0),
            "Time adds doubt.",
        ),
        Wrong(
            "the noise twice",
            "Q is added once.",
            mistakes.Carried(noise=2.0),
            "F P Fᵀ + Q.",
        ),
        Wrong(
            "the velocity moved by the place",
            "F has the age in its upper right block: the place moves by the velocity.",
            mistakes.Carried(lambda age: [[1.0, 0.0], [age, 1.0]]),
            "The velocity moves the place.",
        ),
        Wrong(
            "the age squared in F",
            "The place moves by velocity times age.",
            mistakes.Carried(lambda age: [[1.0, age**2 / 2.0], [0.0, 1.0]]),
            "The velocity moves the place.",
        ),
        Wrong(
            "a half where a third belongs",
            "The corner of the place is age³/3: ∫ (age - s)² ds.",
            mistakes.Predicted(((3.0, 0.5), (2.0, 0.5), (1.0, 1.0))),
            "Integrate the push's effect.",
        ),
        Wrong(
            "no third",
            "The corner of the place is age³/3: ∫ (age - s)² ds.",
            mistakes.Predicted(((3.0, 1.0), (2.0, 0.5), (1.0, 1.0))),
            "Integrate the push's effect.",
        ),
        Wrong(
            "no half beside the diagonal",
            "Beside the diagonal is age²/2: ∫ (age - s) ds.",
            mistakes.Predicted(((3.0, 1.0 / 3.0), (2.0, 1.0), (1.0, 1.0))),
            "Integrate the push's effect.",
        ),
        Wrong(
            "age² for the place's age³",
            "The corner of the place is age³/3: ∫ (age - s)² ds.",
            mistakes.Predicted(((2.0, 1.0 / 3.0), (2.0, 0.5), (1.0, 1.0))),
            "Integrate the push's effect.",
        ),
        Wrong(
            "age² for the velocity's age",
            "The corner of the velocity is age, once.",
            mistakes.Predicted(((3.0, 1.0 / 3.0), (2.0, 0.5), (2.0, 1.0))),
            "Integrate the push's effect.",
        ),
        Wrong(
            "place and velocity exchanged in Q",
            "The place's corner has age³/3 and the velocity's has age.",
            mistakes.Predicted(((1.0, 1.0), (2.0, 0.5), (3.0, 1.0 / 3.0))),
            "Integrate the push's effect.",
        ),
        Wrong(
            "a minus beside the diagonal",
            "A push forward makes the velocity larger and the place farther: both grow together.",
            mistakes.Predicted(((3.0, 1.0 / 3.0), (2.0, -0.5), (1.0, 1.0))),
            "Say what two numbers do together.",
        ),
    ),
    variants=(variants.predict_by_exponential,),
)

PROBLEMS = (TAG_CORNERS, TAG_POSE, QUALITY, BLEND, PREDICT)
