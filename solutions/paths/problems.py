"""The questions of notebook 01."""

from __future__ import annotations

from math import sqrt

import numpy as np

import labkit as lk
from labkit.course import Close
from labkit.course.authoring.problem import Problem, Trial, Wrong, call

from . import answers, hidden, mistakes, variants

OWN_WORK = ("labkit.BangBang", "labkit.Trapezoid", "labkit.Cubic", "labkit.Quintic")
SCALING = Close(parts=("s", "ds", "dds"))

BANG_BANG = Problem(
    name="bang_bang",
    points=3,
    outcomes=("motion",),
    asks="Return `(s, ds, dds)` at time `t` of a bang-bang motion.",
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
            weight=0.5,
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
            weight=1.5,
        ),
    ),
    withheld=OWN_WORK,
    hints=(
        "Draw the acceleration first: constant and positive, then constant and negative. "
        "Integrate it once for the speed, which has the shape of a roof, and again for s. How "
        "large must the acceleration be for s to end at 1?",
        "In the first half s = a t²/2, and at T/2 it must be 1/2, so a = 4/T². The second half "
        "is the first one run backwards from the end: use the time until the end, T - t.",
        "As a function of the time until the end, the second half mirrors the first. "
        "Differentiate your s twice and check each sign. Then add the two remaining cases: "
        "before the start and after the end.",
    ),
    wrong=(
        Wrong(
            "an acceleration of 2/T²",
            "With this acceleration, s reaches only 1/4 by the middle, where it should be 1/2. "
            "Speeding up lasts T/2, not T.",
            mistakes.Bang(size=2.0),
            cure="Choose a such that a (T/2)²/2 = 1/2.",
        ),
        Wrong(
            "at rest, but still accelerating",
            "Before the start and from T on nothing moves: your s is right there and ds is 0, "
            "but dds is not.",
            mistakes.still_but_accelerated,
            cure="The derivative of a constant is 0: dds must be 0 there as well.",
        ),
        Wrong(
            "no hold after the end",
            "After the end your formula continues, and s decreases from 1.",
            mistakes.Bang(after=False),
            cure="From t = T on, the motion rests at s = 1.",
        ),
        Wrong(
            "no hold before the start",
            "Before t = 0 your parabola continues, so s is above 0.",
            mistakes.Bang(before=False),
            cure="Before the start, the motion rests at s = 0.",
        ),
        Wrong(
            "back to 0 after the end",
            "After the end your s is 0, so the arm would jump back to the start.",
            mistakes.Bang(end=0.0),
            cure="After the end, the motion rests where it arrived, at s = 1.",
        ),
        Wrong(
            "still speeding up in the second half",
            "Your dds stays positive while the speed decreases.",
            mistakes.Bang(dds=-1.0),
            cure="Braking is a negative acceleration: -a.",
        ),
        Wrong(
            "a negative speed while braking",
            "Braking makes the speed smaller, not negative, because s still grows.",
            mistakes.Bang(ds=-1.0),
            cure="The speed is a times the time until the end.",
        ),
        Wrong(
            "a rounded middle: // in place of /",
            "duration // 2 drops the fraction, so the middle of a motion of 1 s is at 0 s, and "
            "it brakes from the start.",
            mistakes.Bang(middle=lambda T: T // 2.0),
            cure="Write duration / 2.",
        ),
        Wrong(
            "the distance of the first half forgotten",
            "In the second half your s starts again at 0, but the first half ended at 1/2.",
            mistakes.Bang(brake=mistakes.half_the_way_lost),
            cure="Add the 1/2, or count back from the end: 1 - a (T - t)²/2.",
        ),
    ),
    variants=(variants.bang_bang_list, variants.bang_bang_array),
)

DURATION_FOR = Problem(
    name="duration_for",
    points=2,
    outcomes=("motion",),
    asks="Return the shortest duration, in s, of a motion over `distance` metres, from rest to rest, "
    "within `v_max` in m/s and `a_max` in m/s².",
    answer=answers.duration_for,
    trials=(
        Trial(
            "distances long enough to cruise",
            (call(0.3, 0.2, 0.4), call(0.5, 0.25, 1.0), call(1.2, 0.5, 0.4)),
            hidden.durations_long,
            "other limits",
            weight=0.0,
        ),
        Trial(
            "distances too short to reach v_max",
            (call(0.03, 0.2, 0.4), call(0.08, 0.2, 0.4)),
            hidden.durations_short,
            "other short distances",
        ),
    ),
    withheld=OWN_WORK,
    hints=(
        "Draw the speed over time. The area under it is the distance, and the slope of its ramps "
        "is a_max. How wide is it?",
        "With a top speed v each ramp lasts v/a_max and covers v²/(2 a_max). When do two ramps "
        "need more than the whole distance?",
        "If they do, the graph is a triangle: its height is found from area and slope. With the "
        "top speed that is really reached, one formula serves both cases.",
    ),
    wrong=(
        Wrong(
            "no triangular case",
            "Over a short distance the arm never reaches v_max; your ramps alone cover more than "
            "the distance.",
            mistakes.Lasting(lambda d, v, a: d / v + v / a),
            cure="Use the smaller of v_max and √(distance·a_max) as the top speed.",
        ),
        Wrong(
            "always a triangle",
            "Over a long distance your arm goes faster than v_max.",
            mistakes.Lasting(lambda d, v, a: 2.0 * sqrt(d / a)),
            cure="Where √(distance·a_max) exceeds v_max, the arm cruises at v_max.",
        ),
        Wrong(
            "five seconds a metre",
            "This is the report's equation 1. Its 5 has the unit s/m, so the arm's limits do not "
            "matter in it, and a short move needs an acceleration without bound.",
            mistakes.Lasting(lambda d, v, a: 5.0 * d),
            cure="Find the width of the trapezoid from v_max, a_max and its area.",
        ),
        Wrong(
            "a duration of distance/v",
            "The ramps are slower than the cruise, so the motion lasts longer than distance/v.",
            mistakes.Lasting(lambda d, v, a: d / v),
            cure="Add v/a_max, which is half of each ramp, twice.",
        ),
        Wrong(
            "both ramps added to the duration",
            "You added both ramps in full, but the arm covers distance during them.",
            mistakes.Lasting(lambda d, v, a: d / v + 2.0 * v / a),
            cure="The area under the trapezoid is v (T - v/a_max); solve that for T.",
        ),
        Wrong(
            "a triangle that is too high",
            "√(2·distance·a_max) is the speed after speeding up over the whole distance, and the "
            "arm must brake, too.",
            mistakes.Lasting(
                lambda d, v, a: d / min(v, sqrt(2.0 * d * a)) + min(v, sqrt(2.0 * d * a)) / a
            ),
            cure="Only half of the distance is there to speed up: √(distance·a_max).",
        ),
        Wrong(
            "one half of the triangle",
            "Over a short distance this is the time to speed up; braking takes as long again.",
            mistakes.Lasting(lambda d, v, a: sqrt(d / a) if d < v * v / a else d / v + v / a),
            cure="Double it where v_max is not reached.",
        ),
        Wrong(
            "one ramp taken for two",
            "v_max²/(2 a_max) is the distance of one ramp. Speeding up and braking take twice "
            "that.",
            mistakes.Lasting(
                lambda d, v, a: 2.0 * sqrt(d / a) if d < v * v / a / 2.0 else d / v + v / a
            ),
            cure="The motion is a triangle below v_max²/a_max.",
        ),
    ),
    variants=(variants.duration_by_cases,),
)

TRAPEZOID = Problem(
    name="trapezoid",
    points=4,
    core=False,
    outcomes=("motion",),
    asks="Return `(s, ds, dds)` at time `t` for a motion along a path of `distance` metres that "
    "is as fast as `v_max` in m/s and `a_max` in m/s² allow: speed up, cruise, brake.",
    answer=answers.trapezoid,
    judge=SCALING,
    trials=(
        Trial(
            "a long distance: 0.3 m at 0.2 m/s and 0.4 m/s²",
            tuple(call(t, 0.3, 0.2, 0.4) for t in (0.2, 1.0, 1.8)),
            hidden.trapezoid_long,
            "other limits",
            weight=0.0,
        ),
        Trial(
            "distances too short to reach v_max: 0.03 m and 0.08 m",
            (*(call(t, 0.03, 0.2, 0.4) for t in (0.1, 0.3, 0.5)), call(0.5, 0.08, 0.2, 0.4)),
            hidden.trapezoid_short,
            "a move of one centimetre",
        ),
        Trial(
            "whole motions",
            (
                *(call(float(t), 0.3, 0.2, 0.4) for t in np.linspace(-0.3, 2.5, 8)),
                *(call(float(t), 0.08, 0.2, 0.4) for t in np.linspace(-0.1, 1.2, 8)),
            ),
            hidden.trapezoid_all,
            "times outside the motion",
            weight=3.0,
        ),
    ),
    withheld=OWN_WORK,
    hints=(
        "Work in metres: find the distance covered, the speed and the acceleration, and divide "
        "all three by `distance` at the very end.",
        "The top speed is v = min(v_max, √(distance·a_max)): over a short distance, braking must "
        "begin before v_max is reached. Then ramp = v/a_max and duration = distance/v + ramp.",
        "A ramp lasts v_max/a_max, or √(distance/a_max) if v_max is never reached. Write the "
        "distance covered in metres for each of the three phases, the last one as a function of "
        "the time until the end; divide everything by `distance` at the end.",
    ),
    wrong=(
        Wrong(
            "no triangular case",
            "On a short distance, the ramps of a long one overlap, so s passes 1 or jumps back.",
            mistakes.Ramps(top=lambda d, v, a: v),
            cure="Use the smaller of v_max and √(distance·a_max) as the top speed.",
        ),
        Wrong(
            "limits taken for limits of s",
            "v_max is in m/s and a_max in m/s², but s has no unit.",
            mistakes.limits_on_s,
            cure="Divide both limits by the distance before you use them as limits of s.",
        ),
        Wrong(
            "metres in place of s",
            "You returned the distance covered, in metres, but s goes from 0 to 1.",
            mistakes.way_for_s,
            cure="Divide distance covered, speed and acceleration by `distance`.",
        ),
        Wrong(
            "a triangle that is too high",
            "√(2·distance·a_max) is the speed after speeding up over the whole distance, but "
            "only half of it is available, because the other half is for braking.",
            mistakes.Ramps(top=lambda d, v, a: min(v, sqrt(2.0 * d * a))),
            cure="The top speed of the triangle is √(distance·a_max).",
        ),
        Wrong(
            "the cruise begins where the ramp did not end",
            "Your v·t jumps where the cruise begins: at the end of the ramp, the distance "
            "covered is v·ramp/2.",
            mistakes.Ramps(offset=0.0),
            cure="The cruise is v (t - ramp/2).",
        ),
        Wrong(
            "still speeding up in the last phase",
            "Your dds stays positive while the speed decreases.",
            mistakes.Ramps(dds=-1.0),
            cure="Braking is a negative acceleration.",
        ),
    ),
    variants=(variants.trapezoid_by_phases,),
)

CIRCLE = Problem(
    name="circle",
    points=4,
    outcomes=("motion",),
    asks="Return an `lk.Sample`, the point and its derivatives with respect to `s`, of a level circle: from "
    "`start` once round the vertical axis through `centre`, counter-clockwise seen from above, at "
    "the height of `start`.",
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
            "starts turned by 130 degrees and by -110 degrees",
            tuple(
                call(s, np.array([x, y, 0.2]), np.array([0.6, 0.1, 0.2]))
                for s, x, y in (
                    (0.0, 0.47144, 0.25321),
                    (0.3, 0.47144, 0.25321),
                    (0.3, 0.5316, -0.08794),
                )
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
        "Think of a level spoke from the vertical axis to the point. It starts as start - centre "
        "without the difference in height, and turns by 2πs. Its length never changes.",
        "Turning a level vector (x, y) by an angle φ gives (cos φ x - sin φ y, sin φ x + cos φ "
        "y). You do not need an arctangent. The height is start[2].",
        "Call the level vector from the vertical axis to the start the spoke. Turn it by 2πs. "
        "Each derivative turns it by another right angle and multiplies it by 2π. The circle's "
        "middle is on the axis, at the height of the start.",
    ),
    wrong=(
        Wrong(
            "the radius measured in space",
            "If the centre is at another height than the start, the distance in space is longer "
            "than the radius, and the circle misses its own start. The report's equation 12 has "
            "this mistake.",
            mistakes.radius_in_space,
            cure="Measure the radius in the circle's plane, from x and y alone.",
        ),
        Wrong(
            "the height of the centre",
            "Your circle jumps to the centre's height.",
            mistakes.height_of_the_centre,
            cure="Keep the height of the start.",
        ),
        Wrong(
            "begins at angle zero",
            "Your circle always begins in the direction of x, wherever the start is, so the arm "
            "would jump.",
            mistakes.starts_at_angle_zero,
            cure="Turn the spoke that goes to the start.",
        ),
        Wrong(
            "derivatives with respect to the angle",
            "These are the derivatives with respect to the angle, not with respect to s.",
            mistakes.rates_without_two_pi,
            cure="The first derivative has one more factor 2π, and the second has two.",
        ),
        Wrong(
            "one factor 2π in the acceleration",
            "Your velocity is right, but the inner derivative is missing once in the acceleration.",
            mistakes.one_two_pi_in_the_acceleration,
            cure="The acceleration has (2π)².",
        ),
        Wrong(
            "a clockwise circle",
            "Seen from above your circle runs clockwise.",
            mistakes.clockwise,
            cure="Angles grow counter-clockwise: θ = θ₀ + 2πs.",
        ),
        Wrong(
            "an acceleration that points outwards",
            "The second derivative should point towards the axis; yours points away from it.",
            mistakes.accelerates_outwards,
            cure="Differentiating a cosine twice gives minus a cosine.",
        ),
        Wrong(
            "the arctangent of y/x",
            "y/x is the same for opposite points, so a start at a smaller x than the centre's is "
            "moved to the opposite side.",
            mistakes.half_an_arctangent,
            cure="Use np.arctan2(y, x), or turn the spoke without any angle.",
        ),
        Wrong(
            "no start angle in the velocity",
            "Your point has the right angle, but your velocity does not. The report's equations "
            "have this mistake.",
            mistakes.velocity_from_angle_zero,
            cure="The velocity needs θ₀ + 2πs too.",
        ),
        Wrong(
            "x and y exchanged in the arctangent",
            "Your circle begins elsewhere: the arguments of np.arctan2 are exchanged.",
            mistakes.arctangent_of_x_over_y,
            cure="np.arctan2 takes y first: np.arctan2(y, x), with x and y measured from the "
            "centre.",
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
    asks="Combine a path `path(s)` with a schedule `scaling(t)`: return position, velocity and "
    "acceleration at time `t`.",
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
            "a line that speeds up, which shows whether dds is used",
            (call(LINE, lk.Quintic(3.0), 0.8), call(LINE, lk.BangBang(3.0), 2.0)),
            hidden.compose_line,
            "lines that speed up and brake",
        ),
        Trial(
            "a circle at constant speed, which shows whether ds is squared",
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
        "The position is path(s(t)). Differentiate it once with the chain rule; then "
        "differentiate the result with the product rule.",
        "Evaluate the scaling first: s, ds, dds = scaling(t). Then evaluate the path at s, not "
        "at t. The velocity is dx·ds.",
        "Differentiate p'(s(t))·s'(t) as a product. Its first factor is again a function of "
        "s(t), so the chain rule applies to it once more: that gives the square.",
    ),
    wrong=(
        Wrong(
            "the term dx·dds left out",
            "Your acceleration along the path is missing; on a line nothing would remain.",
            mistakes.drops_the_ramp,
            cure="The product rule has two terms: ddx·ds² + dx·dds.",
        ),
        Wrong(
            "ds where ds² belongs",
            "The centripetal term grows with the square of the speed. A line cannot show this, "
            "because its ddx is zero; a circle does.",
            mistakes.forgets_the_square,
            cure="Write ds².",
        ),
        Wrong(
            "the path evaluated at t",
            "A path does not depend on time.",
            mistakes.time_for_s,
            cure="Evaluate it at s, which the schedule returns.",
        ),
        Wrong(
            "the second derivatives multiplied",
            "You multiplied ddx by dds, but the second derivative of a composition is not the "
            "product of second derivatives.",
            mistakes.schedule_twice,
            cure="Differentiate dx·ds once more: the product rule gives two terms.",
        ),
        Wrong(
            "the term ddx·ds² is missing",
            "The acceleration that bends the path is missing: on a circle, the one towards the "
            "centre.",
            mistakes.Chained(bend=0.0),
            cure="The product rule has two terms: ddx·ds² + dx·dds.",
        ),
        Wrong(
            "the velocity not scaled",
            "Your velocity is still dx, the derivative with respect to s.",
            mistakes.Chained(velocity=0.0),
            cure="With respect to time it is dx·ds.",
        ),
        Wrong(
            "dx·dds with a minus",
            "Your two terms have opposite signs.",
            mistakes.Chained(along=-1.0),
            cure="The product rule adds its two terms.",
        ),
        Wrong(
            "dx·dds twice",
            "One of your two terms is there twice. The product dx·ds has two factors, so its "
            "derivative has two different terms.",
            mistakes.Chained(along=2.0),
            cure="dx·dds occurs once.",
        ),
    ),
    variants=(variants.compose_matrix,),
)

TOUR = [1.0, 2.0, 0.5]

SEGMENT_AT = Problem(
    name="segment_at",
    points=3,
    outcomes=("motion",),
    asks="Return `(index, local_time)`: which segment is active at time `t`, counted from 0, and the "
    "time since it began. Where two meet, the later one is active; before the start the first, "
    "after the end the last.",
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
            weight=0.5,
        ),
        Trial(
            "the instants where two segments meet",
            (call(TOUR, 1.0), call(TOUR, 3.0)),
            hidden.segment_joints,
            "the instants at which segments of other paths meet",
        ),
        Trial(
            "a whole tour",
            tuple(call(TOUR, 0.5 * k) for k in range(-1, 10)),
            hidden.segment_all,
            weight=1.5,
        ),
    ),
    withheld=("labkit.Chain",),
    hints=(
        "When does each segment begin? The first begins at 0, the next when the first is over. "
        "The active segment is the last one that has begun.",
        "Sum the durations of the segments before the active one, without its own. This sum is "
        "the time at which it began, and local_time = t - begun.",
        "Go through the segments and add up when each begins. Stop at the first that ends later "
        "than t. Think about what should happen when none does, and about a t at which two "
        "segments meet.",
    ),
    wrong=(
        Wrong(
            "the earlier one where two meet",
            "At the instant where two segments meet, your earlier one is still active, but its "
            "time is over.",
            mistakes.Segments(joint=True),
            cure="A segment contains its start but not its end: begun <= t < begun + duration.",
        ),
        Wrong(
            "the local time stops at the end",
            "After the end, the last segment is still active, but your local time has stopped.",
            mistakes.Segments(local=lambda t, begun, d: min(t - begun, d)),
            cure="It keeps growing: t minus the time at which the segment began.",
        ),
        Wrong(
            "the time since the start of the tour",
            "This is the time since the start of the tour.",
            mistakes.Segments(local=lambda t, begun, d: t),
            cure="Measure the local time from the instant at which the segment began.",
        ),
        Wrong(
            "a fraction of the segment's duration",
            "The local time is in seconds; you divided it by the segment's duration.",
            mistakes.Segments(local=lambda t, begun, d: (t - begun) / d),
        ),
        Wrong(
            "a local time of 0 before the start",
            "Before the start, the first segment is active and its local time is negative. Yours "
            "is 0.",
            mistakes.Segments(local=lambda t, begun, d: max(t - begun, 0.0)),
            cure="It is t itself.",
        ),
        Wrong(
            "np.argmax where nothing is true",
            "np.argmax gives the index of the first True, and 0 where there is none: after the "
            "end your first segment is on.",
            mistakes.argmax_of_ends,
            cure="Treat times after the end apart, or use np.searchsorted.",
        ),
        Wrong(
            "counted from 1",
            "The first segment has the index 0.",
            mistakes.Segments(first=1),
        ),
    ),
    variants=(variants.segment_by_searchsorted, variants.segment_by_walking),
)


PROBLEMS = (
    BANG_BANG,
    DURATION_FOR,
    CIRCLE,
    COMPOSE,
    SEGMENT_AT,
    TRAPEZOID,
)
