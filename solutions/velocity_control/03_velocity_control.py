# %% [markdown]
# # 03 · Velocity control
#
# The arm knows where it should be at every moment. Now it must get there, although it starts somewhere else,
# answers late and measures with noise. The controllers of this notebook command the *speeds* of the joints,
# and the motors keep these speeds. That is the easiest method to drive an arm, and it is good enough for
# most tasks.
#
# | | |
# |---|---|
# | **You need** | numpy; notebook 00 or its conventions: the error is target minus actual, the error of an orientation is a rotation, R_wd R_wtᵀ, and not a difference; twists are (v, w) |
# | **Given** | the simulated arm, as the textbook has it (`lk.IDEAL`) and with friction, lag and noise like Baxter's (`lk.BAXTER`); trajectories; the model with its Jacobian |
# | **You write** | two controllers, the rate at which an error decays, a damped inverse, joint motion that leaves the tip at rest; the lag of your own arm |
# | **Time** | core about 3 hours, all about 4 hours; 26 points |
#
# Questions marked *core* are for everybody. Those marked *extension* take the rest of the time: they earn points
# too, but no later question depends on them.
#
# Every cell runs from the start, solved or not. If your part is missing, a stand-in replaces it and says so.
# After each stub a check tells you in words what it found. The functions, your predictions, the numbers to
# find out and the text at the end are marked; play with everything else as you like.

# %% setup=true
import labkit as lk
from labkit.course import check, predict, use

lk.ready()

# %% setup=true
import matplotlib.pyplot as plt
import numpy as np

# %% [markdown]
# ## Feed-forward and feedback
#
# A target that says how fast it moves makes half of the work easy: turn the joints at just that speed. This
# is *feed-forward*. If the arm were perfect and its start exact, you would need nothing else. But no arm is
# perfect, and feed-forward alone leaves every small error as it is. So add *feedback*, which pulls the arm
# towards its target, in proportion to the error (P) and to the rate of the error (D). What are the
# units of the two gains?
#
# Because feed-forward does so well on its own, it hides feedback that is broken, even one with the
# wrong sign. So the check starts off the path, and with a target that stands still (Lynch and Park,
# *Modern Robotics*, section 11.3).

# %% question="joint_velocity_pd"
def joint_velocity_pd(state, target, *, kp, kd):
    """Joint speeds that follow a joint trajectory.

    Args:
        state: An lk.State: angles q in [rad] and speeds dq in [rad/s], shape (7,) each.
        target: An lk.Sample of joint angles: position, velocity, acceleration, shape (7,) each.
        kp: Gain on the error of the angles, a number or shape (7,), in [1/s].
        kd: Gain on the error of the speeds, a number or shape (7,), without unit.

    Returns:
        An lk.JointVelocity of shape (7,), in [rad/s].
    """
    ### BEGIN SOLUTION
    from solutions.velocity_control.answers import joint_velocity_pd as answer

    return answer(state, target, kp=kp, kd=kd)
    ### END SOLUTION


# %% [markdown]
# Here is Baxter with your controller, started a tenth of a radian off. If yours is not ready, the arm runs on
# feed-forward alone, so you see what it lacks. Turn the dials: when does the arm become restless? Does D
# help? (When the notebook is graded nobody turns the dials, and they keep their starting values.)

# %%
def feedforward(state, target, **gains):
    """The stand-in: the target's own speed, whatever the gains."""
    return lk.JointVelocity(target.velocity)


my_joint_velocity_pd = use("joint_velocity_pd", joint_velocity_pd, feedforward)
yours = my_joint_velocity_pd is joint_velocity_pd
joint_law = "joint velocity PD" if yours else "feed-forward (a stand-in)"

ideal, baxter = lk.Arm("left", lk.IDEAL), lk.Arm("left", lk.BAXTER, seed=1)
model, q0 = ideal.model, ideal.robot.ready
off_the_path = q0 + 0.1 * np.array([1, -1, 1, 1, -1, 1, 1])
reach = lk.Trajectory(lk.Line(q0, q0 + [0.6, 0.2, 0.0, -0.4, 0.3, 0.2, 0.4]), lk.Quintic(2.0))


def with_gains(kp, kd):
    """Your joint controller, or the stand-in, with its gains filled in."""

    def controller(state, target):
        return my_joint_velocity_pd(state, target, kp=kp, kd=kd)

    controller.__name__ = joint_law
    return controller


def try_gains(kp, kd):
    """One run of Baxter from off the path, as a figure and its caption."""
    baxter.reset(off_the_path)
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
# ## What D does here
#
# In most textbooks D adds damping and so lets you raise P. These books think of a mass that a force pushes.
# Here you command the speed itself. Suppose that a joint moves at exactly the commanded speed, and that its
# target does not move. Write down the equation for the error, and see how quickly the error decays.

# %% question="decay_rate"
def decay_rate(kp, kd):
    """The rate at which the error of a joint decays that moves at exactly the commanded speed.

    Args:
        kp: Gain on the error of the angle, in [1/s].
        kd: Gain on the error of the speed, without unit.

    Returns:
        The rate r of exp(-r t), in [1/s].
    """
    ### BEGIN SOLUTION
    from solutions.velocity_control.answers import decay_rate as answer

    return answer(kp, kd)
    ### END SOLUTION


# %% predict="with_more_d"

# %% [markdown]
# Compare with an arm whose motors take 50 ms to follow a command. (On paper the controller knows the speed of
# the same instant. A computer knows it a tick late: with motors that obey at once it *is* the last command, so
# with kd above 1 the commands would grow from tick to tick. The report's authors ended with a kd of 0.0001.) kd is useful with a moving target,
# because it reduces the error that the motors' lag causes; here the target rests. The thick lines are
# the arm, the thin dotted ones your rate.

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
# Two things change with D. The thick line is nearer to its dotted one, because D makes the loop less sensitive
# to the motors' lag. And the arm arrives later. The second effect matters more. So
# from here on kd is 0, and you choose only kp.

# %% [markdown]
# ## From the tip to the joints
#
# Often it is the tip that matters, and the target is a pose. The Jacobian says how the tip moves when the
# joints do, $V = J\,\dot q$: six numbers (velocity of the tip, then angular velocity, in world axes) from
# seven. `model.tip_jacobian(q)` gives it. To command a motion of the tip you need the inverse: joint speeds
# from a motion of the tip.
#
# Seven unknowns for six equations: there are many answers, and the *pseudo-inverse* finds the one with
# the smallest joint speeds. But some poses have a direction in which the tip cannot go, whatever the
# joints do: with the elbow straight, towards or away from the shoulder. Near such a *singularity* the
# exact answer is absurd. It pays to be a little wrong instead: minimise
#
# $$ |V - J\,\dot q|^2 + \lambda^2\,|\dot q|^2 $$
#
# over $\dot q$. Set the gradient to zero; the matrix that multiplies $V$ is the one that you need (Nakamura
# and Hanafusa 1986; Siciliano, *Robotics: Modelling, Planning and Control*, section 3.5.2). In the stub,
# `damping` is the whole factor $\lambda^2$. Note that $|V - J\,\dot q|^2$ adds squares of m/s and of rad/s, so
# that one metre counts as much as one radian: a choice, which another unit of length would change.

# %% question="damped_inverse"
def damped_inverse(J, damping):
    """The damped pseudo-inverse of a Jacobian.

    Args:
        J: Jacobian, rows (v, w), shape (6, 7).
        damping: The factor of |dq|^2, at least 0; 0 is the pseudo-inverse.

    Returns:
        The matrix that turns a twist (v, w) into joint speeds, shape (7, 6).
    """
    ### BEGIN SOLUTION
    from solutions.velocity_control.answers import damped_inverse as answer

    return answer(J, damping)
    ### END SOLUTION


# %% [markdown]
# How fast would the joints have to turn to move the tip at 10 cm/s in the direction that is hardest, while
# the elbow stretches? The grey line is the limit of the larger joints, 1.5 rad/s.

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
# Now put it together: how the tip should move, and the joint speeds that do it. The tip should move as its
# target does and, in addition, towards the target, in position and in orientation. The orientation error is
# that of notebook 00, a turn in world axes; `lk.se3.orientation_error(R_wd, R_wt)` gives it. Most wrong
# versions of this controller draw a fine circle as long as the hand starts upright, so the check tilts it.

# %% question="workspace_velocity_pd"
def workspace_velocity_pd(state, target, model, *, kp, damping):
    """Joint speeds that make the tip follow a target of poses.

    Args:
        state: An lk.State: angles q in [rad], shape (7,).
        target: An lk.PoseSample: pose T_wd (4, 4), twist (v, w) and its rate dtwist, (6,) each,
            in world axes, [m/s] and [rad/s].
        model: The lk.Model: pose(q) is T_wt, (4, 4), and tip_jacobian(q) is (6, 7), world axes.
        kp: Gain on the error of position and orientation, a number or shape (6,), in [1/s].
        damping: Of the inverse, as in damped_inverse.

    Returns:
        An lk.JointVelocity of shape (7,), in [rad/s].
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


T_wt = model.pose(q0)
start, upright = T_wt[:3, 3], T_wt[:3, :3]
circle = lk.Circle(start, start + [0.0, -0.12, 0.0])
poses = lk.Trajectory(lk.PosePath(circle, upright), lk.Quintic(5.0))

tilted = lk.se3.pose(upright @ lk.se3.rotation([0.15, 0.1, -0.1]), start + [0.03, -0.02, 0.02])
ideal.reset(model.inverse_kinematics(tilted, q0))
log = lk.run(ideal, poses, in_the_workspace)
lk.plotting.tracking(log)
lk.plotting.show(lk.plotting.describe(log))

# %% [markdown]
# Here is the run in three dimensions, beside an arm that starts where it should. If your controller is not
# ready, the arm has feed-forward only, and keeps the error of its start all round the circle.

# %%
ideal.reset(q0)
reference = lk.run(ideal, poses, in_the_workspace)
lk.replay.show(
    lk.replay.motion_of(
        log, "A circle from a wrong start", label="wrong start", ghosts={"right start": reference}
    )
)

# %% [markdown]
# ## What the tip does not feel
#
# Six numbers for the tip, seven joints: one freedom is left. You can see this freedom on yourself: keep your
# hand on the table and swing your elbow. An arm can use it to stay clear of things or of its joints' limits,
# if you can move the elbow *without* moving the tip. Suppose the joints would like to turn at some speeds
# $\dot q_w$. Which part of that wish does the tip not feel?
#
# The joint speeds with $J\,\dot q = 0$ are called the *null space* of $J$ (Siciliano, section 3.5.1).

# %% question="posture_velocity"
def posture_velocity(J, dq_wish):
    """The part of a wish that does not move the tip.

    Args:
        J: Jacobian, shape (6, 7), of full rank.
        dq_wish: Joint speeds one would like, shape (7,), in [rad/s].

    Returns:
        Joint speeds with J @ dq = 0, as near to the wish as can be, shape (7,).
    """
    ### BEGIN SOLUTION
    from solutions.velocity_control.answers import posture_velocity as answer

    return answer(J, dq_wish)
    ### END SOLUTION


# %% [markdown]
# With your part the tip holds its place while the elbow swings from side to side.

# %%
def stays(J, dq_wish):
    """The stand-in: no motion, so the tip feels none."""
    return np.zeros(7)


my_posture_velocity = use("posture_velocity", posture_velocity, stays)


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
# ## An arm of your own
#
# From here on you have your own arm. It is a Baxter, but its motors, the friction of its joints, its payload
# and the wall in front of it are particular to this arm. Each team has an arm that nobody else has, and so has each
# student without a team. Open it with the name that your instructor gave you: put the name in place of `"demo"`,
# which is a public arm to practise on. When it is marked, the numbers
# that you find are compared with the true numbers of your arm, and the report of notebook 08 is about this arm.

# %%
HANDLE = "demo"  # in a course: the name that your instructor gave you
mine = lk.my_arm(HANDLE)


def steps(state, target, speed=0.4):
    """One joint, s0, at a constant speed from the first tick on."""
    return lk.JointVelocity(speed * np.eye(7)[0])


mine.reset(mine.robot.ready)
own_step = lk.run(mine, lk.Hold(mine.robot.ready, 1.2), steps)
plt.figure(figsize=(8, 2.6), layout="constrained")
plt.plot(own_step.t, own_step.dq[:, 0], label="s0 of your arm")
plt.plot(own_step.t, own_step.command[:, 0], "--", label="commanded")
plt.xlim(0.0, 0.4)
plt.xlabel("time [s]")
plt.ylabel("speed [rad/s]")
plt.legend(frameon=False)
lk.plotting.show(f"A step of the commanded speed, and how joint s0 of the arm {HANDLE} follows it.")

# %% find_out="my_lag"

# %% [markdown]
# ## Baxter, at last
#
# Now the arm has friction, lag and noise like Baxter's. It publishes 100 states a second while you command 200
# times; the speeds are noisy, the motors lag, and now and then a command is late. Some of its numbers are published and others assumed;
# `labkit.plant.EVIDENCE` says which. Three controllers draw the same circle, from the same start a little off
# the path.

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
# If your own controllers are in place, you see this: feed-forward draws a good circle, but in the wrong place.
# Feedback removes the error of the start within a second, and with it nearly all of the error. What is left
# is a few millimetres, largest where the tip is fastest: the motors lag, and the state is some milliseconds
# old. And the two controllers? One has kp = 5, the other 4. Give both the same gain before you call one of
# them better.

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
# Now the same in real time, and you can push. Press *Start* and try to drag the arm off its circle. You hardly
# can: velocity mode is stiff, and the motors give all they have to keep the speed. Only where a motor reaches its
# torque limit does the arm give way: push at the tip with 60 N along +y. Now choose a kp of 30 and raise
# *state_delay* until the arm begins to swing. Repeat this with half the kp: how much more delay can the arm bear?
# (The line beside or below the picture begins with what moves the arm: your controller, or a stand-in. The
# stand-in has no kp.)

# %%
def circling(state, target, kp):
    return with_gains(kp, 0.0)(state, target)


view = lk.live(
    lk.Arm("left", lk.BAXTER, q0=q0), joints, {joint_law: circling}, title="Velocity control",
    kp=(0.0, 30.0, 5.0, "1/s"), state_delay=(0.0, 0.2), payload=(0.0, 1.0),
)
view

# %% [markdown]
# ## Hand in
#
# Run everything once more from the top (*Kernel, Restart Kernel and Run All Cells*) and save the file. Then
# run only the last cell once more: it prints a receipt for the saved file; keep it. `!labkit submit-check 03_velocity_control.ipynb`
# in a new cell runs a copy of that file and says what is missing. Hand in the file without renaming it, in the way your course asks. The grader runs your
# functions on further cases; the text above each stub says what kind of cases.

# %% setup=true
lk.hand_in("03_velocity_control")
