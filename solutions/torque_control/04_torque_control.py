# %% [markdown]
# # 04 · Torque control
#
# Until now you commanded how fast the motors turn, and they found the torque themselves. In torque control
# you compute the torque. That is more work, but it gives you a choice: you decide how the arm reacts, joint
# by joint, when it is off its target.
#
# | | |
# |---|---|
# | **You need** | matrices; a damped spring, ë + kd ė + kp e = 0; what an eigenvalue is |
# | **Given** | the arm's model: M, C and g (notebook 02 builds them, here you only use them) |
# | **You write** | two torque laws, a sampled joint, gains for a real arm, a function that finds a fault |
# | **Time** | about 3.5 hours; 21 points |
#
# Every cell below runs from the start, solved or not. If your part is missing, a stand-in replaces it and
# says so. After each stub a check tells you in words what it found. The functions, your predictions and the
# text at the end are marked; play with everything else as you like.

# %% setup=true
from dataclasses import replace

import labkit as lk
from labkit.course import check, predict, use

lk.ready()

# %% setup=true
import matplotlib.pyplot as plt
import numpy as np

# %% [markdown]
# ## The equation behind it all
#
# For the arm's seven joint angles $q$ Newton's law reads
#
# $$ M(q)\,\ddot q + C(q, \dot q)\,\dot q + g(q) = \tau . $$
#
# $M$ is the inertia: a matrix, because turning one joint shakes the others, and a function of $q$, because a
# stretched arm is harder to turn than a folded one. $C\,\dot q$ are the Coriolis and centrifugal torques, and
# $g$ is the torque that the motors need to hold the arm still. `lk.Model` computes all three. Here they are
# at the pose where the exercises start:

# %%
model = lk.Model("left", lk.BAXTER)
ready = model.robot.ready
names = [name.removeprefix("left_") for name in model.robot.joint_names]

print("joint              ", "  ".join(f"{name:>6}" for name in names))
print("inertia, [kg m²]   ", "  ".join(f"{x:6.3f}" for x in np.diag(model.mass_matrix(ready))))
print("weight, [N m]      ", "  ".join(f"{x:6.2f}" for x in model.gravity(ready) + 0.0))
print("torque limit, [N m]", "  ".join(f"{x:6.0f}" for x in model.robot.effort))

# %% [markdown]
# Keep two things in mind. The shoulder's `s1` needs 36 of its 100 N m only to hold the arm up. And the last
# joint, `w2`, has a fortieth of the shoulder's inertia: the same torque is a nudge here and a kick there.
#
# ## Who carries the weight?
#
# On an ideal arm, as in a textbook, your torques must carry the weight. Baxter carries itself: a separate channel adds $g(q)$ to every
# command, in every mode, all the time. The simulated arm has a switch for this in its *plant*. Release both
# arms, with no torque at all, and see.

# %%
textbook = lk.Plant(name="textbook", armature=0.05)
carries_itself = replace(textbook, name="self-carrying", gravity_compensation=True)


def no_torque(state, target):
    return lk.JointTorque(np.zeros(7))


def stay(plant, controller, duration=1.5, q0=ready, rate=200.0):
    """Let a controller hold the ready pose; returns the log."""
    with lk.Arm("left", plant, q0=q0) as arm:
        return lk.run(arm, lk.Hold(ready, duration), controller, rate)


loose = {plant.name: stay(plant, no_torque, 0.6) for plant in (textbook, carries_itself)}
for name, log in loose.items():
    z = 1e3 * lk.metrics.tip_poses(log)[:, 2, 3]
    print(f"{name}: the tip drops {z[0] - min(z):.0f} mm in {log.t[-1]:.1f} s")

# %% [markdown]
# So a torque law must know which arm it runs on. Your functions have the argument `arm_compensates` for this.
# If it is true, the arm carries its own weight, and the law must not add gravity.
#
# ## Springs, dampers, and the torque of the motion
#
# Throughout this course the error is *target minus actual*:
#
# $$ e = q_d - q, \qquad \dot e = \dot q_d - \dot q . $$
#
# Fasten a spring $K_p$ and a damper $K_d$ between each joint and its target, and add the torque that the
# target's motion needs: put the target's motion into the equation above, at the angles of the arm. This is
# the *augmented PD* law (Murray, Li and Sastry, equation 4.53; there $e$ has the other sign). Note which
# speed multiplies $C$: with the target's speed, the energy of the springs and of the error's motion never
# grows. That alone does not prove that the arm arrives, because this energy is also constant while the error
# does not change; Murray, Li and Sastry close the gap (proposition 4.10). The report that this lab grew out
# of printed the arm's own speed instead. Then their proof does not apply: this energy may grow, unless there is enough
# damping, $K_d > \dot M / 2$.

# %% question="augmented_pd"
def augmented_pd(state, target, model, *, kp, kd, arm_compensates):
    """Augmented PD: the torque that the motion takes, a spring and a damper at each joint.

    Args:
        state: lk.State(t, q, dq), angles in [rad] and speeds in [rad/s], shape (7,) each.
        target: lk.Sample(position, velocity, acceleration) of the joints, shape (7,) each.
        model: lk.Model, with mass_matrix(q), coriolis(q, dq) of shape (7, 7), and gravity(q).
        kp: Springs, shape (7,) or one number, in [N m/rad].
        kd: Dampers, shape (7,) or one number, in [N m s/rad].
        arm_compensates: Whether the arm carries its own weight.

    Returns:
        lk.JointTorque of shape (7,) in [N m].
    """
    ### BEGIN SOLUTION
    from solutions.torque_control.answers import augmented_pd as answer

    return answer(state, target, model, kp=kp, kd=kd, arm_compensates=arm_compensates)
    ### END SOLUTION


# %% [markdown]
# Let your law hold both arms, with `arm_compensates` true and false. Two of these four runs agree with the
# arm. What happens in the other two? (If your law is not ready, Baxter's position mode stands in: it holds
# the place whatever happens, so all four will look alike.)

# %%
def position_mode(state, target, model, *, kp, kd, arm_compensates):
    return lk.JointPosition(target.position)


my_augmented_pd = use("augmented_pd", augmented_pd, position_mode)

KP, KD = 80.0, 12.0  # the same in every joint: enough to see what a law does, and no more


def with_gains(law, plant, kp, kd, arm_compensates):
    """A controller for `lk.run`: the law with its numbers filled in."""
    known = lk.Model("left", plant)

    def controller(state, target):
        return law(state, target, known, kp=kp, kd=kd, arm_compensates=arm_compensates)

    controller.__name__ = "a stand-in, position mode" if law is position_mode else law.__name__
    return controller


logs = {}
for plant in (textbook, carries_itself):
    for flag in (False, True):
        law = with_gains(my_augmented_pd, plant, KP, KD, flag)
        logs[f"{plant.name}, arm_compensates={flag}"] = stay(plant, law)

plt.figure(figsize=(8, 3.4), layout="constrained")
heights = {}
for (name, log), style in zip(logs.items(), ("-", "--", "-.", ":")):
    z = 1e3 * lk.metrics.tip_poses(log)[:, 2, 3]
    z = (z - z[0]).round(3) + 0.0
    heights[name] = z[-1]
    plt.plot(log.t, z, style, label=name)
plt.xlabel("time [s]")
plt.ylabel("height of the tip [mm]")
plt.gcf().legend(loc="outside lower center", ncols=2, frameon=False)
lk.plotting.show(
    "The tip's height after 1.5 s: "
    + "; ".join(f"{name}: {z:+.0f} mm" for name, z in heights.items())
    + "."
)

# %% [markdown]
# Here are the runs as arms. Move the slider, turn the view.

# %%
right, *others = logs.items()
carried = lk.replay.motion_of(
    right[1],
    f"Who carries the weight? Held by {right[1].controller}",
    label=right[0],
    ghosts=dict(others[:2]),
    reference=False,
)
lk.replay.show(carried)

# %% [markdown]
# ## Every joint the same
#
# With springs at the joints, each joint swings at its own frequency, and the joints shake each other through
# $M$. *Computed torque* first asks which acceleration would be good. If the joints had
#
# $$ \ddot q = \ddot q_d + K_d\,\dot e + K_p\,e , $$
#
# then the error would obey $\ddot e + K_d\,\dot e + K_p\,e = 0$: a damped spring in each joint, free of all
# the others, whatever the pose. So this is the acceleration to ask for, and the equation of motion gives the
# torque. The gains are now multiplied by $M$; their units are 1/s² and 1/s.

# %% question="computed_torque"
def computed_torque(state, target, model, *, kp, kd, arm_compensates):
    """Computed torque: the error of every joint decays like that of a damped spring.

    Args:
        state: lk.State(t, q, dq), angles in [rad] and speeds in [rad/s], shape (7,) each.
        target: lk.Sample(position, velocity, acceleration) of the joints, shape (7,) each.
        model: lk.Model, with mass_matrix(q), coriolis(q, dq) of shape (7, 7), gravity(q) and
            inverse_dynamics(q, dq, ddq) = M ddq + C dq + g.
        kp: Gains, shape (7,) or one number, in [1/s^2].
        kd: Gains, shape (7,) or one number, in [1/s].
        arm_compensates: Whether the arm carries its own weight.

    Returns:
        lk.JointTorque of shape (7,) in [N m].
    """
    ### BEGIN SOLUTION
    from solutions.torque_control.answers import computed_torque as answer

    return answer(state, target, model, kp=kp, kd=kd, arm_compensates=arm_compensates)
    ### END SOLUTION


# %% [markdown]
# Start both laws 0.1 rad off in every joint, and look at the error that is left in each joint.

# %%
my_computed_torque = use("computed_torque", computed_torque, position_mode)

off = 0.1 * np.array([1, -1, 1, 1, -1, 1, -1])
contest = (
    ("augmented PD", with_gains(my_augmented_pd, textbook, KP, KD, False)),
    ("computed torque", with_gains(my_computed_torque, textbook, 40.0, 2 * 40.0**0.5, False)),
)
_, axes = plt.subplots(1, 2, figsize=(9, 3), sharey=True, layout="constrained")
spread = []
for ax, (name, law) in zip(axes, contest):
    log = stay(textbook, law, 1.2, q0=ready - off, rate=500.0)
    share = lk.metrics.joint_error(log) / off
    for k, column in enumerate(share.T):
        ax.plot(log.t, column, ("-", "--", "-.", ":")[k % 4], label=names[k])
    spread.append(np.ptp(share[len(share) // 4]))
    ax.set_title(name, loc="left", fontsize="medium")
    ax.set_xlabel("time [s]")
axes[0].set_ylabel("share of the error left")
axes[1].legend(frameon=False, ncols=2)
lk.plotting.show(
    "What is left of a start error in each joint. After 0.3 s the joints differ by "
    f"{spread[0]:.2f} of it under augmented PD and by {spread[1]:.3f} under computed torque."
)

# %% [markdown]
# All seven curves are the same: that is what the model gives you. But this result depends on the model. On an
# arm with friction, or with something in its gripper, the curves come apart again.

# %% predict="unknown_load"

# %%
burdened = replace(carries_itself, name="with 0.5 kg", payload=0.5)
log = stay(burdened, with_gains(my_computed_torque, carries_itself, 40.0, 2 * 40.0**0.5, True), 3.0)
z = 1e3 * lk.metrics.tip_poses(log)[:, 2, 3]
if my_computed_torque is not position_mode:
    predict("unknown_load", truth=round(float(z[0] - z[-1]), 1))
else:
    print("The stand-in holds any load: the truth is shown here once your law is ready.")

# %% [markdown]
# ## Gains with a meaning
#
# Nobody knows what "kp = 40" feels like. A frequency and a damping ratio are easier to imagine: how often the
# error would swing in a second if nothing damped it, and how strongly it is damped. A ratio of 1 is *critical* damping, the
# quickest response without overshoot. Compare with the standard form of a damped spring,
#
# $$ \ddot e + 2\,\zeta\,\omega\,\dot e + \omega^2\,e = 0 . $$
#
# Turn the dials: this is the error of one joint, started at 1. Which setting settles soonest?

# %%
def error_of_one_joint(frequency, damping):
    omega = 2.0 * np.pi * frequency
    kp, kd = omega**2, 2.0 * damping * omega
    t = np.linspace(0.0, 2.0, 401)
    fast, slow = np.roots([1.0, kd, kp]) + [0.0, 1e-9]  # apart, so that one formula serves
    e = np.real((fast * np.exp(slow * t) - slow * np.exp(fast * t)) / (fast - slow))
    outside = np.flatnonzero(np.abs(e) > 0.02)
    figure, ax = plt.subplots(figsize=(7, 2.6), layout="constrained")
    ax.plot(t, e)
    ax.axhspan(-0.02, 0.02, color="0.85")
    ax.set_xlabel("time [s]")
    ax.set_ylabel("error left")
    return figure, (
        f"kp = {kp:.1f} 1/s², kd = {kd:.2f} 1/s: the error stays within 2 % after "
        f"{t[outside[-1]]:.2f} s and overshoots by {100 * max(0.0, -e.min()):.0f} %."
    )


dials = lk.plotting.dials(error_of_one_joint, frequency=(0.5, 6.0, 2.0, "Hz"), damping=(0.1, 2.0, 0.7))

# %% [markdown]
# ## The torque is constant between two ticks
#
# A computer reads the state and computes a torque, and the motor keeps that torque until the next reading: 5
# ms at 200 Hz. For a heavy joint that is very short. For a light joint it can be too long: the torque that
# should stop the joint drives it past the target and away. The *eigenvalues* of the step from one sample to
# the next tell you whether the joint settles or runs away. If all of them are inside the unit circle, the
# error decays in the end, although it may grow at first.
#
# During one step the torque is constant. So the acceleration of a single joint is constant too, and you can
# compute exactly where the joint will be. Take the target as zero:
#
# $$ \begin{pmatrix} q \\ \dot q \end{pmatrix}_{k+1} = A \begin{pmatrix} q \\ \dot q \end{pmatrix}_{k},
# \qquad \tau_k = -k_p\,q_k - k_d\,\dot q_k . $$

# %% question="sampled_joint"
def sampled_joint(inertia, kp, kd, dt):
    """One sampling period of a joint under a torque that is held meanwhile.

    Args:
        inertia: Of the joint, in [kg m^2].
        kp: Spring, in [N m/rad].
        kd: Damper, in [N m s/rad].
        dt: Sampling period, in [s].

    Returns:
        The matrix that takes (angle, speed) from one sample to the next, shape (2, 2).
    """
    ### BEGIN SOLUTION
    from solutions.torque_control.answers import sampled_joint as answer

    return answer(inertia, kp, kd, dt)
    ### END SOLUTION


# %% [markdown]
# The report's team had 8 N m/rad and 1.5 N m s/rad at the last wrist joint `w2`. In Baxter's published data
# this joint has 0.001 kg m², the inertia of a little disc, because the motor's rotor is left out. Behind its
# gears the rotor turns many times faster than the joint, so to the joint it feels far heavier than it is
# (people call this the *armature*). Nobody has published its value; here we assume 0.05 kg m². Which of the
# two inertias must the team's joint have had?

# %%
def never_sampled(inertia, kp, kd, dt):
    """A stand-in: the loop as if the torque changed all the time."""
    values, axes = np.linalg.eig(np.array([[0.0, 1.0], [-kp / inertia, -kd / inertia]]))
    return np.real(axes @ np.diag(np.exp(values * dt)) @ np.linalg.inv(axes))


my_sampled_joint = use("sampled_joint", sampled_joint, never_sampled)

bare = lk.Model("left", lk.IDEAL).mass_matrix(ready)[6, 6]
with_rotor = model.mass_matrix(ready)[6, 6]
rates = np.geomspace(50.0, 2000.0, 200)
plt.figure(figsize=(8, 3), layout="constrained")
radius = {}
discs = ("the disc alone", bare, "-"), ("with its rotor", with_rotor, "--")
for name, inertia, style in discs:
    largest = [np.abs(np.linalg.eigvals(my_sampled_joint(inertia, 8.0, 1.5, 1 / r))).max() for r in rates]
    plt.loglog(rates, largest, style, label=f"{name}, {inertia:.3f} kg m²")
    radius[name] = np.interp(200.0, rates, largest)
plt.axhline(1.0, color="0.5", linewidth=1)
plt.axvline(200.0, color="0.5", linewidth=1, linestyle=":")
plt.xlabel("how often the torque is computed [Hz]")
plt.ylabel("largest |eigenvalue|")
plt.legend(frameon=False)
lk.plotting.show(
    "Joint w2 with a spring of 8 N m/rad and a damper of 1.5 N m s/rad; above 1 it blows up. At 200 Hz: "
    + ", ".join(f"{name} {x:.2f}" for name, x in radius.items())
    + "."
)

# %% [markdown]
# Does the arm agree? Springs and dampers at every joint, at 200 Hz, on the arm without rotors and on the
# one with them. `lk.run` notices when an arm runs away and says where it began.

# %%
kp_report = 8.0 * np.array([1.0, 1.0, 1.5, 1.5, 1.0, 1.0, 1.0])
springs = lk.control.springs(kp_report, [10.0, 10.0, 5.0, 5.0, 4.0, 1.5, 1.5])
for armature in (0.0, 0.05):
    plant = replace(carries_itself, name=f"armature {armature:g}", armature=armature)
    try:
        log = stay(plant, springs, 1.0, q0=ready + 0.02)
        print(f"{plant.name}: it holds,\n  {lk.metrics.summary(log)}")
    except lk.errors.Diverged as error:
        print(f"{plant.name}: {error}".replace("; ", ";\n  "))

# %% [markdown]
# This is why a simulated Baxter needs rotors in its data if springs and dampers like those of the real arm are to
# drive it, although the data sheet has none.

# %% [markdown]
# ## Find the bug
#
# Here are three runs of computed torque that nobody else has: put the name that your instructor gave
# you in place of `"demo"` (notebook 03 introduces it; `"demo"` is public). The arm in these runs is the textbook's, with
# rotors, a little friction and noisy speeds, and the law carries its weight. In each run the law is right at first; then,
# while the arm moves, a version with one mistake replaces it. You know how the right law behaves, because you
# have written it. The suspects:
#
# | | |
# |---|---|
# | a | the error of the speed has the wrong sign |
# | b | gravity is left out |
# | c | gravity is added twice |
# | d | the state is 60 ms old |
# | e | the target is always the last one (index -1) |
# | f | the target's acceleration is left out |
# | g | the errors of the joints w0 and w2 are exchanged |
# | h | the joints' own speed is damped, not the error of the speed |

# %%
HANDLE = "demo"  # in a course: the name that your instructor gave you
_, axes = plt.subplots(1, 3, figsize=(9, 3), sharex=True, layout="constrained")
for number, ax in enumerate(axes, start=1):
    log = lk.my_bug(number, HANDLE)
    off = log.target.position[: len(log)] - log.q
    for k, column in enumerate(off.T):
        ax.plot(log.t, column, ("-", "--", "-.", ":")[k % 4], label=names[k])
    ax.set_title(f"run {number}", loc="left", fontsize="medium")
    ax.set_xlabel("time [s]")
axes[0].set_ylabel("error [rad]")
axes[2].legend(frameon=False, ncols=2, fontsize="small")
lk.plotting.show(f"The errors of the seven joints in three misbehaving runs for the name {HANDLE}.")

# %% [markdown]
# Name what you see. A function does it for any run: `lk.course.commanded(log, "b")` gives, for the states that the run saw, the
# torques of the law with mistake b, shape (N, 7), and `log.command` what was really commanded.

# %% question="diagnose"
def diagnose(log):
    """The letter of the mistake in the law of a run, which enters at some time before 0.8 s."""
    ### BEGIN SOLUTION
    from solutions.torque_control.answers import diagnose as answer

    return answer(log)
    ### END SOLUTION


# %%
my_diagnose = use("diagnose", diagnose, lambda log: "?")
for number in (1, 2, 3):
    print(f"run {number}: {my_diagnose(lk.my_bug(number, HANDLE))}")

# %% [markdown]
# ## Gravity on the real robot, and why nobody could tell
#
# For years teams of this lab fought with gravity. One wrote a formula that came to 3 % of the true weight,
# one to minus 10 %, a third to minus 96 %. The staff multiplied the model's gravity by 0.075, in another year
# by 0.01, "because it seems quite wrong". How could such different answers pass?
#
# Measure gravity. Hold the arm at several poses with springs and dampers, and write down the torques that
# *you* command once it rests. If you have to carry the weight, these torques are $g(q)$, and the factor
# between the two is 1. By least squares it is $\sum \tau g / \sum g^2$, over all joints and poses.

# %% [markdown]
# Here are the same eight poses twice: once with the arm's own compensation suppressed, as Rethink's manual
# explains, and once as Baxter comes out of the box. Both arms have Baxter's friction and noise.

# %%
holding = np.diag(model.mass_matrix(ready))
holding = lk.control.springs(50.0 * holding, 14.0 * holding)


def rest_torques(plant, poses=8, seed=1):
    """What the springs command at rest, and the model's gravity there, shape (poses, 7) each."""
    random = np.random.default_rng(seed)
    tau, g = [], []
    shown = lk.plotting.progress(f"holding {poses} poses, plant {plant.name}", poses)
    with lk.Arm("left", plant, seed) as arm:
        for k, q in enumerate(ready + random.uniform(-0.4, 0.4, (poses, 7))):
            arm.reset(q)
            log = lk.run(arm, lk.Hold(q, 1.2), holding)
            tau.append(log.command[-20:].mean(axis=0))
            g.append(model.gravity(log.q[-1]))
            shown(k + 1)
    return np.array(tau), np.array(g)


suppressed = replace(lk.BAXTER, name="suppressed", gravity_compensation=False)
plt.figure(figsize=(5, 3.6), layout="constrained")
factors = {}
for plant, mark in ((suppressed, "o"), (lk.BAXTER, "x")):
    tau, g = rest_torques(plant)
    factors[plant.name] = np.sum(tau * g) / np.sum(g * g)
    label = f"{plant.name}: factor {factors[plant.name]:+.3f}"
    plt.plot(g.ravel(), tau.ravel(), mark, mfc="none", label=label)
plt.xlabel("the model's gravity [N m]")
plt.ylabel("torque commanded at rest [N m]")
plt.legend(frameon=False)
lk.plotting.show(
    "Torques commanded at rest over the model's gravity, seven joints in eight poses. The factor is "
    + " and ".join(f"{x:+.3f} ({name})" for name, x in factors.items())
    + "."
)

# %% [markdown]
# The right factor on Baxter is 0. It is not 0.075, not 0.01, and not 1, because the arm already carries its
# own weight. Now try the factors that people used, on a circle, on an arm with Baxter's friction.

# %%
tip = model.pose(ready)[:3, 3]
sixteen_centimetres = lk.Circle(tip, tip + [0.0, -0.08, -0.2])
circle = model.joint_trajectory(lk.Trajectory(sixteen_centimetres, lk.Quintic(4.0)), ready)


def drive(plant, controller, target=circle, seed=1):
    with lk.Arm("left", plant, seed, q0=ready) as arm:
        return lk.run(arm, target, controller)


def adds_gravity(factor):
    def controller(state, target):
        return lk.JointTorque(holding(state, target).value + factor * model.gravity(state.q))

    return controller


print("factor   RMS error of the tip")
for factor in (-0.03, 0.0, 0.01, 0.03, 0.075, 0.3, 1.0):
    log = drive(lk.BAXTER, adds_gravity(factor))
    print(f"{factor:6.3f}   {lk.metrics.summary(log).rms_mm:6.1f} mm")

# %% [markdown]
# From -0.03 to 0.03 little changes, because about 1 N m of friction hides an error of about 1 N m at the
# shoulder. Nobody plotted a torque against a model, so wrong and right looked alike. The one factor whose
# effect nobody could overlook, the model's own factor 1, looked worst of all.
#
# ## Gains for a real arm
#
# Now choose gains for a real arm. This one publishes its state 100 times a second, up to 14 ms late, with
# noise; it has friction; and there may be a load in its gripper. It carries its own weight, but not that of
# the load.
#
# Play first. Here both gains are the same for all seven joints, on a slow line. Can you find any pair that
# follows well and does not buzz? Watch the error of the *speed*, because buzzing shows there first.

# %%
slow_line = model.joint_trajectory(
    lk.Trajectory(lk.Line(tip, tip + [0.08, -0.12, 0.08]), lk.Quintic(3.0)), ready
)


def same_gains_everywhere(kp, kd):
    figure, ax = plt.subplots(figsize=(7, 2.6), layout="constrained")
    try:
        log = drive(lk.BAXTER, lk.control.springs(kp, kd), slow_line)
    except lk.errors.Diverged as error:
        log = error.log
    error = 1e3 * np.linalg.norm(lk.metrics.tip_error(log)[:, :3], axis=1)
    ax.plot(log.t, error)
    ax.set_xlabel("time [s]")
    ax.set_ylabel("error [mm]")
    return figure, f"kp = {kp:g} N m/rad, kd = {kd:g} N m s/rad everywhere: {lk.metrics.summary(log)}."


dials = lk.plotting.dials(same_gains_everywhere, kp=(0.0, 200.0, 50.0, "N m/rad"), kd=(0.0, 40.0, 8.0, "N m s/rad"))

# %% [markdown]
# The shoulder needs higher gains, but the wrist cannot bear them. Your gains may differ from joint to joint,
# and the model can tell you how. Then one number remains to be chosen, a frequency. If the frequency is
# too low, friction and load win; if it is too high, the arm reacts to an old state.
#
# The law is the simplest there is, `lk.control.springs(kp, kd)`: springs and dampers, no model. Only the
# gains matter here. They are tried on the slow line, then on quicker paths, with a load, and on an arm that
# is released a tenth of a radian off in every joint: it must come to rest.

# %% question="choose_gains"
def choose_gains(model):
    """Springs and dampers for any path, at any speed, with up to 1 kg in the gripper.

    Args:
        model: lk.Model of a Baxter arm, left or right, with an empty gripper.

    Returns:
        (kp, kd), each shape (7,) or one number, in [N m/rad] and [N m s/rad].
    """
    ### BEGIN SOLUTION
    from solutions.torque_control.answers import choose_gains as answer

    return answer(model)
    ### END SOLUTION


# %% [markdown]
# How good are your gains? The figure shows them, made softer and stiffer by a factor, in the three cases. The
# factor multiplies the frequency: the springs change with its square, the dampers with the factor itself. (If
# your gains are not ready, those of Rethink's own example stand in; they were made to be soft.)

# %%
def rethinks_example(model):
    """The joint springs of Rethink's own example."""
    return np.array([10.0, 15.0, 5.0, 5.0, 3.0, 2.0, 1.5]), 0.1 * np.ones(7)


my_choose_gains = use("choose_gains", choose_gains, rethinks_example)
spring_law = "your springs" if my_choose_gains is choose_gains else "a stand-in, the springs of Rethink's example"

loaded = replace(lk.BAXTER, name="with 1 kg", payload=1.0)
occasions = (
    ("slow line", lk.BAXTER, slow_line),
    ("circle", lk.BAXTER, circle),
    ("circle, 1 kg", loaded, circle),
)
steps = np.array([0.5, 0.75, 1.0, 1.25, 1.6, 2.0])
kp, kd = (np.asarray(gain) for gain in my_choose_gains(model))
plt.figure(figsize=(7, 3.2), layout="constrained")
middle = []
shown = lk.plotting.progress("eighteen runs", len(occasions) * len(steps))
for (name, plant, target), style in zip(occasions, ("-", "--", "-.")):
    errors = []
    for x in steps:
        try:
            log = drive(plant, lk.control.springs(x**2 * kp, x * kd), target)
        except lk.errors.Diverged as error:
            log = error.log
        errors.append(lk.metrics.summary(log).rms_mm)
        shown(len(middle) * len(steps) + len(errors))
    plt.plot(steps, errors, style, marker="o", mfc="none", label=name)
    middle.append(f"{name} {errors[2]:.1f} mm")
plt.axvline(1.0, color="0.5", linewidth=1)
plt.yscale("log")
plt.yticks([3, 5, 10, 20, 50, 100], ["3", "5", "10", "20", "50", "100"])
plt.minorticks_off()
plt.xlabel(f"factor on the frequency of {spring_law}")
plt.ylabel("RMS error [mm]")
plt.legend(frameon=False)
lk.plotting.show(f"The error over the stiffness. With {spring_law}, at factor 1: {', '.join(middle)}.")

# %% [markdown]
# To the left of the lowest point friction and load cause the error; to its right, the old state does. The
# lowest point is not the best choice, because it is close to an edge, and on a quicker path, or with more
# noise, the edge comes sooner. Your gains are marked on such paths. Stay well to the left of the lowest
# point.
#
# Finally, watch the arm move: your springs with a kilogram in the gripper, and beside them computed torque,
# which does not know of that kilogram either.

# %%
ct = with_gains(my_computed_torque, lk.BAXTER, 120.0, 22.0, True)
sprung, computed = drive(loaded, lk.control.springs(kp, kd)), drive(loaded, ct)
print(f"{spring_law}: {lk.metrics.summary(sprung)}")
print(f"{ct.__name__}: {lk.metrics.summary(computed)}")
lk.replay.show(
    lk.replay.motion_of(
        sprung, "A circle with 1 kg in the gripper", label=spring_law, ghosts={ct.__name__: computed}
    )
)

# %% [markdown] why="why_unknown_load"
# How far did you see computed torque sag under half a kilogram, and why? The load pulls with 5 N: say which
# matrix converts it to accelerations, and why "stiff" means something else for kp in 1/s² than for kp in N
# m/rad.
#
# ### BEGIN SOLUTION
# It sagged by 21 mm. The load's torques are J^T F, and computed torque answers with M kp e, so M^-1
# converts torques to accelerations. The stiffness is M kp: with kp = 40 1/s² about 80 N m/rad at the shoulder, only
# 2 to 4 at the wrist. So kp fixes a frequency, not a stiffness. Springs of 40 N m/rad in every joint are
# half as stiff at the shoulder and sag more: 38 mm.
# ### END SOLUTION

# %% [markdown]
# Now pull the arm yourself. Press *Start*, and pull at the arm while it circles: the springs give way. Make
# them softer and stiffer with the dial, which is the factor on their frequency as above; hang the kilogram
# on; take the friction away. Then choose computed torque. (The line of numbers beside or below the picture
# begins with what moves the arm, and says so if it is a stand-in.)

# %%
def pulled(state, target, factor):
    return lk.control.springs(factor**2 * kp, factor * kd)(state, target)


view = lk.live(
    lk.Arm("left", lk.BAXTER, q0=circle(0.0).position), circle, {spring_law: pulled, ct.__name__: ct},
    title="Torque control", factor=(0.3, 2.0, 1.0), payload=(0.0, 1.0), stiction=(0.0, 1.0),
)
view

# %% [markdown]
# ## Hand in
#
# Run everything once more from the top (*Kernel, Restart Kernel and Run All Cells*) and save the file. Then
# run only the last cell once more: it prints a receipt for the saved file; keep it. `!labkit submit-check 04_torque_control.ipynb`
# in a new cell runs a copy of that file and says what is missing. Hand in the file without renaming it, in the way your course asks. The grader runs your
# functions on further cases; the text above each stub says what kind of cases.

# %% setup=true
lk.hand_in("04_torque_control")
