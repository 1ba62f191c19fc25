"""The questions of notebook 06."""

from __future__ import annotations

import numpy as np

from labkit import Sample, se3
from labkit.course import Close
from labkit.course.authoring.problem import Problem, Trial, Wrong, call
from labkit.servo import Bend

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


_LOOKS = tuple(hidden.looking(_RANDOM) for _ in range(2))
_EARLY, _NEAR, _FAR, *_NO_TAG = (hidden.looking(_RANDOM, *x) for x in hidden.OCCASIONS)
_WHEN = "other waits, steps, and pictures without the tag"


TAG_POSE = Problem(
    name="tag_pose",
    points=4,
    outcomes=("frames",),
    asks="Project the four corners with each of the two candidate poses `T_cm`. Give the candidate "
    "that fits the pixels better, and its error: the root mean square of the four distances, in px.",
    answer=answers.tag_pose,
    judge=Close(rtol=1e-6, atol=1e-9, parts=("pose", "error")),
    trials=(
        Trial(
            "the better one of two",
            (call(*hidden.candidates(_RANDOM, hidden.seen(0.6, 0.8, 0.4, 0.3, x=0.05), 0.1)),),
            hidden.tilted,
            "other tags",
            0.0,
            "pose",
        ),
        Trial(
            "in whatever order they come",
            tuple(hidden.tilted(np.random.default_rng(8))),
            hidden.tilted,
            "tags near and far, in both orders",
            2.0,
            "pose",
        ),
        Trial(
            "how well it fits",
            tuple(hidden.tilted(np.random.default_rng(9)))[:2],
            hidden.tilted,
            "tags near and far, in both orders",
            2.0,
            "error",
        ),
    ),
    withheld=("labkit.tags.detection", "labkit.detect_tags"),
    hints=(
        "A corner c of the tag is at R c + p in the camera's frame. Where is it in the picture?",
        "K times that point gives (u w, v w, w). Divide by w, subtract the pixel, and square.",
        "All corners at once: multiply the (4, 3) array by the transposed R, add p, multiply by "
        "the transposed K and divide the first two columns by the third.",
    ),
    wrong=(
        Wrong(
            "the worse one",
            "This is the candidate whose corners are farther from the pixels.",
            mistakes.Chosen(best=np.argmax),
        ),
        Wrong(
            "always the first",
            "They come in no order: you return the first one even where the second fits better.",
            mistakes.Chosen(best=lambda errors: 0),
            "Look whether a list is sorted before you take its head.",
        ),
        Wrong(
            "the camera in the tag's frame",
            "You project with the inverse of the candidate, which takes points the other way.",
            mistakes.Chosen(pose=se3.inverse),
            cure="T_cm takes points from m to c as it is.",
        ),
        Wrong(
            "the transposed rotation",
            "Your corners are turned back: points in rows need the transposed rotation.",
            mistakes.Chosen(pose=lambda T: se3.pose(T[:3, :3].T, T[:3, 3])),
            cure="R c for a column c is c @ R.T for a row.",
        ),
        Wrong(
            "twice the size of the square",
            "You project a square of twice the size.",
            mistakes.Chosen(scale=2.0),
            "Draw the square: is it a side or half a side?",
            "The corners lie half a side from the middle.",
        ),
        Wrong(
            "no perspective",
            "What is twice as far away looks half as large, but your projection ignores the depth.",
            mistakes.Chosen(project=lambda p, K: (p @ K.T)[:, :2]),
            "A pixel is a ratio.",
            "Divide by the third number.",
        ),
        Wrong(
            "u and v exchanged",
            "A pixel is (u, v): first along the row, then down. You have exchanged the two.",
            mistakes.Chosen(project=lambda p, K: ((p @ K.T)[:, :2] / p[:, 2:])[:, ::-1]),
        ),
        Wrong(
            "the mean over eight coordinates",
            "You took the mean over all eight coordinates. A corner's distance has both.",
            mistakes.Chosen(error=lambda off: np.sqrt(np.mean(off**2))),
            "Say what one error is before you average errors.",
            "First add the squares of u and v, then take the mean over four corners.",
        ),
        Wrong(
            "the sum over the corners",
            "Your error grows with the number of corners.",
            mistakes.Chosen(error=np.linalg.norm),
            cure="Take the mean over the corners before the root.",
        ),
        Wrong(
            "the mean distance",
            "You took the mean of the distances, not the root of their mean square.",
            mistakes.Chosen(error=lambda off: np.mean(np.linalg.norm(off, axis=1))),
            "RMS weighs the large ones more.",
        ),
    ),
    variants=(variants.pose_by_opencv,),
)

STEP = Problem(
    name="servo_step",
    points=6,
    outcomes=("frames", "sensing"),
    asks="Look if at least `every` seconds have passed since `looked`; "
    "else return the memory as it is. A look sets `looked`, and without a tag nothing else. "
    "The goal's pose comes from the sighting and from the hand *at its stamp*. Only if it is more "
    "than `moved` from the memory's goal, the memory takes the new goal and a straight "
    "`lk.Trajectory` to it, from where the reference is now, with a bang-bang of `seconds`.",
    answer=answers.servo_step,
    judge=Close(rtol=1e-6, atol=1e-8),
    trials=(
        Trial(
            "a first look, without any turns",
            (hidden.looking(_RANDOM, plain=True),),
            hidden.first_looks,
            "other places",
            0.0,
        ),
        Trial("the goal", (_LOOKS[0], _NEAR), hidden.looks, "other hands", 2.0, "goal"),
        Trial("when it looks", (_EARLY, _NEAR, *_NO_TAG), hidden.occasions, _WHEN, 1.0, "looked"),
        Trial("whether it begins anew", (_NEAR, _FAR), hidden.occasions, _WHEN, 1.0, "began"),
        Trial("the new line", _LOOKS[1:], hidden.looks, "other lines", 1.0, "line"),
        Trial(
            "behind a tag on a conveyor, and above a tag at rest",
            (hidden.chase(hidden.WHOLE), hidden.chase({"lines": 2.0}, speed=0.0)),
            hidden.belts,
            "other speeds",
            1.0,
        ),
    ),
    hints=(
        "Four questions in order: is it due? is there a tag? where is the goal? has it moved?",
        "Read the frames from right to left: the goal in the tag, the tag in the camera, the camera "
        "at the tip, the tip in the world. Which of the four belongs to another time than now?",
        "`memory._replace(looked=t)` changes one field. The reference is now at "
        "`memory.line(t - memory.began).position`; a new line has its own zero of time.",
    ),
    wrong=(
        Wrong(
            "the hand of now",
            "You used the hand's pose of now with a picture of then. In between the hand has moved, "
            "and you take its own motion for the tag's.",
            mistakes.Stepping(
                goal=lambda hand, t, s, T_tc, T_cm, T_mg: hand(t) @ T_tc @ T_cm @ T_mg
            ),
            "A picture belongs with the joint angles of its own time stamp.",
            "Ask for the hand at the stamp.",
        ),
        Wrong(
            "the camera left out",
            "The camera is not at the tip, but your goal takes it to be.",
            mistakes.Stepping(goal=lambda hand, t, s, T_tc, T_cm, T_mg: hand(s) @ T_cm @ T_mg),
            cure="T_tc belongs between the hand and the sighting.",
        ),
        Wrong(
            "the camera inverted",
            "You turned T_tc round: it is the camera's pose in the tip's frame.",
            mistakes.Stepping(
                goal=lambda hand, t, s, T_tc, T_cm, T_mg: hand(s) @ se3.inverse(T_tc) @ T_cm @ T_mg
            ),
            "Neighbouring subscripts must match.",
        ),
        Wrong(
            "into the tag",
            "The tip's goal is where the tag is: the arm would run into the board.",
            mistakes.Stepping(goal=lambda hand, t, s, T_tc, T_cm, T_mg: hand(s) @ T_tc @ T_cm),
            "Say which frame has which goal.",
            "T_mg says where the goal is in the tag's frame.",
        ),
        Wrong(
            "the goal in the world's axes",
            "You applied T_mg in the world's frame: a tag that turns would leave the goal behind.",
            mistakes.Stepping(
                goal=lambda hand, t, s, T_tc, T_cm, T_mg: T_mg @ hand(s) @ T_tc @ T_cm
            ),
            "On the left: the world's axes; on the right: its own.",
            "T_mg stands at the right end of the chain.",
        ),
        Wrong(
            "from the end of the old line",
            "The new line begins at the old goal, where the reference has not arrived yet: it jumps. "
            "Either you took the goal itself, or you gave `line` the time of day.",
            mistakes.Stepping(start=lambda memory, t, hand, goal: memory.goal[:3, 3]),
            "A new reference begins where the old one is.",
            "Begin where the old line is now, `t - began` after its beginning.",
        ),
        Wrong(
            "from the beginning of the old line",
            "The new line begins where the old one began: it jumps back.",
            mistakes.Stepping(start=lambda memory, t, hand, goal: memory.line(0.0)[0]),
            cure="Begin where the old line is now.",
        ),
        Wrong(
            "looks at every call",
            "It looks even if it looked a moment ago.",
            mistakes.Stepping(due=lambda wait, every: True),
            "Two rates: the loop's and the camera's.",
            "Return the memory as it is until `every` seconds have passed since `looked`.",
        ),
        Wrong(
            "a new line after every look",
            "It begins a new line although the goal has moved by less than `moved`: a tag at rest "
            "gives a line for each millimetre of noise.",
            mistakes.Stepping(far=lambda d, moved: True),
            "Without a threshold the noise moves the arm: 24 lines in 12 s where 1 would do.",
            "Compare the distance between the two goals with `moved`.",
        ),
        Wrong(
            "a goal that creeps",
            "Without a new line the old goal must stay: if it follows each small step, a slow tag is "
            "never far from it, and the arm never starts.",
            mistakes.Stepping(near=lambda memory, t, goal: memory._replace(looked=t, goal=goal)),
            "Compare with the goal to which the line leads.",
        ),
        Wrong(
            "a look that is forgotten",
            "A look that changed nothing is not remembered, so it looks again at once.",
            mistakes.Stepping(unseen=lambda memory, t: memory, near=lambda memory, t, goal: memory),
            "A look is an event, whatever it shows.",
            "Set `looked` whenever it has looked.",
        ),
        Wrong(
            "no tag is not a look",
            "A look without a tag is not remembered, so it looks again at once.",
            mistakes.Stepping(unseen=lambda memory, t: memory),
            cure="Set `looked` whenever it has looked.",
        ),
        Wrong(
            "an old start",
            "The new line begins now, but `began` still has the old time.",
            mistakes.Stepping(seen=lambda memory: memory._replace(began=memory.began - 1.2)),
        ),
        Wrong(
            "seconds per metre",
            "The line takes `seconds` in all, but yours takes that for each metre.",
            mistakes.Stepping(lasts=lambda seconds, d: seconds * max(d, 1e-3)),
            "The report's 5 had a hidden unit.",
        ),
    ),
    variants=(variants.step_by_cases,),
)

SMOOTH = Problem(
    name="servo_smooth",
    points=4,
    outcomes=("sensing", "motion"),
    asks="At each call bend the reference towards the tag. Fit a straight line to the goals of all "
    "`sightings` over their stamps; its place at t + `ahead` and its velocity are where the new "
    "`Bend` of `ahead` seconds ends. It begins with the reference's present sample, at `began` = t. If the "
    "newest sighting is more than `patience` old, or there is none, come to rest in `ahead` "
    "seconds, `ahead`/2 times the present velocity further on.",
    answer=answers.servo_smooth,
    judge=Close(rtol=0.0, atol=1e-4),
    trials=(
        Trial(
            "to a tag at rest",
            (hidden.bending(_RANDOM, plain=True),),
            hidden.bends,
            "other places",
            0.0,
            "line",
        ),
        Trial(
            "smooth, on a conveyor and after a jump",
            (
                hidden.bending(_RANDOM, 0.0),
                hidden.chase(hidden.SMOOTH, hidden.LAST),
                hidden.chase(hidden.JUMP, hidden.LAST, speed=0.0, jump=0.1, age=0.5),
            ),
            hidden.smooth,
            "other speeds",
            2.0,
            "line",
        ),
        Trial(
            "the same, seen half a second late",
            (
                *(hidden.bending(_RANDOM, age) for age in (0.4, 1.6)),
                hidden.chase(hidden.SMOOTH, hidden.LAST, age=0.5),
            ),
            hidden.late,
            "other ages and speeds",
            1.0,
            "line",
        ),
        Trial(
            "blind for a second, and for good",
            (
                hidden.bending(_RANDOM, 0.4, stale=1.5),
                hidden.chase(hidden.SMOOTH, hidden.LAST, age=0.5, blind=(6.0, 7.0)),
                hidden.chase(hidden.GONE, hidden.LAST, age=0.5, blind=(6.0, 99.0)),
            ),
            hidden.blind,
            "other seeds",
            1.0,
            "line",
        ),
    ),
    hints=(
        "First the goals: one pose for each sighting, as in servo_step. Then ask of their places "
        "where they will be, and how fast.",
        "np.polyfit(stamps - t, places, 1) fits all three coordinates at once and gives the velocity "
        "and the place at t.",
        "The start of the Bend is memory.line(t - memory.began), all three parts. Its end is a "
        "Sample: the fitted place carried on by `ahead`, the fitted velocity, no acceleration.",
    ),
    wrong=(
        Wrong(
            "the hand of now",
            "You used the hand's pose of now with pictures of then: you take the hand's own motion "
            "for the tag's, so the tag seems to flee, the hand follows, and the tag flees faster.",
            mistakes.Smoothing(hand_at=lambda t, s: t),
            cure="Ask for the hand at each stamp.",
        ),
        Wrong(
            "the age ignored",
            "You took the newest sighting for one of now, so you aim where the tag was.",
            mistakes.Smoothing(stamps=lambda s, t: s + t - s[-1]),
            "Half a second at 3 cm/s is 15 mm.",
            "Count the time to t + `ahead` from the stamps.",
        ),
        Wrong(
            "no velocity",
            "You aim at where the tag was seen, as if it stood still.",
            mistakes.Smoothing(velocity=0.0),
            "Without a velocity every look is too late; but when the tag jumps it is better.",
            "Fit a line over the stamps: its slope is the velocity.",
        ),
        Wrong(
            "aims at now",
            "You aim at where the tag is now, but the bend arrives `ahead` seconds later.",
            mistakes.Smoothing(ahead=0.0),
        ),
        Wrong(
            "velocity per sighting",
            "Your velocity is counted per sighting, not per second.",
            mistakes.Smoothing(stamps=lambda s, t: s[-1] + np.arange(len(s)) - len(s) + 1.0),
            "Say the unit of the horizontal axis.",
            "Fit over the stamps.",
        ),
        Wrong(
            "from rest",
            "The bend begins at rest, although the reference moves: its speed falls to zero at each "
            "call, and it never gets away.",
            mistakes.Smoothing(start=(0.0, 0.0)),
            "Algorithm 1's own mistake.",
            "Begin with all three parts of the present sample.",
        ),
        Wrong(
            "without the acceleration",
            "Position and velocity go on, but the acceleration begins at zero at each call.",
            mistakes.Smoothing(start=(1.0, 0.0)),
            "Six conditions: three at each end.",
        ),
        Wrong(
            "from the old goal",
            "The bend begins at the old goal, where the reference has not arrived yet: it jumps.",
            mistakes.Smoothing(place=lambda memory, p: memory.goal[:3, 3]),
            "A new reference begins where the old one is.",
        ),
        Wrong(
            "from the beginning of the old line",
            "The bend begins where the old one began: it never gets on.",
            mistakes.Smoothing(place=lambda memory, p: memory.line(0.0)[0]),
        ),
        Wrong(
            "stops at the goal",
            "The bend ends at rest, but the tag moves on.",
            mistakes.Smoothing(end=0.0),
        ),
        Wrong(
            "Algorithm 1, more often",
            "This is Algorithm 1 at every call: a line from rest.",
            mistakes.more_often,
            "Looking more often makes many small jerks of a few large ones.",
        ),
        Wrong(
            "never comes to rest",
            "However old the sightings are, it goes on.",
            mistakes.Smoothing(patience=1e6),
            "What is not seen becomes less sure.",
            "Compare the age of the newest sighting with `patience`.",
        ),
        Wrong(
            "stops dead",
            "Without news the reference stands still at once: its speed jumps.",
            mistakes.Smoothing(
                rest=lambda memory, now, t, ahead: memory._replace(
                    line=Bend(
                        Sample(now[0], 0 * now[1], 0 * now[1]),
                        Sample(now[0], 0 * now[1], 0 * now[1]),
                        ahead,
                    ),
                    began=t,
                )
            ),
            "Stopping is a motion, too.",
        ),
        Wrong(
            "back to where it was",
            "The rest is at the present place, so the reference turns back to it.",
            mistakes.Smoothing(
                rest=lambda memory, now, t, ahead: memory._replace(
                    line=Bend(now, Sample(now[0], 0 * now[1], 0 * now[1]), ahead), began=t
                )
            ),
            "Who moves needs a way to stop.",
            "Leave it ahead/2 times its velocity to stop.",
        ),
    ),
    variants=(variants.smooth_by_ends,),
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
            "The sign is wrong: yours is estimate minus truth.",
            mistakes.the_other_sign,
            "Choose one sign of the error, and say it aloud.",
        ),
        Wrong(
            "Euler angles subtracted",
            "A tag that faces the camera is rotated by half a turn from the camera's axes, "
            "exactly where Euler angles jump.",
            mistakes.euler_subtracted,
            "Never subtract Euler angles.",
            cure="Use the logarithm of one rotation.",
        ),
        Wrong(
            "n instead of n - 1 in the denominator",
            "You divided by n, but the mean comes from the same numbers.",
            mistakes.n_in_the_denominator,
            cure="Divide by n - 1.",
        ),
        Wrong(
            "the covariance of the mean",
            "This is the covariance of the mean; that of a single picture is asked for.",
            mistakes.of_the_mean,
            "Standard deviation and standard error are two things.",
            cure="Do not divide by the number of pictures.",
        ),
        Wrong(
            "the variances alone",
            "The errors are correlated: a tag that seems tilted also seems moved. You give the "
            "variances alone.",
            mistakes.diagonal_only,
            cure="Give the whole covariance, as np.cov does.",
        ),
        Wrong(
            "the turn in the tag's axes",
            "Your rotation is in the tag's axes, your position in the camera's.",
            mistakes.turn_in_tag_axes,
            cure="Take R_truth R_estimateᵀ.",
        ),
        Wrong(
            "the turn reversed",
            "This is the rotation from the truth to the estimate.",
            mistakes.turn_backwards,
            cure="Put the truth on the left of the product.",
        ),
        Wrong(
            "logarithms subtracted",
            "The difference of two rotation vectors is not a rotation vector, least of all near "
            "half a turn, where they jump.",
            mistakes.logarithms_subtracted,
            "Orientations are compared by a product.",
            cure="Multiply the rotations, then take one logarithm.",
        ),
        Wrong(
            "about zero, with n - 1",
            "Your spread is about zero, so it holds the bias as well.",
            mistakes.Quality(spread=lambda e: e.T @ e / (len(e) - 1)),
            cure="Subtract the mean from each error first, as np.cov does.",
        ),
    ),
    variants=(variants.quality_by_loops,),
)

BLEND = Problem(
    name="blend",
    points=3,
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
            2.0,
        ),
        Trial(
            "after the end it goes on with the goal's velocity",
            (
                *(call(2.2, _MOVING, goal, 1.6) for goal in (_GOING, _TURNING)),
                call(2.2, _JOINTS, _THEIR_GOAL, 1.6),
            ),
            hidden.blends_after_the_end,
            "other durations, seven joints and a single number",
            1.0,
        ),
    ),
    withheld=("labkit.servo.Bend",),
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
            "and the torque with it.",
            mistakes.without_the_bend,
            "Count the conditions: a polynomial needs as many coefficients.",
            cure="Fifth order matches the acceleration as well.",
        ),
        Wrong(
            "a polynomial without end",
            "After `duration` your polynomial grows without limit.",
            mistakes.never_ends,
            "A polynomial is useful only between its ends.",
            cure="From there on, continue with the goal's velocity.",
        ),
        Wrong(
            "an acceleration that never ends",
            "After the end your acceleration goes on, but the goal's velocity should.",
            mistakes.speeds_up_for_ever,
            cure="Set it to zero there.",
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
        ),
    ),
    variants=(variants.blend_by_bernstein,),
    terms=mistakes.blend_terms,
)

PREDICT = Problem(
    name="carry_forward",
    points=5,
    core=False,
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
            "errors are correlated.",
            mistakes.noise_on_the_diagonal,
            "Derive Q; do not guess its diagonal.",
            cure="Keep the terms between them.",
        ),
        Wrong(
            "one push in each step",
            "age⁴/4, age³/2 and age² belong to a single push that is held for the whole step: two "
            "half steps then do not give the same as one step.",
            mistakes.Predicted(((4, 0.25), (3, 0.5), (2, 1.0))),
            "Held noise and white noise grow with different powers of the step.",
            cure="White noise gives age³/3, age²/2 and age.",
        ),
        Wrong(
            "Q left out",
            "Q is missing, so the velocity never becomes less certain, and soon the filter "
            "ignores every picture.",
            mistakes.Predicted(((0, 0.0), (0, 0.0), (0, 0.0))),
            "What is not seen becomes less sure.",
        ),
        Wrong(
            "pushes on the velocity alone",
            "A push at the beginning of the step has moved the position by its end; yours has not.",
            mistakes.Predicted(((0, 0.0), (0, 0.0), (1, 1.0))),
            cure="Integrate F(s), too.",
        ),
        Wrong(
            "the noise squared",
            "You squared accel_noise, which is a power already, in m²/s³.",
            mistakes.Predicted(((3, 1 / 3), (2, 0.5), (1, 1.0)), power=2.0),
            "Is it a variance or a deviation? Look at the unit.",
        ),
        Wrong(
            "back in time",
            "You carry the mean back in time.",
            mistakes.back_in_time,
            "Say for each number at what time it is valid.",
        ),
        Wrong(
            "the covariance not moved",
            "The covariance is not carried forward by F: an uncertain velocity makes the position "
            "uncertain too.",
            mistakes.covariance_not_moved,
        ),
        Wrong(
            "a half where a third belongs",
            "One of your powers of the age has the wrong factor: the position's.",
            mistakes.Predicted(((3.0, 0.5), (2.0, 0.5), (1.0, 1.0))),
            cure="∫ (age - s)² ds = age³/3.",
        ),
        Wrong(
            "no half beside the diagonal",
            "One of your powers of the age has the wrong factor: beside the diagonal.",
            mistakes.Predicted(((3.0, 1.0 / 3.0), (2.0, 1.0), (1.0, 1.0))),
            cure="∫ (age - s) ds = age²/2.",
        ),
    ),
    variants=(variants.predict_by_exponential,),
)

PROBLEMS = (TAG_POSE, STEP, BLEND, SMOOTH, QUALITY, PREDICT)
