"""The questions of notebook 07."""

from __future__ import annotations

import numpy as np

from labkit.course import Close, Response
from labkit.course.authoring.problem import Problem, Trial, Wrong, call

from . import answers, hidden, mistakes, variants

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
            "This is the loop of a speed, but the controller looks at an angle.",
            mistakes.no_integrator,
            "Count the integrators between command and measurement.",
            cure="The angle is the integral of the speed: multiply by 1/s.",
        ),
        Wrong(
            "the closed loop",
            "Margins are read from the open loop: leave the feedback out.",
            mistakes.closed_loop,
        ),
        Wrong(
            "the delay as one more lag",
            "A lag takes at most 90 degrees of phase and lowers the gain. A delay takes more and "
            "more phase as the frequency grows, and does not change the gain.",
            mistakes.delay_as_a_lag,
            cure="Use control.pade for the delay.",
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
            "In your loop the speed follows its command at once.",
            mistakes.LoopWithout(lag=0.0),
            "Name every part of the loop before you multiply.",
            cure="Multiply by 1 / (lag s + 1).",
        ),
        Wrong(
            "the delay inverted",
            "You divide by the delay, as if the controller knew the angle before it is measured.",
            mistakes.LoopWithout(delay=-1.0),
        ),
        Wrong(
            "a delay of first order",
            "Your approximation of the delay is accurate for slow signals only: at 25 rad/s and 30 ms its "
            "phase is wrong by 2 degrees.",
            mistakes.LoopWithout(order=1),
            "Know the range in which an approximation is valid.",
            cure="Use control.pade(delay, 4).",
        ),
        Wrong(
            "the lag in the numerator",
            "In the numerator the lag adds phase instead of taking it away.",
            mistakes.Loop(lambda kp, lag: ([kp * lag, kp], [1.0, 0.0])),
        ),
        Wrong(
            "the lag's coefficients exchanged",
            "control.tf expects the highest power first: [lag, 1] is lag·s + 1. Yours is s + lag.",
            mistakes.Loop(lambda kp, lag: ([kp], [1.0, lag, 0.0])),
        ),
        Wrong(
            "two integrators",
            "From speed to angle there is one integration. Yours has two.",
            mistakes.Loop(lambda kp, lag: ([kp], [lag, 1.0, 0.0, 0.0])),
        ),
        Wrong(
            "a minus in the loop",
            "The minus of the feedback is not a part of the open loop. It is needed only where "
            "the loop is closed.",
            mistakes.Loop(lambda kp, lag: ([-kp], [lag, 1.0, 0.0])),
        ),
    ),
    variants=(variants.loop_from_s,),
)


RECIPE = Problem(
    name="recipe",
    points=4,
    outcomes=("evidence",),
    asks="Find `(Kp, Kd)` of the joint velocity PD with at most 20 runs: `runner(Kp, Kd, seed)` gives the RMS "
    f"error of a run along the line in mm, seeds 0 to 4. The worst seed's may be {hidden.LINE_LIMIT:g} mm, also with "
    f"{hidden.FAR:g} times your Kp. The instructor tries {hidden.RESERVE:g} times your Kp on other paths "
    f"({hidden.UNSEEN_LIMIT:g} mm). It is called for two arms, one of them a quarter as fast: typed numbers fail.",
    answer=answers.recipe,
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
            "The lowest point of the curve is near the edge and leaves no margin: with a larger Kp "
            "the error is too large where you could not try it.",
            mistakes.Lowest(),
            "The best gain on one path is the most fragile one.",
            "Step back clearly from the largest Kp that was safe.",
        ),
    ),
    variants=(variants.by_doubling, variants.by_bisection),
)

_TABLES = tuple(
    call(*hidden.table(np.random.default_rng(k), n, t))
    for k, (n, t) in enumerate(((4, 5.0), (4, -5.0), (4, 1.5), (3, 3.4), (5, 2.4)))
)

VERDICT = Problem(
    name="verdict",
    points=4,
    outcomes=("evidence",),
    asks="Is the error of controller a larger than that of b *on tasks in general*? `a` and `b` have shape (tasks, "
    "seeds). Take each task by its mean. Give `(mean, half_width, verdict)`: of the difference a - b, half of its "
    '95 % interval by Student\'s t, and "holds", "does not hold" or, if the interval contains 0, "undecided".',
    answer=answers.verdict,
    judge=Close(rtol=1e-3, atol=1e-9, parts=("mean", "half_width", "verdict")),
    trials=(
        Trial(
            "a clear case: its mean", _TABLES[:1], hidden.raises, "other clear cases", 0.0, "mean"
        ),
        Trial(
            "half the width of the interval",
            _TABLES,
            hidden.tables,
            "three to six tasks",
            2.0,
            "half_width",
        ),
        Trial("the verdict", _TABLES, hidden.tables, "three to six tasks", 2.0, "verdict"),
    ),
    hints=(
        "What varies if you try another task? And what if you try another seed? The claim is about tasks.",
        "First the mean over the seeds of each task, then the differences, then their mean and its standard "
        "error.",
        "The standard deviation of the differences has n - 1 in it, the standard error the root of n as well, "
        "and the quantile of Student's t is that of 0.975 with n - 1 degrees of freedom; n counts tasks.",
    ),
    wrong=(
        Wrong(
            "every seed a unit",
            "You counted every seed as a unit. Five looks at one task tell how noisy that task is, not how tasks "
            "differ.",
            mistakes.Judged(units=np.ravel),
            "Ask of which population the numbers are a sample.",
            "Average the seeds of each task first; n is the number of tasks.",
        ),
        Wrong(
            "seeds in place of tasks",
            "You averaged over the tasks, so your units are the seeds.",
            mistakes.Judged(units=lambda errors: np.mean(errors, axis=0)),
            "Say what an axis is before you average over it.",
            "The tasks are the rows: average over the second axis.",
        ),
        Wrong(
            "the rows taken as unpaired",
            "Taken as unpaired, the rows spread as much as the tasks do, and this hides the difference.",
            mistakes.Judged(mistakes.unpaired),
            cure="Subtract pair by pair first.",
        ),
        Wrong(
            "the spread of one difference",
            "This says where a single difference may be. The mean of n differences is known better.",
            mistakes.Judged(mistakes.deviation_of_one),
            "Standard deviation and standard error are two different numbers.",
            "Divide by √n.",
        ),
        Wrong(
            "1.96 for a handful of tasks",
            "1.96 is right for very many pairs. A few pairs need a wider interval.",
            mistakes.Judged(mistakes.normal_quantile),
            "Four tasks are not many.",
            "Use Student's t, scipy.stats.t.",
        ),
        Wrong(
            "n instead of n - 1 in the deviation",
            "Your deviation divides by n, as numpy's std does, but the mean comes from the same numbers.",
            mistakes.Judged(mistakes.Interval(given=0)),
            "n or n - 1: where does the mean come from?",
            "ddof=1.",
        ),
        Wrong(
            "95 % on one side only",
            "Your quantile leaves 5 % above and another 5 % below.",
            mistakes.Judged(mistakes.Interval(quantile=0.95)),
            cure="The two tails have 2.5 % each.",
        ),
        Wrong(
            "n degrees of freedom",
            "The mean has used up one degree of freedom.",
            mistakes.Judged(mistakes.Interval(freedom=0)),
        ),
        Wrong(
            "b - a instead of a - b",
            "The sign is wrong: you subtract a from b.",
            mistakes.Judged(mistakes.Interval(sign=-1.0)),
            "Say what a positive difference means before you compute it.",
        ),
        Wrong(
            "the whole width",
            "This is the whole width of the interval; half of it is asked for.",
            mistakes.Judged(mistakes.Interval(share=2.0)),
        ),
        Wrong(
            "always decided",
            "A mean nearly always has a sign. If the interval contains 0, another task might reverse it.",
            mistakes.Judged(says=lambda mean, half: "holds" if mean > 0 else "does not hold"),
            "Undecided is a result.",
        ),
        Wrong(
            "nothing is undecided: it holds or it does not",
            'Where the interval contains 0 you say "does not hold", but nothing is settled there.',
            mistakes.Judged(says=lambda mean, half: "holds" if mean > half else "does not hold"),
            "No evidence for a claim is not evidence against it.",
        ),
    ),
    variants=(variants.verdict_by_scipy,),
)

PROBLEMS = (RECIPE, VERDICT, OPEN_LOOP)
