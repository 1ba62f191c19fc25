"""The questions of notebook 01."""

from __future__ import annotations

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
    asks="Return `(s, ds, dds)` at time `t` for a motion with constant acceleration in the first "
    "half of its duration and constant deceleration in the second half.",
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
            "Speeding up lasts T/2, so choose a such that a (T/2)²/2 = 1/2.",
            mistakes.twice_too_slow,
            "Check the middle of every symmetric motion: s(T/2) = 1/2.",
        ),
        Wrong(
            "at rest, but still accelerating",
            "Before the start and from T on nothing moves: your s is right there and ds is 0, so "
            "dds must be 0 as well.",
            mistakes.still_but_accelerated,
            "The derivative of a constant is zero.",
        ),
        Wrong(
            "no hold after the end",
            "After the end your formula continues, and s decreases from 1. From t = T on, the "
            "motion rests at s = 1.",
            mistakes.Bang(after=False),
            "A reference can be evaluated at any time; outside the motion it is at rest.",
        ),
        Wrong(
            "no hold before the start",
            "Before t = 0 your parabola continues, so s is above 0. Before the start, the motion "
            "rests at s = 0.",
            mistakes.Bang(before=False),
            "A reference can be evaluated at any time; outside the motion it is at rest.",
        ),
        Wrong(
            "back to 0 after the end",
            "After the end, the motion rests where it arrived, at s = 1. With s = 0 the arm "
            "would jump back to the start.",
            mistakes.Bang(end=0.0),
            "After the end, a motion rests at its end, not at its start.",
        ),
        Wrong(
            "still speeding up in the second half",
            "Your dds stays positive while the speed decreases. Braking is a negative "
            "acceleration: -a.",
            mistakes.Bang(dds=-1.0),
            "The second derivative is the slope of the first.",
        ),
        Wrong(
            "a negative speed while braking",
            "Braking makes the speed smaller, not negative, because s still grows. The speed is "
            "a times the time until the end.",
            mistakes.Bang(ds=-1.0),
            "Slowing down is not going back.",
        ),
        Wrong(
            "a rounded middle: // in place of /",
            "duration // 2 drops the fraction, so the middle of a motion of 1 s is at 0 s, and "
            "it brakes from the start. Write duration / 2.",
            mistakes.Bang(middle=lambda T: T // 2.0),
            "// rounds down; / divides.",
        ),
        Wrong(
            "the distance of the first half forgotten",
            "In the second half, s starts at 1/2, where the first half ended. Your s starts "
            "again at 0.",
            mistakes.Bang(brake=mistakes.half_the_way_lost),
            "Each phase starts with the position and speed at the end of the phase before.",
        ),
    ),
    variants=(variants.bang_bang_list, variants.bang_bang_array),
)

TRAPEZOID = Problem(
    name="trapezoid",
    points=4,
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
            "On a short distance, the ramps of a long one overlap, so s passes 1 or jumps back. "
            "Use the smaller of v_max and √(distance·a_max) as the top speed.",
            mistakes.always_cruises,
            "A trapezoid whose cruise would last less than zero seconds is a triangle.",
        ),
        Wrong(
            "limits taken for limits of s",
            "v_max is in m/s and a_max in m/s², but s has no unit. Divide both limits by the "
            "distance before you use them as limits of s.",
            mistakes.limits_on_s,
            "Units: a limit in m/s bounds distance·ds, not ds.",
        ),
        Wrong(
            "metres in place of s",
            "You returned the distance covered, in metres. s goes from 0 to 1: divide distance "
            "covered, speed and acceleration by `distance`.",
            mistakes.way_for_s,
            "s has no unit.",
        ),
        Wrong(
            "a triangle that is too high",
            "√(2·distance·a_max) is the speed after speeding up over the whole distance. Only "
            "half of the distance is available for speeding up, because the other half is for "
            "braking: √(distance·a_max).",
            mistakes.speeds_up_all_the_way,
            "A triangle has two halves.",
        ),
        Wrong(
            "one ramp taken for two",
            "v_max²/(2 a_max) is the distance of one ramp. Speeding up to v_max and braking "
            "again takes twice that distance, so the motion is a triangle if the distance is "
            "shorter than v_max²/a_max.",
            mistakes.Ramps(reach=0.5),
            "Both ramps need distance.",
        ),
        Wrong(
            "a duration of distance/v",
            "The ramps are slower than the cruise, so the motion lasts distance/v + v/a. With "
            "distance/v alone it ends too early.",
            mistakes.Ramps(ramp=0.0),
            "The area under the speed is the distance.",
        ),
        Wrong(
            "both ramps added to the duration",
            "You added both ramps in full. The area under the trapezoid of the speed is v (T - "
            "v/a), so T = distance/v + v/a.",
            mistakes.Ramps(ramp=2.0),
            "The area under the speed is the distance.",
        ),
        Wrong(
            "the cruise begins where the ramp did not end",
            "At the end of the ramp, the distance covered is v·ramp/2, so the cruise is v (t - "
            "ramp/2). Your v·t jumps there.",
            mistakes.Ramps(offset=0.0),
            "Each phase starts with the position and speed at the end of the phase before.",
        ),
        Wrong(
            "still speeding up in the last phase",
            "Your dds stays positive while the speed decreases. Braking is a negative "
            "acceleration.",
            mistakes.Ramps(dds=-1.0),
            "The second derivative is the slope of the first.",
        ),
    ),
    variants=(variants.trapezoid_by_phases,),
)

CIRCLE = Problem(
    name="circle",
    points=4,
    outcomes=("motion",),
    asks="Return the `lk.Sample` (point and derivatives with respect to `s`) of a level circle. "
    "It begins at `start`, goes once round the vertical axis through `centre`, "
    "counter-clockwise seen from above, and comes back to `start` at `s` = 1. It keeps the "
    "height of `start`.",
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
            "than the radius, and the circle misses its own start. Measure the radius in the "
            "circle's plane. The report's equation 12 has this mistake.",
            mistakes.radius_in_space,
            "A radius is measured in the circle's plane.",
        ),
        Wrong(
            "the height of the centre",
            "Your circle jumps to the centre's height. Keep the height of the start.",
            mistakes.height_of_the_centre,
            "A reference must begin where the arm is.",
        ),
        Wrong(
            "begins at angle zero",
            "Your circle always begins in the direction of x, wherever the start is, so the arm "
            "would jump. Turn the spoke that goes to the start.",
            mistakes.starts_at_angle_zero,
            "A reference must begin where the arm is.",
        ),
        Wrong(
            "derivatives with respect to the angle",
            "These are the derivatives with respect to the angle. With respect to s, the first "
            "derivative has one more factor 2π, and the second has two.",
            mistakes.rates_without_two_pi,
            "The chain rule again: dφ/ds = 2π.",
        ),
        Wrong(
            "one factor 2π in the acceleration",
            "Your velocity is right. Its derivative with respect to s brings the factor 2π once more: the "
            "acceleration has (2π)².",
            mistakes.one_two_pi_in_the_acceleration,
            "The inner derivative comes out once for each derivative.",
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
            "The second derivative should point towards the axis: differentiating a cosine twice "
            "gives minus a cosine.",
            mistakes.accelerates_outwards,
            "A point on a circle accelerates towards the centre.",
        ),
        Wrong(
            "the arctangent of y/x",
            "y/x is the same for opposite points, so a start at a smaller x than the centre's is "
            "moved to the opposite side. Use np.arctan2(y, x), or turn the spoke without any "
            "angle.",
            mistakes.half_an_arctangent,
            "atan2 knows the quadrant, atan does not.",
        ),
        Wrong(
            "no start angle in the velocity",
            "Your point has the right angle, but your velocity does not: it needs θ₀ + 2πs too. "
            "The report's equations have this mistake.",
            mistakes.velocity_from_angle_zero,
            "Differentiating does not change the angle inside the cosine.",
        ),
        Wrong(
            "x and y exchanged in the arctangent",
            "Your circle begins elsewhere. np.arctan2 takes y first: the start's angle is "
            "np.arctan2(y, x), with x and y measured from the centre.",
            mistakes.arctangent_of_x_over_y,
            "Evaluate every path at s = 0: it must begin at the start.",
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
    asks="Combine a path `path(s)` with a schedule `scaling(t)`: return the `lk.Sample` of "
    "position, velocity and acceleration at time `t`, with derivatives with respect to "
    "time.",
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
            "Your acceleration along the path is missing; on a line nothing would remain. The "
            "product rule has two terms.",
            mistakes.drops_the_ramp,
            "Product rule: d/dt (dx ds) = ddx ds² + dx dds.",
        ),
        Wrong(
            "ds where ds² belongs",
            "The centripetal term grows with the square of the speed: write ds². A line cannot "
            "show this, because its ddx is zero; a circle does.",
            mistakes.forgets_the_square,
            "The inner derivative appears twice.",
        ),
        Wrong(
            "the path evaluated at t",
            "A path does not depend on time. Evaluate it at s, which the schedule returns.",
            mistakes.time_for_s,
            "s says where, t says when.",
        ),
        Wrong(
            "the second derivatives multiplied",
            "Differentiate dx·ds once more: the product rule gives two terms.",
            mistakes.schedule_twice,
            "The second derivative of x(s(t)) is ddx·ds² + dx·dds.",
        ),
        Wrong(
            "the term ddx·ds² is missing",
            "The acceleration that bends the path is missing: on a circle, the one towards the "
            "centre. The product rule has two terms.",
            mistakes.Chained(bend=0.0),
            "Product rule: d/dt (dx ds) = ddx ds² + dx dds.",
        ),
        Wrong(
            "the velocity not scaled",
            "Your velocity is still dx, the derivative with respect to s. With respect to time "
            "it is dx·ds.",
            mistakes.Chained(velocity=0.0),
            "Say with respect to which variable each derivative is taken.",
        ),
        Wrong(
            "dx·dds with a minus",
            "The product rule adds its two terms.",
            mistakes.Chained(along=-1.0),
            "Product rule: d/dt (dx ds) = ddx ds² + dx dds.",
        ),
        Wrong(
            "dx·dds twice",
            "The product dx·ds has two factors, so its derivative has two different terms; "
            "dx·dds occurs once.",
            mistakes.Chained(along=2.0),
            "Product rule: d/dt (dx ds) = ddx ds² + dx dds.",
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
    asks="Segments of the given `durations` follow one another. Return `(index, local_time)`: "
    "the index, counted from 0, of the segment that is active at time `t`, and the time "
    "since this segment began. At the instant where two segments meet, the later one is "
    "active. Before the start the first is active, and after the end the last.",
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
            "At the instant where two segments meet, the later one is active, and its local time "
            "is 0. A segment contains its start but not its end: begun <= t < begun + duration.",
            mistakes.Segments(joint=True),
            "Each interval contains its start but not its end.",
        ),
        Wrong(
            "the local time stops at the end",
            "After the end, the last segment is still active and its local time keeps growing: t "
            "minus the time at which it began.",
            mistakes.Segments(local=lambda t, begun, d: min(t - begun, d)),
            "Let the segment itself decide what it does after its end.",
        ),
        Wrong(
            "the time since the start of the tour",
            "The local time is measured from the instant at which the segment began, not from "
            "the start of the tour.",
            mistakes.Segments(local=lambda t, begun, d: t),
            "Say for each time from which instant it is measured.",
        ),
        Wrong(
            "a fraction of the segment's duration",
            "The local time is in seconds; you divided it by the segment's duration.",
            mistakes.Segments(local=lambda t, begun, d: (t - begun) / d),
            "A time has a unit; a fraction of a duration has none.",
        ),
        Wrong(
            "a local time of 0 before the start",
            "Before the start, the first segment is active and its local time is negative: t "
            "itself. Yours is 0.",
            mistakes.Segments(local=lambda t, begun, d: max(t - begun, 0.0)),
            "Let the segment itself decide what it does before its start.",
        ),
        Wrong(
            "counted from 1",
            "The first segment has the index 0.",
            mistakes.Segments(first=1),
            "Python counts from 0.",
        ),
    ),
    variants=(variants.segment_by_searchsorted, variants.segment_by_walking),
)


PROBLEMS = (
    BANG_BANG,
    TRAPEZOID,
    CIRCLE,
    COMPOSE,
    SEGMENT_AT,
)
