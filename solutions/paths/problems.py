"""What notebook 01 asks."""

from __future__ import annotations

import numpy as np

import labkit as lk
from labkit.course import Close, Within
from labkit.course.problem import Problem, Trial, Wrong, call

from . import answers, hidden, mistakes, variants

OWN_WORK = ("labkit.BangBang", "labkit.Trapezoid", "labkit.Cubic", "labkit.Quintic")
SCALING = Close(parts=("s", "ds", "dds"))

BANG_BANG = Problem(
    name="bang_bang",
    points=3,
    outcomes=("motion",),
    asks="Give `(s, ds, dds)` at time `t` for a motion that speeds up evenly for half of its "
    "duration and brakes evenly for the other half.",
    answer=answers.bang_bang,
    judge=SCALING,
    trials=(
        Trial(
            "a time in the first half",
            (call(0.5, 2.0), call(0.25, 1.0)),
            hidden.bang_bang_first,
            "other durations",
            weight=0.0,
        ),
        Trial(
            "the second half",
            (call(1.5, 2.0), call(1.001, 2.0)),
            hidden.bang_bang_second,
            "just after the middle",
        ),
        Trial(
            "before the start and after the end the motion is at rest",
            (call(-1.0, 2.0), call(2.0, 2.0), call(3.0, 2.0)),
            hidden.bang_bang_outside,
            "times outside the motion",
        ),
        Trial(
            "the whole motion",
            tuple(call(float(t), 4.0) for t in np.linspace(-0.6, 4.6, 14)),
            hidden.bang_bang_all,
            weight=2.0,
        ),
    ),
    withheld=OWN_WORK,
    hints=(
        "Draw the acceleration first: a step up, a step down. Integrate it once for the speed (a "
        "roof) and again for s. How high must the step be for s to end at 1?",
        "In the first half s = a t²/2, and at T/2 it must be 1/2, so a = 4/T². The second half is "
        "the first one run backwards from the end: use the time that is left, T - t.",
        "With the time that is left, the second half is the first one seen from the other "
        "end. Differentiate what you have twice and look at each sign. Then two cases are "
        "missing: before and after.",
    ),
    wrong=(
        Wrong(
            "the second half still uses a·t for the speed",
            "The speed grows to the end and then drops to zero at once. While braking, the speed "
            "is a times the time that is left.",
            mistakes.accelerates_on,
            "The speed is the integral of the acceleration from the start, not a·t for ever.",
        ),
        Wrong(
            "no rest before the start and after the end",
            "The formulas go on where the motion does not: s runs below 0 or back from 1. Hold the "
            "start before t = 0 and the goal from t = T on, both at rest.",
            mistakes.runs_past_the_ends,
            "A reference is asked at any time; outside the motion it stands still.",
        ),
        Wrong(
            "an acceleration of 2/T²",
            "With this, s reaches only half of what it should. Speeding up lasts T/2, so choose a "
            "such that a (T/2)²/2 = 1/2.",
            mistakes.twice_too_slow,
            "Check the end point of every time scaling: s(T) = 1.",
        ),
        Wrong(
            "at rest, but still accelerating",
            "Before the start and from T on nothing moves: s is right there and ds is 0, so dds "
            "must be 0 as well.",
            mistakes.still_but_accelerated,
            "The derivative of a constant is zero.",
        ),
    ),
    variants=(variants.bang_bang_list, variants.bang_bang_array),
)

TRAPEZOID = Problem(
    name="trapezoid",
    points=4,
    outcomes=("motion",),
    asks="Give `(s, ds, dds)` at time `t` for a path of `distance` metres, as quick as `v_max` in m/s "
    "and `a_max` in m/s² allow: speed up, cruise, brake.",
    answer=answers.trapezoid,
    judge=SCALING,
    trials=(
        Trial(
            "a long way: 0.3 m at 0.2 m/s and 0.4 m/s²",
            tuple(call(t, 0.3, 0.2, 0.4) for t in (0.2, 1.0, 1.8)),
            hidden.trapezoid_long,
            "other limits",
            weight=0.0,
        ),
        Trial(
            "a way too short to reach v_max: 0.03 m",
            tuple(call(t, 0.03, 0.2, 0.4) for t in (0.1, 0.3, 0.5)),
            hidden.trapezoid_short,
            "a move of one centimetre",
        ),
        Trial(
            "whole motions",
            (
                *(call(float(t), 0.3, 0.2, 0.4) for t in np.linspace(-0.3, 2.5, 8)),
                *(call(float(t), 0.03, 0.2, 0.4) for t in np.linspace(-0.1, 0.8, 8)),
            ),
            hidden.trapezoid_all,
            "times outside the motion",
        ),
    ),
    withheld=OWN_WORK,
    hints=(
        "Work in metres: find the way gone, its speed and its acceleration, and divide all three by "
        "the distance at the very end.",
        "The speed reached is v = min(v_max, √(distance·a_max)): on a short way the two ramps meet "
        "before v_max. Then ramp = v/a_max and duration = distance/v + ramp.",
        "The ramp lasts v/a, or the square root of d/a where v is never reached. Write the "
        "way in metres in each of the three phases, the last one by the time that is left; "
        "divide everything by d at the end.",
    ),
    wrong=(
        Wrong(
            "no triangular case",
            "On a short distance the ramps of a long one overlap: s passes 1 or comes back. Use "
            "the smaller of v_max and √(distance·a_max) as the top speed.",
            mistakes.always_cruises,
            "A trapezoid with a negative cruise is a triangle.",
        ),
        Wrong(
            "limits taken for limits of s",
            "v_max and a_max are in metres, and s has no unit. Divide way, speed and acceleration "
            "by the distance.",
            mistakes.limits_on_s,
            "Units: a limit in m/s bounds distance·ds, not ds.",
        ),
        Wrong(
            "metres in place of s",
            "This is the distance travelled, in metres. s goes from 0 to 1: divide way, speed and "
            "acceleration by the distance.",
            mistakes.way_for_s,
            "s has no unit.",
        ),
        Wrong(
            "a triangle that is too high",
            "√(2·distance·a_max) is the speed after speeding up all the way. Half of it is there to "
            "speed up, and half to brake: √(distance·a_max).",
            mistakes.speeds_up_all_the_way,
            "A triangle has two halves.",
        ),
    ),
    variants=(variants.trapezoid_by_phases,),
)

CIRCLE = Problem(
    name="circle",
    points=4,
    outcomes=("motion",),
    asks="Give the `lk.Sample` (point and derivatives with respect to `s`) of the level circle that "
    "begins at `start`, goes once round the vertical axis through `centre`, counter-clockwise seen "
    "from above, and comes back to `start` at `s` = 1. It keeps the height of `start`.",
    answer=answers.circle,
    judge=Close(rtol=1e-6, atol=1e-8, parts=("position", "velocity", "acceleration")),
    trials=(
        Trial(
            "start level with the centre, in the direction of x",
            (
                call(0.25, np.array([0.8, 0.1, 0.2]), np.array([0.6, 0.1, 0.2])),
                call(0.6, np.array([0.8, 0.1, 0.2]), np.array([0.6, 0.1, 0.2])),
            ),
            hidden.circle_flat,
            "other radii",
            weight=0.0,
        ),
        Trial(
            "a centre 0.2 m below the start",
            (
                call(0.0, np.array([0.8, 0.1, 0.2]), np.array([0.6, 0.1, 0.0])),
                call(0.4, np.array([0.8, 0.1, 0.2]), np.array([0.6, 0.1, 0.0])),
            ),
            hidden.circle_height,
            "centres above and below",
        ),
        Trial(
            "a start turned by 130 degrees",
            tuple(
                call(s, np.array([0.47144, 0.25321, 0.2]), np.array([0.6, 0.1, 0.2]))
                for s in (0.0, 0.3)
            ),
            hidden.circle_yaw,
            "starts all round the centre",
        ),
        Trial(
            "the whole circle",
            tuple(
                call(float(s), np.array([0.5, 0.3, 0.2]), np.array([0.6, 0.1, 0.05]))
                for s in np.linspace(0.0, 1.0, 5)
            ),
            hidden.circle_all,
            "the return to the start",
            weight=2.0,
        ),
    ),
    withheld=("labkit.Circle",),
    hints=(
        "Think of a spoke from the axis to the point. It starts as start - centre, laid flat, and "
        "turns by 2πs. Its length never changes.",
        "Turning a flat vector (x, y) by an angle φ gives (cos φ x - sin φ y, sin φ x + cos φ y). No "
        "arctangent is needed. The height is start[2].",
        "Call the level vector from the axis to the start the spoke. Turn it by 2πs, and each "
        "derivative turns it by a right angle and brings one factor 2π. The axis passes at "
        "the height of the start.",
    ),
    wrong=(
        Wrong(
            "the radius measured in space",
            "With the centre at another height, the distance in space is longer than the radius "
            "in the plane, and the circle misses its own start. Measure the radius in the plane. "
            "The report's equation 12 has this mistake.",
            mistakes.radius_in_space,
            "A radius is measured in the circle's plane.",
        ),
        Wrong(
            "the height of the centre",
            "The circle jumps to the centre's height. Keep the height of its start.",
            mistakes.height_of_the_centre,
            "A reference must begin where the arm is.",
        ),
        Wrong(
            "begins at angle zero",
            "Every circle begins in the direction of x, wherever the start stands: the arm would "
            "jump. Turn the spoke that goes to the start.",
            mistakes.starts_at_angle_zero,
            "A reference must begin where the arm is.",
        ),
        Wrong(
            "derivatives with respect to the angle",
            "These are the derivatives with respect to the angle. With respect to s each has one "
            "more factor 2π.",
            mistakes.rates_without_two_pi,
            "The chain rule again: dφ/ds = 2π.",
        ),
        Wrong(
            "a clockwise circle",
            "Seen from above your circle runs clockwise. Angles grow counter-clockwise: θ = θ₀ + "
            "2πs.",
            mistakes.clockwise,
            "Angles about z grow from x to y.",
        ),
        Wrong(
            "an acceleration that points outwards",
            "The second derivative should point to the axis: differentiating a cosine twice gives "
            "minus a cosine.",
            mistakes.accelerates_outwards,
            "What goes round is pulled inwards.",
        ),
        Wrong(
            "the arctangent of y/x",
            "y/x is the same for opposite points, so a start behind the centre lands before it. "
            "Use np.arctan2(y, x), or turn the spoke without any angle.",
            mistakes.half_an_arctangent,
            "atan2 knows the quadrant, atan does not.",
        ),
    ),
    variants=(variants.circle_by_rotation, variants.circle_tuple),
)

LINE = lk.Line(np.array([0.6, 0.3, 0.1]), np.array([0.8, 0.1, 0.3]))
RING = lk.Circle(np.array([0.8, 0.1, 0.2]), np.array([0.6, 0.1, 0.2]))

COMPOSE = Problem(
    name="compose",
    points=4,
    outcomes=("motion",),
    asks="Combine a path `path(s)` with a schedule `scaling(t)`: give the `lk.Sample` of position, velocity "
    "and acceleration at time `t`, now with respect to time.",
    answer=answers.compose,
    judge=Close(rtol=1e-6, atol=1e-9, parts=("position", "velocity", "acceleration")),
    trials=(
        Trial(
            "a line at constant speed",
            (call(LINE, lk.Trapezoid(LINE.length, 0.1, 0.4), 2.0),),
            hidden.compose_steady,
            "other lines",
            weight=0.0,
        ),
        Trial(
            "a line that speeds up: only it shows whether dds is there",
            (call(LINE, lk.Quintic(3.0), 0.8), call(LINE, lk.BangBang(3.0), 2.0)),
            hidden.compose_line,
            "lines that speed up and brake",
        ),
        Trial(
            "a circle at constant speed: only it shows whether ds is squared",
            (call(RING, lk.Trapezoid(RING.length, 0.3, 0.6), 2.2),),
            hidden.compose_circle,
            "circles",
        ),
        Trial(
            "any path, at any time",
            tuple(call(RING, lk.Cubic(4.0), t) for t in (-0.5, 0.0, 1.0, 3.1, 5.0)),
            hidden.compose_all,
            "times outside the motion",
            weight=2.0,
        ),
    ),
    withheld=("labkit.Trajectory",),
    hints=(
        "The position is path(s(t)). Differentiate that once, with the chain rule; then the result "
        "once more, with the product rule.",
        "Ask the scaling first: s, ds, dds = scaling(t). Then the path at s, not at t. The velocity "
        "is dx·ds.",
        "Differentiate p'(s(t))·s'(t) as a product. One factor of it is a function of a "
        "function again: that brings the square.",
    ),
    wrong=(
        Wrong(
            "the term dx·dds left out",
            "The acceleration along the path is lost; on a line none would remain. The product "
            "rule has two terms.",
            mistakes.drops_the_ramp,
            "Product rule: d/dt (dx ds) = ddx ds² + dx dds.",
        ),
        Wrong(
            "ds where ds² belongs",
            "The centripetal term grows with the square of the speed: write ds². A line cannot "
            "show this, because its ddx is zero; a circle does.",
            mistakes.forgets_the_square,
            "The inner derivative comes out twice.",
        ),
        Wrong(
            "the path evaluated at t",
            "A path knows nothing of time. Evaluate it at s, which the schedule gives.",
            mistakes.time_for_s,
            "s is where, t is when.",
        ),
        Wrong(
            "still the derivatives with respect to s",
            "These are dx and ddx of the path. For derivatives with respect to time use the chain "
            "rule: what is d/dt of x(s(t))?",
            mistakes.still_by_s,
            "A derivative has a variable; say it aloud.",
        ),
        Wrong(
            "the second derivatives multiplied",
            "Differentiate dx·ds once more: the product rule gives two terms.",
            mistakes.schedule_twice,
            "The second derivative of x(s(t)) is ddx·ds² + dx·dds.",
        ),
    ),
    variants=(variants.compose_matrix,),
)

TOUR = [1.0, 2.0, 0.5]

SEGMENT_AT = Problem(
    name="segment_at",
    points=3,
    core=False,
    outcomes=("motion",),
    asks="Segments of the given `durations` follow one another. Give `(index, local_time)`: which "
    "segment is active at time `t`, counted from 0, and how long ago it began. At the instant where two "
    "segments meet, the later one is active; before the start it is the first, after the end the last.",
    answer=answers.segment_at,
    judge=Close(rtol=1e-9, atol=1e-9, parts=("index", "local_time")),
    trials=(
        Trial(
            "inside a segment",
            (call(TOUR, 1.5), call(TOUR, 3.25)),
            hidden.segment_inside,
            "paths with other segments",
            weight=0.0,
        ),
        Trial(
            "the very start and after the end",
            (call(TOUR, 0.0), call(TOUR, -0.5), call(TOUR, 3.5), call(TOUR, 5.0)),
            hidden.segment_ends,
            "before the start",
        ),
        Trial(
            "the joints",
            (call(TOUR, 1.0), call(TOUR, 3.0)),
            hidden.segment_joints,
            "the instants at which segments of other paths meet",
        ),
        Trial(
            "a whole tour",
            tuple(call(TOUR, 0.5 * k) for k in range(-1, 10)),
            hidden.segment_all,
            weight=2.0,
        ),
    ),
    withheld=("labkit.Chain",),
    hints=(
        "When does each segment begin? The first at 0, the next when the first is over. The one that "
        "is on is the last that has begun.",
        "Sum the durations of the segments before it, not its own: that sum is when it began, and "
        "local_time = t - begun.",
        "Go through the segments and add up when each begins. Stop at the first that ends "
        "later than t; think about what should happen when none does, and about t exactly on "
        "a joint.",
    ),
    wrong=(
        Wrong(
            "a sum that includes the current segment",
            "The local time comes out negative, because the sum includes the segment's own "
            "duration, as in the report's equation 15. Subtract only the durations before it.",
            mistakes.sums_through_the_segment,
            "Sum over j < k, not over j <= k.",
        ),
        Wrong(
            "index -1 at the start",
            "At t = 0 the index is -1, which Python takes for the last segment: the arm would "
            "start at the last corner, as in the authors' program. Return index 0 there.",
            mistakes.one_segment_early,
            "Python's index -1 is valid, and wrong.",
        ),
        Wrong(
            "no segment left at the end",
            "At the end no segment is left, and the index runs past the list. After the end stay "
            "in the last segment.",
            mistakes.runs_out_of_segments,
            "A reference is asked at any time.",
        ),
        Wrong(
            "the last segment begins again",
            "After the end the last segment goes on and its local time keeps growing. Do not "
            "subtract its duration.",
            mistakes.starts_anew_after_the_end,
            "Say what happens at the ends before you write the loop.",
        ),
    ),
    variants=(variants.segment_by_searchsorted, variants.segment_by_walking),
)

WITNESS = Problem(
    name="witness",
    points=2,
    core=False,
    outcomes=("motion",),
    asks="The report's equation 8 for the angle of a circle adds the start angle `theta` in the first "
    "half of the motion and once more in the second. Give one time at which the angle by this equation "
    "does what the joints of no arm can do; any such time counts.",
    answer=answers.witness,
    expected=lambda theta, duration: [[0.499 * duration, 0.501 * duration]],
    judge=Within(),
    trials=(
        Trial(
            "the angle jumps there",
            (call(0.7, 2.0), call(1.1, 5.0)),
            hidden.witness_others,
            "other angles and durations",
        ),
    ),
    hints=(
        "An arm cannot jump. Where could a motion that is put together from two formulas jump?",
        "Put a time just before and just after the seam into both formulas and subtract.",
        "The seam is where speeding up ends and braking begins.",
    ),
    wrong=(
        Wrong(
            "a time at the end of the motion",
            "At its end the printed motion stands still, at a wrong angle, but it does not jump "
            "there. Look for the time of the jump.",
            mistakes.an_end_point,
            "A witness is a place where the law fails, not where the number looks odd.",
        ),
        Wrong(
            "a time in the second half",
            "The whole second half is shifted, but it moves smoothly. Look for the jump where the "
            "shift begins.",
            mistakes.a_late_time,
            "Shifted is not broken: look at the seam.",
        ),
    ),
    variants=(variants.Witness(),),
)

PROBLEMS = (BANG_BANG, TRAPEZOID, CIRCLE, COMPOSE, SEGMENT_AT, WITNESS)
