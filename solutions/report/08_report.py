# %% [markdown]
# # 08 · The report
#
# The lab that this one grew out of was a written report. Here it is again: a team, an arm that nobody else
# has, four pages. The mark does not depend on whether the arm obeys, but on whether a reader can believe you.
#
# | | |
# |---|---|
# | **You need** | your arm and its numbers (notebooks 03 and 05), your laws, the interval of notebook 07 |
# | **Given** | a rubric of six rows, two exemplars |
# | **You write** | a claim, a prediction, a figure, an interval, a failure, threats, who did what |
# | **Time** | about 4 hours for each member of a team of three · 18 points |
#
# Before you begin, each of you marks the two exemplars below with the rubric, alone, in ten minutes. Then
# compare. After the deadline each of you reads two other teams' reports, without names, and marks them with
# the same rubric.

# %% setup=true
import labkit as lk
from labkit.course import check, hint, predict, use

lk.ready()

# %% setup=true
import matplotlib.pyplot as plt
import numpy as np

# %% [markdown]
# ## Two exemplars
#
# **One.** *We compared computed torque with springs. Computed torque is better because it uses the model. Our
# arm followed the circle well, as can be seen in the figure. The error was 4.127 mm. There were some problems
# with the gains at first but we solved them. In future work one could use a real robot. We all worked together
# on everything.*
#
# **Two.** *Our arm (handle kestrel) carries 0.41 ± 0.05 kg. Claim: on the 16 cm circle, springs of 1.9 Hz stay
# within 25 mm RMS with that load. Predicted: a constant sag of Jᵀ(0, 0, -mg) over the springs, 19 mm, plus the
# 9 mm that they had empty: 21 mm, as the two are nearly at right angles. Measured over five seeds: 22.6 ± 0.4 mm
# (95 %, t with 4 degrees of freedom). The claim holds for this pose and this load. Failure: the first run gave
# 31 mm. The sag was right and the circle wrong: s1 lagged. Half the speed gave 22 mm, so it was the speed, not
# the load. Threats: the interval speaks of noise alone; another pose changes the sag by up to 6 mm (estimated
# from M and J); the armature is assumed, which moves the springs by 3 %. A. identified the load, B. ran the
# circle, C. found the failure and wrote this.*
#
# Exemplar one earns 1, 1, 0, 0, 0, 1 in the rows below, and exemplar two earns 3, 2, 3, 3, 3, 3. Where do you
# differ, and why?

# %%
HANDLE = "demo"  # in a course: your login
mine = lk.my_arm(HANDLE)

# %% [markdown] task="claim_and_prediction" points=3
# ## 1. Claim and prediction
#
# Up to 150 words. One claim about *our* arm that a run could refute, and what you predicted before that run: a number, its unit, and how you came to it.
#
# | 0 | 1 | 2 | 3 |
# |---|---|---|---|
# | no claim that a run could refute | a claim, and a prediction without a number or a reason | a refutable claim and a number with its unit, from a model that is named | as before, and the number is for *this* arm, from values that you identified yourselves |
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
# | no figure, or nobody could repeat it | a figure without units, or settings are missing | axes, units, settings; the prediction is drawn in the figure | as before, and the figure shows at one glance whether the claim holds |
#
# ### BEGIN SOLUTION
# Five seeds, lk.Hold at the ready pose for 3 s, rate 200 Hz; the figure shows the sag over time and our 14 mm as a dashed line.
# ### END SOLUTION

# %% [markdown] task="interval" points=3
# ## 3. Result with an interval
#
# Up to 100 words. The number, its unit and an interval. Say what was repeated, and what the interval covers.
#
# | 0 | 1 | 2 | 3 |
# |---|---|---|---|
# | a number alone | an interval of the wrong thing, such as of ticks of one run | a right interval over independent runs, with its unit | as before, and it says what the interval does not cover |
#
# ### BEGIN SOLUTION
# 13.6 ± 0.4 mm (95 %, five seeds). The seeds draw noise; they do not draw another pose.
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
# Up to 120 words. What could make the claim false although your runs agree with it? Rank the threats by how
# much they would matter.
#
# | 0 | 1 | 2 | 3 |
# |---|---|---|---|
# | none | general ones that fit any report | two that concern this arm and this run | as before, with the size of each, measured or estimated |
#
# ### BEGIN SOLUTION
# The armature is assumed (0.05 to 0.1 kg m²): at most 0.5 mm. The pose: stretched, the same load would sag by 25 mm.
# ### END SOLUTION

# %% [markdown] task="writing_and_shares" points=3
# ## 6. Writing, and who did what
#
# Up to 80 words on who did what, in a sentence for each member. Marked together with the whole: order, plain sentences, four pages.
#
# | 0 | 1 | 2 | 3 |
# |---|---|---|---|
# | cannot be followed | can be followed with an effort | clear and in order; shares are stated | as before, and not a sentence too many |
#
# ### BEGIN SOLUTION
# A. identified the payload, B. wrote the law and the figure, C. found the failure and wrote sections 3 to 5.
# ### END SOLUTION

# %% [markdown]
# ## Hand in
#
# Run everything once more from the top (*Kernel, Restart Kernel and Run All Cells*) and save the file. Then
# run the last cell. It says what is missing and prints a receipt; keep it. Hand in the file without renaming
# it. One member hands in for the team.

# %% setup=true
lk.hand_in("08_report")
