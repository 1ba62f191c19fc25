# %% [markdown]
# # 08 · The report
#
# This lab grew out of a written report, and now you write one: a team, an arm that nobody else has, four pages. The mark does not depend on whether the arm obeys, but on whether a reader can believe you.
#
# | | |
# |---|---|
# | **You need** | your arm and its numbers (notebooks 03 and 05), your laws, the interval of notebook 07 |
# | **Given** | a rubric of six rows, two exemplars |
# | **You write** | a claim, a prediction, a figure, an interval, a failure, threats, who did what |
# | **Time** | about 4 hours for each member of a team of three; 20 points |
#
# Each of the six sections earns up to 3 points, one for each level of its row in the rubric. Committing to the levels of
# the two exemplars earns 1 point each.
#
# Before you begin, each of you marks the two exemplars below with the rubric, alone and in a copy of this notebook,
# in ten minutes. The rows of the rubric are in the six sections at the end of this notebook; read them first. Our marks
# appear once you have committed to yours. In the notebook that the team hands in, enter the levels of one of you.

# %% setup=true
import labkit as lk
from labkit.course import check, predict, use

lk.ready()

# %% setup=true
import matplotlib.pyplot as plt
import numpy as np

# %% [markdown]
# ## Two exemplars
#
# Two reports of one page about the same experiment on the public arm. The runs behind both are the same, and here
# they are: computed torque without integral action holds the hand at its ready pose; the hand starts 50 mm above
# it or 50 mm below, three times each.

# %%
demo = lk.my_arm("demo")
model, ready = demo.model, demo.model.robot.ready
J = model.tip_jacobian(ready)
up = np.linalg.pinv(J) @ [0, 0, 1, 0, 0, 0]


def computed_torque(state, target, kp=40.0):
    acceleration = kp * (target.position - state.q) - 2 * np.sqrt(kp) * state.dq
    return lk.JointTorque(model.mass_matrix(state.q) @ acceleration)


def height_after(start, seed):
    """Time in s and the hand's height above its target in mm, from a start that many m above it."""
    arm = lk.my_arm("demo", seed)
    arm.reset(ready + start * up)
    log = lk.run(arm, lk.Hold(ready, 2.0), computed_torque)
    return log.t, 1e3 * (np.array([model.pose(q)[2, 3] for q in log.q]) - model.pose(ready)[2, 3])


above, below = ([height_after(start, seed) for seed in range(3)] for start in (0.05, -0.05))

# %% [markdown]
# ### Exemplar one
#
# **Claim.** We wanted to see how good computed torque is. Computed torque uses the model of the robot, so it should
# be better than a controller without a model. We predict that the arm goes to its target and stays there with only
# a small error.
#
# **Method.** We used the law from notebook 04 with good gains and let the arm hold a position. The figure shows
# that it works well: after some time the curve is almost flat.

# %%
plt.figure(figsize=(5, 2.4), layout="constrained")
plt.plot(above[0][1])
lk.plotting.show("A curve that falls from 50 to 1 within 400 ticks. The axes have no names and no units.")

# %% [markdown]
# **Result.** The error at the end was 0.901280 ± 0.127 mm, where 0.127 mm is the standard deviation of the last
# hundred ticks. This is very precise and shows that computed torque is a good controller.
#
# **Problems.** At first we had a typing error in the name of a variable, and the gains were too high. We corrected
# both. Then everything went as expected.
#
# **Discussion.** Simulation is never the same as reality. There could be errors of measurement and of rounding, and
# a real robot has more friction than a simulated one. In future work one could try other gains, other paths and a
# real robot.
#
# **Who did what.** We worked together on everything.

# %% predict="exemplar_one"

# %% [markdown]
# Ours, row by row; look where you differ by more than one level, and read that row of the rubric again.

# %%
predict("exemplar_one", truth=([1, 2, 3, 4, 5, 6], [1, 1, 1, 0, 1, 1]))

# %% [markdown]
# ### Exemplar two
#
# **Claim and prediction.** Our arm carries 0.33 ± 0.02 kg (from both sides, notebook 05). Claim: under computed
# torque with kp = 40 1/s² the hand rests as far below its target as this load alone explains. The load is not in
# the model, so at rest M kp e = Jᵀ F with F = m g upwards. At the ready pose that is 14.1 ± 0.9 mm. Dry friction
# stops the hand too high when it comes from above and too low when it comes from below, so we predict the middle
# of the two.
#
# **Method.** Law and runs are in the cell above: ready pose, kp = 40 1/s², kd = 2 √kp, 200 Hz, 2 s, starts 50 mm
# above and below, seeds 0, 1, 2. If the claim holds, the middle of the two bundles ends in the grey band.

# %%
plt.figure(figsize=(7, 3), layout="constrained")
for runs, style, name in ((above, "-", "from above"), (below, "--", "from below")):
    for k, (t, z) in enumerate(runs):
        plt.plot(t, z, style, color="C0", linewidth=1, label=name if k == 0 else None)
middle = [(a[1] + b[1]) / 2 for a, b in zip(above, below)]
plt.plot(above[0][0], np.mean(middle, axis=0), "k", label="middle of both")
plt.axhspan(-15.0, -13.2, color="0.8", label="predicted")
plt.xlabel("time [s]")
plt.ylabel("hand above its target [mm]")
plt.legend(frameon=False, ncols=2)
rests = np.array([z[-1] for z in middle])
half = 4.303 * rests.std(ddof=1) / np.sqrt(3)
lk.plotting.show(
    f"Height of the hand over 2 s. From above it ends at {np.mean([z[-1] for _, z in above]):.1f} mm, from below at "
    f"{np.mean([z[-1] for _, z in below]):.1f} mm; the middle ends at {rests.mean():.1f} ± {half:.1f} mm, outside "
    "the predicted band from -15.0 to -13.2 mm."
)

# %% [markdown]
# **Result.** The middle rests at -10.5 ± 0.2 mm (95 %, three seeds, t with 2 degrees of freedom). The seeds draw
# the sensors' noise; the interval says nothing of other poses, other starts or the uncertainty of our load. The
# claim is refuted: the load alone would give 14.1 mm, and the two intervals do not meet.
#
# **A failure.** Our first run came from above and rested at 1.0 mm, as if there were no load at all. We suspected
# the number of the load. A run from below rested at -22.1 mm, so it is friction that holds the hand, up to 11.6 mm
# to either side. The next suspect was that 2 s are too short. After 3 s the middle had moved by 0.02 mm; so it was not.
#
# **Threats**, the largest first. (1) Friction is not alike in both directions in all joints: each joint stops by itself, so the
# middle need not be where the load alone would hold the hand; this may be all of the 3.6 mm that are missing. (2) The
# load: 0.25 kg would explain the result, four of our intervals away. (3) The pose: stretched out, J is larger, and
# the same load sags by more. (4) Noise: 0.2 mm.
#
# **Who did what.** A. identified the load. B. wrote the law and the figure. C. ran the second side after the first
# had misled us, and wrote this page.

# %% predict="exemplar_two"

# %% [markdown]
# And ours:

# %%
predict("exemplar_two", truth=([1, 2, 3, 4, 5, 6], [3, 3, 3, 3, 2, 3]))

# %% [markdown]
# ## Your report
#
# A report needs a figure and numbers from your own arm. Where section 2 or section 3 earns 0, no other
# section earns more than 1; where both earn 0, no section earns anything. Each section says how many words it may
# have; whatever goes beyond that number is not read. The text of a section goes into its cell, and your runs and your figure
# into code cells that you add below the cell of section 2.
#
# An interval needs runs that differ. The seed draws the noise of the measured joint speeds and of the torques that the
# arm feels, and which ticks come late; the joint angles have no noise. So a law that uses angles alone does almost the
# same for every seed. Then vary something else, such as the pose or the start, and say what.
#
# Look at each run before you count it. A wall stands a few centimetres ahead of the tip in the ready pose, so another
# pose can start in the wall: `lk.metrics.felt_wrench(log)` shows its force. And where a limit of speed or torque cut a
# command, `log.saturated` is true.

# %%
HANDLE = "demo"  # in a course: the name that your instructor gave you
mine = lk.my_arm(HANDLE)

# %% [markdown] task="claim_and_prediction" points=3
# ## 1. Claim and prediction
#
# Up to 150 words. One claim about *our* arm that a run could refute, and what you predicted before that run: a number, its unit, and how you came to it.
#
# | 0 | 1 | 2 | 3 |
# |---|---|---|---|
# | no claim that a run could refute | a claim, and a prediction without a number or a reason | a refutable claim and a number with its unit, from a model that is named | as before, and the number is for *this* arm, and the values that decide it are those that you identified yourselves |
#
# ### BEGIN SOLUTION
# Our arm carries 0.33 kg. With kp = 40 1/s² computed torque should sag by 14 mm, from e = M⁻¹ Jᵀ F / kp with our payload.
# ### END SOLUTION

# %% [markdown] task="method_and_figure" points=3
# ## 2. Method and figure
#
# Up to 150 words and one figure that you made. Anybody with this lab should be able to repeat it: plant, law, gains, target, rate, seeds.
#
# | 0 | 1 | 2 | 3 |
# |---|---|---|---|
# | no figure, or nobody could repeat it | a figure without units, or settings are missing | axes, units, settings; the prediction is drawn in the figure | as before, and even without the text a reader can tell the runs from the prediction, and whether runs and prediction agree |
#
# ### BEGIN SOLUTION
# lk.Hold at the ready pose for 2 s, kp = 40 1/s², kd = 2 √kp, rate 200 Hz, starts 50 mm above and 50 mm below, three seeds each; the figure shows the middle of both over time and our 14 mm as a dashed line.
# ### END SOLUTION

# %% [markdown] task="interval" points=3
# ## 3. Result with an interval
#
# Up to 100 words. The number, its unit and an interval. Say what was repeated, and what the interval covers.
#
# | 0 | 1 | 2 | 3 |
# |---|---|---|---|
# | a number alone | an interval of the wrong thing, such as of ticks of one run | a right interval over independent runs, with its unit | as before, and one thing is named that the interval does not cover |
#
# ### BEGIN SOLUTION
# The middle rests 10.5 ± 0.2 mm below the target (95 %, three seeds). The seeds draw noise; they do not draw another pose.
# ### END SOLUTION

# %% [markdown] task="failure" points=3
# ## 4. A failure
#
# Up to 120 words. One thing that went wrong or differed from your prediction, and what you did to find out
# why.
#
# | 0 | 1 | 2 | 3 |
# |---|---|---|---|
# | none, or a typing slip | a failure without a cause | a failure and a cause, with a run that shows it | as before, and a second run that rules out the next suspect |
#
# ### BEGIN SOLUTION
# Our first payload was 0.41 kg: one pose, one direction, so friction was in it. Coming from both sides gave 0.33 and 0.34 kg.
# ### END SOLUTION

# %% [markdown] task="threats" points=3
# ## 5. Threats
#
# Up to 120 words. What could make your verdict on the claim wrong, whether your runs agreed with it or not? The
# largest threat comes first.
#
# | 0 | 1 | 2 | 3 |
# |---|---|---|---|
# | none | general ones that fit any report | two that concern this arm and this run | as before, the largest first, and every threat has its size, measured or estimated |
#
# ### BEGIN SOLUTION
# Friction that differs from side to side: up to the 3.6 mm that are missing. The load: 0.02 kg, which is 0.9 mm. Noise: 0.2 mm.
# ### END SOLUTION

# %% [markdown] task="writing_and_shares" points=3
# ## 6. Writing, and who did what
#
# Up to 80 words on who did what, in a sentence for each member. Marked together with the whole: order, plain sentences, four pages without the code.
#
# | 0 | 1 | 2 | 3 |
# |---|---|---|---|
# | cannot be followed | can be followed with effort | clear and in order; a share for each member | as before, no section is too long, and none repeats itself |
#
# ### BEGIN SOLUTION
# A. identified the payload, B. wrote the law and the figure, C. found the failure and wrote sections 3 to 5.
# ### END SOLUTION

# %% [markdown]
# ## Hand in
#
# Run everything once more from the top (*Kernel, Restart Kernel and Run All Cells*) and save the file. Then
# run only the last cell once more: it prints a receipt for the saved file; keep it. `!labkit submit-check 08_report.ipynb`
# in a new cell runs a copy of that file and says what is missing. Each member of the team hands in the same file, without renaming it, in the way your course asks.

# %% setup=true
lk.hand_in("08_report")
