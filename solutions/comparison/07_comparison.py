# %% [markdown]
# # 07 · Which controller is better?
#
# The report of 2019 compared seven methods of moving the arm. Its authors looked at the plots and wrote that
# their own controllers "obtained superior performance". On another page they wrote that the built-in method
# "performs slightly better in most cases". Neither sentence comes with a number. In this notebook you learn
# what you need before you can write such a sentence, or the sentence that is more often true: *we cannot
# tell*.
#
# | | |
# |---|---|
# | **You need** | numpy; what a standard deviation is; complex numbers |
# | **Given** | recorded runs of every controller, the parts of the loop, the formula of the interval |
# | **You write** | the transfer function of a loop, gains with a margin, paired differences over seeds, verdicts |
# | **Time** | core about 2.5 hours, all about 3 hours; 17 points |
#
# Questions marked *core* are for everybody. Those marked *extension* take the rest of the time: they earn points
# too, but no later question depends on them.
#
# Every cell below runs from the start, solved or not. If your part is missing, a stand-in replaces it and
# says so. The functions, your prediction and the text at the end are marked; play with everything else as
# you like.

# %% setup=true
import labkit as lk
from labkit.course import check, predict, use

lk.ready()

# %% setup=true
import control
import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

from labkit import recordings, stability

# %% [markdown]
# ## One number for a run
#
# Here is a recording of Baxter's built-in method on the line: a planner made a path, a time parameterisation
# gave it a schedule, and the arm's own trajectory server followed it.

# %%
log = recordings.load("baseline_line")
model = lk.Model("left")
lk.plotting.tracking(log, model)
lk.plotting.show(lk.plotting.describe(log, model))

# %% [markdown]
# Here is the same run as an arm. One ghost follows perfectly; the other is the server's second mode, which
# commands velocities:

# %%
other_mode = {"velocity mode": recordings.load("baseline_line_velocity")}
lk.replay.show(
    lk.replay.motion_of(log, "The built-in method on the line", label="position mode", ghosts=other_mode)
)

# %% [markdown]
# At each instant the error of the tip is a vector, target minus actual. The usual number for a whole run is
# the root of the mean of its squared length. Two mistakes are common. A mean that also runs over the three
# components is too small by a factor of $\sqrt 3$, and nobody notices, because all controllers profit
# equally. And a program that asks for *the* pose, without saying at which instant, compares every row with
# the last one; that is what the plots of the report show. Is the first second counted below, in which the arm makes
# up for the offset of its start?

# %% [markdown]
# The built-in method was recorded on other paths too, and on the line in a second mode. Its targets are joint
# angles; the tip's target positions follow from them.

# %%
def rms_error(log):
    """Root of the mean of the squared length of the tip's position error, in [m]."""
    places = [[model.pose(q)[:3, 3] for q in angles] for angles in (log.target.position, log.q)]
    return np.sqrt(np.mean(np.sum(np.subtract(*places) ** 2, axis=1)))


for name in recordings.names():
    error = rms_error(recordings.load(name))
    print(f"{name.removeprefix('baseline_'):13} {1e3 * error:5.1f} mm")

# %% [markdown]
# ## The loop on paper
#
# Why is there a best gain at all? Take one joint in velocity mode. Its speed follows the command with a
# first-order lag; the angle is the integral of the speed; the controller sees an angle that is some
# milliseconds old. In series these give
#
# $$ L(s) = K_p \cdot \frac{1}{\tau s + 1} \cdot \frac1s \cdot e^{-s d} . $$
#
# python-control multiplies such things for you. A delay is not a ratio of polynomials, but
# `control.pade(delay, 4)` gives one that is close enough at the frequencies that matter here.

# %% question="open_loop"
def open_loop(kp, lag, delay):
    """The open loop of one velocity-commanded joint under a proportional controller.

    Args:
        kp: Gain, in [1/s].
        lag: Time constant of the speed, in [s]; may be 0.
        delay: Age of what the controller sees, in [s]; may be 0.

    Returns:
        A control.TransferFunction.
    """
    ### BEGIN SOLUTION
    from solutions.comparison.answers import open_loop as answer

    return answer(kp, lag, delay)
    ### END SOLUTION


# %%
def integrator_alone(kp, lag, delay):
    """The stand-in: a joint that obeys at once, and is seen at once."""
    return control.tf([kp], [1.0, 0.0])


my_open_loop = use("open_loop", open_loop, integrator_alone)

joint = stability.velocity_joint_of(lk.BAXTER)
lag, delay = lk.BAXTER.velocity_lag, joint.delay
print(f"Baxter's joint: lag {1e3 * lag:.0f} ms, delay {1e3 * delay:.1f} ms")

omega = np.logspace(0, 2.3, 300)
figure, (above, below) = plt.subplots(2, 1, figsize=(8, 5), sharex=True, layout="constrained")
for kp, style in ((8.0, "-"), (25.0, "--"), (70.0, ":")):
    L = np.array([my_open_loop(kp, lag, delay)(1j * w) for w in omega])
    above.loglog(omega, np.abs(L), style, label=f"Kp = {kp:g} 1/s")
    below.semilogx(omega, np.degrees(np.unwrap(np.angle(L))), style)
above.axhline(1.0, color="0.6", linewidth=0.8)
below.axhline(-180.0, color="0.6", linewidth=0.8)
above.set_ylabel("gain")
above.legend(frameon=False)
below.set_ylabel("phase [deg]")
below.set_xlabel("frequency [rad/s]")
lk.plotting.show(
    "Gain and phase of the loop on paper, with the lines where the gain is 1 and where the phase is "
    "-180 degrees, for Kp = 8, 25 and 70 1/s."
)

# %% [markdown]
# The gain moves the upper curve up and down and leaves the lower one alone. At the frequency where the gain
# is 1, the distance of the phase from -180° is the *phase margin*. With a margin of zero the loop swings for
# ever, and with a negative margin it runs away. So a margin determines the gain: find the frequency at which
# the phase is right, then make the gain 1 there. The next cell does so, with the delay taken exactly.

# %%
def kp_for_margin(margin_deg):
    """The gain that leaves this phase margin, in [1/s]."""

    def excess(w):
        return np.radians(90.0 - margin_deg) - np.arctan(w * lag) - w * delay

    w = brentq(excess, 0.0, np.radians(90.0) / delay)
    return w * np.hypot(1.0, w * lag)


for margin in (30, 45, 60, 75):
    print(f"{margin} degrees of margin: Kp = {kp_for_margin(margin):.1f} 1/s")

# %% [markdown]
# ## The whole map
#
# A calculation on paper is not the arm. This map was measured: the joint velocity PD along the line on the
# simulated Baxter, one run for each pair of gains and seed. The error falls with the gain, slower and slower,
# and then there is a cliff.

# %%
measured = recordings.error_map("joint_velocity_pd_baxter")
errors = measured.array()
figure, ax = plt.subplots(figsize=(8, 3.6), layout="constrained")
for j, style in ((0, "-"), (4, "--"), (6, ":")):
    ax.loglog(measured.Kp, errors[:, j], style, marker="o", ms=3, label=f"Kd = {measured.Kd[j]:g}")
for margin in (30, 60):
    kp = kp_for_margin(margin)
    ax.axvline(kp, color="0.6", linewidth=0.8)
    ax.annotate(f"{margin}° on paper", (kp, 38.0), rotation=90, ha="right", va="top", fontsize="small")
ax.set_xticks([1, 10, 100], ["1", "10", "100"])
ax.set_yticks([2, 5, 10, 20, 40], ["2", "5", "10", "20", "40"])
ax.minorticks_off()
ax.set_xlabel("Kp [1/s]")
ax.set_ylabel("RMS error [mm]")
ax.legend(frameon=False)
lk.plotting.show(measured.describe())

# %% [markdown]
# ## Gains that survive
#
# Choose gains yourself, with at most twenty runs along the line. Each call `runner(Kp, Kd, seed)` is one run
# on the arm, with a start and a noise drawn from the seed, and returns its RMS error in millimetres. `Kp` may
# be from 2 to 100, `Kd` from 0 to 1, and the seeds are 0 to 4. (The runs were recorded; between the recorded
# gains the error is interpolated.)
#
# Your gains are then used where you could not try them: on another path, at twice the speed, with a kilogram
# in the hand, with a state that is a few milliseconds older. Then 1.3 times your `Kp` is tried as well, so leave
# at least this much margin; the check tries 1.8 times your `Kp` on the line. Your function is called for this arm
# and for one that takes about four times as long for everything, its path included. Each time it may make twenty
# runs. (On the slower arm, no runs were recorded with a `Kp` above about 25: there `runner` returns infinity. Above
# 100 it stops with an error on either arm.) No pair of gains serves both arms, so let the function look for them.

# %% question="choose_gains"
def choose_gains(runner):
    """Gains of the joint velocity PD that also hold where they were not tuned.

    Args:
        runner: runner(Kp, Kd, seed) gives the RMS error along the line in [mm]; 20 calls.

    Returns:
        (Kp, Kd).
    """
    ### BEGIN SOLUTION
    from solutions.comparison.answers import choose_gains as answer

    return answer(runner)
    ### END SOLUTION


# %% [markdown]
# Try your own strategy here; the runner records your calls.

# %%
line_trials = recordings.read_trials(recordings.LINE)
runner = recordings.Runner(line_trials)
for kp in (8.0, 30.0, 60.0):
    row = [runner(kp, 0.0, seed) for seed in range(3)]
    print(f"Kp = {kp:4g}: " + ", ".join(f"{x:.2f} mm" for x in row) + f"; {runner.left} tries left")

for seed in (1, 0):
    grown = line_trials.error(seed, 90.0, 0.0) / line_trials.error(seed, 34.0, 0.0)
    print(f"Kp = 90 in place of 34, seed {seed}: the error is {grown:.1f} times as large")

# %% [markdown]
# Seed 1 alone would have told you that 90 is a fine gain.
#
# Here is your strategy: the gains that it chooses, their error on the line, and what the loop on paper says
# about them. (If your function is not ready, a guess replaces it.)

# %%
def a_guess(runner):
    return 6.0, 0.0


my_choose_gains = use("choose_gains", choose_gains, a_guess)
runner = recordings.Runner(line_trials)
Kp, Kd = my_choose_gains(runner)
phase = stability.margins(stability.VelocityJoint(lag, delay), Kp).phase
print(f"Kp = {Kp:g} 1/s, Kd = {Kd:g}, chosen with {runner.budget - runner.left} tries")
print(f"on the line, worst of five seeds: {line_trials.worst(Kp, Kd):.2f} mm")
print(f"phase margin of Kp alone, on paper: {phase:.0f} degrees")

# %% [markdown]
# ## Paired differences
#
# Two controllers, five seeds. A seed that draws a bad start is bad for both. If you compare the rows as if
# they were independent, the spread of the starts hides everything; if you subtract first, it drops out. The
# differences have a mean, and the mean of a few numbers is itself uncertain: by Student's $t$, with 95 %
# confidence, the true mean is within
#
# $$ \bar d \pm t_{0.975,\,n-1}\,\frac{s_d}{\sqrt n}, \qquad
#    s_d^2 = \frac{1}{n-1}\sum_i (d_i - \bar d)^2 . $$

# %% question="paired_difference"
def paired_difference(errors_a, errors_b):
    """Mean difference over pairs, and how sure it is.

    Args:
        errors_a: One number for each seed.
        errors_b: Those of the other method, on the same seeds.

    Returns:
        (mean, half_width): of a - b, and half of its 95 % interval; Student's t to three decimals
        is enough.
    """
    ### BEGIN SOLUTION
    from solutions.comparison.answers import paired_difference as answer

    return answer(errors_a, errors_b)
    ### END SOLUTION


# %% [markdown]
# ## Verdicts
#
# The campaign of this course let every controller follow every task on the simulated Baxter, five seeds each.
# Here are its rows. The errors are counted after the first second, when the offset of the start should be
# gone.

# %%
rows = [row for row in recordings.campaign() if row["plant"] == "baxter"]
controllers = list(dict.fromkeys(row["controller"] for row in rows))
table = {name: [] for name in controllers}
for row in rows:
    if row["task"] == "circle":
        table[row["controller"]].append(row["late_rms_mm"])
figure, ax = plt.subplots(figsize=(8, 3), layout="constrained")
for k, controller in enumerate(controllers):
    ax.plot(table[controller], [k] * len(table[controller]), "o", mfc="none")
ax.set_yticks(range(len(controllers)), controllers)
ax.set_xscale("log")
ax.set_xticks([3, 5, 10, 20], ["3", "5", "10", "20"])
ax.minorticks_off()
ax.set_xlabel("RMS error on the circle, one ring for each seed [mm]")
means = ", ".join(f"{controller} {np.mean(errors):.1f} mm" for controller, errors in table.items())
lk.plotting.show(f"The errors of each method on the circle; on average {means}.")

# %% [markdown]
# From rows like these write a verdict on each claim. The claim is always that the *first* error is the larger
# one. "Undecided" is an answer, and if the interval contains 0 it is the only honest one.

# %% question="verdicts"
def verdicts(table):
    """A verdict on each claim.

    Args:
        table: For each claim two rows of errors over the same units: {claim: (errors_a, errors_b)}.

    Returns:
        {claim: "holds", "does not hold" or "undecided"}, whether a is larger than b.
    """
    ### BEGIN SOLUTION
    from solutions.comparison.answers import verdicts as answer

    return answer(table)
    ### END SOLUTION


# %%
def given_verdicts(table):
    return {claim: "(your verdict)" for claim in table}


def medians_apart(errors_a, errors_b):
    return np.median(errors_a) - np.median(errors_b), (np.ptp(errors_a) + np.ptp(errors_b)) / 2


my_verdicts = use("verdicts", verdicts, given_verdicts)
my_paired_difference = use("paired_difference", paired_difference, medians_apart)


def late(controller):
    """The errors of one method on the tasks and seeds, in one order."""
    mine = [row for row in rows if row["controller"] == controller]
    return [row["late_rms_mm"] for row in sorted(mine, key=lambda row: (row["task"], row["seed"]))]


claims = {
    "workspace velocity is worse than joint velocity": ("workspace velocity", "joint velocity"),
    "workspace impedance is worse than joint impedance": ("workspace impedance", "joint impedance"),
    "joint impedance is worse than joint torque": ("joint impedance", "joint torque"),
    "the built-in method is worse than joint velocity": ("baseline", "joint velocity"),
    "the built-in method is worse than joint torque": ("baseline", "joint torque"),
}


def tasks_of(a, b):
    """Where both have the same target: on the tag the built-in method follows an old line of its own."""
    paths = ["circle", "line", "square"]
    return paths if "baseline" in (a, b) else [*paths, "tag"]


def on(controller, task):
    """The errors of one method on one task, one for each seed."""
    return [row["late_rms_mm"] for row in rows if row["controller"] == controller and row["task"] == task]


for claim, (a, b) in claims.items():
    tasks = tasks_of(a, b)
    alone = my_verdicts({task: (on(a, task), on(b, task)) for task in tasks})
    means = [[np.mean(on(controller, task)) for task in tasks] for controller in (a, b)]
    (over_tasks,) = my_verdicts({claim: means}).values()
    mean, half = my_paired_difference(*means)
    print(f"{claim}\n    task by task: " + ", ".join(f"{k} {v}" for k, v in alone.items()))
    print(f"    over {len(tasks)} tasks: {over_tasks} ({mean:+.2f} ± {half:.2f} mm)")

# %% [markdown]
# The output has two lines for each claim, because there are two questions. *On this path, is it worse?* Five seeds are five
# looks at one path, and they can settle that. *Is it worse at tracking?* Then the tasks are the units, each
# represented by its mean, and there are three or four of them, no matter how many seeds each had. (A claim about
# the built-in method has three: with the tag it follows an old line of its own, so there it cannot be compared.)
#
# And five claims are five chances to be wrong: at 95 % each, up to about one in four such lists holds a verdict
# that is due to chance alone. Use $1 - 0.05/5$ instead of 0.95 for each interval, and 95 % holds for the five
# together:

# %%
from scipy.stats import t as student

for n in (3, 4, 5):
    wider = student.ppf(1 - 0.025 / 5, n - 1) / student.ppf(0.975, n - 1)
    print(f"{n} units: an interval {wider:.2f} times as wide")

# %% [markdown]
# If your own verdicts are in place, you see that each of the report's two sentences is true of some controller.
# Whether a controller is better than the built-in method depends on the controller, and by how much depends on the
# path. Over the tasks some claims are undecided, and they would be undecided with five hundred seeds. Two more
# paths would tell more than any number of seeds. So name the two controllers, the task and the number,
# say what your units are, and say how sure you are.

# %% predict="twenty_pairs"

# %%
def half_width(differences):
    """Of the 95 % interval, by Student's t."""
    t = {4: 3.182, 20: 2.093}[len(differences)]
    return t * np.std(differences, ddof=1) / len(differences) ** 0.5


apart = np.subtract(late("workspace impedance"), late("joint impedance"))
pooled, by_task = half_width(apart), half_width(apart.reshape(4, 5).mean(axis=1))
if twenty_pairs is not None:
    print(f"± {pooled:.2f} mm from 20 differences, ± {by_task:.2f} mm from the means of 4 tasks")
predict("twenty_pairs", truth="b" if pooled < 0.7 * by_task else "c" if pooled > 1.4 * by_task else "a")

# %% [markdown] why="why_twenty_pairs"
# Which interval was narrower, and why? Say what five seeds of one task have in common, what a second task
# would tell you that a sixth seed would not, and which interval belongs to "controllers in general".
#
# ### BEGIN SOLUTION
# The interval from 20 differences was much narrower: 1.1 mm to either side, where the means of the tasks give
# 3.3 mm. The five seeds of a task share path, speed and pose: they tell how noisy this task is, not how tasks
# differ. A sixth seed makes the mean of this task surer; a second task shows how much another task changes it. A
# claim about controllers in general rests on four independent numbers, and has their wide interval.
# ### END SOLUTION

# %% [markdown]
# ## Hand in
#
# Run everything once more from the top (*Kernel, Restart Kernel and Run All Cells*) and save the file. Then
# run only the last cell once more: it prints a receipt for the saved file; keep it. `!labkit submit-check 07_comparison.ipynb`
# in a new cell runs a copy of that file and says what is missing. Hand in the file without renaming it, in the way your course asks. The grader runs your
# functions on further cases; the text above each stub says what kind of cases.

# %% setup=true
lk.hand_in("07_comparison")
