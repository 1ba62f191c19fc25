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
    asks="Give the four corners of the black square in the tag's own frame, shape (4, 3): the "
    "origin is in the middle, x points to the right, y up and z out of the paper. Begin at the "
    "upper left corner and go clockwise, as seen by somebody who looks at the tag.",
    answer=answers.tag_corners,
    trials=(Trial("a tag of 10 cm", (call(0.1), call(0.16)), hidden.sizes, "other sizes"),),
    withheld=("labkit.tags.tag.tag_corners",),
    hints=(
        "Draw the square, mark the middle, and write the coordinates of the upper left corner first.",
        "Half a side to the left is -size/2 in x, half a side up is +size/2 in y. The tag is in the plane z = 0.",
        "Draw the square with x to the right and y upwards. For each corner write down half a "
        "side with its sign, beginning at the upper left and going round like the hands of a "
        "clock.",
    ),
    wrong=(
        Wrong(
            "the corners counter-clockwise",
            "With the corners in this order the tag is seen from behind, and z points into the "
            "paper. Go clockwise.",
            mistakes.counter_clockwise,
            "The order of the corners is a part of the measurement.",
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
            "Say where the origin of a frame is before you use the frame.",
        ),
        Wrong(
            "counter-clockwise from the upper left",
            "The upper left corner is right, but the next one is wrong. Go clockwise as you look "
            "at the tag: to the upper right.",
            mistakes.Reordered((0, 3, 2, 1)),
            "The order of the corners is a part of the measurement.",
        ),
        Wrong(
            "y pointing down",
            "y points down in a picture. In the tag's frame it points up.",
            mistakes.Reordered(scale=(1.0, -1.0, 1.0)),
            "The picture and the tag each have their own axes.",
        ),
        Wrong(
            "the lower left corner first",
            "The corners are clockwise but begin at the wrong one, so the tag seems turned by 90 "
            "degrees. Begin at the upper left.",
            mistakes.Reordered((3, 0, 1, 2)),
            "The order of the corners is a part of the measurement.",
        ),
        Wrong(
            "the upper right corner first",
            "The corners are clockwise but begin at the wrong one, so the tag seems turned by 90 "
            "degrees. Begin at the upper left.",
            mistakes.Reordered((1, 2, 3, 0)),
            "The order of the corners is a part of the measurement.",
        ),
        Wrong(
            "a square twice as large",
            "The corners lie half a side from the middle, not a whole one.",
            mistakes.Reordered(scale=(2.0, 2.0, 1.0)),
            "Draw the square: is it a side or half a side?",
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
    asks="From the four corners in the picture give the pose of the tag in the camera's frame, "
    "`T_cm`, shape (4, 4). `K` is the camera's matrix. You may use OpenCV: `cv2.solvePnPGeneric` "
    "with `cv2.SOLVEPNP_IPPE_SQUARE` returns two candidates and the error of each.",
    answer=answers.tag_pose,
    judge=Close(rtol=0.0, atol=2e-4),
    trials=(
        Trial("a tag seen at 45 degrees", (call(*_seen(0.8, 0.4)),), weight=0.0),
        Trial(
            "tags seen from aside",
            (call(*_seen(0.6, 2.0, 0.5)), call(*_seen(0.9, -1.5, 1.1, 0.16))),
            hidden.oblique,
            "near and far, other sizes",
            weight=3.5,
        ),
        Trial(
            "a tag that nearly faces the camera",
            (call(*_seen(0.25, -0.7, 0.6)),),
            hidden.nearly_frontal,
            "other ways of facing it",
            weight=1.5,
        ),
    ),
    withheld=("labkit.tags.detection", "labkit.detect_tags"),
    hints=(
        "solvePnPGeneric needs, in this order: the corners in the tag's frame, ordered like the "
        "pixels; the pixels; the camera's matrix; and None for the distortion.",
        "It returns (count, rotation vectors, translations, errors). Take the candidate with the smallest "
        "error; cv2.Rodrigues turns a rotation vector into a matrix.",
        "solvePnPGeneric returns lists of rotation vectors, translations and errors. Find the "
        "index of the best fit, turn its rotation vector into a matrix with Rodrigues, and "
        "remember that the vectors are columns of shape (3, 1).",
    ),
    wrong=(
        Wrong(
            "the camera in the tag's frame",
            "This is T_mc, the inverse: its translation does not point along the camera's view. "
            "Invert it.",
            mistakes.camera_in_the_tag,
            "T_cm takes points from the tag's frame to the camera's, as its subscripts say.",
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
            "For three numbers that describe a rotation, always ask which three they are.",
        ),
        Wrong(
            "a rotation vector in the rows of the matrix",
            "numpy has copied the three numbers of the rotation vector into every row of the "
            "rotation matrix, without an error. cv2.Rodrigues makes a matrix of the vector.",
            mistakes.Seen(pose=mistakes.vector_in_the_rows),
            "An array of another shape may be copied instead of refused: look at the matrix.",
        ),
        Wrong(
            "a rotation vector in the columns of the matrix",
            "numpy has copied the three numbers of the rotation vector into every column of the "
            "rotation matrix, without an error. cv2.Rodrigues makes a matrix of the vector.",
            mistakes.Seen(pose=mistakes.vector_in_the_columns),
            "An array of another shape may be copied instead of refused: look at the matrix.",
        ),
        Wrong(
            "the candidate that fits worse",
            "A flat square looks nearly the same whether it is tilted in one direction or in the "
            "opposite one. Choose the candidate with the smaller error.",
            mistakes.the_worse_answer,
            "A flat tag has two candidate poses; compare their errors.",
        ),
        Wrong(
            "corners the other way round",
            "The corners run counter-clockwise, so a tag seen from behind is fitted to the "
            "picture. Use the corners of tag_corners, which run clockwise.",
            mistakes.PoseOf(mistakes.Reordered((0, 3, 2, 1))),
            "The order of the corners is a part of the measurement.",
        ),
        Wrong(
            "twice the size of the square",
            "Everything seems twice as far away as it is. The corners lie half a side from the "
            "middle.",
            mistakes.PoseOf(scale=2.0),
            "Draw the square: is it a side or half a side?",
        ),
        Wrong(
            "half the size of the square",
            "Everything seems half as far away as it is. `size` is the whole side.",
            mistakes.PoseOf(scale=0.5),
            "Draw the square: is it a side or half a side?",
        ),
        Wrong(
            "the rotation transposed",
            "The translation is right, but the rotation is that of the camera in the tag's frame. "
            "Transpose it.",
            mistakes.rotation_transposed,
            "R_cm takes directions from the tag's frame to the camera's.",
        ),
        Wrong(
            "no rotation",
            "The rotation is left as the identity. cv2.Rodrigues makes a matrix of the rotation "
            "vector.",
            mistakes.Seen(pose=lambda T: se3.pose(np.eye(3), T[:3, 3])),
            "A pose has two parts.",
        ),
        Wrong(
            "no translation",
            "The translation is left at zero. It is the second vector that OpenCV returns.",
            mistakes.Seen(pose=lambda T: se3.pose(T[:3, :3], np.zeros(3))),
            "A pose has two parts.",
        ),
        Wrong(
            "the translation with a minus",
            "The translation that OpenCV returns is the tag's position in the camera's frame: "
            "leave its sign as it is.",
            mistakes.Seen(pose=lambda T: se3.pose(T[:3, :3], -T[:3, 3])),
            "A tag in front of the camera has a positive z.",
        ),
        Wrong(
            "millimetres",
            "Your translation is in millimetres. OpenCV returns it in the unit of the corners, "
            "metres: leave it so.",
            mistakes.Seen(pose=lambda T: se3.pose(T[:3, :3], 1000.0 * T[:3, 3])),
            "Say the unit of every number.",
        ),
        Wrong(
            "u and v exchanged",
            "A pixel is (u, v): first along the row, then down. You have exchanged the two.",
            mistakes.Seen(pixels=lambda p: p[:, ::-1]),
            "u along x, v along y.",
        ),
        Wrong(
            "the pixels one corner late",
            "The first pixel belongs to the first corner. Your pixels begin at another corner, so "
            "the tag is turned by 90 degrees.",
            mistakes.Seen(pixels=lambda p: np.roll(p, 1, axis=0)),
            "Say which pixel belongs to which corner.",
        ),
        Wrong(
            "the pixels one corner early",
            "The first pixel belongs to the first corner. Your pixels begin at another corner, so "
            "the tag is turned by 90 degrees.",
            mistakes.Seen(pixels=lambda p: np.roll(p, -1, axis=0)),
            "Say which pixel belongs to which corner.",
        ),
        Wrong(
            "the principal point subtracted twice",
            "solvePnPGeneric subtracts the principal point itself, with the camera's matrix: pass "
            "the pixels as they are.",
            mistakes.Seen(pixels=lambda p: p - np.array([320.0, 240.0])),
            "Say which function does which step.",
        ),
    ),
    variants=(variants.pose_by_iteration,),
)

QUALITY = Problem(
    name="sensor_quality",
    points=3,
    core=False,
    outcomes=("sensing",),
    asks="From many estimates `T_cm` of one tag and its true pose give `(bias, covariance)` of "
    "the error, truth minus estimate. An error has six numbers: three of position and the "
    "rotation vector of R_truth R_estimate^T. The shapes are (6,) and (6, 6).",
    answer=answers.sensor_quality,
    judge=Close(rtol=1e-6, atol=1e-10, parts=("bias", "covariance")),
    trials=(
        Trial(
            "an offset and a little noise",
            (call(*hidden.scattered(_RANDOM, 6, [0.002, 0, 0.004, 0, 0.01, 0], 1e-4)),),
            hidden.offsets,
            "other offsets",
            0.0,
            "bias",
        ),
        Trial(
            "noise",
            (call(*hidden.scattered(_RANDOM, 8, np.zeros(6), 0.003)),),
            hidden.noises,
            "noise and offset together",
            3.0,
            "covariance",
        ),
    ),
    hints=(
        "First compute one error vector of six numbers for each estimate. Then take the mean and "
        "the covariance of these vectors.",
        "se3.rotation_log(R_truth @ R_estimate.T) is the rotation from the estimate to the truth.",
        "First make n rows of six errors, with the function for the error of a pose and the truth "
        "first. Then numpy has a mean along an axis, and a covariance that expects its variables "
        "in rows.",
    ),
    wrong=(
        Wrong(
            "the spread about zero",
            "The covariance is taken about zero, so a constant offset counts as spread. Take it "
            "about the mean: averaging many pictures reduces the effect of the spread, but never "
            "that of an offset.",
            mistakes.spread_about_zero,
            "Averaging reduces the spread; only calibration reduces the bias.",
        ),
        Wrong(
            "estimate minus truth",
            "The sign is wrong: in this course an error is target minus actual, here truth minus "
            "estimate.",
            mistakes.the_other_sign,
            "Choose one sign of the error, and say it aloud.",
        ),
        Wrong(
            "Euler angles subtracted",
            "A tag that faces the camera is rotated by half a turn from the camera's axes, "
            "exactly where Euler angles jump. Use the logarithm of one rotation.",
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
            "This is the covariance of the mean. Give the covariance of a single picture: do not "
            "divide by the number of pictures.",
            mistakes.of_the_mean,
            "Standard deviation and standard error are two things.",
        ),
        Wrong(
            "the variances alone",
            "The errors are correlated: a tag that seems tilted also seems moved. Give the whole "
            "covariance, as np.cov does.",
            mistakes.diagonal_only,
            "The numbers off the diagonal say which errors occur together.",
        ),
        Wrong(
            "the turn in the tag's axes",
            "R_estimateᵀ R_truth is a rotation in the tag's axes. Position and rotation should "
            "both be in the camera's axes: R_truth R_estimateᵀ.",
            mistakes.turn_in_tag_axes,
            "In which axes is the rotation vector?",
        ),
        Wrong(
            "the turn reversed",
            "This is the rotation from the truth to the estimate. Put the truth on the left of "
            "the product.",
            mistakes.turn_backwards,
            "Choose one sign of the error, and say it aloud.",
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
            "Put the position first, then the rotation vector.",
            mistakes.turn_first,
            "In this course the position comes before the rotation.",
        ),
        Wrong(
            "everything in the tag's axes",
            "The inverse of the estimate times the truth has all six numbers in the tag's axes. "
            "Give them in the camera's.",
            mistakes.everything_in_the_tag,
            "In which axes is the error?",
        ),
        Wrong(
            "about zero, with n - 1",
            "The covariance is about the mean: subtract the mean from each error first, as np.cov "
            "does.",
            mistakes.Quality(spread=lambda e: e.T @ e / (len(e) - 1)),
            "Bias and spread are two different numbers.",
        ),
        Wrong(
            "degrees",
            "Your rotation vector is in degrees. Give it in radians.",
            mistakes.Quality((1.0, 180.0 / np.pi)),
            "Say the unit of every number.",
        ),
        Wrong(
            "millimetres",
            "Your position is in millimetres. Give it in metres.",
            mistakes.Quality((1000.0, 1.0)),
            "Say the unit of every number.",
        ),
        Wrong(
            "correlations",
            "np.corrcoef divides by the standard deviations. Give the covariance, which has units.",
            mistakes.Quality(spread=lambda e: np.corrcoef(e.T)),
            "A correlation has no unit: it does not say how large the errors are.",
        ),
        Wrong(
            "a median",
            "This is the median. The bias is the mean of the errors.",
            mistakes.Quality(centre=lambda e: np.median(e, axis=0)),
            "Mean and median are two different numbers.",
        ),
        Wrong(
            "an RMS for the mean",
            "An RMS has no sign, and it includes the spread. The bias is the mean.",
            mistakes.Quality(centre=lambda e: np.sqrt((e**2).mean(axis=0))),
            "Bias and spread are two different numbers.",
        ),
        Wrong(
            "the mean of sizes",
            "In a bias, errors of opposite sign must cancel: keep the signs.",
            mistakes.Quality(centre=lambda e: np.abs(e).mean(axis=0)),
            "A bias has a sign.",
        ),
        Wrong(
            "the sum of the errors",
            "The bias is the mean: divide the sum by the number of estimates.",
            mistakes.Quality(centre=lambda e: e.sum(axis=0)),
            "A mean does not grow with n.",
        ),
        Wrong(
            "no transpose",
            "R_truth R_estimate is not the rotation between the two. Undo the estimate with its "
            "transpose.",
            mistakes.Quality(turn=lambda R, S: se3.rotation_log(R @ S)),
            "Orientations are compared by R Sᵀ.",
        ),
        Wrong(
            "the place in the tag's axes",
            "Your error of position is in the tag's axes. Give it in the camera's axes.",
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
    asks="Join a moving reference to a moving goal by a polynomial of fifth order. At `t` = 0 the "
    "polynomial has the reference's position, velocity and acceleration; at `t` = `duration` it "
    "has the goal's. After that the result goes on with the goal's velocity, without "
    "acceleration. Give an `lk.Sample`.",
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
        "c0, c1 and c2 follow directly from the start: p, v and a/2. The other three solve a 3 x "
        "3 system with the rows [T³, T⁴, T⁵], [3T², 4T³, 5T⁴], [6T, 12T², 20T³].",
        "The first three coefficients follow from the start. The goal gives three equations for "
        "the others: what the goal demands, minus what the three known coefficients contribute at "
        "the end. Solve these equations for all axes at once.",
    ),
    wrong=(
        Wrong(
            "a new start from rest",
            "Every new goal stops the reference dead, and the arm with it, as in the report's "
            "Algorithm 1. Begin with the velocity and the acceleration that the reference has.",
            mistakes.restarts_at_rest,
            "A reference that jumps makes an arm jerk.",
        ),
        Wrong(
            "rates of t used for x = t/T",
            "As a derivative with respect to x = t/T, a velocity is T times as large, and an "
            "acceleration T² times. Convert both; T = 1 does not show this mistake.",
            mistakes.rates_not_scaled,
            "Scale derivatives when you scale time.",
        ),
        Wrong(
            "a stop at the goal",
            "The goal moves on, but the reference arrives at rest, so it will always lag behind. "
            "End with the goal's velocity.",
            mistakes.stops_at_the_goal,
            "Meet a moving goal with its velocity.",
        ),
        Wrong(
            "a cubic polynomial",
            "A cubic matches position and velocity, but its acceleration jumps at every new goal, "
            "and the torque with it. Use fifth order to match the acceleration as well.",
            mistakes.without_the_bend,
            "Count the conditions: a polynomial needs as many coefficients.",
        ),
        Wrong(
            "the start's velocity left out",
            "The reference is moving when the blend begins. At t = 0 the blend must have the "
            "reference's velocity.",
            mistakes.Blended(start=(0.0, 1.0)),
            "At both ends check position, velocity and acceleration.",
        ),
        Wrong(
            "the start's acceleration left out",
            "At t = 0 the acceleration must be the reference's: the coefficient of t² is half of it.",
            mistakes.Blended(start=(1.0, 0.0)),
            "At both ends check position, velocity and acceleration.",
        ),
        Wrong(
            "the goal's velocity left out",
            "The goal moves on. At t = duration the blend must have the goal's velocity.",
            mistakes.Blended(end=(0.0, 1.0)),
            "At both ends check position, velocity and acceleration.",
        ),
        Wrong(
            "the goal's acceleration left out",
            "At t = duration the blend must have the goal's acceleration, which is not always "
            "zero.",
            mistakes.Blended(end=(1.0, 0.0)),
            "At both ends check position, velocity and acceleration.",
        ),
        Wrong(
            "from rest to rest",
            "This blend begins and ends at rest. Take over the velocities and accelerations of "
            "start and goal.",
            mistakes.Blended(start=(0.0, 0.0), end=(0.0, 0.0)),
            "At both ends check position, velocity and acceleration.",
        ),
        Wrong(
            "a polynomial without end",
            "After `duration` the polynomial grows without limit. From there on, continue with "
            "the goal's velocity.",
            mistakes.never_ends,
            "A polynomial is useful only between its ends.",
        ),
        Wrong(
            "a wait at the goal",
            "After the end your blend stands still. The position must go on with the velocity of "
            "the goal.",
            mistakes.waits_at_the_goal,
            "The velocity must be the slope of the position.",
        ),
        Wrong(
            "an acceleration that never ends",
            "After the end the acceleration must be zero, even if the goal's was not. Set it to "
            "zero there.",
            mistakes.speeds_up_for_ever,
            "Read what the question says about the time after the end.",
        ),
        Wrong(
            "an acceleration without effect",
            "After the end the velocity is constant, so the acceleration is zero.",
            mistakes.acceleration_kept,
            "The acceleration must be the slope of the velocity.",
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
            "The velocity must be the slope of the position.",
        ),
        Wrong(
            "three coordinates, however many there are",
            "A sample may hold a point, seven joint angles or a single number, of shape (n,). Do "
            "not assume three.",
            mistakes.three_alone,
            "Read the shape in the docstring, then try another n.",
        ),
        Wrong(
            "reference and goal exchanged",
            "The blend begins at the reference and ends at the goal. Yours begins at the goal.",
            mistakes.Ends(lambda a, b: (b, a)),
            "Evaluate every reference at t = 0.",
        ),
        Wrong(
            "a crossfade",
            "You mix two motions with a smooth weight, but leave out the derivatives of the "
            "weight. So the velocity is not the slope of the position. Use one polynomial of "
            "fifth order.",
            mistakes.Ends(made=mistakes.crossfade),
            "Check that the velocity is the slope of the position.",
        ),
        Wrong(
            "counts from the start after the end",
            "After the end the goal has moved for t - duration, not for t.",
            mistakes.Ends(
                late=lambda b, t, T: Sample(
                    b.position + b.velocity * t, b.velocity, 0.0 * b.velocity
                )
            ),
            "Say for each time from which instant it is counted.",
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
            "Before the end your velocity is zero. Give the derivative of the position.",
            mistakes.Ends(
                made=lambda x, t, a, b, T: Sample(x.position, 0.0 * x.velocity, x.acceleration)
            ),
            "Check that the velocity is the slope of the position.",
        ),
        Wrong(
            "no acceleration",
            "Before the end your acceleration is zero. Give the derivative of the velocity.",
            mistakes.Ends(
                made=lambda x, t, a, b, T: Sample(x.position, x.velocity, 0.0 * x.velocity)
            ),
            "Check that the acceleration is the slope of the velocity.",
        ),
        Wrong(
            "the velocity not divided by the duration",
            "This velocity is the derivative with respect to t/duration. Divide it by the "
            "duration.",
            mistakes.Ends(
                made=lambda x, t, a, b, T: Sample(x.position, x.velocity * T, x.acceleration)
            ),
            "Say with respect to what you differentiate.",
        ),
        Wrong(
            "the acceleration not divided by the duration",
            "This acceleration is the second derivative with respect to t/duration. Divide it by "
            "the duration squared.",
            mistakes.Ends(
                made=lambda x, t, a, b, T: Sample(x.position, x.velocity, x.acceleration * T**2)
            ),
            "Say with respect to what you differentiate.",
        ),
        Wrong(
            "the acceleration divided by the duration once",
            "The acceleration is a second derivative: from t/duration to t, divide it by the "
            "duration squared, not by the duration.",
            mistakes.Ends(
                made=lambda x, t, a, b, T: Sample(x.position, x.velocity, x.acceleration * T)
            ),
            "Say with respect to what you differentiate.",
        ),
    ),
    variants=(variants.blend_by_bernstein,),
)

PREDICT = Problem(
    name="carry_forward",
    points=5,
    outcomes=("sensing",),
    asks="A tag is believed to have the position and the velocity in `mean`, with `covariance`. "
    "Give both `age` seconds later, for constant velocity under continuous white acceleration of "
    "power `accel_noise`.",
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
        "The position grows by age times velocity, and the velocity stays: together a matrix F. "
        "How does a matrix change a covariance?",
        "mean' = F mean and covariance' = F P F^T + Q. Q is what the random accelerations add. It "
        "must vanish with the age, and two half steps must give the same as one whole step.",
        "Multiply F(s) diag(0, q) F(s)ᵀ out for one axis: the four entries are powers of s. "
        "Integrate each of them from 0 to the age. The three axes do not mix; numpy's kron "
        "spreads the result over them.",
    ),
    wrong=(
        Wrong(
            "the age of the picture ignored",
            "At 0.1 m/s a picture that is 100 ms old is 10 mm wrong. Carry the mean forward.",
            mistakes.ignores_the_age,
            "A measurement belongs to the time at which it was taken.",
        ),
        Wrong(
            "noise that does not know of time",
            "Your noise does not depend on the length of the step, so ten short steps add ten "
            "times the noise of one long one. Let Q grow with `age`.",
            mistakes.noise_without_time,
            "Two half steps must give the same as one step.",
        ),
        Wrong(
            "a covariance that stays the same",
            "The mean moves on, but the covariance does not, so the filter soon trusts only its "
            "own belief. Carry the covariance forward too, and add the noise.",
            mistakes.certain_for_ever,
            "What is not seen becomes less sure.",
        ),
        Wrong(
            "the cross terms left out",
            "A push changes the velocity and, through the velocity, the position, so the two "
            "errors are correlated. Keep the terms between them.",
            mistakes.noise_on_the_diagonal,
            "Derive Q; do not guess its diagonal.",
        ),
        Wrong(
            "one push in each step",
            "age⁴/4, age³/2 and age² belong to a single push that is held for the whole step: two "
            "half steps then do not give the same as one step. White noise gives age³/3, age²/2 "
            "and age.",
            mistakes.Predicted(((4, 0.25), (3, 0.5), (2, 1.0))),
            "Held noise and white noise grow with different powers of the step.",
        ),
        Wrong(
            "Q left out",
            "Q is missing, so the velocity never becomes less certain, and soon the filter "
            "ignores every picture. Add Q.",
            mistakes.Predicted(((0, 0.0), (0, 0.0), (0, 0.0))),
            "What is not seen becomes less sure.",
        ),
        Wrong(
            "pushes on the velocity alone",
            "A push at the beginning of the step has moved the position by its end. Integrate "
            "F(s) too.",
            mistakes.Predicted(((0, 0.0), (0, 0.0), (1, 1.0))),
            "Derive Q; do not guess its diagonal.",
        ),
        Wrong(
            "the same on place and velocity",
            "accel_noise · age has the wrong unit for the position. Integrate F(s) diag(0, q) "
            "F(s)ᵀ.",
            mistakes.Predicted(((1, 1.0), (0, 0.0), (1, 1.0))),
            "Check the unit: a variance of position is in m².",
        ),
        Wrong(
            "the noise squared",
            "accel_noise is a power already, in m²/s³. Do not square it.",
            mistakes.Predicted(((3, 1 / 3), (2, 0.5), (1, 1.0)), power=2.0),
            "Is it a variance or a deviation? Look at the unit.",
        ),
        Wrong(
            "F P without Fᵀ",
            "A covariance goes through a matrix from both sides: F P Fᵀ.",
            mistakes.half_the_product,
            "A covariance is symmetric: check that yours is.",
        ),
        Wrong(
            "Fᵀ P F instead of F P Fᵀ",
            "The transpose belongs on the right: F P Fᵀ.",
            mistakes.product_turned_round,
            "y = F x has the covariance F P Fᵀ.",
        ),
        Wrong(
            "back in time",
            "Carry the mean forward by `age`, from the picture to now.",
            mistakes.back_in_time,
            "Say for each number at what time it is valid.",
        ),
        Wrong(
            "the mean not moved",
            "The mean is not moved. The position goes on with the velocity: F m.",
            mistakes.Carried(mean=False),
            "Mean and covariance both move.",
        ),
        Wrong(
            "the noise before the motion",
            "Q is the effect of the pushes during the step, at the end of the step: add Q after F "
            "P Fᵀ.",
            mistakes.Carried(order="Q first"),
            "F P Fᵀ + Q.",
        ),
        Wrong(
            "the covariance not moved",
            "The covariance is not carried forward by F: an uncertain velocity makes the position "
            "uncertain too.",
            mistakes.Carried(order="no F"),
            "F P Fᵀ + Q.",
        ),
        Wrong(
            "the noise subtracted",
            "Pushes make the belief less certain: add Q, do not subtract it.",
            mistakes.Carried(noise=-1.0),
            "A belief becomes less certain with time.",
        ),
        Wrong(
            "the noise twice",
            "Add Q only once.",
            mistakes.Carried(noise=2.0),
            "F P Fᵀ + Q.",
        ),
        Wrong(
            "the velocity moved by the place",
            "F has the age in its upper right block, because the velocity moves the position.",
            mistakes.Carried(lambda age: [[1.0, 0.0], [age, 1.0]]),
            "The velocity moves the position, not the other way round.",
        ),
        Wrong(
            "the age squared in F",
            "The position moves by velocity times age, so F has the age itself.",
            mistakes.Carried(lambda age: [[1.0, age**2 / 2.0], [0.0, 1.0]]),
            "The velocity moves the position, not the other way round.",
        ),
        Wrong(
            "a half where a third belongs",
            "The block of the position has age³/3: ∫ (age - s)² ds.",
            mistakes.Predicted(((3.0, 0.5), (2.0, 0.5), (1.0, 1.0))),
            "Integrate the push's effect.",
        ),
        Wrong(
            "no third",
            "The block of the position has age³/3: ∫ (age - s)² ds.",
            mistakes.Predicted(((3.0, 1.0), (2.0, 0.5), (1.0, 1.0))),
            "Integrate the push's effect.",
        ),
        Wrong(
            "no half beside the diagonal",
            "The blocks off the diagonal have age²/2: ∫ (age - s) ds.",
            mistakes.Predicted(((3.0, 1.0 / 3.0), (2.0, 1.0), (1.0, 1.0))),
            "Integrate the push's effect.",
        ),
        Wrong(
            "age² for the place's age³",
            "The block of the position has age³/3: ∫ (age - s)² ds.",
            mistakes.Predicted(((2.0, 1.0 / 3.0), (2.0, 0.5), (1.0, 1.0))),
            "Integrate the push's effect.",
        ),
        Wrong(
            "age² for the velocity's age",
            "The block of the velocity has age, to the first power.",
            mistakes.Predicted(((3.0, 1.0 / 3.0), (2.0, 0.5), (2.0, 1.0))),
            "Integrate the push's effect.",
        ),
        Wrong(
            "place and velocity exchanged in Q",
            "The block of the position has age³/3, and that of the velocity has age.",
            mistakes.Predicted(((1.0, 1.0), (2.0, 0.5), (3.0, 1.0 / 3.0))),
            "Integrate the push's effect.",
        ),
        Wrong(
            "a minus beside the diagonal",
            "A push forward increases the velocity and the position: both grow together, so the "
            "sign is plus.",
            mistakes.Predicted(((3.0, 1.0 / 3.0), (2.0, -0.5), (1.0, 1.0))),
            "Say whether two errors grow together or against each other.",
        ),
    ),
    variants=(variants.predict_by_exponential,),
)

PROBLEMS = (TAG_CORNERS, TAG_POSE, QUALITY, BLEND, PREDICT)
