"""The questions of notebook 07."""

from __future__ import annotations

from math import atan, pi, sqrt

import control
import numpy as np
from scipy.stats import t as student

from labkit.course import Close, Response
from labkit.course.authoring.problem import Problem, Trial, Wrong, call

from . import answers, hidden, mistakes, variants

_RANDOM = np.random.default_rng(7)
_SEEDS = [3.0, 1.1, 4.9, 2.05, 3.9]
_TEN_PAIRS = [
    [4.0, 0.5, 6.0, 5.0, 5.5, 2.0, 7.5, 4.5, 4.0, 2.0],
    [3.0, 1.0, 4.0, 2.0, 5.0, 3.0, 6.0, 2.0, 4.0, 1.0],
]
_PAIRS = (call([4.0, 2.0, 6.0, 3.0, 5.0], _SEEDS), call(*_TEN_PAIRS[::-1]))
_NEAR_THE_EDGE = [3.1, 2.7, 5.2, 3.45, 4.4], [3.5, 2.7, 5.7, 3.45, 4.5]
"""Rows that differ from `_SEEDS` by 2.6 and by 4.5 standard errors; the threshold is 2.78."""
_345 = np.array([0.003, 0.004, 0.012])

RMS_ERROR = Problem(
    name="rms_error",
    points=3,
    outcomes=("evidence",),
    asks="From a log whose target is poses, give the RMS position error of the tip in metres: the "
    "root of the mean, over the rows, of the squared length of the error.",
    answer=answers.rms_error,
    judge=Close(rtol=1e-6, atol=1e-9),
    trials=(
        Trial(
            "an arm at rest, 3, 4 and 12 mm off: 13 mm",
            (call(hidden.drawn_log(_RANDOM, 4, _345, moving=False), hidden.MODEL),),
            hidden.still_logs,
            "other offsets",
            weight=0.0,
        ),
        Trial(
            "the same error on an arm that moves, with a tilt",
            (call(hidden.drawn_log(_RANDOM, 5, _345, moving=True), hidden.MODEL),),
            hidden.moving_logs,
            "other motions",
        ),
        Trial(
            "errors that change from row to row, of the left arm and of the right",
            (
                call(
                    hidden.drawn_log(_RANDOM, 5, np.outer([1, -2, 0, 3, 1], _345), moving=True),
                    hidden.MODEL,
                ),
                call(
                    hidden.drawn_log(
                        _RANDOM, 4, np.outer([2, 1, -1, 1], _345), moving=True, model=hidden.RIGHT
                    ),
                    hidden.RIGHT,
                ),
            ),
            hidden.uneven_logs,
            "uneven errors, either arm",
            weight=2.0,
        ),
    ),
    withheld=("labkit.metrics",),
    hints=(
        "Where is the tip in row k? Ask the model, with that row's joint angles. Where should it be? "
        "In the target of that row.",
        "log.q has one row for each instant, log.target.pose one pose. model.pose(q)[:3, 3] is the "
        "tip. Square the length of the difference, row by row.",
        "Make an array of one error vector for each row, in three columns. Square, sum over "
        "the right axis, mean over the other, root.",
    ),
    wrong=(
        Wrong(
            "the mean goes over the components too",
            "A mean over rows and components divides by three times too many numbers: the result is "
            "too small by √3. Sum over the components, then take the mean over the rows.",
            mistakes.mean_of_components,
            "An RMS of a vector: sum over components, mean over time.",
        ),
        Wrong(
            "the last tip used for all rows",
            "Every row is compared with where the arm ended. Compute the tip for each row. The "
            "report's plots did not, so their curves of the workspace are constants.",
            mistakes.last_row_for_all,
            "A plot that cannot be wrong is not a measurement.",
        ),
        Wrong(
            "the mean length instead of the root of the mean square",
            "This is the mean error. Square the lengths, take their mean, then the root: large "
            "errors weigh more.",
            mistakes.mean_of_lengths,
            "Mean, RMS and maximum are three numbers; say which.",
        ),
        Wrong(
            "the largest error",
            "This is the largest error of the run. Give the root mean square.",
            mistakes.largest,
            "Mean, RMS and maximum are three numbers; say which.",
        ),
        Wrong(
            "the root left out",
            "A mean of squares is in square metres: take the root at the end.",
            mistakes.without_the_root,
            "Look at the unit of the result.",
        ),
        Wrong(
            "millimetres for metres",
            "These numbers are in millimetres. Give metres.",
            mistakes.in_millimetres,
            "SI inside, millimetres in print.",
        ),
        Wrong(
            "a sum, not a mean",
            "The root of the sum of all squares grows with the length of the run. Divide by the number "
            "of rows before you take the root.",
            mistakes.not_a_mean,
            "Twice as long a run is not a worse one.",
        ),
        Wrong(
            "the whole poses subtracted",
            "A pose has sixteen numbers, nine of them a rotation's, so a tilt counts as metres. "
            "Take the position alone, [:3, 3].",
            mistakes.whole_poses,
            "Metres and radians do not add.",
        ),
        Wrong(
            "one row late",
            "Each tip is compared with the target of the next row. Compare the same rows: both "
            "have one for each instant.",
            mistakes.one_row_late,
            "Same instant, same row.",
        ),
        Wrong(
            "the length of the mean error",
            "Errors to the left and to the right cancel in a mean. Square the length of each row "
            "first, then take the mean.",
            mistakes.length_of_the_mean,
            "A mean of signed numbers hides how large they are.",
        ),
        Wrong(
            "the left arm's model for every arm",
            "The log of the right arm is compared with tips of the left one. Ask the `model` that "
            "you are given.",
            mistakes.always_the_left_arm,
            "Use what you are given, not what happens to lie about.",
        ),
        Wrong(
            "one row alone: the first",
            "The mean goes over all rows of the run; this is the error of the first row.",
            mistakes.Rms(lambda e: np.linalg.norm(e[0])),
            "An RMS is a mean over the run.",
        ),
        Wrong(
            "one row, not a mean",
            "This is the error of a single row, the last or the one in the middle. The mean goes over the "
            "squared lengths of all rows.",
            mistakes.Rms(lambda e: np.linalg.norm(e[-1])),
            "An RMS is a mean over the run.",
        ),
        Wrong(
            "one direction alone",
            "The error is a vector in space: its length has x, y and z in it. Yours has z alone.",
            mistakes.Rms(lambda e: np.sqrt(np.mean(e[:, 2] ** 2))),
            "The length of a vector has all its components.",
        ),
        Wrong(
            "in the plane alone",
            "The error is a vector in space: its length has x, y and z in it. Yours has no z.",
            mistakes.Rms(lambda e: np.sqrt(np.mean(np.sum(e[:, :2] ** 2, axis=1)))),
            "The length of a vector has all its components.",
        ),
        Wrong(
            "the components' sizes added",
            "The length of a vector is the root of the sum of squares; the sum of |x|, |y| and |z| is longer.",
            mistakes.Rms(lambda e: np.mean(np.abs(e).sum(axis=1))),
            "The length of a vector is the root of the sum of squares.",
        ),
        Wrong(
            "components, or their RMS values, added without squares",
            "(x + y + z)² is not x² + y² + z². In each row square the three components, then add them.",
            mistakes.Rms(lambda e: np.sqrt(np.mean(e.sum(axis=1) ** 2))),
            "Square first, then add.",
        ),
        Wrong(
            "the spread of the length",
            "This is the standard deviation of the error's length: a constant error would count for nothing.",
            mistakes.Rms(lambda e: np.linalg.norm(e, axis=1).std()),
            "A standard deviation is about the mean, an RMS about zero.",
        ),
        Wrong(
            "divided by the rows outside the root",
            "The mean square is the sum divided by n; the root comes after it. Yours divides the root by n.",
            mistakes.Rms(lambda e: np.linalg.norm(e) / len(e)),
            "Mean, then root: each letter of RMS is a step.",
        ),
        Wrong(
            "the mean of three RMS values",
            "Each axis has its own RMS here, and then a mean or a sum is taken. Add the three squares in each row first.",
            mistakes.Rms(lambda e: np.sqrt(np.mean(e**2, axis=0)).mean()),
            "Mean, then root: each letter of RMS is a step.",
        ),
        Wrong(
            "centimetres",
            "A hundred times too large: the answer is in metres.",
            mistakes.Rms(lambda e: 100.0 * mistakes.rms(e)),
            "Say the unit of every number.",
        ),
        Wrong(
            "all rows beside the first target",
            "The target moves: each row has its own, log.target.pose[k].",
            mistakes.from_the_first_target,
            "Compare what belongs to one instant.",
        ),
        Wrong(
            "how far the tip went",
            "This compares the tip with its own start. The error is between the tip and its target.",
            mistakes.from_the_first_tip,
            "An error needs a target.",
        ),
    ),
    variants=(variants.rms_vectorised,),
)

OPEN_LOOP = Problem(
    name="open_loop",
    points=4,
    core=False,
    outcomes=("control",),
    asks="Give the open loop of one velocity-commanded joint as a transfer function of "
    "python-control: the gain `kp`, the first-order `lag` of its speed, the integration to an angle, "
    "and the `delay`.",
    answer=answers.open_loop,
    judge=Response(omega=(0.3, 1.0, 3.0, 10.0, 25.0)),
    trials=(
        Trial(
            "no lag and no delay: kp / s",
            (call(4.0, 0.0, 0.0),),
            hidden.pure_integrators,
            weight=0.0,
        ),
        Trial("with a lag", (call(4.0, 0.05, 0.0),), hidden.lagging, "other lags"),
        Trial(
            "with a delay, the lag may be 0",
            (call(4.0, 0.03, 0.015), call(12.0, 0.05, 0.03), call(6.0, 0.0, 0.02)),
            hidden.loops,
            "other gains, lags and delays",
            weight=2.0,
        ),
    ),
    withheld=("labkit.stability",),
    hints=(
        "Three things stand one after another: a speed that follows its command with a lag, an "
        "integrator from speed to angle, a delay. Transfer functions in a row multiply.",
        "control.tf([kp], [lag, 1, 0]) holds gain, lag and integrator. The delay is not a ratio "
        "of polynomials; control.pade(delay, 4) gives one that is close.",
        "A lag and an integrator make a second-order denominator with no constant term. The "
        "delay multiplies; where it is 0 there is nothing to approximate.",
    ),
    wrong=(
        Wrong(
            "no integrator",
            "This is the loop of a speed. The controller looks at an angle, the integral of the "
            "speed: multiply by 1/s.",
            mistakes.no_integrator,
            "Count the integrators between command and measurement.",
        ),
        Wrong(
            "the closed loop",
            "Margins are read from the open loop: leave the feedback out.",
            mistakes.closed_loop,
            "Open loop: cut the wire once and multiply what is left.",
        ),
        Wrong(
            "the delay as one more lag",
            "A lag costs at most 90 degrees of phase and lowers the gain; a delay costs ever more "
            "phase and leaves the gain alone. Use control.pade for the delay.",
            mistakes.delay_as_a_lag,
            "A delay is not a slow lag.",
        ),
        Wrong(
            "almost no delay",
            "The controller sees an old angle, and the loop hardly shows it. `delay` is in "
            "seconds; control.pade approximates it.",
            mistakes.LoopWithout(delay=0.0),
            "The age of the state is part of the loop.",
        ),
        Wrong(
            "no delay where the lag is 0",
            "Where the lag is 0 your loop forgets the delay: the branch for `lag == 0` returns "
            "before the delay is multiplied in.",
            mistakes.delay_forgotten,
            "Each part of the loop may be absent by itself.",
        ),
        Wrong(
            "no lag",
            "The speed follows its command with a time constant. Multiply by 1 / (lag s + 1).",
            mistakes.LoopWithout(lag=0.0),
            "Name every part of the loop before you multiply.",
        ),
        Wrong(
            "the gain left out",
            "kp is missing. It is a factor of the open loop.",
            mistakes.LoopWithout(kp=0.0),
            "Name every part of the loop before you multiply.",
        ),
        Wrong(
            "the delay inverted",
            "The loop is divided by the delay, so it knows the angle before it is there. Multiply "
            "by the delay.",
            mistakes.LoopWithout(delay=-1.0),
            "A delay takes phase away.",
        ),
        Wrong(
            "the delay twice",
            "Put it in once.",
            mistakes.LoopWithout(delay=2.0),
            "Name every part of the loop before you multiply.",
        ),
        Wrong(
            "a delay of first order",
            "control.pade(delay, 1) is right for slow signals only: at 25 rad/s and 30 ms its "
            "phase is 2 degrees off. Use order 4.",
            mistakes.LoopWithout(order=1),
            "An approximation has a range; know it.",
        ),
        Wrong(
            "s squared in the lag",
            "The lag is lag·s + 1. With s² it is a spring that swings, not a first-order lag.",
            mistakes.Loop(lambda kp, lag: ([kp], [lag, 0.0, 1.0, 0.0])),
            "A first-order lag has one pole, at -1/lag.",
        ),
        Wrong(
            "the lag in the numerator",
            "The lag is in the denominator, 1/(lag·s + 1). Above it would hurry and not lag.",
            mistakes.Loop(lambda kp, lag: ([kp * lag, kp], [1.0, 0.0])),
            "A lag takes phase away.",
        ),
        Wrong(
            "the lag's coefficients exchanged",
            "control.tf wants the highest power first: [lag, 1], which is lag·s + 1. Yours is s + lag.",
            mistakes.Loop(lambda kp, lag: ([kp], [1.0, lag, 0.0])),
            "Highest power first.",
        ),
        Wrong(
            "two integrators",
            "From speed to angle is one integration. Yours has 1/s twice.",
            mistakes.Loop(lambda kp, lag: ([kp], [lag, 1.0, 0.0, 0.0])),
            "Count the integrations from command to angle.",
        ),
        Wrong(
            "a differentiator for the integrator",
            "From speed to angle is an integration, 1/s. Yours multiplies by s.",
            mistakes.Loop(lambda kp, lag: ([kp, 0.0], [lag, 1.0])),
            "Dividing by s integrates.",
        ),
        Wrong(
            "the gain below",
            "kp multiplies the loop: it is in the numerator.",
            mistakes.Loop(lambda kp, lag: ([1.0], [kp * lag, kp, 0.0])),
            "More gain, larger loop.",
        ),
        Wrong(
            "the gain squared",
            "kp comes once in the loop.",
            mistakes.Loop(lambda kp, lag: ([kp**2], [lag, 1.0, 0.0])),
            "Follow the signal round the loop once.",
        ),
        Wrong(
            "the lag twice",
            "The lag comes once in the loop.",
            mistakes.Loop(lambda kp, lag: ([kp], [lag**2, 2 * lag, 1.0, 0.0])),
            "Follow the signal round the loop once.",
        ),
        Wrong(
            "a minus in the loop",
            "The minus of the feedback is not part of the open loop. It comes in where the loop is closed.",
            mistakes.Loop(lambda kp, lag: ([-kp], [lag, 1.0, 0.0])),
            "The open loop is what is between error and angle.",
        ),
        Wrong(
            "half of the delay",
            "Padé's approximation makes its own halves: give it the whole delay.",
            mistakes.Loop(mistakes.plain_loop, delay=lambda delay, lag: delay / 2.0),
            "A delay d turns the phase by w d.",
        ),
        Wrong(
            "the lag added to the delay",
            "Lag and delay are two things: the lag has its own factor, and the delay is the delay alone.",
            mistakes.Loop(mistakes.plain_loop, delay=lambda delay, lag: delay + lag),
            "A lag smooths, a delay only shifts.",
        ),
        Wrong(
            "the sensitivity",
            "1/(1 + L) is what the closed loop does to a disturbance. The open loop L itself is asked for.",
            mistakes.Loop(mistakes.plain_loop, close=lambda loop: control.feedback(1, loop)),
            "The open loop is what is between error and angle.",
        ),
    ),
    variants=(variants.loop_from_s,),
)

KP_FOR_MARGIN = Problem(
    name="kp_for_margin",
    points=3,
    core=False,
    outcomes=("control",),
    asks="Give the gain at which that loop has a phase margin of `margin_deg` degrees, with the delay "
    "taken exactly.",
    answer=answers.kp_for_margin,
    judge=Close(rtol=1e-4, atol=1e-6),
    trials=(
        Trial(
            "a lag alone",
            (call(0.05, 0.0, 45.0),),
            hidden.no_delay,
            "other margins",
            weight=0.0,
        ),
        Trial(
            "lag and delay",
            (call(0.03, 0.015, 60.0), call(0.05, 0.05, 45.0)),
            hidden.margins,
            "other lags, delays and margins",
        ),
    ),
    hints=(
        "The phase does not depend on kp. Find the frequency at which the phase is what the margin "
        "wants; then choose kp so that the gain is 1 there.",
        "The phase at ω is -90° - atan(lag·ω) - delay·ω, the last one in radians. The margin is what "
        "is left to -180°.",
        "The phase of the loop does not know Kp. Find the frequency at which it leaves the "
        "margin (scipy has root finders), then the Kp that makes the gain 1 there.",
    ),
    wrong=(
        Wrong(
            "the margin taken for radians",
            "60 radians are nearly ten turns. Convert the margin to radians before you add it to "
            "an angle in radians.",
            mistakes.margin_in_radians,
            "Degrees outside, radians inside.",
        ),
        Wrong(
            "the delay left out",
            "Without the delay the crossover may be much higher, and the gain is too large for "
            "the real loop. Put the delay's phase, delay·ω, into the condition.",
            mistakes.without_the_delay,
            "The age of the state is part of the loop.",
        ),
        Wrong(
            "the frequency taken for the gain",
            "kp is not the frequency itself: at the crossover the gain of the lag is below 1, and "
            "kp has to make up for it.",
            mistakes.lag_free_gain,
            "Phase first, then the gain to be 1 there.",
        ),
        Wrong(
            "the loop's gain, not its inverse",
            "This is the gain that the loop has there without kp. To make the loop's gain 1, kp "
            "must be one over it.",
            mistakes.GainAt(power=-1.0),
            "kp times the rest is 1.",
        ),
        Wrong(
            "the integrator's gain left out",
            "The integrator is missing: at the crossover it has the gain 1/ω.",
            mistakes.GainAt(integrator=0.0),
            "Every factor has a gain and a phase.",
        ),
        Wrong(
            "the lag's gain squared",
            "The root is missing. The gain of the lag is 1 / √(1 + (lag ω)²).",
            mistakes.GainAt(lag=2.0),
            "The length of a complex number has a root in it.",
        ),
        Wrong(
            "radians among degrees",
            "delay·ω is in radians. Convert it to degrees before you subtract it from 90.",
            mistakes.phase_mixed,
            "Degrees outside, radians inside.",
        ),
        Wrong(
            "divided by 2π",
            "kp is in 1/s, and the frequency in it is in rad/s, as in the loop. Do not divide by "
            "2π.",
            mistakes.in_hertz,
            "s is iω, and ω is in rad/s.",
        ),
        Wrong(
            "one over the gain",
            "At the crossover |L| = 1, so that kp = w √(1 + (w·lag)²). Yours divides by w where it multiplies.",
            mistakes.Margin(gain=lambda w, lag, delay: sqrt(1.0 + (lag * w) ** 2) / w),
            "At the crossover the loop's gain is 1.",
        ),
        Wrong(
            "the root forgotten",
            "The size of 1 + j·w·lag is √(1 + (w·lag)²). Yours adds 1 and w·lag as if they were lengths along "
            "one line.",
            mistakes.Margin(gain=lambda w, lag, delay: w * (1.0 + lag * w)),
            "The size of 1 + jx is √(1 + x²).",
        ),
        Wrong(
            "the delay in the gain",
            "A delay shifts and does not change the size: the gain has the lag in it.",
            mistakes.Margin(gain=lambda w, lag, delay: w * sqrt(1.0 + (delay * w) ** 2)),
            "The size of exp(-j w d) is 1.",
        ),
        Wrong(
            "the delay's arctangent",
            "A delay turns the phase by w·delay; the arctangent belongs to the lag alone.",
            mistakes.Margin(lambda w, lag, delay, m: pi / 2 - atan(lag * w) - atan(delay * w) - m),
            "A lag turns by 90 degrees at most, a delay without end.",
        ),
        Wrong(
            "the lag's arctangent left out",
            "A lag turns the phase by atan(w·lag), not by w·lag: it never takes more than 90 degrees.",
            mistakes.Margin(lambda w, lag, delay, m: pi / 2 - lag * w - delay * w - m),
            "A lag turns by 90 degrees at most, a delay without end.",
        ),
        Wrong(
            "the margin for the phase",
            "The margin is what is left to -180 degrees. Yours is the phase that lag and delay may take.",
            mistakes.Margin(lambda w, lag, delay, m: m - atan(lag * w) - delay * w),
            "Margin: what is missing to -180 degrees.",
        ),
        Wrong(
            "the delay taken for milliseconds",
            "The delay is in seconds already.",
            mistakes.Margin(
                lambda w, lag, delay, m: pi / 2 - atan(lag * w) - delay * w / 1000.0 - m
            ),
            "Say the unit of every number.",
        ),
        Wrong(
            "half of it",
            "At the crossover |L| = 1 gives kp = w √(1 + (w·lag)²), without a half.",
            mistakes.Margin(gain=lambda w, lag, delay: 0.5 * w * sqrt(1.0 + (lag * w) ** 2)),
            "At the crossover the loop's gain is 1.",
        ),
    ),
    variants=(variants.margin_by_search,),
)

CHOOSE_GAINS = Problem(
    name="choose_gains",
    points=4,
    outcomes=("evidence",),
    asks="Choose `(Kp, Kd)` for the joint velocity PD with at most 20 runs: `runner(Kp, Kd, seed)` "
    "gives the RMS error of a run along the line in mm, for `seed` 0 to 4. Your gains are then tried "
    f"where you could not try them, and so is {hidden.RESERVE:g} times your Kp, your margin: at most "
    f"{hidden.UNSEEN_LIMIT:g} mm on the worst seed there. On the line at most {hidden.LINE_LIMIT:g} mm "
    f"are allowed, with your Kp and with {hidden.FAR:g} times it. Your function is called for two arms, "
    "with 20 runs each time: the second arm is about a quarter as fast as the first, so other gains are "
    "right for it.",
    answer=answers.choose_gains,
    trials=(
        Trial(
            f"on the line, on its worst seed: at most {hidden.LINE_LIMIT:g} mm, and with "
            f"{hidden.FAR:g} times the chosen Kp; the same on an arm a quarter as fast",
            tuple(hidden.on_the_line()),
            weight=0.0,
        ),
        Trial(
            f"where it was not tuned, on the worst seed: at most {hidden.UNSEEN_LIMIT:g} mm",
            (),
            hidden.unseen_cases,
            "another path, twice the speed, a payload, an older state",
        ),
        Trial(
            f"the same with {hidden.RESERVE:g} times the chosen Kp",
            (),
            hidden.with_reserve,
            "the same, on an arm that is slower",
            weight=2.0,
        ),
    ),
    hints=(
        "The error falls as Kp grows, until the arm is lost; where that happens depends on the seed. "
        "The best place on the map is close to the edge.",
        "Raise Kp in steps and look at more than one seed. As soon as the error jumps on one of them, "
        "you have found the edge.",
        "Look at the largest Kp that was safe on more than one seed, and ask what an older "
        "state would leave of it. A step well back costs a few tenths of a millimetre and "
        "buys a robot that may be loaded, hurried and late.",
    ),
    wrong=(
        Wrong(
            "the best on the line, at the edge of the cliff",
            "It has the smallest error where you tried it. With 1.3 times this Kp the error is many "
            "times as large where you could not try it. Step back from the edge.",
            mistakes.best_on_the_training_path,
            "The best gain on one path is the most fragile one.",
        ),
        Wrong(
            "gains as low as possible",
            "With such gains the arm never shakes, and it never catches up either. Raise Kp.",
            mistakes.as_soft_as_possible,
            "A margin is bought with error; buy what you need.",
        ),
        Wrong(
            "the lowest error of all seeds, and no step back",
            "The lowest point of the curve lies near the cliff and leaves no reserve: with 1.3 times this Kp "
            "the error is too large where you could not try it. Take a third of the largest Kp that was safe.",
            mistakes.Lowest(),
            "The best gain on one path is the most fragile one.",
        ),
        Wrong(
            "only a tenth below the lowest point",
            "A tenth is too small a margin: with 1.3 times this Kp the error is too large where you could not "
            "try it. Take a third of the largest Kp that was safe.",
            mistakes.Lowest(0.9),
            "Say how large your margin is, and against what.",
        ),
        Wrong(
            "gains chosen without a run",
            "You return the same gains for an arm that is a quarter as fast, and they cannot be "
            "right for both. Try gains with the runner.",
            mistakes.Typed(20.0, 1.0),
            "A procedure can be carried to another arm; a number cannot.",
        ),
    ),
    variants=(variants.by_doubling, variants.by_bisection),
)

PAIRED = Problem(
    name="paired_difference",
    points=3,
    outcomes=("evidence",),
    asks="Two controllers were run on the same seeds. Give `(mean, half_width)`: the mean of a - b and "
    "half the width of its 95 % interval by Student's t.",
    answer=answers.paired_difference,
    judge=Close(rtol=1e-6, atol=1e-9, parts=("mean", "half_width")),
    trials=(
        Trial(
            "the same numbers, shifted by one millimetre",
            (call([4.0, 2.0, 6.0], [5.0, 3.0, 7.0]),),
            weight=0.0,
        ),
        Trial(
            "the mean over seeds that differ much, of a difference that does not: five and ten",
            _PAIRS,
            hidden.pairs,
            "other seeds, other numbers of them",
            0.4,
            "mean",
        ),
        Trial(
            "half the width of its interval",
            _PAIRS,
            hidden.pairs,
            "other seeds, other numbers of them",
            0.6,
            "half_width",
        ),
    ),
    hints=(
        "The seeds are the same in both rows, so subtract first: what a hard seed does to both drops "
        "out.",
        "d = a - b. Its mean, and the standard error of the mean: the standard deviation over √n, "
        "with n - 1 in it.",
        "Differences first. Their standard deviation has n - 1 in it, the mean's has a root "
        "of n on top, and the quantile of Student's t is that of 0.975 with n - 1.",
    ),
    wrong=(
        Wrong(
            "the rows taken as unpaired",
            "Taken as unpaired, the rows spread as much as the seeds do, and the difference "
            "drowns. Subtract pair by pair first.",
            mistakes.unpaired,
            "Same seeds: pair them.",
        ),
        Wrong(
            "the spread of one difference",
            "This says where a single difference may fall. The mean of n of them is surer: divide "
            "by √n.",
            mistakes.deviation_of_one,
            "Standard deviation and standard error are two things.",
        ),
        Wrong(
            "1.96 for a handful of seeds",
            "1.96 is right for very many pairs. For a few, use Student's t, which is wider.",
            mistakes.normal_quantile,
            "Five seeds are not many.",
        ),
        Wrong(
            "the rows sorted first",
            "Sorted, each error has another partner, and the differences shrink. The pairs are the "
            "seeds: leave them as they are.",
            mistakes.Paired(lambda a, b: np.sort(a) - np.sort(b)),
            "Same seeds: pair them.",
        ),
        Wrong(
            "n instead of n - 1 in the deviation",
            "numpy's std divides by n. The mean comes from the same numbers, so divide by n - 1: "
            "ddof=1.",
            mistakes.Interval(given=0),
            "n or n - 1: who gave you the mean?",
        ),
        Wrong(
            "95 % on one side only",
            "ppf(0.95) leaves 5 % above and another 5 % below. For 95 % in the middle take 0.975.",
            mistakes.Interval(quantile=0.95),
            "Two tails of 2.5 % each.",
        ),
        Wrong(
            "n degrees of freedom",
            "The mean has used up one degree of freedom. Use n - 1.",
            mistakes.Interval(freedom=0),
            "n or n - 1: who gave you the mean?",
        ),
        Wrong(
            "b - a instead of a - b",
            "Give the mean of a - b.",
            mistakes.Interval(sign=-1.0),
            "Say what a positive difference means before you compute it.",
        ),
        Wrong(
            "the whole width",
            "This is the whole width of the interval. Give half of it.",
            mistakes.Interval(share=2.0),
            "Mean ± half width.",
        ),
        Wrong(
            "the ends of the interval",
            "These are the ends of the interval. Give its middle and half of its width.",
            mistakes.ends_of_the_interval,
            "Mean ± half width.",
        ),
        Wrong(
            "the standard error alone",
            "One standard error holds the truth in two cases of three. For 95 % multiply by Student's t.",
            mistakes.without_students_t,
            "Say how sure, then how wide.",
        ),
        Wrong(
            "the standard deviation alone",
            "This is the spread of the differences. Divide it by √n and multiply by Student's t.",
            mistakes.plain_deviation,
            "Standard deviation and standard error are two things.",
        ),
        Wrong(
            "two intervals added",
            "The two rows have each its own interval here. The question is about the differences: take a - b first, then one interval.",
            mistakes.two_intervals,
            "Pairs first, then statistics.",
        ),
        Wrong(
            "unpaired, with more degrees of freedom",
            "2 n - 2 belongs to two groups of strangers. Here are n pairs: n differences, n - 1 degrees of freedom.",
            mistakes.unpaired_with_more_freedom,
            "Pairs first, then statistics.",
        ),
        Wrong(
            "divided by n, not by its root",
            "The standard error is the deviation divided by √n.",
            mistakes.Paired(half=lambda d: mistakes.half_of(d) / np.sqrt(len(d))),
            "Four times the pairs, half the interval.",
        ),
        Wrong(
            "divided by the root of n - 1",
            "With ddof=1 the n - 1 is in the deviation already; the standard error divides by √n.",
            mistakes.Paired(half=lambda d: mistakes.half_of(d) * np.sqrt(len(d) / (len(d) - 1))),
            "n - 1 comes once.",
        ),
        Wrong(
            "the variance for the deviation",
            "The half width is in the unit of the errors: take the root of the variance.",
            mistakes.Paired(half=lambda d: mistakes.half_of(d) * d.std(ddof=1)),
            "A variance has the unit squared.",
        ),
        Wrong(
            "a 99 % interval",
            "0.995 leaves half a percent on each side. For 95 % it is 0.975.",
            mistakes.Paired(
                half=lambda d: (
                    mistakes.half_of(d)
                    * student.ppf(0.995, len(d) - 1)
                    / student.ppf(0.975, len(d) - 1)
                )
            ),
            "95 % in the middle leaves 2.5 % on each side.",
        ),
        Wrong(
            "2 for Student's t",
            "2 is for many pairs. Student's t for n - 1 degrees of freedom is larger.",
            mistakes.Paired(half=lambda d: 2.0 * d.std(ddof=1) / np.sqrt(len(d))),
            "Few pairs: Student's t.",
        ),
        Wrong(
            "2.776, however many pairs there are",
            "2.776 is Student's t for five pairs. Ask for n - 1 degrees of freedom.",
            mistakes.Paired(half=lambda d: 2.776 * d.std(ddof=1) / np.sqrt(len(d))),
            "Few pairs: Student's t.",
        ),
        Wrong(
            "1.645 for the half width",
            "1.645 is the normal quantile of one side. Take Student's t at 0.975.",
            mistakes.Paired(half=lambda d: 1.645 * d.std(ddof=1) / np.sqrt(len(d))),
            "95 % in the middle leaves 2.5 % on each side.",
        ),
        Wrong(
            "1.96 and n in the deviation",
            "Two shortcuts for large n at once: 1.96 for Student's t, and n for n - 1.",
            mistakes.Paired(half=lambda d: 1.96 * d.std() / np.sqrt(len(d))),
            "Few pairs: Student's t.",
        ),
        Wrong(
            "a ratio",
            "a - b is asked for, and yours is made of a / b.",
            mistakes.Paired(np.divide),
            "A difference has a unit, a ratio has none.",
        ),
        Wrong(
            "without its sign",
            "The size of each difference loses who was better: some pairs must cancel. Keep the sign.",
            mistakes.Paired(lambda a, b: np.abs(a - b)),
            "A difference has a sign.",
        ),
        Wrong(
            "the median",
            "The middle of the interval is the mean of the differences.",
            mistakes.Paired(mean=np.median),
            "Student's t is about the mean.",
        ),
        Wrong(
            "half of the range",
            "From the smallest to the largest difference is not a 95 % interval of the mean.",
            mistakes.Paired(half=lambda d: (d.max() - d.min()) / 2.0),
            "The range grows with n, the interval of the mean shrinks.",
        ),
    ),
    variants=(variants.paired_by_scipy, variants.paired_by_hand),
)

VERDICTS = Problem(
    name="verdicts",
    points=3,
    outcomes=("evidence",),
    asks="A table gives for each claim two rows of errors over the same seeds. The claim is that the "
    'first is larger. Give for each claim "holds", "does not hold" or "undecided".',
    answer=answers.verdicts,
    trials=(
        Trial(
            "one claim that clearly holds, one that clearly does not",
            (
                call(
                    {
                        "A is worse than B": [[4.0, 5.0, 6.0], [0.0, 1.1, 1.9]],
                        "C is worse than D": [[0.0, 1.1, 1.9], [4.0, 5.0, 6.0]],
                    }
                ),
            ),
            weight=0.0,
        ),
        Trial(
            "one that flips with the seed, some near the edge on either side, three and ten seeds",
            (
                call({"A is worse than B": [[4.0, 5.0, 6.0, 2.0], [3.0, 6.2, 5.1, 2.6]]}),
                call(
                    {
                        "C is worse than D": [_NEAR_THE_EDGE[0], _SEEDS],
                        "E is worse than F": [_NEAR_THE_EDGE[1], _SEEDS],
                        "G is worse than H": [[3.5, 1.7, 5.3, 2.65, 4.5], _SEEDS],
                    }
                ),
                call({"I is worse than J": [[4.0, 3.5, 5.5], [3.0, 2.0, 5.0]]}),
                call(
                    {
                        "S is worse than T": [[6.1, 4.0, 7.8, 5.2, 3.5], _SEEDS],
                        "U is worse than V": [[2.8, 0.8, 4.8, 4.05, 6.9], _SEEDS],
                    }
                ),
                call(
                    {
                        "O is worse than P": [_SEEDS, _NEAR_THE_EDGE[0]],
                        "Q is worse than R": [_SEEDS, _NEAR_THE_EDGE[1]],
                    }
                ),
                call(
                    {
                        "K is worse than L": _TEN_PAIRS,
                        "M is worse than N": [[3.1, 1.22, 5.0, 2.16, 4.0], _SEEDS],
                    }
                ),
            ),
            hidden.tables,
            "claims of every kind",
        ),
    ),
    hints=(
        "When does a difference say something? When it is larger than what the seeds alone could make.",
        "Use your paired_difference: the claim holds if mean - half_width > 0, and does not hold if "
        "mean + half_width < 0.",
        "Compare the mean with the half width: beyond it on one side, beyond it on the other, "
        "or neither. Neither is an honest and often the right answer.",
    ),
    wrong=(
        Wrong(
            "every claim decided",
            "The sign of a mean is always one or the other. If the interval holds 0, another seed "
            'might reverse it: return "undecided".',
            mistakes.always_decided,
            "Undecided is a result.",
        ),
        Wrong(
            "the two verdicts swapped",
            "The claim is that the first error is larger, so a positive difference speaks for it.",
            mistakes.the_other_way_round,
            "Say what a positive difference means before you compute it.",
        ),
        Wrong(
            "an interval too narrow",
            "You decide a claim that five seeds do not settle. Check each factor: Student's t for "
            "both sides (0.975, n - 1), where 1.96 is too small; the deviation with n - 1, divided "
            "by √n and not by n; and if you compare squares, the squares of both.",
            mistakes.VerdictsBy(mistakes.normal_quantile),
            "Five seeds are not many.",
        ),
        Wrong(
            "an interval too wide",
            "You leave a claim undecided that five seeds do settle. The mean of n differences is "
            "surer than one of them: divide by √n.",
            mistakes.VerdictsBy(mistakes.deviation_of_one),
            "Standard deviation and standard error are two things.",
        ),
        Wrong(
            "the rows taken as unpaired",
            "You leave a claim undecided that five seeds do settle: taken as unpaired, the rows "
            "spread as much as the seeds do. Subtract pair by pair first.",
            mistakes.VerdictsBy(mistakes.unpaired),
            "Same seeds: pair them.",
        ),
        Wrong(
            "every claim undecided",
            "Of all claims that are tried here you say undecided. This is right only where the "
            "interval of the differences, pair by pair, holds 0; the intervals of the two rows, each for "
            "itself, decide nothing. Where it leaves out 0, say which error is larger.",
            mistakes.never_decided,
            "Undecided is a result, not a way out.",
        ),
        Wrong(
            "a threshold instead of an interval",
            "A fixed percentage is much where the seeds hardly differ, and little where they do. "
            "Use the interval of the differences.",
            mistakes.ten_percent,
            "How sure is a matter of the spread, not of the size.",
        ),
        Wrong(
            "the rows sorted first",
            "Sorted, each error has another partner, and the differences shrink to next to nothing. "
            "The pairs are the seeds: leave them as they are.",
            mistakes.sorted_first,
            "Same seeds: pair them.",
        ),
        Wrong(
            "Student's t of five pairs for any number",
            "2.776 is right for five pairs only. Three pairs need 4.303, ten need 2.262: use "
            "scipy.stats.t.ppf(0.975, n - 1).",
            mistakes.VerdictsBy(mistakes.t_of_five),
            "A number in a program should say where it comes from.",
        ),
        Wrong(
            "other words: true and false",
            "The words that are asked for are 'holds', 'does not hold' and 'undecided'.",
            mistakes.Said((True, False, None)),
            "Read what form an answer should have.",
        ),
        Wrong(
            "nothing is undecided: it holds or it does not",
            "Where the interval holds zero, nothing is known: the verdict is 'undecided', not 'does not hold'.",
            mistakes.Said(("holds", "does not hold", "does not hold")),
            "No evidence for is not evidence against.",
        ),
        Wrong(
            "what speaks against is undecided",
            "An interval that lies below zero is an answer too: 'does not hold'.",
            mistakes.Said(("holds", "undecided", "undecided")),
            "An interval has two sides.",
        ),
        Wrong(
            "it holds whenever it is decided",
            "The sign of the mean decides: above zero 'holds', below zero 'does not hold'.",
            mistakes.Said(("holds", "holds", "undecided")),
            "An interval has two sides.",
        ),
        Wrong(
            "below zero without an interval",
            "A mean below zero does not yet speak against the claim: the whole interval must lie "
            "below zero, as it must lie above zero before the claim holds.",
            mistakes.Said(sure=lambda d: d.mean() < 0.0 or d.mean() > mistakes.half_of(d)),
            "An interval has two sides.",
        ),
        Wrong(
            "all pairs must agree",
            "You ask whether all differences have one sign. The mean may be sure although one pair is against it.",
            mistakes.Said(sure=lambda d: not d.min() < 0.0 < d.max()),
            "An interval is about the mean.",
        ),
        Wrong(
            "the majority of the seeds decides",
            "You count on how many seeds the first is larger. A majority says nothing of how sure "
            "it is: three of five is little. Use the interval of the mean difference.",
            mistakes.by_majority,
            "An interval is about the mean.",
        ),
        Wrong(
            "the spread of the pairs instead of the interval",
            "You compare the mean with the standard deviation of the differences. The mean of n "
            "differences varies less than one of them, and few of them need Student's t: compare "
            "it with t·s/√n.",
            mistakes.Said(sure=lambda d: abs(d.mean()) > d.std(ddof=1)),
            "Standard deviation and standard error are two things.",
        ),
        Wrong(
            "capital letters",
            "The words are written small: 'holds', 'does not hold', 'undecided'.",
            mistakes.Said(("Holds", "Does not hold", "Undecided")),
            "Read what form an answer should have.",
        ),
    ),
    variants=(variants.verdicts_by_comprehension,),
)

PROBLEMS = (RMS_ERROR, OPEN_LOOP, KP_FOR_MARGIN, CHOOSE_GAINS, PAIRED, VERDICTS)
