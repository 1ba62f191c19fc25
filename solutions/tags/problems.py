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
            "a rotation vector read as Euler angles",
            "The three numbers are an axis times an angle. cv2.Rodrigues turns them into a matrix.",
            mistakes.vector_as_euler_angles,
            "For three numbers that describe a rotation, always ask which three they are.",
        ),
        Wrong(
            "the candidate that fits worse",
            "A flat square looks nearly the same whether it is tilted in one direction or in the "
            "opposite one. Choose the candidate with the smaller error.",
            mistakes.the_worse_answer,
            "A flat tag has two candidate poses; compare their errors.",
        ),
        Wrong(
            "twice the size of the square",
            "Everything seems twice as far away as it is. The corners lie half a side from the "
            "middle.",
            mistakes.PoseOf(scale=2.0),
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
            "u and v exchanged",
            "A pixel is (u, v): first along the row, then down. You have exchanged the two.",
            mistakes.Seen(pixels=lambda p: p[:, ::-1]),
            "u along x, v along y.",
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
            "correlations",
            "np.corrcoef divides by the standard deviations. Give the covariance, which has units.",
            mistakes.Quality(spread=lambda e: np.corrcoef(e.T)),
            "A correlation has no unit: it does not say how large the errors are.",
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
            "the goal's acceleration left out",
            "At t = duration the blend must have the goal's acceleration, which is not always "
            "zero.",
            mistakes.Blended(end=(1.0, 0.0)),
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
            "an acceleration that never ends",
            "After the end the acceleration must be zero, even if the goal's was not. Set it to "
            "zero there.",
            mistakes.speeds_up_for_ever,
            "Read what the question says about the time after the end.",
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
            "the noise squared",
            "accel_noise is a power already, in m²/s³. Do not square it.",
            mistakes.Predicted(((3, 1 / 3), (2, 0.5), (1, 1.0)), power=2.0),
            "Is it a variance or a deviation? Look at the unit.",
        ),
        Wrong(
            "back in time",
            "Carry the mean forward by `age`, from the picture to now.",
            mistakes.back_in_time,
            "Say for each number at what time it is valid.",
        ),
        Wrong(
            "the covariance not moved",
            "The covariance is not carried forward by F: an uncertain velocity makes the position "
            "uncertain too.",
            mistakes.Carried(order="no F"),
            "F P Fᵀ + Q.",
        ),
        Wrong(
            "the velocity moved by the place",
            "F has the age in its upper right block, because the velocity moves the position.",
            mistakes.Carried(lambda age: [[1.0, 0.0], [age, 1.0]]),
            "The velocity moves the position, not the other way round.",
        ),
        Wrong(
            "a half where a third belongs",
            "The block of the position has age³/3: ∫ (age - s)² ds.",
            mistakes.Predicted(((3.0, 0.5), (2.0, 0.5), (1.0, 1.0))),
            "Integrate the push's effect.",
        ),
        Wrong(
            "no half beside the diagonal",
            "The blocks off the diagonal have age²/2: ∫ (age - s) ds.",
            mistakes.Predicted(((3.0, 1.0 / 3.0), (2.0, 1.0), (1.0, 1.0))),
            "Integrate the push's effect.",
        ),
    ),
    variants=(variants.predict_by_exponential,),
)

PROBLEMS = (
    TAG_POSE,
    QUALITY,
    BLEND,
    PREDICT,
)
