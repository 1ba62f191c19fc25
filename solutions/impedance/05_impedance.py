# %% [markdown]
# # 05 · Impedance
#
# Push a robot arm aside. A stiff arm does not give way, and it can hurt you. A limp arm falls. You would like
# an arm that gives way as a spring does: it moves a little when you push a little, and comes back when you
# let go. How an arm gives way is its *impedance*, and you are going to choose it.
#
# | | |
# |---|---|
# | **You need** | Newton's law for one mass on a spring; matrices and their inverses |
# | **Given** | the arm's model, an arm that can be pushed, a wall and a spring to meet |
# | **You write** | the inertia at the tip, two impedance laws; what your own arm carries |
# | **Time** | core about 3 hours, all about 4 hours; 18 points |
#
# Questions marked *core* are for everybody. Those marked *extension* take the rest of the time: they earn points
# too, but no later question depends on them.
#
# The team whose report this lab grew out of wrote two impedance controllers, found them "a bit off", and
# saw no use in them. They never pushed the arm. Here you will.
#
# Every cell below runs from the start, solved or not. If your part is missing, a stand-in replaces it and
# says so. After each stub a check tells you in words what it found. The functions, your prediction and the
# number to find out are marked; play with everything else as you like. Running all
# cells takes about half a minute on an idle computer, and minutes on a busy one; the cell that is at work shows
# `[*]`.

# %% setup=true
from dataclasses import replace

import labkit as lk
from labkit.course import check, predict, use

lk.ready()

# %% setup=true
import matplotlib.pyplot as plt
import numpy as np

# %% [markdown]
# ## One mass on a spring
#
# Everything in this notebook comes from one picture: a mass $m$ is tied to its *target* $x_d$ by a spring $k$
# and a damper $b$, and a hand pushes it with a force $F$. The target itself may move. As everywhere in this
# course the error is target minus actual, $e = x_d - x$. If nobody pushes and there is no error, the mass
# moves exactly as its target does:
#
# $$ m\,\ddot x = m\,\ddot x_d + b\,\dot e + k\,e + F . $$
#
# Push with 10 N for a second, then let go; here the target rests at 0. What determines how far the mass goes? What
# determines how it starts, and how it comes back?

# %%
def push_and_release(m, b, k):
    dt = 0.002
    t = np.arange(0.0, 2.5, dt)
    x, dx, way = 0.0, 0.0, []
    for now in t:
        way.append(1e3 * x)
        dx += dt * ((10.0 if now < 1.0 else 0.0) - b * dx - k * x) / m
        x += dt * dx
    figure, ax = plt.subplots(figsize=(7, 2.6), layout="constrained")
    ax.plot(t, way)
    ax.axvspan(0.0, 1.0, color="0.9")
    ax.axhline(1e4 / k, color="0.5", linestyle="--", linewidth=1)
    ax.set_xlabel("time [s]")
    ax.set_ylabel("displacement [mm]")
    return figure, (
        f"m = {m:.1f} kg, b = {b:.0f} N s/m, k = {k:.0f} N/m: under a push of 10 N (grey) the mass goes "
        f"{max(way):.0f} mm at most and is {way[499]:.0f} mm away after one second; "
        f"10 N / k would be {1e4 / k:.0f} mm (dashed)."
    )


dials = lk.plotting.dials(
    push_and_release, m=(0.5, 10.0, 1.0, "kg"), b=(1.0, 80.0, 20.0, "N s/m"), k=(50.0, 1000.0, 300.0, "N/m")
)

# %% [markdown]
# You can feel each of the three numbers: the *stiffness* while you hold the mass away from its target, the
# *inertia* at the very first moment, and the *damping* when the swinging stops.
#
# ## How heavy is the tip?
#
# No data sheet gives the mass of the arm's tip. Its seven joints move when you push it, each with its own
# inertia and lever, so how heavy the tip feels depends on the pose and on the direction. Follow a push
# through the arm: the wrench $F$ at the tip gives joint torques $J^T F$; with the motors off and the arm at
# rest these give the joint accelerations; and those move the tip. The result is
#
# $$ F = \Lambda(q)\,\ddot x , $$
#
# and $\Lambda$ is called the *operational-space inertia* (Khatib 1987). Here $J$ is the tip Jacobian in
# world axes, with the six rows (velocity, angular velocity).

# %% question="operational_inertia"
def operational_inertia(M, J):
    """The inertia that a hand feels at the tip of an arm.

    Args:
        M: Mass matrix, shape (n, n) in [kg m^2].
        J: Jacobian, shape (6, n), or its first three rows, (3, n).

    Returns:
        Shape (6, 6), or (3, 3).
    """
    ### BEGIN SOLUTION
    from solutions.impedance.answers import operational_inertia as answer

    return answer(M, J)
    ### END SOLUTION


# %% [markdown]
# Now measure it. The arm carries its own weight, its motors do nothing else, and a force of 5 N taps its tip
# for a hundredth of a second.

# %%
plant = lk.Plant(name="textbook", armature=0.05, viscous=0.7)
model = lk.Model("left", plant)
ready = model.robot.ready
T_ready = model.pose(ready)
rate = 200.0


def given_inertia(M, J):
    return model.operational_inertia(ready)


my_operational_inertia = use("operational_inertia", operational_inertia, given_inertia)

inertia = my_operational_inertia(model.mass_matrix(ready), model.tip_jacobian(ready))
felt = 1.0 / np.diag(np.linalg.inv(inertia))
floating = replace(plant, name="floating", gravity_compensation=True)


def no_torque(state, target):
    return lk.JointTorque(np.zeros(7))


print("tapped along   predicted   felt")
for axis, name in enumerate("xyz"):
    world = lk.World(things=[lk.Push(5.0 * np.eye(3)[axis])])
    with lk.Arm("left", floating, q0=ready, world=world) as arm:
        log = lk.run(arm, lk.Hold(ready, 0.01), no_torque, rate=1000)
    speed = (model.tip_jacobian(log.q[-1])[:3] @ log.dq[-1])[axis]
    print(f"      {name}        {felt[axis]:5.2f} kg   {5.0 * log.t[-1] / speed:5.2f} kg")

# %% [markdown]
# Along x and y the tip feels like less than 1 kg; up and down it feels like 6 kg. And all this in one pose.
#
# ## Springs at the tip
#
# Now give the tip the springs of your choice, and let it keep its inertia $\Lambda$. The wanted behaviour is
# that of the one mass, in six directions at once:
#
# $$ \Lambda\,\ddot e + D\,\dot e + K\,e = -F_{ext} . $$
#
# $e$ holds the position error and the rotation from the tip to the target, in world axes:
# `lk.se3.pose_error(target.pose, model.pose(q))`. $F_{ext}$ is the wrench of the hand on the arm. The rate of
# the error is $\dot e = V_d - J\dot q$; for the rotation this is an approximation, good while the hand is
# turned only a little. Use one rotational stiffness for all three axes: with unequal ones $K\,e$ is not the
# slope of an energy, and a hand that is led round can gain work. Combine the joints' equation of motion with this one, and see what the motors have to
# do. Keep two things in mind:
#
# - The tip's acceleration is $J\ddot q + \dot J\dot q$. The term $\dot J\dot q$ is there even when $\ddot q = 0$, so
#   the motors have to produce only the remaining acceleration, $\ddot x - \dot J\dot q$.
# - A force $F$ at the tip takes the joint torques $J^T F$. No inverse, no pseudo-inverse.
#
# There are seven joints and six springs, so nothing holds or damps the elbow. Here friction brakes the elbow.
# Do not rely on friction elsewhere: add a damper that the tip does not feel, as everybody does who builds
# such arms. For torques this takes the projector $I - J^T\bar J^T$ with $\bar J = M^{-1}J^T\Lambda$; the $I - J^+J$ of
# speeds would shake the tip. You may do so here too, because many torques move the tip in the same manner, and
# the check looks only at the tip.
#
# No force is measured. Many texts, the report among them, claim that "impedance needs a force sensor". It
# does not, as long as the arm keeps its own inertia.

# %% question="workspace_impedance"
def workspace_impedance(state, target, model, *, stiffness, damping):
    """Springs and dampers between the tip and its target, with the inertia that the tip has.

    Args:
        state: lk.State(t, q, dq), angles in [rad] and speeds in [rad/s], shape (7,) each.
        target: lk.PoseSample(pose, twist, dtwist): T_wd, shape (4, 4), the twist (v, w) and its
            rate, shape (6,) each, world axes.
        model: lk.Model, with pose(q), tip_jacobian(q), tip_jacobian_rate(q, dq),
            operational_inertia(q), coriolis(q, dq) of shape (7, 7), and gravity(q).
        stiffness: K of x, y, z and the three rotations, shape (6,), in [N/m] and [N m/rad].
        damping: D, shape (6,), in [N s/m] and [N m s/rad].

    Returns:
        lk.JointTorque of shape (7,) in [N m], the arm's weight included.
    """
    ### BEGIN SOLUTION
    from solutions.impedance.answers import workspace_impedance as answer

    return answer(state, target, model, stiffness=stiffness, damping=damping)
    ### END SOLUTION


# %% [markdown]
# ## A push
#
# The arm holds still, and a force of 10 N pushes its tip to the side for two seconds. Baxter's position mode,
# as stiff as its motors allow, runs beside your law. The damping is critical for the masses that you
# just measured, $d_i = 2\sqrt{k_i m_i}$. (If your law is not ready, springs in the *joints* stand in. They
# give way too, but not as you asked.)

# %%
JOINT_K = np.array([400.0, 400.0, 200.0, 200.0, 40.0, 40.0, 20.0])
JOINT_D = np.array([60.0, 60.0, 28.0, 28.0, 6.0, 6.0, 3.0])
joint_springs = lk.control.springs(JOINT_K, JOINT_D)


def springs_in_the_joints(state, target, model, *, stiffness, damping):
    q_d = model.inverse_kinematics(target.pose, ready)
    pull = joint_springs(state, lk.Sample(q_d, np.zeros(7), np.zeros(7)))
    return lk.JointTorque(pull.value + model.gravity(state.q))


my_workspace_impedance = use("workspace_impedance", workspace_impedance, springs_in_the_joints)
yours = my_workspace_impedance is workspace_impedance
your_law = "your impedance" if yours else "a stand-in with springs in the joints"

K = np.array([300.0, 300.0, 300.0, 20.0, 20.0, 20.0])


def compliant(K, law=my_workspace_impedance):
    """A controller for `lk.run`: the law with stiffness K, critically damped."""
    D = 2.0 * np.sqrt(K * felt)

    def compliant(state, target):
        return law(state, target, model, stiffness=K, damping=D)

    compliant.__name__ = your_law if law is my_workspace_impedance else law.__name__
    return compliant


def stiff(state, target):
    """Baxter's position mode."""
    return lk.JointPosition(model.inverse_kinematics(target.pose, ready))


def meet(controller, target, *things, on=plant):
    """Let a controller meet things in the world; returns the log."""
    with lk.Arm("left", on, q0=ready, world=lk.World(things=things)) as arm:
        return lk.run(arm, target, controller, rate)


def displacement(log):
    """Actual minus target position of the tip, shape (N, 3) in [mm]."""
    return -1e3 * lk.metrics.tip_error(log)[:, :3]


stay = lk.Hold(T_ready, 3.5)
sideways = lk.Push((0.0, 10.0, 0.0), duration=2.0)
try:
    yielding = meet(compliant(K), stay, sideways)
except lk.errors.Diverged as error:  # with anyway=True
    print(f"{error}, and is shown here")
    yielding = error.log
pushed = {your_law: yielding, "position mode": meet(stiff, stay, sideways)}

plt.figure(figsize=(8, 3), layout="constrained")
plt.axvspan(0.0, 2.0, color="0.92")
for (name, log), style in zip(pushed.items(), ("-", "--")):
    plt.plot(log.t, displacement(log)[:, 1], style, label=name)
plt.axhline(1e3 * 10.0 / K[1], color="0.5", linestyle=":", label="10 N / K")
plt.xlabel("time [s]")
plt.ylabel("displacement along y [mm]")
plt.legend(frameon=False)


def after_two_seconds(log):
    """The displacement along y in words, if the run lasted so long."""
    if log.t[-1] < 1.99:
        return f"stopped at {log.t[-1]:.2f} s"
    x, y, z = (np.interp(1.99, log.t, one) for one in displacement(log).T)
    far = f", and {np.hypot(x, z):.0f} mm to the side" if np.hypot(x, z) > 100.0 else ""
    return f"{y:.1f} mm{far}"


lk.plotting.show(
    "The tip under a push of 10 N along y (grey). Displacement after 2 s: "
    + ", ".join(f"{after_two_seconds(log)} ({name})" for name, log in pushed.items())
    + f"; 10 N / K is {1e4 / K[1]:.1f} mm."
)

# %% [markdown]
# Here are the same runs as arms: the impedance gives way, the ghost does not move.

# %%
lk.replay.show(
    lk.replay.motion_of(
        yielding,
        "A push of 10 N",
        ghosts={"position mode": pushed["position mode"]},
        force=True,
    )
)

# %% [markdown]
# ## A wall
#
# The arm does not know that there is a wall, and its target is 3 cm behind the wall. The position mode pushes
# with all the force of its motors. An impedance presses with a force that you can predict. Two springs are in
# a row: the one that you command, and the wall together with the finger's rubber tip. The same force presses
# both, and what they give way adds up to the 3 cm.

# %% predict="wall_force"

# %%
from labkit.scene import TIP_RADIUS, contact_stiffness

gap, beyond = 0.05, 0.03
tip = T_ready[:3, 3]
wall = lk.Wall(tip + [gap + TIP_RADIUS, 0.0, 0.0], (-1.0, 0.0, 0.0), size=(0.3, 0.3))


def forwards(way, duration=2.0):
    """The tip goes a distance along x or y and stays there; a target of poses."""
    path = lk.PosePath(lk.Line(tip, tip + way), T_ready[:3, :3])
    there = lk.se3.pose(T_ready[:3, :3], tip + way)
    return lk.Chain([lk.Trajectory(path, lk.Quintic(duration)), lk.Hold(there, 1.0)])


into_the_wall = forwards([gap + beyond, 0.0, 0.0])


def pressed(log):
    """The force of the wall on the arm, as its joints feel it, shape (N,) in [N]."""
    return -lk.metrics.felt_wrench(log)[:, 0]


def press(stiffness):
    figure, ax = plt.subplots(figsize=(7, 2.6), layout="constrained")
    log = meet(compliant(np.array([stiffness] * 3 + [20.0] * 3)), into_the_wall, wall)
    force = beyond / (1.0 / stiffness + 1.0 / contact_stiffness(wall))
    ax.plot(log.t, pressed(log), label="felt")
    ax.axhline(force, color="0.5", linestyle="--", label="springs in a row")
    ax.set_xlabel("time [s]")
    ax.set_ylabel("force on the wall [N]")
    ax.legend(frameon=False)
    last = pressed(log)[-20:].mean()
    who = "the tip" if yours else "a stand-in, which does not know K,"
    does = f"presses with {last:.1f} N" if last > 0.0 else "does not rest on the wall"
    return figure, f"With K = {stiffness:.0f} N/m {who} {does}; {force:.1f} N is expected."


if wall_force is not None:  # first comes your prediction
    lk.plotting.dials(press, stiffness=(100.0, 1000.0, 300.0, "N/m"))

rammed = meet(stiff, into_the_wall, wall)

# %%
met = meet(compliant(K), into_the_wall, wall)
felt_at_rest = float(pressed(met)[-20:].mean())
if yours:
    predict("wall_force", truth=round(felt_at_rest, 1))
else:
    print("This is a stand-in: the truth is shown here once your law is right.")
if wall_force is not None:
    print(f"The position mode presses with {np.max(pressed(rammed)):.0f} N.")
into = lk.replay.motion_of(
    met, "Into the wall", ghosts={"position mode": rammed}, force=True, things=[wall]
)
lk.replay.show(into) if wall_force is not None else None

# %% [markdown]
# Two springs in a row that give way by $\delta$ together press with $F = \delta/(1/K + 1/k_{wall})$, where $k_{wall}$
# is the stiffness of the wall and the finger's tip together. While it is much larger than $K$, you decide the force.

# %% [markdown]
# ## A spring
#
# Tie the tip to its starting place with a rubber band of 200 N/m and send it 10 cm away. Two springs pull at
# it, and it ends where their forces balance. Which of the two controllers "tracks better"? Which one would
# you rather be near?

# %%
band = lk.Spring(tip, 200.0)
away = forwards([0.0, 0.10, 0.0])
print(f"{'':{len(your_law)}s}    gets to   pulls with")
for name, controller in ((your_law, compliant(K)), ("position mode", stiff)):
    log = meet(controller, away, band)
    there = lk.metrics.tip_poses(log)[-1][:3, 3] - tip
    pull = -lk.metrics.felt_wrench(log)[-20:, 1].mean()
    print(f"{name:{len(your_law)}s}  {1e3 * there[1]:6.1f} mm  {pull:8.1f} N")
print(f"K / (K + 200) of the way would be {1e2 * K[1] / (K[1] + 200.0):.1f} mm.")

# %% [markdown]
# ## What is the stiffness really?
#
# You asked for 300 N/m. Do you get it? Never trust a label: measure. Push the resting tip in ten directions,
# read each force from a spring balance (accurate to about 0.2 N), wait, and write down where the tip went. A
# linear fit to those numbers gives the *apparent* stiffness. It is a matrix, because a push along x may also
# move the tip along y.

# %% [markdown]
# There are 300 g in the gripper, and the model does not know of them. So the tip sags a little before anyone
# pushes. The same pushes are made on springs in the *joints*, for comparison with your law.

# %%
def ten_pushes(controller, newtons=8.0, seed=5):
    """Force and displacement at rest, shape (10, 3) each, in [N] and [m]."""
    random = np.random.default_rng(seed)
    directions = np.vstack([np.eye(3), -np.eye(3), random.standard_normal((4, 3))])
    force, gone = [], []
    shown = lk.plotting.progress("ten pushes", 10)
    for k, way in enumerate(directions):
        F = newtons * way / np.linalg.norm(way)
        log = meet(controller, lk.Hold(T_ready, 1.6), lk.Push(F), on=replace(plant, payload=0.3))
        force.append(F + 0.2 * random.standard_normal(3))
        gone.append(displacement(log)[-1] / 1e3)
        shown(k + 1)
    return np.array(force), np.array(gone)


def stiffness_of(force, displacement):
    """K of force = K @ displacement + offset by least squares, shape (3, 3) in [N/m]."""
    F, x = force - force.mean(axis=0), displacement - displacement.mean(axis=0)
    return np.linalg.lstsq(x, F, rcond=None)[0].T


def in_the_joints(state, target):
    return springs_in_the_joints(state, target, model, stiffness=None, damping=None)


measured = {
    your_law: stiffness_of(*ten_pushes(compliant(K))),
    "springs in the joints": stiffness_of(*ten_pushes(in_the_joints)),
}
for name, matrix in measured.items():
    print(f"{name}, [N/m]")
    print(np.array2string(matrix, precision=0, suppress_small=True))

# %% [markdown]
# ## Joint impedance, and an old acquaintance
#
# Springs in the joints are an impedance too, one for each joint. Written out with the joints' own inertia,
# $M_d = M$, the law is
#
# $$ \tau = M\,\ddot q_d + C\,\dot q_d + g + D\,\dot e + K\,e , \qquad e = q_d - q , $$
#
# and that is, letter by letter, the augmented PD law of torque control (notebook 04). The report counts the
# two as different controllers and wonders why one is worse than the other. They are one law with two sets of
# gains: high gains for an arm that tracks well, low gains for an arm that gives way.
#
# The Jacobian says how joint springs feel at the tip: a force at the tip turns the joints by $K_q^{-1}J^T F$,
# and that moves the tip by $J K_q^{-1} J^T F$. Let us see whether the measured matrix agrees, and how the two
# kinds of springs differ: each curve below shows where pushes of 10 N from all sides, in the vertical plane
# of x and z, would move the tip.

# %%
J = model.tip_jacobian(ready)[:3]
predicted = np.linalg.inv(J @ np.diag(1.0 / JOINT_K) @ J.T)
angle = np.linspace(0.0, 2.0 * np.pi, 200)
pushes = 10.0 * np.column_stack([np.cos(angle), 0.0 * angle, np.sin(angle)])
at_tip, in_joints = measured.values()
curves = (
    ("springs at the tip: asked for", np.diag(K[:3]), {"color": "0.8", "linewidth": 5}),
    (f"measured: {your_law}", at_tip, {"color": "C0"}),
    ("springs in the joints: by the Jacobian", predicted, {"color": "0.8", "linewidth": 5}),
    ("measured: springs in the joints", in_joints, {"color": "C1", "linestyle": "--"}),
)
plt.figure(figsize=(7.5, 3.6), layout="constrained")
for name, matrix, look in curves:
    gone = 1e3 * np.linalg.solve(matrix, pushes.T)
    plt.plot(gone[0], gone[2], label=name, **look)
plt.axis("equal")
plt.xlabel("x [mm]")
plt.ylabel("z [mm]")
plt.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def apart(one, other):
    """How much two compliances differ, in percent of the largest entry."""
    one, other = np.linalg.inv(one), np.linalg.inv(other)
    return 1e2 * np.abs(one - other).max() / np.abs(other).max()


lk.plotting.show(
    "Where pushes of 10 N move the tip. Expected, in grey: a circle for springs at the tip, a "
    "slanted ellipse for springs in the joints. What was measured differs from that by "
    f"{apart(at_tip, np.diag(K[:3])):.0f} % for {your_law} and by "
    f"{apart(in_joints, predicted):.0f} % for springs in the joints."
)

# %% [markdown]
# If the springs are in the joints, the pose decides how soft the arm is, and in which direction. If the
# springs are at the tip, you decide. That is the purpose of workspace impedance.

# %% [markdown]
# ## Your own arm: what does it carry?
#
# Your own arm carries something. (Open the arm with the name that your instructor gave you, as in notebook 03;
# `"demo"` is a public arm to practise on.) Find out how heavy it is with an experiment of your own; the cell below is
# only a beginning. The torque sensors were set to zero with the load in the gripper, so they do not feel it. There is
# a wall somewhere in front of the arm, and its force would spoil the result: do not let the tip move more than 3 cm
# forwards from the ready pose.

# %%
HANDLE = "demo"  # in a course: the name that your instructor gave you
mine = lk.my_arm(HANDLE)
holding = np.diag(mine.model.mass_matrix(ready))
holding = lk.control.springs(50.0 * holding, 14.0 * holding)

resting = lk.run(mine, lk.Hold(ready, 1.0), holding)
names = [name.removeprefix("left_") for name in mine.robot.joint_names]
print("commanded at rest [N m]:", ", ".join(
    f"{name} {x:+.2f}" for name, x in zip(names, resting.command[-20:].mean(axis=0))
))
one_kilogram = mine.model.tip_jacobian(ready)[:3].T @ [0.0, 0.0, 9.81]
print("one kilogram takes [N m]:", ", ".join(f"{name} {x:+.2f}" for name, x in zip(names, one_kilogram)))

# %% find_out="my_payload"

# %% [markdown]
# ## Another inertia
#
# So far the tip has kept its inertia $\Lambda$. It can also behave as if it had another one, $M_d$:
#
# $$ M_d\,\ddot e + D\,\dot e + K\,e = -F_{ext} . $$
#
# For that the motors must help the hand, or resist it, so they must know how hard it pushes. Now, and only
# now, the wrench $F_{ext}$ must be measured. Baxter can do this: its joints measure the external torque,
# `state.tau_ext`, and `model.tip_wrench(q, tau_ext)` converts it to a wrench at the tip. When you combine the
# equations, remember that the hand also accelerates the arm.

# %% question="shaped_impedance"
def shaped_impedance(state, target, wrench, model, *, inertia, stiffness, damping):
    """Springs and dampers between the tip and its target, and an inertia of your choice.

    Args:
        state: lk.State(t, q, dq), angles in [rad] and speeds in [rad/s], shape (7,) each.
        target: lk.PoseSample(pose, twist, dtwist), world axes.
        wrench: Force and moment of the hand on the arm's tip, shape (6,), in [N] and [N m].
        model: lk.Model, as in workspace_impedance.
        inertia: M_d, shape (6, 6), in [kg] and [kg m^2].
        stiffness: K, shape (6,), in [N/m] and [N m/rad].
        damping: D, shape (6,), in [N s/m] and [N m s/rad].

    Returns:
        lk.JointTorque of shape (7,) in [N m], the arm's weight included.
    """
    ### BEGIN SOLUTION
    from solutions.impedance.answers import shaped_impedance as answer

    return answer(
        state, target, wrench, model, inertia=inertia, stiffness=stiffness, damping=damping
    )
    ### END SOLUTION


# %% [markdown]
# Here is a push of 10 N again, with the same springs, on a tip that should feel like 1, 5 and 20 kg. Look at
# the first tenths of a second. (In 0.1 s a push of 10 N moves 20 kg on this spring and damper by 1.9 mm. Your
# tip goes farther, because the law sees the push one tick late, and for these 5 ms the tip has only its own
# kilogram. With `rate = 1000.0`, where the plant is made near the top of this notebook, it moves 2.7 mm.)

# %%
def ignores_the_wrench(state, target, wrench, model, *, inertia, stiffness, damping):
    """A stand-in: joint springs, whatever the inertia."""
    return springs_in_the_joints(state, target, model, stiffness=stiffness, damping=damping)


my_shaped_impedance = use("shaped_impedance", shaped_impedance, ignores_the_wrench)


def as_heavy_as(kilograms):
    inertia = np.diag([kilograms] * 3 + [0.3] * 3)
    D = 2.0 * np.sqrt(K * np.diag(inertia))

    def controller(state, target):
        wrench = model.tip_wrench(state.q, state.tau_ext)
        return my_shaped_impedance(
            state, target, wrench, model, inertia=inertia, stiffness=K, damping=D
        )

    return controller


plt.figure(figsize=(8, 3), layout="constrained")
early = {}
for kilograms, style in ((1.0, "-"), (5.0, "--"), (20.0, "-.")):
    log = meet(as_heavy_as(kilograms), lk.Hold(T_ready, 2.0), lk.Push((0.0, 10.0, 0.0)))
    plt.plot(log.t, displacement(log)[:, 1], style, label=f"{kilograms:g} kg")
    early[kilograms] = np.interp([0.1, 2.0], log.t, displacement(log)[:, 1])
plt.xlabel("time [s]")
plt.ylabel("displacement along y [mm]")
plt.legend(frameon=False)
lk.plotting.show(
    "A push of 10 N on a tip that pretends to have a mass. Displacement after 0.1 s and after 2 s: "
    + "; ".join(f"{a:.1f} and {b:.1f} mm with {kg:g} kg" for kg, (a, b) in early.items())
    + "."
)

# %% [markdown]
# At first the inertia decides how far the tip goes; at rest the stiffness alone does. So against a wall the stiffness
# sets the force, however heavy the tip feels.

# %% [markdown]
# ## Feel it
#
# The same arm, in real time, under your own law; the line of numbers beside or below the picture begins
# with the law, and says so if it is a stand-in.
# Press *Start* and drag the tip with the mouse: the arrow is your force. By how much must 10 N move the tip,
# with K = 300 N/m? Change the stiffness and drag again. Then drag the elbow: your law says nothing about it, so
# what holds it back? Push the tip against the wall and move the wall. Finally choose *position mode* and pull
# as hard as you can, which is 60 N here, first sideways and then down: at which force does the arm give way, in
# which direction does it hold, and which motor has reached its torque limit? (The line of
# numbers names it.) You can do all this without a mouse: below the picture, choose where to push, how hard and
# along which axis.

# %%
def by_hand(state, target, stiffness):
    K_now = np.array([stiffness] * 3 + [20.0] * 3)
    D = 2.0 * np.sqrt(K_now * felt)
    return my_workspace_impedance(state, target, model, stiffness=K_now, damping=D)


wall = lk.Wall(T_ready[:3, 3] + [0.06, 0.0, 0.0], normal=(-1.0, 0.0, 0.0), size=(0.3, 0.3))
view = lk.live(
    lk.Arm("left", plant, q0=ready, world=lk.World(things=[wall])),
    lk.Hold(T_ready, 1.0),
    {your_law: by_hand, "position mode": stiff},
    title="An impedance in your hand",
    stiffness=(50.0, 1500.0, 300.0, "N/m"),
    payload=(0.0, 1.0),
    stiction=(0.0, 2.0),
)
view

# %% [markdown]
# ## Hand in
#
# Run everything once more from the top (*Kernel, Restart Kernel and Run All Cells*) and save the file. Then
# run only the last cell once more: it prints a receipt for the saved file; keep it. `!labkit submit-check 05_impedance.ipynb`
# in a new cell runs a copy of that file and says what is missing. Hand in the file without renaming it, in the way your course asks. The grader runs your
# functions on further cases; the text above each stub says what kind of cases.

# %% setup=true
lk.hand_in("05_impedance")
