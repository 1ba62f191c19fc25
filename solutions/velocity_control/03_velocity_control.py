# %% [markdown]
# # 03 · Velocity control
#
# The arm must get where its target is, although it starts elsewhere, answers late and measures with noise. The
# controllers here command the *speeds* of the joints.
#
# | | |
# |---|---|
# | **You need** | numpy; the error is target minus actual, that of an orientation is the turn R_wd R_wtᵀ; twists are (v, w) (notebook 00) |
# | **Given** | the arm as the textbook has it (`lk.IDEAL`) and with friction, lag and noise (`lk.BAXTER`); trajectories; the Jacobian |
# | **You write** | a mended controller, a decay rate, a damped inverse, a controller of the tip, the lag of an arm |
# | **Time** | core 3.2 hours, 22 points; all 3.6 hours, 26 points. After 3 hours, stop writing and read the rest. |

# %% setup=true
import matplotlib.pyplot as plt
import numpy as np

import labkit as lk
from labkit.course import check, predict, use

lk.ready()

# %% [markdown]
# ## Find and mend
#
# *Feed-forward* turns the joints at the target's own speed; *feedback* pulls in proportion to the error (P) and its
# rate (D). This is *our reading of the report's formula*, in the
# course's sign. **Some terms are right. Change what is wrong, nothing else.**

# %%
def equation_17(state, target, *, kp, kd):
    """The report's joint velocity controller."""
    a = state.dq
    b = kp * (target.position - state.q)
    c = kd * (target.velocity - state.dq)
    return lk.JointVelocity(a + b + c)


# %% [markdown]
# It drives the textbook's arm in three runs: **H**, a held target, with the arm started beside it;
# **P**, on the path from its start; **F**, a quick move, from beside.

# %%
ideal, baxter = lk.Arm("left", lk.IDEAL), lk.Arm("left", lk.BAXTER, seed=1)
model, q0 = ideal.model, ideal.robot.ready
T_wt = model.pose(q0)
start, upright = T_wt[:3, 3], T_wt[:3, :3]
beside = 0.1 * np.array([1, -1, 1, 1, -1, 1, 1])
way = lk.Line(q0, q0 + [0.6, 0.2, 0.0, -0.4, 0.3, 0.2, 0.4])
reach = lk.Trajectory(way, lk.Quintic(2.0))
circle = lk.Circle(start, start + [0.0, -0.12, 0.0])
poses = lk.Trajectory(lk.PosePath(circle, upright), lk.Quintic(5.0))
figure, panels = plt.subplots(1, 3, figsize=(9, 2.4), sharey=True, layout="constrained")
says = []
for panel, name, target, q in zip(
    panels, "HPF", (lk.Hold(q0, 3.0), reach, lk.Trajectory(way, lk.Quintic(0.7))), (q0 + 0.02, q0, q0 + beside)
):
    ideal.reset(q)
    log = lk.run(ideal, target, lambda state, target: equation_17(state, target, kp=3.0, kd=0.0001))
    largest = np.abs(lk.metrics.joint_error(log)).max(axis=1)
    panel.plot(log.t, largest)
    panel.set(title=f"17, run {name}", xlabel="time [s]")
    says.append(f"{name}, {largest[0]:.3f} rad at first and {largest.max():.3f} rad at most")
panels[0].set_ylabel("largest error [rad]")
lk.plotting.show("Equation 17 in three runs, the largest error of a joint: " + "; ".join(says) + ".")

# %% [markdown]
# A run that looks good proves little. Copy equation 17 into the stub and mend it. (The check starts beside its
# target: feed-forward hides even feedback of the wrong sign.)

# %% question="joint_velocity_pd"
def joint_velocity_pd(state, target, *, kp, kd):
    """An lk.JointVelocity; kp [1/s] and kd [1] are numbers or (7,)."""
    ### BEGIN SOLUTION
    from solutions.velocity_control.answers import joint_velocity_pd as answer

    return answer(state, target, kp=kp, kd=kd)
    ### END SOLUTION


# %% [markdown]
# Baxter with your controller, a tenth of a radian off. When does it become restless? Does D help?

# %%
def feedforward(state, target, **gains):
    """The stand-in: the target's own speed, whatever the gains."""
    return lk.JointVelocity(target.velocity)


my_joint_velocity_pd = use("joint_velocity_pd", joint_velocity_pd, feedforward)
yours = my_joint_velocity_pd is joint_velocity_pd
joint_law = "joint velocity PD" if yours else "feed-forward (a stand-in)"


def with_gains(kp, kd):
    """Your joint controller, or the stand-in, with its gains filled in."""

    def controller(state, target):
        return my_joint_velocity_pd(state, target, kp=kp, kd=kd)

    controller.__name__ = joint_law
    return controller


def try_gains(kp, kd):
    """One run of Baxter from off the path, as a figure and its caption."""
    baxter.reset(q0 + beside)
    log = lk.run(baxter, reach, with_gains(kp, kd))
    error = lk.metrics.joint_error(log)
    figure, (above, below) = plt.subplots(
        2, 1, figsize=(8, 4.4), sharex=True, height_ratios=(3, 2), layout="constrained"
    )
    for j, style in ((0, "-"), (1, "--"), (5, ":")):
        above.plot(log.t, error[:, j], style, label=f"joint {'s0 s1 e0 e1 w0 w1 w2'.split()[j]}")
        below.plot(log.t, log.command[:, j], style)
    above.axhline(0.0, color="0.8", zorder=0)
    above.set_ylabel("error [rad]")
    above.legend(frameon=False)
    below.set_ylabel("command [rad/s]")
    below.set_xlabel("time [s]")
    last = np.abs(error[-len(error) // 4 :]).max()
    gains = f", kp = {kp:.3g}, kd = {kd:.3g}" if joint_law == "joint velocity PD" else ", which has no gains"
    jitter = np.abs(np.diff(log.command, axis=0)).max()
    return figure, (
        f"Baxter by {joint_law.partition(',')[0]}{gains}: the largest error in the last quarter is "
        f"{last:.3f} rad, the largest jump of a command {jitter:.2f} rad/s."
    )


dials = lk.plotting.dials(try_gains, kp=(0.0, 40.0, 5.0, "1/s"), kd=(0.0, 3.0, 0.0))

# %% [markdown]
# A larger kp is quicker, until lag and the age of the state make the commands jump.
#
# ## What D does here
#
# In textbooks that push a mass with a force, D adds damping and lets you raise P.
# Here you command the speed itself. A joint moves at exactly the commanded speed, and its
# target rests: write down the equation of the error.

# %% question="decay_rate"
def decay_rate(kp, kd):
    """The r of exp(-r t), in [1/s], for kp in [1/s] and kd without unit."""
    ### BEGIN SOLUTION
    from solutions.velocity_control.answers import decay_rate as answer

    return answer(kp, kd)
    ### END SOLUTION


# %% predict="with_more_d"

# %%
def nobody_knows(kp, kd):
    """The stand-in: not a number, so nothing is drawn."""
    return np.nan


my_decay_rate = use("decay_rate", decay_rate, nobody_knows)

lagging = lk.Arm("left", lk.Plant(name="lagging", velocity_lag=0.05))


def braked(kd):
    """Times and errors of s0 while a D term brakes the joints."""

    def brakes(state, target):
        return lk.JointVelocity(3.0 * (target.position - state.q) - kd * state.dq)

    lagging.reset(q0)
    log = lk.run(lagging, lk.Hold(q0 + 0.2 * np.eye(7)[0], 1.5), brakes)
    return log.t, log.target.position[:, 0] - log.q[:, 0]


errors = {kd: braked(kd) for kd in (0.0, 1.0, 3.0)}
plt.figure(figsize=(8, 3), layout="constrained")
shares = {}
for (kd, (t, left)), style in zip(errors.items(), ("-", "--", "-.")):
    line = plt.plot(t, left, style, linewidth=2, label=f"kd = {kd:g}")[0]
    yours = left[0] * np.exp(-my_decay_rate(3.0, kd) * t)
    plt.plot(t, yours, ":", color=line.get_color())
    shares[kd] = left[-1] / left[0]
plt.xlabel("time [s]")
plt.ylabel("error of s0 [rad]")
plt.legend(frameon=False)
if with_more_d is None:
    plt.close()  # the figure waits for your prediction
else:
    lk.plotting.show(
        "Error of one joint with kp = 3 and more and more D. What is left after 1.5 s: "
        + ", ".join(f"{100 * share:.0f} % at kd = {kd:g}" for kd, share in shares.items())
        + (". Dotted: exp(-r t) with your rate." if my_decay_rate is decay_rate else ".")
    )

# %%
predict("with_more_d", truth=errors[3.0])

# %% [markdown]
# <details><summary>After your prediction: what you see</summary>The motors of this arm take 50 ms. With D the thick line (the arm) is nearer to its
# dotted one (your rate), because D makes the loop less sensitive to lag. And the arm arrives later, which matters more. So from here on kd
# is 0. (A computer knows the speed a tick late: with motors that obey at once and kd above 1 the commands would grow from tick to tick.
# The report's authors ended with 0.0001. With a moving target kd reduces what the lag costs.)</details>
#
# ## From the tip to the joints
#
# The Jacobian says how the tip moves, $V = J\,\dot q$: six numbers from
# seven. To command a motion of the tip you need an inverse; the *pseudo-inverse* finds
# the smallest joint speeds. The trap: with the arm stretched the tip cannot go towards the shoulder, whatever the
# joints do. Near such a *singularity* the
# exact answer is absurd. It pays to be a little wrong: minimise
#
# $$ |V - J\,\dot q|^2 + \lambda^2\,|\dot q|^2 $$
#
# over $\dot q$. Set the gradient to zero; you need the matrix that multiplies $V$ (Siciliano,
# *Robotics*, section 3.5.2). `damping` is the whole factor $\lambda^2$.

# %% question="damped_inverse"
def damped_inverse(J, damping):
    """Of shape (7, 6), for J (6, 7) and damping >= 0."""
    ### BEGIN SOLUTION
    from solutions.velocity_control.answers import damped_inverse as answer

    return answer(J, damping)
    ### END SOLUTION


# %% [markdown]
# How fast must the joints turn to move the tip at 10 cm/s in the hardest direction? Grey is the limit.

# %%
def truncated_inverse(J, damping):
    """The stand-in: leaves out the directions that are nearly impossible, whatever the damping."""
    return np.linalg.pinv(J, rcond=0.03)


def exact_inverse(J, damping):
    """NumPy's pseudo-inverse: no damping."""
    return np.linalg.pinv(J, rcond=1e-12)


my_damped_inverse = use("damped_inverse", damped_inverse, truncated_inverse)

angles = np.linspace(0.0, 0.8, 161)
stretched = [np.array([-0.3, -0.4, 0.0, e1, 0.0, 0.6, 0.0]) for e1 in angles]
straight = angles[np.argmin([model.nearness_to_singularity(q) for q in stretched])]


def fastest_joint(inverse, damping):
    """The speed of the fastest joint at each angle, in [rad/s]."""
    fastest = []
    for q in stretched:
        J = model.tip_jacobian(q)
        worst = np.linalg.svd(J)[0][:, -1]
        worst = 0.1 * worst / np.linalg.norm(worst[:3])
        fastest.append(np.abs(inverse(J, damping) @ worst).max())
    return fastest


undamped = fastest_joint(exact_inverse, 0.0)
plt.figure(figsize=(8, 3), layout="constrained")
speeds = {}
for damping, style in ((0.0, "-"), (0.0025, "--"), (0.02, "-.")):
    fastest = fastest_joint(my_damped_inverse, damping) if damping else undamped
    name = "no damping" if damping == 0.0 else f"damping {damping:g}"
    plt.semilogy(angles, fastest, style, label=name)
    speeds[name] = max(fastest)
plt.axhline(1.5, color="0.7", linewidth=3, zorder=0)
plt.ylim(1e-2, 1e2)
plt.xlabel("elbow e1 [rad]")
plt.ylabel("fastest joint [rad/s]")
plt.legend(frameon=False)
lk.plotting.show(
    "Joint speed for 10 cm/s of the tip in its worst direction, over the elbow's angle; the arm is "
    f"straight at {straight:.2f} rad, because the elbow's axis is beside the upper arm. The most, in rad/s: "
    + ", ".join(f"{speed:.3g} with {name}" for name, speed in speeds.items())
    + ". Without damping the speeds become absurd near this pose; with damping the tip hardly moves there."
)

# %% [markdown]
# ## A controller for the tip
#
# The report's equation 16, its first term mended as in 17; the rest is as printed. In run H the hand is also tilted by 5°.

# %%
def equation_16(state, target, *, kp=4.0, k_turn=0.04):
    """The report's workspace velocity controller."""
    T_wt = model.pose(state.q)
    move = kp * (target.pose[:3, 3] - T_wt[:3, 3])
    turn = k_turn * roll_pitch_yaw_difference(target.pose[:3, :3], T_wt[:3, :3])
    twist = target.twist + np.concatenate([move, turn])
    return lk.JointVelocity(np.linalg.pinv(model.tip_jacobian(state.q)) @ twist)


# %%
def roll_pitch_yaw_difference(R_wd, R_wt):
    """The difference of the angles, brought to half a turn."""
    both = np.array([R_wd, R_wt])
    tilt = np.hypot(both[:, 2, 1], both[:, 2, 2])
    across = np.array([both[:, 2, 1], -both[:, 2, 0], both[:, 1, 0]])
    angles = np.arctan2(across, np.array([both[:, 2, 2], tilt, both[:, 0, 0]]))
    return (angles[:, 0] - angles[:, 1] + np.pi) % (2 * np.pi) - np.pi


shifted = lk.se3.pose(upright, start + [0.02, -0.01, 0.01])
tilted = lk.se3.pose(upright @ lk.se3.rotation(np.radians([3.0, 4.0, 0.0])), shifted[:3, 3])
dash = lk.Trajectory(lk.PosePath(lk.Line(start, start + [0.1, -0.2, 0.1]), upright), lk.Quintic(0.8))
figure, panels = plt.subplots(1, 3, figsize=(9, 2.4), sharey=True, layout="constrained")
says = []
for panel, name, target, T in zip(panels, "HPF", (lk.Hold(T_wt, 3.0), poses, dash), (tilted, T_wt, shifted)):
    ideal.reset(model.inverse_kinematics(T, q0))
    log = lk.run(ideal, target, equation_16)
    error = lk.metrics.tip_error(log)
    off = 1e3 * np.linalg.norm(error[:, :3], axis=1)
    turned = np.degrees(np.linalg.norm(error[:, 3:], axis=1))
    panel.plot(log.t, off, label="position [mm]")
    panel.plot(log.t, turned, "--", label="tilt [degrees]")
    panel.set(title=f"16, run {name}", xlabel="time [s]")
    says.append(f"{name}, {off[-1]:.1f} mm and {turned[-1]:.1f} degrees")
panels[0].legend(frameon=False)
lk.plotting.show("Equation 16 in three runs, off at the end: " + "; ".join(says) + ".")

# %% question="what_shows"
def what_shows(run):
    """Replace the question marks in this line and use it:"""
    # return {"H": "?", "P": "?", "F": "a", "tilt": "?"}[run]
    ### BEGIN SOLUTION
    from solutions.velocity_control.answers import what_shows as answer

    return answer(run)
    ### END SOLUTION


# %% [markdown]
# Now mend it; `lk.se3.orientation_error(R_wd, R_wt)` is the turn of notebook 00. The trap: most wrong
# versions draw a fine circle if the hand starts upright.

# %% question="workspace_velocity_pd"
def workspace_velocity_pd(state, target, model, *, kp, damping):
    """An lk.JointVelocity; all in world axes.

    Args:
        target: lk.PoseSample: pose T_wd (4, 4), twist (v, w) and dtwist, (6,) each.
        model: lk.Model: pose(q) is T_wt, tip_jacobian(q) is (6, 7).
        kp: Gain, a number or (6,), in [1/s].
    """
    ### BEGIN SOLUTION
    from solutions.velocity_control.answers import workspace_velocity_pd as answer

    return answer(state, target, model, kp=kp, damping=damping)
    ### END SOLUTION


# %%
def tip_feedforward(state, target, model, *, kp, damping):
    """The stand-in: the target's own twist, whatever the error."""
    return lk.JointVelocity(my_damped_inverse(model.tip_jacobian(state.q), damping) @ target.twist)


my_workspace_velocity_pd = use("workspace_velocity_pd", workspace_velocity_pd, tip_feedforward)
yours = my_workspace_velocity_pd is workspace_velocity_pd
workspace_law = "workspace velocity PD" if yours else "feed-forward of the tip (a stand-in)"


def in_the_workspace(state, target):
    return my_workspace_velocity_pd(state, target, model, kp=4.0, damping=1e-5)


tilted = lk.se3.pose(upright @ lk.se3.rotation([0.15, 0.1, -0.1]), start + [0.03, -0.02, 0.02])
ideal.reset(model.inverse_kinematics(tilted, q0))
log = lk.run(ideal, poses, in_the_workspace)
lk.plotting.tracking(log)
lk.plotting.show(lk.plotting.describe(log))

# %%
ideal.reset(q0)
reference = lk.run(ideal, poses, in_the_workspace)
lk.replay.show(
    lk.replay.motion_of(
        log, "A circle from a wrong start", label="wrong start", ghosts={"right start": reference}
    )
)

# %% [markdown]
# Both errors are gone within two seconds; feed-forward alone keeps the error of its start all round.
#
# ## Measure an arm
#
# A real arm has numbers that nobody tells you. Yours is a Baxter with motors, friction, a payload
# and a wall of its own; the report of notebook 08 is about it. Put your name in the course, or your team's, in place of
# `"demo"`, a public arm.

# %%
HANDLE = "demo"  # your name in the course
mine = lk.my_arm(HANDLE)

# %% [markdown]
# Its motors follow a commanded speed with a lag. Write the experiment as a function: a step of the speed of one joint. The
# trap: `log.q` and `log.dq` are true, `log.measured` is what the controller saw, noisy and late. The grader tries two arms that you
# have not seen.

# %% question="find_lag"
def find_lag(arm):
    """In [s], of an lk.Arm at rest in its ready pose."""
    ### BEGIN SOLUTION
    from solutions.velocity_control.answers import find_lag as answer

    return answer(arm)
    ### END SOLUTION


# %%
def not_measured(arm):
    """The stand-in: not a number."""
    return np.nan


my_find_lag = use("find_lag", find_lag, not_measured)
found = my_find_lag(lk.my_arm(HANDLE))


def steps(state, target, speed=0.4):
    """One joint, s0, at a constant speed from the first tick on."""
    return lk.JointVelocity(speed * np.eye(7)[0])


own_step = lk.run(mine, lk.Hold(mine.robot.ready, 1.2), steps)
plt.figure(figsize=(8, 2.6), layout="constrained")
plt.plot(own_step.t, own_step.dq[:, 0], label="s0 of your arm")
plt.plot(own_step.t, own_step.command[:, 0], "--", label="commanded")
plt.axvline(found, color="0.7", linestyle=":", label="your lag")
plt.xlim(0.0, 0.4)
plt.xlabel("time [s]")
plt.ylabel("speed [rad/s]")
plt.legend(frameon=False)
lk.plotting.show(
    f"A step of the commanded speed, and how joint s0 of the arm {HANDLE} follows it. find_lag gives {1e3 * found:.0f} ms."
)

# %% [markdown]
# ## Baxter, at last
#
# Three controllers draw a circle on Baxter, from a little off the path.

# %%
joints = model.joint_trajectory(poses, q0)
runs = {}
for name, target, controller in (
    ("feed-forward alone", joints, feedforward),
    (joint_law, joints, with_gains(5.0, 0.0)),
    (workspace_law, poses, in_the_workspace),
):
    baxter.reset(q0 + 0.02)
    runs[name] = lk.run(baxter, target, controller)

plt.figure(figsize=(8, 3), layout="constrained")
print(f"{'RMS [mm]':>44} {'largest [mm]':>14} {'tilted by [deg]':>17}")
for (name, run), style in zip(runs.items(), ("-", "--", "-.")):
    numbers = lk.metrics.summary(run)
    off = 1e3 * np.linalg.norm(lk.metrics.tip_error(run)[:, :3], axis=1)
    plt.plot(run.t, off, style, label=name)
    print(f"{name:35} {numbers.rms_mm:8.1f} {numbers.max_mm:14.1f} {numbers.max_deg:17.1f}")
plt.xlabel("time [s]")
plt.ylabel("tip off by [mm]")
plt.legend(frameon=False)
lk.plotting.show(
    "How far the tip is off the circle on Baxter. RMS: "
    + ", ".join(f"{lk.metrics.summary(run).rms_mm:.1f} mm by {name}" for name, run in runs.items())
    + "."
)

# %%
lk.replay.show(
    lk.replay.motion_of(
        runs[workspace_law],
        "Baxter draws a circle",
        label=workspace_law,
        ghosts={"feed-forward alone": runs["feed-forward alone"]},
    )
)

# %% [markdown]
# Feed-forward draws a good circle in the wrong place. Feedback removes the error of the start; a few
# millimetres are left where the tip is fastest: motors lag, and the state is
# old. (Give both controllers the same kp before you call one better.)

# %% [markdown] why="why_with_more_d"
# What did you see happen to the error of a resting joint when D grew, and why? In your mechanics lecture a
# damper lets you raise P: say what is different in an arm whose speed is commanded.
#
# ### BEGIN SOLUTION
# With more D the error died more slowly: its rate is kp/(1 + kd). Where the speed itself is commanded, D subtracts
# a share of the speed from the command, so it only makes the command smaller. A mass needs D to lose its kinetic
# energy; a joint that obeys its speed command at once cannot swing, so nothing needs damping. (A long lag makes the
# loop one of second order, and there D does let you raise P.)
# ### END SOLUTION

# %% [markdown]
# Now in real time: drag the arm off its circle. You hardly
# can: velocity mode is stiff, until a motor reaches its
# torque limit: push the tip with 60 N along +y. Then raise kp to 30, and
# *state_delay* until the arm swings. With half the kp, how much more delay can it bear?

# %%
def circling(state, target, kp):
    return with_gains(kp, 0.0)(state, target)


view = lk.live(
    lk.Arm("left", lk.BAXTER, q0=q0), joints, {joint_law: circling}, title="Velocity control",
    kp=(0.0, 30.0, 5.0, "1/s"), state_delay=(0.0, 0.2), payload=(0.0, 1.0),
)
view

# %% [markdown]
# ## Appendix: an extension
#
# No later question depends on it.
#
# ### What the tip does not feel
#
# Six numbers for the tip, seven joints: one freedom is left. Keep your
# hand on the table and swing your elbow. Suppose the joints would like to turn at some speeds
# $\dot q_w$. Which part of that wish does the tip not feel? (The joint speeds with $J\,\dot q = 0$ are the *null space* of $J$; Siciliano, section 3.5.1.)

# %% question="posture_velocity"
def posture_velocity(J, dq_wish):
    """Joint speeds (7,) with J @ dq = 0, nearest to dq_wish (7,) [rad/s]; J (6, 7) has full rank."""
    ### BEGIN SOLUTION
    from solutions.velocity_control.answers import posture_velocity as answer

    return answer(J, dq_wish)
    ### END SOLUTION


# %% [markdown]
# With your part the tip holds its place while the elbow swings.

# %%
def stays(J, dq_wish):
    """The stand-in: no motion, so the tip feels none."""
    return np.zeros(7)


my_posture_velocity = use("posture_velocity", posture_velocity, stays)

# %%
def swings_the_elbow(state, target):
    J = model.tip_jacobian(state.q)
    hold = in_the_workspace(state, target).value
    wish = np.zeros(7)
    wish[2] = 0.6 * np.cos(2.0 * np.pi * state.t / 4.0)
    return lk.JointVelocity(hold + my_posture_velocity(J, wish))


swinger = lk.Arm("left", lk.IDEAL, q0=q0)
log = lk.run(swinger, lk.Hold(T_wt, 4.0), swings_the_elbow)
tip = 1e3 * np.linalg.norm(lk.metrics.tip_error(log)[:, :3], axis=1)
print(f"The upper arm turned by {np.ptp(log.q[:, 2]):.2f} rad, the tip moved by {tip.max():.2f} mm.")
lk.replay.show(lk.replay.motion_of(log, "Only the elbow should move", reference=False))

# %% [markdown]
# ## Hand in
#
# Run all cells, save, and run the last one once more: it prints a receipt.

# %% setup=true
lk.hand_in("03_velocity_control")
