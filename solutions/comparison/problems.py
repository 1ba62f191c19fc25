"""The questions of notebook 07."""

from __future__ import annotations

import numpy as np

from labkit.course import Close, Response
from labkit.course.authoring.problem import Problem, Trial, Wrong, call

from . import answers, hidden, mistakes, variants

_SEEDS = [3.0, 1.1, 4.9, 2.05, 3.9]
_TEN_PAIRS = [
    [4.0, 0.5, 6.0, 5.0, 5.5, 2.0, 7.5, 4.5, 4.0, 2.0],
    [3.0, 1.0, 4.0, 2.0, 5.0, 3.0, 6.0, 2.0, 4.0, 1.0],
]
_PAIRS = (call([4.0, 2.0, 6.0, 3.0, 5.0], _SEEDS), call(*_TEN_PAIRS[::-1]))
_NEAR_THE_EDGE = [3.1, 2.7, 5.2, 3.45, 4.4], [3.6, 2.6, 5.7, 3.45, 4.6]
"""Rows that differ from `_SEEDS` by 2.6 and by 5.3 standard errors; the threshold is 2.78."""


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
            "no lag",
            "The speed follows its command with a lag. Multiply by 1 / (lag s + 1).",
            mistakes.LoopWithout(lag=0.0),
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
            "a delay of first order",
            "control.pade(delay, 1) is accurate for slow signals only: at 25 rad/s and 30 ms its "
            "phase is wrong by 2 degrees. Use order 4.",
            mistakes.LoopWithout(order=1),
            "Know the range in which an approximation is valid.",
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
            "a minus in the loop",
            "The minus of the feedback is not a part of the open loop. It is needed only where "
            "the loop is closed.",
            mistakes.Loop(lambda kp, lag: ([-kp], [lag, 1.0, 0.0])),
            "The open loop is everything from the error to the angle.",
        ),
    ),
    variants=(variants.loop_from_s,),
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
            "the lowest error of all seeds, and no step back",
            "The lowest point of the curve is near the edge and leaves no margin: with 1.3 times "
            "this Kp the error is too large where you could not try it. Take a third of the "
            "largest Kp that was safe.",
            mistakes.Lowest(),
            "The best gain on one path is the most fragile one.",
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
            "2.776, however many pairs there are",
            "2.776 is Student's t for five pairs. Use n - 1 degrees of freedom.",
            mistakes.Paired(half=lambda d: 2.776 * d.std(ddof=1) / np.sqrt(len(d))),
            "With few pairs use Student's t.",
        ),
        Wrong(
            "the median",
            "This is the median. The middle of the interval is the mean of the differences.",
            mistakes.Paired(mean=np.median),
            "Student's t is about the mean.",
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
            "nothing is undecided: it holds or it does not",
            "Where the interval contains zero, the seeds settle nothing: the verdict is "
            "'undecided', not 'does not hold'.",
            mistakes.Said(("holds", "does not hold", "does not hold")),
            "No evidence for a claim is not evidence against it.",
        ),
        Wrong(
            "it holds whenever it is decided",
            "You return 'holds' for every claim that is settled. The sign of the mean decides: "
            "above zero 'holds', below zero 'does not hold'.",
            mistakes.Said(("holds", "holds", "undecided")),
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
            "the spread of the pairs instead of the interval",
            "You compare the mean with the standard deviation s of the differences. The mean of n "
            "differences varies less than one of them, and with few differences you need "
            "Student's t: compare the mean with t·s/√n.",
            mistakes.Said(sure=lambda d: abs(d.mean()) > d.std(ddof=1)),
            "Standard deviation and standard error are two different numbers.",
        ),
    ),
    variants=(variants.verdicts_by_comprehension,),
)

PROBLEMS = (
    OPEN_LOOP,
    CHOOSE_GAINS,
    PAIRED,
    VERDICTS,
)
