"""The questions of notebook 01."""

from __future__ import annotations

import numpy as np

import labkit as lk
from labkit.course import Close, Within
from labkit.course.authoring.problem import Problem, Trial, Wrong, call

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
            "The formulas go on where the motion does not: s is above 0 before the start, and runs back from 1 after the end. Hold the "
            "start before t = 0 and the goal from t = T on, both at rest.",
            mistakes.runs_past_the_ends,
            "A reference is asked at any time; outside the motion it stands still.",
        ),
        Wrong(
            "an acceleration of 2/T²",
            "With this, s reaches only 1/4 by the middle, where it should be 1/2. Speeding up lasts T/2, so choose a "
            "such that a (T/2)²/2 = 1/2.",
            mistakes.twice_too_slow,
            "Check the middle of every symmetric motion: s(T/2) = 1/2.",
        ),
        Wrong(
            "at rest, but still accelerating",
            "Before the start and from T on nothing moves: s is right there and ds is 0, so dds "
            "must be 0 as well.",
            mistakes.still_but_accelerated,
            "The derivative of a constant is zero.",
        ),
        Wrong(
            "no hold after the end",
            "After the end the formula goes on, and s runs back from 1. From t = T on the motion rests at s = 1.",
            mistakes.Bang(after=False),
            "A reference is asked at any time; outside the motion it stands still.",
        ),
        Wrong(
            "no hold before the start",
            "Before t = 0 the parabola goes on to the left, and s is above 0. Before the start the motion rests at s = 0.",
            mistakes.Bang(before=False),
            "A reference is asked at any time; outside the motion it stands still.",
        ),
        Wrong(
            "back to 0 after the end",
            "After the end the motion rests where it arrived, at s = 1. With 0 the arm would jump back to the start.",
            mistakes.Bang(end=0.0),
            "After a motion comes its end, not its start.",
        ),
        Wrong(
            "still speeding up in the second half",
            "dds keeps its plus while the speed falls. Braking is a negative acceleration: -a.",
            mistakes.Bang(dds=-1.0),
            "The second derivative is the slope of the first.",
        ),
        Wrong(
            "a negative speed while braking",
            "Braking makes the speed smaller, not negative: s still grows. The speed is a times the time that is left.",
            mistakes.Bang(ds=-1.0),
            "Slowing down is not going back.",
        ),
        Wrong(
            "t where the time that is left belongs",
            "The second half is the first one seen from the end. It needs T - t, the time that is left, not t.",
            mistakes.Bang(left=lambda t, T: t),
            "Use the symmetry of the motion: put the origin of time at the end.",
        ),
        Wrong(
            "the time since the middle for the time that is left",
            "t - T/2 counts from the middle. In 1 - a r²/2 the r is the time that is left until the end, T - t.",
            mistakes.Bang(left=lambda t, T: t - T / 2.0),
            "Say for each time from where it is counted.",
        ),
        Wrong(
            "the braking half begins at rest",
            "In the middle the motion has the speed a T/2, and this is forgotten: what is left only goes back.",
            mistakes.Bang(brake=mistakes.from_rest_in_the_middle),
            "Position and speed at the end of one phase are the start of the next.",
        ),
        Wrong(
            "the speed of the middle kept",
            "While braking the speed falls by a for each second since the middle. Yours stays at its peak.",
            mistakes.Bang(brake=mistakes.speed_of_the_middle_kept),
            "The speed is the integral of the acceleration.",
        ),
        Wrong(
            "the first half of the way forgotten",
            "In the second half s starts at 1/2, where the first half ended. Yours starts again at 0.",
            mistakes.Bang(brake=mistakes.half_the_way_lost),
            "Position and speed at the end of one phase are the start of the next.",
        ),
        Wrong(
            "the one half of a t²/2 forgotten",
            "The integral of a t is a t²/2. Without the one half s and ds do not fit together.",
            mistakes.Bang(half=2.0),
            "Check that ds is the slope of s.",
        ),
        Wrong(
            "an acceleration of 4/T",
            "The acceleration has T squared below: (4/T²)(T/2)²/2 = 1/2. With 4/T the middle is right only for T = 1.",
            mistakes.Bang(power=1.0),
            "Try a second duration: what is right for 1 s alone has lost a unit.",
        ),
        Wrong(
            "an acceleration of 8/T²",
            "That goes the whole distance in half of the time. In T/2 only half of it is done: a (T/2)²/2 = 1/2.",
            mistakes.Bang(a=2.0),
            "Check the middle of every symmetric motion: s(T/2) = 1/2.",
        ),
        Wrong(
            "an acceleration of 1/T²",
            "a (T/2)²/2 = 1/2 gives a = 4/T². With 1/T² the first half reaches only 1/8.",
            mistakes.Bang(a=0.25),
            "Check the middle of every symmetric motion: s(T/2) = 1/2.",
        ),
    ),
    variants=(variants.bang_bang_list, variants.bang_bang_array),
)

TRAPEZOID = Problem(
    name="trapezoid",
    points=4,
    outcomes=("motion",),
    asks="Give `(s, ds, dds)` at time `t` for a path of `distance` metres, as fast as `v_max` in m/s "
    "and `a_max` in m/s² allow: speed up, cruise, brake.",
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
        "Work in metres: find the way gone, its speed and its acceleration, and divide all three by "
        "the distance at the very end.",
        "The speed reached is v = min(v_max, √(distance·a_max)): over a short distance the two ramps meet "
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
            "v_max and a_max are in metres, and s has no unit. Divide both limits by the distance "
            "before you use them.",
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
            "√(2·distance·a_max) is the speed after speeding up all the way. Only half of the way "
            "is there to speed up, the other half to brake: √(distance·a_max).",
            mistakes.speeds_up_all_the_way,
            "A triangle has two halves.",
        ),
        Wrong(
            "one ramp taken for two",
            "v_max**2/(2 a_max) is the distance of one ramp. To speed up to v_max and brake again takes "
            "twice that, so that a way shorter than v_max**2/a_max is a triangle.",
            mistakes.Ramps(reach=0.5),
            "Both ramps need room.",
        ),
        Wrong(
            "a duration of distance/v",
            "The ramps are slower than the cruise, so that the motion lasts distance/v + v/a. distance/v alone ends too early.",
            mistakes.Ramps(ramp=0.0),
            "The area under the speed is the way.",
        ),
        Wrong(
            "both ramps added to the duration",
            "The ramps are not added whole. The area under the trapezoid of the speed is v (T - v/a), so that T = distance/v + v/a.",
            mistakes.Ramps(ramp=2.0),
            "The area under the speed is the way.",
        ),
        Wrong(
            "the cruise begins where the ramp did not end",
            "At the end of the ramp the distance is v·ramp/2, so that the cruise is v (t - ramp/2). v·t jumps there.",
            mistakes.Ramps(offset=0.0),
            "Position and speed at the end of one phase are the start of the next.",
        ),
        Wrong(
            "the distance of the ramp forgotten",
            "v (t - ramp) starts the cruise at 0, although the ramp has gone v·ramp/2 already.",
            mistakes.Ramps(offset=2.0),
            "Position and speed at the end of one phase are the start of the next.",
        ),
        Wrong(
            "still speeding up in the last phase",
            "dds keeps its plus while the speed falls. Braking is a negative acceleration.",
            mistakes.Ramps(dds=-1.0),
            "The second derivative is the slope of the first.",
        ),
        Wrong(
            "a negative speed while braking",
            "Braking makes the speed smaller, not negative. It is a_max times the time that is left.",
            mistakes.Ramps(ds=-1.0),
            "Slowing down is not going back.",
        ),
        Wrong(
            "the one half of a t²/2 forgotten",
            "The integral of a t is a t²/2. Without the one half, way and speed do not fit together.",
            mistakes.Ramps(half=2.0),
            "Check that ds is the slope of s.",
        ),
        Wrong(
            "a triangle that is too low",
            "Half of the distance is there to speed up: v²/(2 a) = distance/2, so that v = √(distance·a_max), without a 2 below.",
            mistakes.Ramps(top=0.5**0.5),
            "A triangle has two halves.",
        ),
        Wrong(
            "it never brakes",
            "Speeding up and cruising are there; the last phase is not. From T - ramp on the speed is a_max times the time that is left.",
            mistakes.Ramps(brakes=False),
            "Draw the speed: a trapezoid has three sides above its base.",
        ),
        Wrong(
            "an acceleration while cruising",
            "While cruising the speed stays the same, so that dds is 0.",
            mistakes.Ramps(cruise=1.0),
            "The derivative of a constant is zero.",
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
            "These are the derivatives with respect to the angle. With respect to s the first has one "
            "more factor 2π, and the second has two.",
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
            "The second derivative should point to the axis: differentiating a cosine twice gives "
            "minus a cosine.",
            mistakes.accelerates_outwards,
            "What goes round is pulled inwards.",
        ),
        Wrong(
            "the arctangent of y/x",
            "y/x is the same for opposite points, so a start on the side of smaller x lands on the other side. "
            "Use np.arctan2(y, x), or turn the spoke without any angle.",
            mistakes.half_an_arctangent,
            "atan2 knows the quadrant, atan does not.",
        ),
        Wrong(
            "the arccosine of the start",
            "An arccosine is never negative: a start at a smaller y than the centre's lands on the "
            "other side. Use np.arctan2(y, x), or turn the spoke without any angle.",
            mistakes.arccosine_of_the_start,
            "atan2 knows the quadrant, acos does not.",
        ),
        Wrong(
            "the start's angle twice",
            "The start's angle is added twice, so that the circle begins elsewhere. The report's circle does this in its second half. At s = 0 the answer must be start.",
            mistakes.Spoke(start=2.0, rates=2.0),
            "Put s = 0 into every path: it must begin at the start.",
        ),
        Wrong(
            "the start's angle with the wrong sign",
            "The circle begins at minus the start's angle. The angle of the spoke is θ₀ + 2πs, with a plus.",
            mistakes.Spoke(start=-1.0, rates=-1.0),
            "Put s = 0 into every path: it must begin at the start.",
        ),
        Wrong(
            "no start angle in the derivatives",
            "The point starts at the right angle, its derivatives do not: they need θ₀ + 2πs too.",
            mistakes.Spoke(rates=0.0),
            "A derivative keeps what stands inside the cosine.",
        ),
        Wrong(
            "half a turn",
            "The angle grows by π, not 2π, so that s = 1 is on the other side.",
            mistakes.Spoke(turn=0.5),
            "Put s = 1 into every closed path: it must come back.",
        ),
        Wrong(
            "s taken for the angle",
            "The angle grows by 1 rad over the whole path. Once round is 2πs.",
            mistakes.Spoke(turn=0.5 / np.pi),
            "Put s = 1 into every closed path: it must come back.",
        ),
        Wrong(
            "sine and cosine exchanged",
            "x goes with the cosine and y with the sine of an angle that is measured from x.",
            mistakes.Spoke(mirrored=True),
            "Angles about z grow from x to y.",
        ),
        Wrong(
            "round the start",
            "The circle goes round the start. Its middle is the centre; the start lies on it.",
            mistakes.Spoke(about_start=True),
            "A path has a start and a shape: say which point is which.",
        ),
        Wrong(
            "round the origin",
            "The centre is not added, so that the circle goes round the origin.",
            mistakes.Spoke(centre=0.0),
            "A vector from the centre is not yet a point.",
        ),
        Wrong(
            "the diameter for the radius",
            "The circle is twice as wide. The spoke from the axis to the start is the radius.",
            mistakes.Spoke(radius=2.0),
            "Put s = 0 into every path: it must begin at the start.",
        ),
        Wrong(
            "the radius squared",
            "x² + y² is the square of the radius; its root is missing.",
            mistakes.Spoke(power=2.0),
            "Units: square metres are not length.",
        ),
        Wrong(
            "a radius of 1 m",
            "Your circle has the radius 1. It should be the level distance from the axis to the start.",
            mistakes.Spoke(power=0.0),
            "Put s = 0 into every path: it must begin at the start.",
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
        Wrong(
            "the term ddx·ds² is missing",
            "What bends the path is lost: on a circle the pull towards the centre. The product rule has two terms.",
            mistakes.Chained(bend=0.0),
            "Product rule: d/dt (dx ds) = ddx ds² + dx dds.",
        ),
        Wrong(
            "the velocity not scaled",
            "The velocity is still dx, by s. With respect to time it is dx·ds.",
            mistakes.Chained(velocity=0.0),
            "A derivative has a variable; say it aloud.",
        ),
        Wrong(
            "the velocity scaled twice",
            "The velocity is dx·ds: one derivative, one factor ds.",
            mistakes.Chained(velocity=2.0),
            "The inner derivative comes out once for each derivative.",
        ),
        Wrong(
            "the acceleration not scaled",
            "The acceleration is still ddx, by s. Differentiate dx·ds by time: the product rule gives two terms.",
            mistakes.Chained(plain=True),
            "A derivative has a variable; say it aloud.",
        ),
        Wrong(
            "dx·dds with a minus",
            "Both terms of the product rule are added.",
            mistakes.Chained(along=-1.0),
            "Product rule: d/dt (dx ds) = ddx ds² + dx dds.",
        ),
        Wrong(
            "dx·dds twice",
            "The product dx·ds has two factors, so that dx·dds comes once.",
            mistakes.Chained(along=2.0),
            "Product rule: d/dt (dx ds) = ddx ds² + dx dds.",
        ),
        Wrong(
            "dx·ds where dx·dds belongs",
            "In the second term the schedule is differentiated: dds, not ds.",
            mistakes.Chained(along=0.0, late=1.0),
            "Product rule: d/dt (dx ds) = ddx ds² + dx dds.",
        ),
        Wrong(
            "ddx·dds where dx·dds belongs",
            "In the second term it is the schedule that is differentiated, and the path only once: dx·dds.",
            mistakes.Chained(along=0.0, cross=1.0),
            "Product rule: d/dt (dx ds) = ddx ds² + dx dds.",
        ),
        Wrong(
            "ds and dds exchanged",
            "A scaling gives (s, ds, dds) in this order; yours takes dds for ds.",
            mistakes.Chained(dds_first=True),
            "Read in which order a function gives its results.",
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
        Wrong(
            "the earlier one where two meet",
            "At the instant where two segments meet, the later one is on, and its local time is 0. A segment holds its start but not its end: begun <= t < begun + duration.",
            mistakes.Segments(joint=True),
            "An interval holds its start and not its end.",
        ),
        Wrong(
            "an index too large after the end",
            "After the end no other segment begins: the last one stays on, with index n - 1.",
            mistakes.Segments(after=lambda n, t, d: (n, t)),
            "The last index is one less than the number.",
        ),
        Wrong(
            "the local time stops at the end",
            "After the end the last segment is still on, and its local time goes on: t minus when it began.",
            mistakes.Segments(local=lambda t, begun, d: min(t - begun, d)),
            "Let the segment itself decide what it does after its end.",
        ),
        Wrong(
            "the local time is 0 after the end",
            "After the end the last segment is still on, and its local time goes on: t minus when it began.",
            mistakes.Segments(after=lambda n, t, d: (n - 1, 0.0)),
            "Let the segment itself decide what it does after its end.",
        ),
        Wrong(
            "the time of the whole tour",
            "The local time counts from when the segment began, not from the start of the tour.",
            mistakes.Segments(local=lambda t, begun, d: t),
            "Say for each time from where it is counted.",
        ),
        Wrong(
            "the time that is left",
            "The local time is how long ago the segment began, not how long it still lasts.",
            mistakes.Segments(local=lambda t, begun, d: begun + d - t),
            "Say for each time from where it is counted.",
        ),
        Wrong(
            "a share of the segment",
            "The local time is in seconds; yours is divided by the segment's duration.",
            mistakes.Segments(local=lambda t, begun, d: (t - begun) / d),
            "A time has a unit, a share has none.",
        ),
        Wrong(
            "no time before the start",
            "Before the start the first segment is on with a negative local time, t itself. Yours is 0.",
            mistakes.Segments(local=lambda t, begun, d: max(t - begun, 0.0)),
            "Let the segment itself decide what it does before its start.",
        ),
        Wrong(
            "the last segment before the start",
            "Index -1 is the last segment in Python: before the start the arm would jump to the end. The first one is on.",
            mistakes.Segments(before=lambda n, t, d: (n - 1, t)),
            "An index below 0 counts from the end.",
        ),
        Wrong(
            "index -1 before the start",
            "Before the start the first segment is on, with index 0. In Python -1 is the last one.",
            mistakes.Segments(before=lambda n, t, d: (-1, t)),
            "An index below 0 counts from the end.",
        ),
        Wrong(
            "counted from 1",
            "The first segment has the index 0.",
            mistakes.Segments(first=1),
            "Python counts from 0.",
        ),
        Wrong(
            "index and time exchanged",
            "The index comes first, then the local time.",
            mistakes.Segments(swapped=True),
            "Read in which order results are asked for.",
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
        Wrong(
            "the start",
            "At the start the printed formula is right: the angle is theta, as it should be. Look "
            "for a time at which the formula changes its branch.",
            mistakes.the_start,
            "A counterexample is a place where the formula is wrong.",
        ),
        Wrong(
            "an angle",
            "A time is asked for, in seconds; this is the angle.",
            mistakes.an_angle,
            "Units: rad is not s.",
        ),
        Wrong(
            "a time in the first half",
            "In the first half the printed formula is right. Look at where the second branch begins.",
            mistakes.a_time_in_the_first_half,
            "A counterexample is a place where the formula is wrong.",
        ),
    ),
    variants=(variants.Witness(),),
)

PROBLEMS = (BANG_BANG, TRAPEZOID, CIRCLE, COMPOSE, SEGMENT_AT, WITNESS)
