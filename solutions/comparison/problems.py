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
_NEAR_THE_EDGE = [3.1, 2.7, 5.2, 3.45, 4.4], [3.6, 2.6, 5.7, 3.45, 4.6]
"""Rows that differ from `_SEEDS` by 2.6 and by 5.3 standard errors; the threshold is 2.78."""
_345 = np.array([0.003, 0.004, 0.012])

RMS_ERROR = Problem(
    name="rms_error",
    points=3,
    outcomes=("evidence",),
    asks="From a log whose targets are poses, give the RMS position error of the tip in metres: "
    "square the length of each row's error, take the mean over the rows, then the root.",
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
        "Where is the tip in row k? Ask the model, with the joint angles of that row. Where "
        "should the tip be? The target of that row says.",
        "log.q has one row for each instant, and log.target.pose has one pose. model.pose(q)[:3, "
        "3] is the tip's position. Square the length of the difference, row by row.",
        "Make an array with one error vector in each row, in three columns. Square it, sum over "
        "the right axis, take the mean over the other, then the root.",
    ),
    wrong=(
        Wrong(
            "the mean goes over the components too",
            "A mean over rows and components divides by three times as many numbers, so the "
            "result is too small by a factor of √3. Sum over the components, then take the mean "
            "over the rows.",
            mistakes.mean_of_components,
            "An RMS of a vector: sum over components, mean over time.",
        ),
        Wrong(
            "the last tip used for all rows",
            "Every target is compared with the tip at the end of the run. Compute the tip for "
            "each row. The report's plots did not, so their curves of the workspace are constants.",
            mistakes.last_row_for_all,
            "A curve that does not depend on the run measures nothing.",
        ),
        Wrong(
            "the mean length instead of the root of the mean square",
            "This is the mean error. Square the lengths, take their mean, then the root: large "
            "errors weigh more.",
            mistakes.mean_of_lengths,
            "Mean, RMS and maximum are three different numbers; say which you give.",
        ),
        Wrong(
            "the largest error",
            "This is the largest error of the run. Give the root mean square.",
            mistakes.largest,
            "Mean, RMS and maximum are three different numbers; say which you give.",
        ),
        Wrong(
            "the root left out",
            "A mean of squares is in square metres. Take the root at the end.",
            mistakes.without_the_root,
            "Look at the unit of the result.",
        ),
        Wrong(
            "millimetres for metres",
            "These numbers are in millimetres. Give metres.",
            mistakes.in_millimetres,
            "Compute in SI units; use millimetres only in print.",
        ),
        Wrong(
            "a sum, not a mean",
            "The root of the sum of all squares grows with the length of the run. Divide by the number "
            "of rows before you take the root.",
            mistakes.not_a_mean,
            "A run that is twice as long is not a worse one.",
        ),
        Wrong(
            "the whole poses subtracted",
            "A pose has sixteen numbers, nine of which are the rotation, so a tilt counts as "
            "metres. Take the position alone, [:3, 3].",
            mistakes.whole_poses,
            "You cannot add metres and the numbers of a rotation.",
        ),
        Wrong(
            "one row late",
            "Each tip is compared with the target of the next row. Compare the tip and the target "
            "of the same row.",
            mistakes.one_row_late,
            "What belongs to the same instant is in the same row.",
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
            "For the log of the right arm you compute the tips of the left arm. Use the `model` "
            "that you are given.",
            mistakes.always_the_left_arm,
            "Use the arguments of the function, not a global variable.",
        ),
        Wrong(
            "one row alone: the first",
            "This is the error of the first row. Take the mean over all rows of the run.",
            mistakes.Rms(lambda e: np.linalg.norm(e[0])),
            "An RMS is a mean over the run.",
        ),
        Wrong(
            "one row, not a mean",
            "This is the error of a single row, the last or the one in the middle. Take the mean "
            "of the squared lengths over all rows.",
            mistakes.Rms(lambda e: np.linalg.norm(e[-1])),
            "An RMS is a mean over the run.",
        ),
        Wrong(
            "one direction alone",
            "The error is a vector in space, so its length depends on x, y and z. Yours depends "
            "on z alone.",
            mistakes.Rms(lambda e: np.sqrt(np.mean(e[:, 2] ** 2))),
            "The length of a vector depends on all its components.",
        ),
        Wrong(
            "in the plane alone",
            "The error is a vector in space, so its length depends on x, y and z. Yours leaves z "
            "out.",
            mistakes.Rms(lambda e: np.sqrt(np.mean(np.sum(e[:, :2] ** 2, axis=1)))),
            "The length of a vector depends on all its components.",
        ),
        Wrong(
            "the components' sizes added",
            "The length of a vector is the root of the sum of squares; the sum of |x|, |y| and |z| is longer.",
            mistakes.Rms(lambda e: np.mean(np.abs(e).sum(axis=1))),
            "The length of a vector is the root of the sum of squares.",
        ),
        Wrong(
            "components, or their RMS values, added without squares",
            "(x + y + z)² is not x² + y² + z². In each row square the three components, then add "
            "the squares.",
            mistakes.Rms(lambda e: np.sqrt(np.mean(e.sum(axis=1) ** 2))),
            "Square first, then add.",
        ),
        Wrong(
            "the spread of the length",
            "This is the standard deviation of the error's length, in which a constant error "
            "counts for nothing. Take the root mean square.",
            mistakes.Rms(lambda e: np.linalg.norm(e, axis=1).std()),
            "A standard deviation is about the mean, an RMS about zero.",
        ),
        Wrong(
            "divided by the rows outside the root",
            "Divide the sum of the squares by n, then take the root. You take the root first and "
            "divide it by n.",
            mistakes.Rms(lambda e: np.linalg.norm(e) / len(e)),
            "Each letter of RMS is a step: square, mean, root.",
        ),
        Wrong(
            "the mean of three RMS values",
            "You compute an RMS for each axis, and then their mean or sum. Add the three squares "
            "in each row first.",
            mistakes.Rms(lambda e: np.sqrt(np.mean(e**2, axis=0)).mean()),
            "Each letter of RMS is a step: square, mean, root.",
        ),
        Wrong(
            "centimetres",
            "These numbers are in centimetres. Give metres.",
            mistakes.Rms(lambda e: 100.0 * mistakes.rms(e)),
            "Say the unit of every number.",
        ),
        Wrong(
            "all rows compared with the first target",
            "The target moves: each row has its own target, log.target.pose[k].",
            mistakes.from_the_first_target,
            "Compare only what belongs to the same instant.",
        ),
        Wrong(
            "all rows compared with the last target",
            "The target moves: each row has its own target, log.target.pose[k].",
            mistakes.from_the_last_target,
            "Compare only what belongs to the same instant.",
        ),
        Wrong(
            "how far the tip went",
            "This compares the tip with its own start. The error is the difference between the "
            "target and the tip.",
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
    "python-control. It has the gain `kp`, the first-order `lag` of the speed, the integration to "
    "an angle, and the `delay`.",
    answer=answers.open_loop,
    judge=Response(omega=(0.3, 1.0, 3.0, 10.0, 25.0)),
    trials=(
        Trial(
            "no lag and no delay: kp / s",
            (call(4.0, 0.0, 0.0),),
            hidden.pure_integrators,
            weight=0.0,
        ),
        Trial("with a lag", (call(4.0, 0.05, 0.0),), hidden.lagging, "other lags", weight=1.5),
        Trial(
            "with a delay, the lag may be 0",
            (call(4.0, 0.03, 0.015), call(12.0, 0.05, 0.03), call(6.0, 0.0, 0.02)),
            hidden.loops,
            "other gains, lags and delays",
            weight=2.5,
        ),
    ),
    withheld=("labkit.stability",),
    hints=(
        "Three parts follow one another: a speed that follows its command with a lag, an "
        "integrator from speed to angle, and a delay. Transfer functions in a row multiply.",
        "control.tf([kp], [lag, 1, 0]) contains the gain, the lag and the integrator. The delay "
        "is not a ratio of polynomials; control.pade(delay, 4) returns one that is close to it.",
        "A lag and an integrator make a second-order denominator without a constant term. "
        "Multiply by the delay; where the delay is 0 there is nothing to approximate.",
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
            "For the open loop, cut the loop at one place and multiply the parts.",
        ),
        Wrong(
            "the delay as one more lag",
            "A lag takes at most 90 degrees of phase and lowers the gain. A delay takes more and "
            "more phase as the frequency grows, and does not change the gain. Use control.pade "
            "for the delay.",
            mistakes.delay_as_a_lag,
            "A delay is not a slow lag.",
        ),
        Wrong(
            "almost no delay",
            "The controller sees an old angle, but your loop has almost no delay. `delay` is in "
            "seconds; control.pade approximates it.",
            mistakes.LoopWithout(delay=0.0),
            "The age of the state is a part of the loop.",
        ),
        Wrong(
            "no delay where the lag is 0",
            "Where the lag is 0 your loop forgets the delay: the branch for `lag == 0` returns "
            "before the delay is multiplied in.",
            mistakes.delay_forgotten,
            "Each part of the loop may be zero on its own.",
        ),
        Wrong(
            "no lag",
            "The speed follows its command with a lag. Multiply by 1 / (lag s + 1).",
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
            "You divide by the delay, as if the controller knew the angle before it is measured. "
            "Multiply by the delay.",
            mistakes.LoopWithout(delay=-1.0),
            "A delay takes phase away.",
        ),
        Wrong(
            "the delay twice",
            "Multiply by the delay only once.",
            mistakes.LoopWithout(delay=2.0),
            "Name every part of the loop before you multiply.",
        ),
        Wrong(
            "a delay of first order",
            "control.pade(delay, 1) is accurate for slow signals only: at 25 rad/s and 30 ms its "
            "phase is wrong by 2 degrees. Use order 4.",
            mistakes.LoopWithout(order=1),
            "Know the range in which an approximation is valid.",
        ),
        Wrong(
            "s squared in the lag",
            "The denominator of the lag is lag·s + 1. With s² it belongs to a spring that swings, "
            "not to a first-order lag.",
            mistakes.Loop(lambda kp, lag: ([kp], [lag, 0.0, 1.0, 0.0])),
            "A first-order lag has one pole, at -1/lag.",
        ),
        Wrong(
            "the lag in the numerator",
            "The lag belongs in the denominator, 1/(lag·s + 1). In the numerator it would add "
            "phase instead of taking it away.",
            mistakes.Loop(lambda kp, lag: ([kp * lag, kp], [1.0, 0.0])),
            "A lag takes phase away.",
        ),
        Wrong(
            "the lag's coefficients exchanged",
            "control.tf expects the highest power first: [lag, 1] is lag·s + 1. Yours is s + lag.",
            mistakes.Loop(lambda kp, lag: ([kp], [1.0, lag, 0.0])),
            "The coefficient of the highest power comes first.",
        ),
        Wrong(
            "two integrators",
            "From speed to angle there is one integration. Yours has two.",
            mistakes.Loop(lambda kp, lag: ([kp], [lag, 1.0, 0.0, 0.0])),
            "Count the integrations from command to angle.",
        ),
        Wrong(
            "a differentiator for the integrator",
            "From speed to angle there is an integration, 1/s. You multiply by s.",
            mistakes.Loop(lambda kp, lag: ([kp, 0.0], [lag, 1.0])),
            "Dividing by s integrates.",
        ),
        Wrong(
            "the gain in the denominator",
            "kp multiplies the loop, so it belongs in the numerator.",
            mistakes.Loop(lambda kp, lag: ([1.0], [kp * lag, kp, 0.0])),
            "A larger gain makes the open loop larger.",
        ),
        Wrong(
            "the gain squared",
            "Multiply the loop by kp only once.",
            mistakes.Loop(lambda kp, lag: ([kp**2], [lag, 1.0, 0.0])),
            "Follow the signal round the loop once.",
        ),
        Wrong(
            "the lag twice",
            "Multiply the loop by the lag's factor only once.",
            mistakes.Loop(lambda kp, lag: ([kp], [lag**2, 2 * lag, 1.0, 0.0])),
            "Follow the signal round the loop once.",
        ),
        Wrong(
            "a minus in the loop",
            "The minus of the feedback is not a part of the open loop. It is needed only where "
            "the loop is closed.",
            mistakes.Loop(lambda kp, lag: ([-kp], [lag, 1.0, 0.0])),
            "The open loop is everything from the error to the angle.",
        ),
        Wrong(
            "half of the delay",
            "You give control.pade half of the delay. Give it the whole delay; the halves in its "
            "formula are its own.",
            mistakes.Loop(mistakes.plain_loop, delay=lambda delay, lag: delay / 2.0),
            "A delay d turns the phase by ω d.",
        ),
        Wrong(
            "the lag added to the delay",
            "Do not add the lag to the delay: the lag has its own factor, and control.pade "
            "receives the delay alone.",
            mistakes.Loop(mistakes.plain_loop, delay=lambda delay, lag: delay + lag),
            "A lag smooths, a delay only shifts.",
        ),
        Wrong(
            "the sensitivity",
            "This is 1/(1 + L), which says what the closed loop does to a disturbance. Give the "
            "open loop L itself.",
            mistakes.Loop(mistakes.plain_loop, close=lambda loop: control.feedback(1, loop)),
            "The open loop is everything from the error to the angle.",
        ),
    ),
    variants=(variants.loop_from_s,),
)

KP_FOR_MARGIN = Problem(
    name="kp_for_margin",
    points=3,
    core=False,
    outcomes=("control",),
    asks="Give the gain kp at which the loop of `open_loop` has a phase margin of `margin_deg` "
    "degrees. Take the delay exactly, without an approximation.",
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
        "The phase does not depend on kp. Find the frequency at which the phase is what the "
        "margin demands; then choose kp so that the gain is 1 there.",
        "The phase at ω is -90° - atan(lag·ω) - delay·ω, with the last term in radians. The "
        "margin is the distance from this phase to -180°.",
        "kp does not change the phase of the loop. Find the frequency at which the phase leaves "
        "the margin (scipy has root finders), then the kp that makes the gain 1 there.",
    ),
    wrong=(
        Wrong(
            "the margin taken for radians",
            "60 radians are nearly ten turns. Convert the margin to radians before you add it to "
            "an angle in radians.",
            mistakes.margin_in_radians,
            "Convert degrees to radians at once, and compute in radians.",
        ),
        Wrong(
            "the delay left out",
            "Without the delay the crossover may be at a much higher frequency, so the gain is "
            "too large for the real loop. Put the delay's phase, delay·ω, into the condition.",
            mistakes.without_the_delay,
            "The age of the state is a part of the loop.",
        ),
        Wrong(
            "the frequency taken for the gain",
            "kp is not the frequency itself: at the crossover the gain of the lag is below 1, and "
            "kp has to compensate for this.",
            mistakes.lag_free_gain,
            "First the phase gives the frequency, then the gain must be 1 there.",
        ),
        Wrong(
            "the loop's gain, not its inverse",
            "This is the gain that the loop without kp has at the crossover. To make the gain of "
            "the whole loop 1, kp must be one over it.",
            mistakes.GainAt(power=-1.0),
            "kp times the gain of the rest is 1.",
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
            "The magnitude of a complex number has a root in it.",
        ),
        Wrong(
            "radians among degrees",
            "delay·ω is in radians. Convert it to degrees before you subtract it from 90.",
            mistakes.phase_mixed,
            "Convert degrees to radians at once, and compute in radians.",
        ),
        Wrong(
            "divided by 2π",
            "kp is in 1/s, and the ω in it is in rad/s, as in the loop. Do not divide by 2π.",
            mistakes.in_hertz,
            "s is iω, and ω is in rad/s.",
        ),
        Wrong(
            "one over the gain",
            "At the crossover |L| = 1, so kp = ω √(1 + (ω·lag)²). You divide by ω instead of "
            "multiplying.",
            mistakes.Margin(gain=lambda w, lag, delay: sqrt(1.0 + (lag * w) ** 2) / w),
            "At the crossover the loop's gain is 1.",
        ),
        Wrong(
            "the root forgotten",
            "The magnitude of 1 + jω·lag is √(1 + (ω·lag)²). You add 1 and ω·lag as if they were "
            "lengths along one line.",
            mistakes.Margin(gain=lambda w, lag, delay: w * (1.0 + lag * w)),
            "The magnitude of 1 + jx is √(1 + x²).",
        ),
        Wrong(
            "the delay in the gain",
            "A delay does not change the magnitude. The gain depends on the lag, not on the delay.",
            mistakes.Margin(gain=lambda w, lag, delay: w * sqrt(1.0 + (delay * w) ** 2)),
            "The magnitude of exp(-jωd) is 1.",
        ),
        Wrong(
            "the delay's arctangent",
            "A delay turns the phase by ω·delay. The arctangent belongs to the lag alone.",
            mistakes.Margin(lambda w, lag, delay, m: pi / 2 - atan(lag * w) - atan(delay * w) - m),
            "A lag turns the phase by at most 90 degrees, a delay without limit.",
        ),
        Wrong(
            "the lag's arctangent left out",
            "A lag turns the phase by atan(ω·lag), not by ω·lag: it never takes more than 90 "
            "degrees.",
            mistakes.Margin(lambda w, lag, delay, m: pi / 2 - lag * w - delay * w - m),
            "A lag turns the phase by at most 90 degrees, a delay without limit.",
        ),
        Wrong(
            "the margin for the phase",
            "The margin is what is left to -180 degrees. You take it for the phase that lag and "
            "delay use up.",
            mistakes.Margin(lambda w, lag, delay, m: m - atan(lag * w) - delay * w),
            "The margin is the distance of the phase from -180 degrees.",
        ),
        Wrong(
            "the delay taken for milliseconds",
            "The delay is in seconds already. Do not divide it by 1000.",
            mistakes.Margin(
                lambda w, lag, delay, m: pi / 2 - atan(lag * w) - delay * w / 1000.0 - m
            ),
            "Say the unit of every number.",
        ),
        Wrong(
            "half of the gain",
            "At the crossover |L| = 1 gives kp = ω √(1 + (ω·lag)²), without a factor 1/2.",
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
    "returns the RMS error in mm of a run along the line, for `seed` 0 to 4. On the line the error of the worst "
    f"seed may be at most {hidden.LINE_LIMIT:g} mm, with your Kp and with {hidden.FAR:g} times your Kp. Your gains are "
    "then tried where you could not try them, once as they are and once with a margin, "
    f"{hidden.RESERVE:g} times your Kp: there the error of the worst seed may be at most "
    f"{hidden.UNSEEN_LIMIT:g} mm. Your function is called for two arms, with 20 runs each time: the second "
    "arm is about a quarter as fast as the first, so other gains are right for it. Runs were recorded only up "
    "to Kp = 100, on the second arm up to about a quarter of that: beyond this, `runner` returns infinity. A Kp "
    f"above 100 stops it with an error. Where {hidden.RESERVE:g} or {hidden.FAR:g} times your Kp was not recorded, "
    "the error counts as infinite.",
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
            weight=1.5,
        ),
        Trial(
            f"the same with {hidden.RESERVE:g} times the chosen Kp",
            (),
            hidden.with_reserve,
            "the same, on an arm that is slower",
            weight=2.5,
        ),
    ),
    hints=(
        "The error falls as Kp grows, until the arm gets out of control; at which Kp this happens "
        "depends on the seed. The lowest point of the map is close to this edge, so do not take the "
        "gain there: it leaves too little margin.",
        "Raise Kp in steps and try more than one seed. As soon as the error jumps on one of them, "
        "you have found the edge.",
        "Find the largest Kp that was safe on more than one seed, and ask how much of it an older "
        "state would allow. A clear step back costs a few tenths of a millimetre, and the arm "
        "then also works with a load, at a higher speed and with an older state.",
    ),
    wrong=(
        Wrong(
            "the best on the line, at the edge of the cliff",
            "These gains have the smallest error where you tried them. With 1.3 times this Kp the "
            "error is many times as large where you could not try it. Step back from the edge.",
            mistakes.best_on_the_training_path,
            "The best gain on one path is the most fragile one.",
        ),
        Wrong(
            "gains as low as possible",
            "With such low gains the arm never shakes, but it does not follow its target either. "
            "Raise Kp.",
            mistakes.as_soft_as_possible,
            "A margin costs accuracy: take as much as you need.",
        ),
        Wrong(
            "the lowest error of all seeds, and no step back",
            "The lowest point of the curve is near the edge and leaves no margin: with 1.3 times "
            "this Kp the error is too large where you could not try it. Take a third of the "
            "largest Kp that was safe.",
            mistakes.Lowest(),
            "The best gain on one path is the most fragile one.",
        ),
        Wrong(
            "only a tenth below the lowest point",
            "A tenth is too small a margin: with 1.3 times this Kp the error is too large where you could not "
            "try it. Take a third of the largest Kp that was safe.",
            mistakes.Lowest(0.9),
            "Say how large your margin is, and what it is for.",
        ),
        Wrong(
            "gains chosen without a run",
            "You return the same gains for the second arm, which is a quarter as fast, and they "
            "cannot be right for both. Try gains with the runner.",
            mistakes.Typed(20.0, 1.0),
            "A procedure works on another arm; a number does not.",
        ),
    ),
    variants=(variants.by_doubling, variants.by_bisection),
)

PAIRED = Problem(
    name="paired_difference",
    points=3,
    outcomes=("evidence",),
    asks="Two controllers, a and b, were run on the same seeds. Give `(mean, half_width)`: the "
    "mean of a - b and half the width of its 95 % interval by Student's t.",
    answer=answers.paired_difference,
    judge=Close(rtol=1e-3, atol=1e-9, parts=("mean", "half_width")),  # t to three decimals
    trials=(
        Trial(
            "the mean of numbers that are shifted by about one millimetre",
            (call([4.0, 2.0, 6.0], [4.9, 3.0, 7.1]),),
            weight=0.0,
            part="mean",
        ),
        Trial(
            "the mean over seeds that differ much, of a difference that does not: five and ten",
            _PAIRS,
            hidden.pairs,
            "other seeds, other numbers of them",
            1.0,
            "mean",
        ),
        Trial(
            "half the width of its interval",
            _PAIRS,
            hidden.pairs,
            "other seeds, other numbers of them",
            2.0,
            "half_width",
        ),
    ),
    hints=(
        "The seeds are the same in both rows, so subtract first: the effect of a hard seed on "
        "both controllers cancels.",
        "With d = a - b you need its mean and the standard error of this mean: the standard "
        "deviation, which has n - 1 in it, divided by √n.",
        "Take the differences first. Their standard deviation has n - 1 in it, the standard error "
        "of their mean has the root of n as well, and the quantile of Student's t is that of "
        "0.975 with n - 1 degrees of freedom.",
    ),
    wrong=(
        Wrong(
            "the rows taken as unpaired",
            "Taken as unpaired, the rows spread as much as the seeds do, and this hides the "
            "difference. Subtract pair by pair first.",
            mistakes.unpaired,
            "Runs with the same seed are a pair.",
        ),
        Wrong(
            "the spread of one difference",
            "This says where a single difference may be. The mean of n differences is known "
            "better: divide by √n.",
            mistakes.deviation_of_one,
            "Standard deviation and standard error are two different numbers.",
        ),
        Wrong(
            "1.96 for a handful of seeds",
            "1.96 is right for very many pairs. For a few pairs use Student's t, which gives a "
            "wider interval.",
            mistakes.normal_quantile,
            "Five seeds are not many.",
        ),
        Wrong(
            "the rows sorted first",
            "Sorting gives each error another partner, and the differences then spread less than "
            "they should. Each pair belongs to one seed: leave the pairs as they are.",
            mistakes.Paired(lambda a, b: np.sort(a) - np.sort(b)),
            "Runs with the same seed are a pair.",
        ),
        Wrong(
            "n instead of n - 1 in the deviation",
            "numpy's std divides by n. The mean comes from the same numbers, so divide by n - 1: "
            "ddof=1.",
            mistakes.Interval(given=0),
            "n or n - 1: where does the mean come from?",
        ),
        Wrong(
            "95 % on one side only",
            "ppf(0.95) leaves 5 % above and another 5 % below. For 95 % in the middle use "
            "ppf(0.975).",
            mistakes.Interval(quantile=0.95),
            "The two tails have 2.5 % each.",
        ),
        Wrong(
            "n degrees of freedom",
            "The mean has used up one degree of freedom. Use n - 1.",
            mistakes.Interval(freedom=0),
            "n or n - 1: where does the mean come from?",
        ),
        Wrong(
            "b - a instead of a - b",
            "The sign is wrong: give the mean of a - b.",
            mistakes.Interval(sign=-1.0),
            "Say what a positive difference means before you compute it.",
        ),
        Wrong(
            "the whole width",
            "This is the whole width of the interval. Give half of it.",
            mistakes.Interval(share=2.0),
            "An interval is written as mean ± half width.",
        ),
        Wrong(
            "the ends of the interval",
            "These are the ends of the interval. Give its middle and half of its width.",
            mistakes.ends_of_the_interval,
            "An interval is written as mean ± half width.",
        ),
        Wrong(
            "the standard error alone",
            "An interval of one standard error contains the truth in about two cases of three. "
            "For 95 % multiply by Student's t.",
            mistakes.without_students_t,
            "First choose how sure you want to be, then compute the width.",
        ),
        Wrong(
            "the standard deviation alone",
            "This is the spread of the differences. Divide it by √n and multiply by Student's t.",
            mistakes.plain_deviation,
            "Standard deviation and standard error are two different numbers.",
        ),
        Wrong(
            "two intervals added",
            "Here each of the two rows has its own interval. The question is about the "
            "differences: compute a - b first, then one interval.",
            mistakes.two_intervals,
            "Subtract pair by pair first, then do the statistics.",
        ),
        Wrong(
            "unpaired, with more degrees of freedom",
            "2 n - 2 degrees of freedom belong to two independent groups. Here are n pairs: n "
            "differences, n - 1 degrees of freedom.",
            mistakes.unpaired_with_more_freedom,
            "Subtract pair by pair first, then do the statistics.",
        ),
        Wrong(
            "divided by n, not by its root",
            "The standard error is the deviation divided by √n.",
            mistakes.Paired(half=lambda d: mistakes.half_of(d) / np.sqrt(len(d))),
            "Four times as many pairs give half the interval.",
        ),
        Wrong(
            "divided by the root of n - 1",
            "With ddof=1 the n - 1 is in the standard deviation already. For the standard error "
            "divide by √n.",
            mistakes.Paired(half=lambda d: mistakes.half_of(d) * np.sqrt(len(d) / (len(d) - 1))),
            "n - 1 is used only once.",
        ),
        Wrong(
            "the variance for the deviation",
            "The half width is in the unit of the errors: take the root of the variance.",
            mistakes.Paired(half=lambda d: mistakes.half_of(d) * d.std(ddof=1)),
            "A variance has the unit squared.",
        ),
        Wrong(
            "a 99 % interval",
            "ppf(0.995) leaves half a percent on each side. For 95 % in the middle use ppf(0.975).",
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
            "2 is right for many pairs. For few pairs Student's t with n - 1 degrees of freedom "
            "is larger.",
            mistakes.Paired(half=lambda d: 2.0 * d.std(ddof=1) / np.sqrt(len(d))),
            "With few pairs use Student's t.",
        ),
        Wrong(
            "2.776, however many pairs there are",
            "2.776 is Student's t for five pairs. Use n - 1 degrees of freedom.",
            mistakes.Paired(half=lambda d: 2.776 * d.std(ddof=1) / np.sqrt(len(d))),
            "With few pairs use Student's t.",
        ),
        Wrong(
            "1.645 for the half width",
            "1.645 is the normal quantile with 5 % on one side. Use Student's t at 0.975.",
            mistakes.Paired(half=lambda d: 1.645 * d.std(ddof=1) / np.sqrt(len(d))),
            "95 % in the middle leaves 2.5 % on each side.",
        ),
        Wrong(
            "1.96 and n in the deviation",
            "These are two shortcuts for large n at once: 1.96 instead of Student's t, and n "
            "instead of n - 1.",
            mistakes.Paired(half=lambda d: 1.96 * d.std() / np.sqrt(len(d))),
            "With few pairs use Student's t.",
        ),
        Wrong(
            "a ratio",
            "Your result comes from a / b. Give the mean and the half width of a - b.",
            mistakes.Paired(np.divide),
            "A difference has a unit, a ratio has none.",
        ),
        Wrong(
            "without its sign",
            "The size of a difference does not say which controller was better. Keep the signs, "
            "so that opposite differences cancel.",
            mistakes.Paired(lambda a, b: np.abs(a - b)),
            "A difference has a sign.",
        ),
        Wrong(
            "the median",
            "This is the median. The middle of the interval is the mean of the differences.",
            mistakes.Paired(mean=np.median),
            "Student's t is about the mean.",
        ),
        Wrong(
            "half of the range",
            "The range from the smallest to the largest difference is not a 95 % interval of the "
            "mean.",
            mistakes.Paired(half=lambda d: (d.max() - d.min()) / 2.0),
            "The range grows with n; the interval of the mean shrinks.",
        ),
    ),
    variants=(variants.paired_by_scipy, variants.paired_by_hand, variants.paired_by_interval),
)

VERDICTS = Problem(
    name="verdicts",
    points=3,
    outcomes=("evidence",),
    asks="For each claim a table has two rows of errors over the same seeds. The claim is that "
    'the errors of the first row are larger. Give for each claim "holds", "does not hold" or '
    '"undecided".',
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
                        "U is worse than V": [[2.8, 1.0, 4.8, 4.05, 6.4], _SEEDS],
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
        "When does a difference mean something? When it is larger than what the seeds alone could "
        "cause.",
        "Use your paired_difference: the claim holds if mean - half_width > 0, and does not hold if "
        "mean + half_width < 0.",
        "Compare the mean difference with the half width: it may be beyond it on one side, beyond "
        "it on the other, or neither. Neither is an honest answer, and often the right one.",
    ),
    wrong=(
        Wrong(
            "every claim decided",
            "A mean nearly always has a sign. If the interval contains 0, another seed might "
            'reverse this sign: return "undecided".',
            mistakes.always_decided,
            "Undecided is a result.",
        ),
        Wrong(
            "the two verdicts swapped",
            "The claim is that the first error is larger, so a positive difference supports it.",
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
            "known better than one of them: divide by √n.",
            mistakes.VerdictsBy(mistakes.deviation_of_one),
            "Standard deviation and standard error are two different numbers.",
        ),
        Wrong(
            "n instead of n - 1 in the deviation",
            "You decide a claim that five seeds do not settle. numpy's std divides by n. The mean "
            "comes from the same numbers, so divide by n - 1: ddof=1.",
            mistakes.VerdictsBy(mistakes.Interval(given=0)),
            "n or n - 1: where does the mean come from?",
        ),
        Wrong(
            "the quantile of another confidence",
            "You leave a claim undecided that the seeds do settle: your interval contains the mean "
            "in more than 95 % of cases. For 95 % leave out 2.5 % on each side, which is "
            "scipy.stats.t.ppf(0.975, n - 1); 0.99 and 0.995 are too large.",
            mistakes.VerdictsBy(mistakes.Interval(quantile=0.995)),
            "Say which confidence an interval has.",
        ),
        Wrong(
            "the rows taken as unpaired",
            "You leave a claim undecided that five seeds do settle: taken as unpaired, the rows "
            "spread as much as the seeds do. Subtract pair by pair first.",
            mistakes.VerdictsBy(mistakes.unpaired),
            "Runs with the same seed are a pair.",
        ),
        Wrong(
            "every claim undecided",
            'You return "undecided" for every claim that is tried here. This is right only where '
            "the interval of the differences, pair by pair, contains 0; the separate intervals of "
            "the two rows decide nothing. Where the interval does not contain 0, say which error "
            "is larger.",
            mistakes.never_decided,
            "Undecided is a result, not a way out.",
        ),
        Wrong(
            "a threshold instead of an interval",
            "A fixed percentage is large where the seeds hardly differ, and small where they do. "
            "Use the interval of the differences.",
            mistakes.ten_percent,
            "How sure you are depends on the spread, not only on the size.",
        ),
        Wrong(
            "the rows sorted first",
            "Sorting gives each error another partner, and the differences then spread less than "
            "they should. Each pair belongs to one seed: leave the pairs as they are.",
            mistakes.sorted_first,
            "Runs with the same seed are a pair.",
        ),
        Wrong(
            "Student's t of five pairs for any number",
            "2.776 is right for five pairs only. Three pairs need 4.303, ten need 2.262: use "
            "scipy.stats.t.ppf(0.975, n - 1).",
            mistakes.VerdictsBy(mistakes.t_of_five),
            "Say where each number in a program comes from.",
        ),
        Wrong(
            "other words: true and false",
            "Return the words 'holds', 'does not hold' and 'undecided'.",
            mistakes.Said((True, False, None)),
            "Read which form the answer should have.",
        ),
        Wrong(
            "nothing is undecided: it holds or it does not",
            "Where the interval contains zero, the seeds settle nothing: the verdict is "
            "'undecided', not 'does not hold'.",
            mistakes.Said(("holds", "does not hold", "does not hold")),
            "No evidence for a claim is not evidence against it.",
        ),
        Wrong(
            "what speaks against is undecided",
            "If the whole interval is below zero, the claim is settled too: 'does not hold'.",
            mistakes.Said(("holds", "undecided", "undecided")),
            "An interval has two sides.",
        ),
        Wrong(
            "it holds whenever it is decided",
            "You return 'holds' for every claim that is settled. The sign of the mean decides: "
            "above zero 'holds', below zero 'does not hold'.",
            mistakes.Said(("holds", "holds", "undecided")),
            "An interval has two sides.",
        ),
        Wrong(
            "below zero without an interval",
            "A mean below zero alone does not refute the claim: the whole interval must be below "
            "zero, just as it must be above zero for the claim to hold.",
            mistakes.Said(sure=lambda d: d.mean() < 0.0 or d.mean() > mistakes.half_of(d)),
            "An interval has two sides.",
        ),
        Wrong(
            "all pairs must agree",
            "You ask whether all differences have one sign. The mean can be settled although one "
            "pair has the other sign.",
            mistakes.Said(sure=lambda d: not d.min() < 0.0 < d.max()),
            "An interval is about the mean.",
        ),
        Wrong(
            "the majority of the seeds decides",
            "You count on how many seeds the first error is larger. A majority does not say how "
            "sure this is: three of five is not much. Use the interval of the mean difference.",
            mistakes.by_majority,
            "An interval is about the mean.",
        ),
        Wrong(
            "the spread of the pairs instead of the interval",
            "You compare the mean with the standard deviation s of the differences. The mean of n "
            "differences varies less than one of them, and with few differences you need "
            "Student's t: compare the mean with t·s/√n.",
            mistakes.Said(sure=lambda d: abs(d.mean()) > d.std(ddof=1)),
            "Standard deviation and standard error are two different numbers.",
        ),
        Wrong(
            "capital letters",
            "The words are in lower case: 'holds', 'does not hold', 'undecided'.",
            mistakes.Said(("Holds", "Does not hold", "Undecided")),
            "Read which form the answer should have.",
        ),
    ),
    variants=(variants.verdicts_by_comprehension,),
)

PROBLEMS = (RMS_ERROR, OPEN_LOOP, KP_FOR_MARGIN, CHOOSE_GAINS, PAIRED, VERDICTS)
