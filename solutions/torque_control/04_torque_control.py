# %% [markdown]
# # 04 · Torque control
#
# Until now you commanded how fast the motors turn, and they found the torque. Here you compute the torque. That
# is more work, but you decide how the arm reacts, joint by joint, when it is off its target.
#
# | | |
# |---|---|
# | **You need** | matrices; a damped spring, ë + kd ė + kp e = 0 |
# | **Given** | the arm's model: M, C and g (02 builds them, here you only use them) |
# | **You write** | a mended torque law, another one, gains for a real arm, a finder of bugs |
# | **Time** | core 3 hours, 18 points; all 3.8 hours, 22 points. After 3 hours, stop writing and read the rest. |

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
# For the seven joint angles $q$ Newton's law reads $M(q)\,\ddot q + C(q, \dot q)\,\dot q + g(q) = \tau$: inertia, a matrix,
# because turning one joint shakes the others; Coriolis torques; and the torque that holds the arm still.

# %%
model = lk.Model("left", lk.BAXTER)
ready = model.robot.ready
names = [name.removeprefix("left_") for name in model.robot.joint_names]

print("joint              ", "  ".join(f"{name:>6}" for name in names))
print("inertia, [kg m²]   ", "  ".join(f"{x:6.3f}" for x in np.diag(model.mass_matrix(ready))))
print("weight, [N m]      ", "  ".join(f"{x:6.2f}" for x in model.gravity(ready) + 0.0))
print("torque limit, [N m]", "  ".join(f"{x:6.0f}" for x in model.robot.effort))

# %% [markdown]
# `s1` needs 36 of its 100 N m only to hold the arm up, and `w2` has a fortieth of the shoulder's inertia: the same
# torque is a nudge here and a kick there.
#
# ## Who carries the weight?
#
# The textbook's arm leaves its weight to your torques. Baxter carries itself: a separate channel adds $g(q)$ to every
# command. Release both with no torque at all.

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
# So a law must know which arm it runs on: that is `arm_compensates`.
#
# ## Find and mend: equation 18
#
# The *augmented PD* law has a spring and a damper at each joint, and the torque that the target's motion takes.
# This is *our reading* of the report's equation 18, with our sign, $e = q_d - q$, and with the gravity that the team
# wrote. **Some terms are right. Change what is wrong, nothing else.**

# %%
def equation_18(state, target, model, *, kp, kd, arm_compensates):
    """The report's joint torque controller."""
    M, J = model.mass_matrix(state.q), model.tip_jacobian(state.q)
    a = M @ target.acceleration
    b = model.coriolis(state.q, state.dq) @ state.dq
    c = kp * (target.position - state.q) + kd * (target.velocity - state.dq)
    d = M @ J.T @ [0.0, 0.0, 0.981, 0.0, 0.0, 0.0]
    return lk.JointTorque(a + b + c + d)


# %% [markdown]
# Three runs on each arm: **H**, held, started beside the target; **P**, on a path; **F**, a quick dash, from beside.

# %%
KP, KD = 80.0, 12.0  # the same in every joint: enough to see what a law does, and no more
beside = 0.05 * np.array([1, -1, 1, 1, -1, 1, -1])
reach = lk.Line(ready, ready + [0.5, 0.2, 0.0, -0.4, 0.3, 0.2, 0.4])
THREE = {
    "H": (lk.Hold(ready, 2.0), ready + beside),
    "P": (lk.Trajectory(reach, lk.Quintic(2.0)), ready),
    "F": (lk.Trajectory(reach, lk.Quintic(0.7)), ready + beside),
}


def with_gains(law, plant, kp, kd, arm_compensates):
    """A controller for `lk.run`: the law with its numbers filled in."""
    known = lk.Model("left", plant)

    def controller(state, target):
        return law(state, target, known, kp=kp, kd=kd, arm_compensates=arm_compensates)

    controller.__name__ = law.__name__
    return controller


def three_runs(law):
    """The tip's height above its target in six runs."""
    figure, axes = plt.subplots(1, 3, figsize=(9, 2.8), sharey=True, layout="constrained")
    says = []
    for ax, (name, (target, q0)) in zip(axes, THREE.items()):
        for plant, style in ((textbook, "-"), (carries_itself, "--")):
            flag = plant.gravity_compensation
            with lk.Arm("left", plant, q0=q0) as arm:
                log = lk.run(arm, target, with_gains(law, plant, KP, KD, flag))
            z = -1e3 * lk.metrics.tip_error(log)[:, 2]
            ax.plot(log.t, z, style, label=plant.name)
            says.append(f"{name}, {plant.name}: {z[-1]:+.0f} mm")
        ax.set_title(name, loc="left", fontsize="medium")
        ax.set_xlabel("time [s]")
    axes[0].set_ylabel("height above the target [mm]")
    axes[0].legend(frameon=False)
    lk.plotting.show(f"{law.__name__}: the tip's height at the end. {'; '.join(says)}.")


three_runs(equation_18)

# %% [markdown]
# A run cannot find every error. If one hides, take paper: with the energy $V = \tfrac12\dot e^T M\dot e + \tfrac12 e^T K_p e$
# and $\dot M = C + C^T$, what must vanish in $\dot V$? (Murray, Li and Sastry, proposition 4.10.)

# %% question="augmented_pd"
def augmented_pd(state, target, model, *, kp, kd, arm_compensates):
    """Equation 18, mended: an lk.JointTorque.

    Args:
        state, target: lk.State(t, q, dq); lk.Sample(position, velocity, acceleration).
        model: lk.Model, with mass_matrix(q), coriolis(q, dq) of shape (7, 7), and gravity(q).
        kp, kd: In [N m/rad] and [N m s/rad], shape (7,) or one number.
        arm_compensates: Whether the arm carries its own weight.
    """
    ### BEGIN SOLUTION
    from solutions.torque_control.answers import augmented_pd as answer

    return answer(state, target, model, kp=kp, kd=kd, arm_compensates=arm_compensates)
    ### END SOLUTION


# %% question="what_shows"
def what_shows(term):
    """Replace the question marks in this line and use it:"""
    # return {"a": "-", "b": "?", "c": "?", "d": "?"}[term]
    ### BEGIN SOLUTION
    from solutions.torque_control.answers import what_shows as answer

    return answer(term)
    ### END SOLUTION


# %%
def position_mode(state, target, model, *, kp, kd, arm_compensates):
    """The stand-in: Baxter's position mode, which holds any place."""
    return lk.JointPosition(target.position)


position_mode.__name__ = "a stand-in, position mode"
my_augmented_pd = use("augmented_pd", augmented_pd, position_mode)
three_runs(my_augmented_pd)

# %% [markdown]
# ## Every joint the same
#
# With springs at the joints each joint swings at its own frequency, and they shake each other through $M$.
# *Computed torque* first asks for an acceleration: $\ddot q = \ddot q_d + K_d\,\dot e + K_p\,e$ would give $\ddot e + K_d\,\dot e +
# K_p\,e = 0$, a damped spring in each joint, free of the others, whatever the pose. The equation of motion then
# gives the torque. The gains are inside $M$ now: their units are 1/s² and 1/s.

# %% question="computed_torque"
def computed_torque(state, target, model, *, kp, kd, arm_compensates):
    """Computed torque: an lk.JointTorque; kp in [1/s^2], kd in [1/s], the rest as above."""
    ### BEGIN SOLUTION
    from solutions.torque_control.answers import computed_torque as answer

    return answer(state, target, model, kp=kp, kd=kd, arm_compensates=arm_compensates)
    ### END SOLUTION


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
# What you should have seen: seven equal curves. That is what the model gives you, and it lasts as long as the
# model is right.

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
# ## Find the bug
#
# Three runs of computed torque. The law is right at first; then, while the arm moves, a version with one mistake
# replaces it. The suspects:
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
# The trap is the time before the mistake enters.

# %% question="find_bug"
def find_bug(log):
    """The letter of the mistake.

    Args:
        log: The run, with t of shape (N,), q, dq and command of shape (N, 7).
    """
    ### BEGIN SOLUTION
    from solutions.torque_control.answers import find_bug as answer

    return answer(log)
    ### END SOLUTION


# %%
my_find_bug = use("find_bug", find_bug, lambda log: "?")
print("My three runs:", ", ".join(my_find_bug(lk.my_bug(number, HANDLE)) for number in (1, 2, 3)))

# %% [markdown]
# ## Gravity on the real robot, and why nobody could tell
#
# For years teams of this lab fought with gravity: one had 3 % of the weight, one minus 10 %, one minus 96 %; the
# staff multiplied it by 0.075, "because it seems quite wrong". On Baxter the right factor is 0. Some factors on a
# circle, with friction:

# %%
holding = np.diag(model.mass_matrix(ready))
holding = lk.control.springs(50.0 * holding, 14.0 * holding)
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
# What you should have seen: from -0.03 to 0.03 little changes, because 1 N m of friction hides 1 N m of error. Nobody
# plotted a torque against a model, so wrong and right looked alike.
#
# ## Gains for a real arm
#
# This arm publishes its state 100 times a second, up to 14 ms late, with noise; it has friction, and there may be a
# load. Play first, with the same gains in all joints: does any pair follow well and not buzz?

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
# The shoulder needs higher gains, and the wrist cannot bear them. A frequency means more than a gain: compare $m\,\ddot e
# + k_d\,\dot e + k_p\,e = 0$ with $\ddot e + 2\zeta\omega\,\dot e + \omega^2 e = 0$. Too low, and friction and load win; too high, and
# the arm reacts to an old state.

# %% question="choose_gains"
def choose_gains(model):
    """(kp, kd), shape (7,) each, in [N m/rad] and [N m s/rad], for an lk.Model of any rotors."""
    ### BEGIN SOLUTION
    from solutions.torque_control.answers import choose_gains as answer

    return answer(model)
    ### END SOLUTION


# %% [markdown]
# Your gains, made softer and stiffer by a factor on the frequency, in three cases:

# %%
def rethinks_example(model):
    """The joint springs of Rethink's own example."""
    return np.array([10.0, 15.0, 5.0, 5.0, 3.0, 2.0, 1.5]), 0.1 * np.ones(7)


my_choose_gains = use("choose_gains", choose_gains, rethinks_example)
spring_law = "a stand-in, the springs of Rethink's example" if my_choose_gains is rethinks_example else "your springs"

loaded = replace(lk.BAXTER, name="with 1 kg", payload=1.0)
occasions = (
    ("slow line", lk.BAXTER, slow_line),
    ("circle", lk.BAXTER, circle),
    ("circle, 1 kg", loaded, circle),
)
steps = np.array([0.5, 1.0, 1.5, 2.0])
kp, kd = (np.asarray(gain) for gain in my_choose_gains(model))
plt.figure(figsize=(7, 3.2), layout="constrained")
middle = []
for (name, plant, target), style in zip(occasions, ("-", "--", "-.")):
    errors = []
    for x in steps:
        try:
            log = drive(plant, lk.control.springs(x**2 * kp, x * kd), target)
        except lk.errors.Diverged as error:
            log = error.log
        errors.append(lk.metrics.summary(log).rms_mm)
    plt.plot(steps, errors, style, marker="o", mfc="none", label=name)
    middle.append(f"{name} {errors[1]:.1f} mm")
plt.axvline(1.0, color="0.5", linewidth=1)
plt.yscale("log")
plt.yticks([3, 5, 10, 20, 50, 100], ["3", "5", "10", "20", "50", "100"])
plt.minorticks_off()
plt.xlabel(f"factor on the frequency of {spring_law}")
plt.ylabel("RMS error [mm]")
plt.legend(frameon=False)
lk.plotting.show(f"The error over the stiffness. With {spring_law}, at factor 1: {', '.join(middle)}.")

# %% [markdown]
# To the left of the lowest point friction and load cause the error, to its right the old state. The lowest point is
# close to an edge: on a quicker path the edge comes sooner. Now watch: your springs with a kilogram in the gripper,
# and computed torque, which does not know of it either.

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
# Pull the arm while it circles: press *Start*. Make the springs softer and stiffer, hang the kilogram on, take the
# friction away. Then choose computed torque.

# %%
def pulled(state, target, factor):
    return lk.control.springs(factor**2 * kp, factor * kd)(state, target)


view = lk.live(
    lk.Arm("left", lk.BAXTER, q0=circle(0.0).position), circle, {spring_law: pulled, ct.__name__: ct},
    title="Torque control", factor=(0.3, 2.0, 1.0), payload=(0.0, 1.0), stiction=(0.0, 1.0),
)
view

# %% [markdown]
# ## Appendix: the torque is constant between two ticks
#
# A computer reads the state and computes a torque, and the motor keeps it until the next reading, 5 ms at 200 Hz. For
# a light joint that can be too long: the torque that should stop it drives it past the target. During one step the
# acceleration of a single joint is constant, so you can compute exactly where it will be (target zero):
#
# $$ \begin{pmatrix} q \\ \dot q \end{pmatrix}_{k+1} = A \begin{pmatrix} q \\ \dot q \end{pmatrix}_{k},
# \qquad \tau_k = -k_p\,q_k - k_d\,\dot q_k . $$
#
# If all eigenvalues of $A$ are inside the unit circle, the error decays in the end.

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
# The report had 8 N m/rad and 1.5 N m s/rad at `w2`. In Baxter's published data this joint has 0.001 kg m²: the motor's
# rotor is left out, which turns many times faster than the joint. We assume 0.05 kg m². Which of the two must it be?

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
# So a simulated Baxter needs rotors in its data, although the data sheet has none.

# %% [markdown]
# ## Hand in
#
# *Kernel, Restart Kernel and Run All Cells*, save, then run only the last cell once more: it prints a receipt.

# %% setup=true
lk.hand_in("04_torque_control")
