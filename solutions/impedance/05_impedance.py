# %% [markdown]
# # 05 · Impedance
#
# A stiff arm does not give way, and it can hurt you. A limp arm falls. You want one that gives way as a spring
# does: a little when you push a little, and back when you let go. How an arm gives way is its *impedance*, and
# you choose it. The team of the report wrote two such controllers, found them "a bit off" and saw no use in
# them. They never pushed the arm. Here you will.
#
# | | |
# |---|---|
# | **You need** | Newton's law for one mass on a spring; matrices and their inverses |
# | **Given** | the arm's model, an arm that can be pushed, a wall to meet |
# | **You write** | the inertia at the tip, springs at the tip and in the joints, a scale |
# | **Time** | core 3 hours, 20 points; all 3.7 hours, 24 points. After 3 hours, stop writing and read the rest. |

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
# A mass $m$ is tied to its target $x_d$ by a spring $k$ and a damper $b$, and a hand pushes with a force $F$. With
# $e = x_d - x$, as everywhere in this course,
#
# $$ m\,\ddot x = m\,\ddot x_d + b\,\dot e + k\,e + F . $$

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
# What you should have seen: the *stiffness* decides where it ends, the *inertia* how it starts, the *damping* how
# it swings.
#
# ## How heavy is the tip?
#
# No data sheet says it. Seven joints move when you push the tip, each with its own inertia and lever, so it
# depends on the pose and on the direction. Follow a push $F$ through the arm, motors off and at rest: to joint
# torques $J^T F$, to joint accelerations, to the tip's. The result is $F = \Lambda(q)\,\ddot x$ (Khatib 1987).

# %% question="operational_inertia"
def operational_inertia(M, J):
    """The inertia that a hand feels at the tip, shape (6, 6) or (3, 3)."""
    ### BEGIN SOLUTION
    from solutions.impedance.answers import operational_inertia as answer

    return answer(M, J)
    ### END SOLUTION


# %% [markdown]
# Now measure it: the arm carries its own weight, its motors do nothing else, and 5 N tap its tip for a
# hundredth of a second.

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
# Along x and y the tip feels like less than 1 kg, up and down like 6 kg: in one pose.
#
# ## Find and mend: equation 21
#
# This is *our reading* of the report's equation 21, for a target at rest and with our sign of the error. Some of
# its terms are right.

# %%
K = np.array([300.0, 300.0, 300.0, 20.0, 20.0, 20.0])
D = 2.0 * np.sqrt(K * felt)  # critical for the masses that you measured


def equation_21(state, target, model, *, stiffness, damping):
    """Our reading of the printed formula."""
    J = model.tip_jacobian(state.q)
    e = lk.se3.pose_error(target.pose, model.pose(state.q))
    de = target.twist - J @ state.dq
    return lk.JointTorque(J.T @ (damping * de - stiffness * e) + model.gravity(state.q))


def let_go(law, off=0.005, seconds=1.5):
    """A run from beside a target that rests, as far as it goes."""

    def controller(state, target):
        return law(state, target, model, stiffness=K, damping=D)

    with lk.Arm("left", plant, q0=ready + off) as arm:
        try:
            return lk.run(arm, lk.Hold(T_ready, seconds), controller, rate)
        except lk.errors.Diverged as error:
            return error.log


def distance(log):
    """How far the tip is from its target, shape (N,) in [mm]."""
    return 1e3 * np.linalg.norm(lk.metrics.tip_error(log)[:, :3], axis=1)


printed = let_go(equation_21)
plt.figure(figsize=(6, 2.4), layout="constrained")
plt.semilogy(printed.t, distance(printed), "C3")
plt.xlabel("time [s]")
plt.ylabel("distance [mm]")
lk.plotting.show(
    f"Equation 21 as printed, let go {distance(printed)[0]:.1f} mm from its target: "
    f"{distance(printed)[-1]:.0f} mm away after {printed.t[-1]:.1f} s."
)

# %% question="tip_spring"
def tip_spring(state, target, model, *, stiffness, damping):
    """Equation 21, mended: the same arguments, lk.JointTorque of shape (7,) in [N m]."""
    ### BEGIN SOLUTION
    from solutions.impedance.answers import tip_spring as answer

    return answer(state, target, model, stiffness=stiffness, damping=damping)
    ### END SOLUTION


# %% [markdown]
# (Equations 22 and 23 say $\tau = J^T F$ with a force of seven numbers. Count the rows.)
#
# ## Springs at the tip
#
# On the move the springs alone drag behind. The wanted behaviour is that of the one mass, in six directions, with
# the inertia that the tip has:
#
# $$ \Lambda\,\ddot e + D\,\dot e + K\,e = -F_{ext} , \qquad e \text{ from } \texttt{lk.se3.pose\_error}, \quad
# \dot e = V_d - J\dot q . $$
#
# Combine it with the joints' equation of motion. Two traps: the tip's acceleration is $J\ddot q + \dot J\dot q$, and
# its second term is there without any torque; and a force $F$ at the tip takes the torques $J^T F$, no inverse.
# No force is measured: "impedance needs a force sensor" is false while the arm keeps its own inertia.

# %% question="workspace_impedance"
def workspace_impedance(state, target, model, *, stiffness, damping):
    """Springs and dampers at the tip: an lk.JointTorque of shape (7,) in [N m].

    Args:
        state: lk.State(t, q, dq).
        target: lk.PoseSample(pose, twist, dtwist), world axes.
        model: lk.Model, with pose(q), tip_jacobian(q), tip_jacobian_rate(q, dq),
            operational_inertia(q), coriolis(q, dq) of shape (7, 7), and gravity(q).
        stiffness, damping: K and D, shape (6,) each.
    """
    ### BEGIN SOLUTION
    from solutions.impedance.answers import workspace_impedance as answer

    return answer(state, target, model, stiffness=stiffness, damping=damping)
    ### END SOLUTION


# %% [markdown]
# ## A push
#
# A force of 10 N pushes the tip to the side for two seconds; Baxter's position mode runs beside your law.

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
# What you should have seen: F / K, and nothing of the arm's seven joints.
#
# ## A wall
#
# The arm does not know that there is a wall 3 cm in front of its target.

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
# Two springs in series that give way by $\delta$ press with $F = \delta/(1/K + 1/k_{wall})$. While the wall is much
# stiffer than $K$, you decide the force.
#
# ## Springs in the joints
#
# Springs in the joints are an impedance, too: $\tau = M\ddot q_d + C\dot q_d + g + D\dot e + K_q e$, letter by letter the
# augmented PD law of 04. The report counts two controllers; they are one, with high gains to track and low gains
# to give way. But a spring in each joint alone feels at the tip as the pose decides. Which matrix $K_q$ feels like
# *your* springs? (The dampers then follow by the same function.) Turn the joints by a little and follow the forces. Seven joints, six springs: one is left over.

# %% question="joint_impedance"
def joint_impedance(J, stiffness, elbow):
    """K_q in [N m/rad], for J of shape (6, 7) and stiffness in [N/m] and [N m/rad]."""
    ### BEGIN SOLUTION
    from solutions.impedance.answers import joint_impedance as answer

    return answer(J, stiffness, elbow)
    ### END SOLUTION


# %%
def springs_in_each_joint(J, stiffness, elbow):
    """The stand-in: a spring, or a damper, in each joint alone."""
    return np.diag(JOINT_K if stiffness[0] > 200.0 else JOINT_D)


my_joint_impedance = use("joint_impedance", joint_impedance, springs_in_each_joint)
mine = [np.asarray(my_joint_impedance(model.tip_jacobian(ready), x, 10.0)) for x in (K, D)]
alone = [np.diag(JOINT_K), np.diag(JOINT_D)]
chosen = "a stand-in" if my_joint_impedance is springs_in_each_joint else "your matrix"


def stiffness_felt(K_q, D_q, newtons=5.0):
    """The stiffness at the tip from three pushes, shape (3, 3) in [N/m]."""

    def springs(state, target):
        tau = K_q @ (target.position - state.q) - D_q @ state.dq
        return lk.JointTorque(tau + model.gravity(state.q))

    gone = []
    for way in np.eye(3):
        with lk.Arm("left", plant, q0=ready, world=lk.World(things=[lk.Push(newtons * way)])) as arm:
            log = lk.run(arm, lk.Hold(ready, 1.5), springs, rate)
        gone.append(model.pose(log.q[-1])[:3, 3] - T_ready[:3, 3])
    return np.linalg.inv(np.array(gone).T / newtons)


angle = np.linspace(0.0, 2.0 * np.pi, 200)
pushes = 10.0 * np.column_stack([np.cos(angle), 0.0 * angle, np.sin(angle)])
curves = (
    ("springs at the tip: asked for", np.diag(K[:3]), {"color": "0.8", "linewidth": 5}),
    (chosen, stiffness_felt(*mine), {"color": "C0"}),
    ("a spring in each joint alone", stiffness_felt(*alone), {"color": "C1", "linestyle": "--"}),
)
plt.figure(figsize=(7.5, 3.2), layout="constrained")
for name, matrix, look in curves:
    gone = 1e3 * np.linalg.solve(matrix, pushes.T)
    plt.plot(gone[0], gone[2], label=name, **look)
plt.axis("equal")
plt.xlabel("x [mm]")
plt.ylabel("z [mm]")
plt.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
lk.plotting.show(
    "Where pushes of 10 N from all sides in the plane of x and z move the tip: a circle where the springs are "
    f"even. Measured along x: {curves[1][1][0, 0]:.0f} N/m with {chosen}, {curves[2][1][0, 0]:.0f} N/m with a "
    "spring in each joint."
)

# %% [markdown]
# What you should have seen: a circle where you chose the matrix, a slanted ellipse where the pose did. Far from
# this pose the circle is lost; springs at the tip keep it.

# %% [markdown]
# ## A scale
#
# Something is in the gripper of your own arm. At rest its joints need the torque of the load plus dry friction, and
# you cannot know how large that is; the torque sensors were set to zero with the load in the gripper. The trap
# is a wall in front: keep the tip within 3 cm of its place.

# %%
HANDLE = "demo"  # in a course: the name that your instructor gave you
own = lk.my_arm(HANDLE)
holding = np.diag(own.model.mass_matrix(ready))
holding = lk.control.springs(50.0 * holding, 14.0 * holding)
resting = lk.run(own, lk.Hold(ready, 1.0), holding)
names = [name.removeprefix("left_") for name in own.robot.joint_names]
one_kilogram = own.model.tip_jacobian(ready)[:3].T @ [0.0, 0.0, 9.81]
for what, numbers in (
    ("commanded at rest", resting.command[-20:].mean(axis=0)), ("one kilogram takes", one_kilogram)
):
    print(f"{what} [N m]:", ", ".join(f"{name} {x:+.2f}" for name, x in zip(names, numbers)))

# %% question="weigh"
def weigh(arm):
    """The mass in the gripper, in [kg].

    Args:
        arm: lk.Arm in its ready pose, which you may move with lk.run(arm, target, controller).
    """
    ### BEGIN SOLUTION
    from solutions.impedance.answers import weigh as answer

    return answer(arm)
    ### END SOLUTION


# %%
my_weigh = use("weigh", weigh, lambda arm: np.nan)
print(f"My own arm carries {my_weigh(lk.my_arm(HANDLE)):.3f} kg.")

# %% [markdown]
# ## Feel it
#
# The same arm in real time, under your own law. Press *Start* and drag the tip: by how much must 10 N move it? Change
# the stiffness. Drag the elbow: your law says nothing about it, so what holds it? (Friction; those who build such arms
# add a damper behind $I - J^T\bar J^T$, with $\bar J = M^{-1}J^T\Lambda$, which the tip does not feel.) Push the tip against the
# wall. Then choose *position mode* and pull as hard as you can.

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
# ## Appendix: another inertia
#
# The tip can also behave as if it had another inertia: $M_d\,\ddot e + D\,\dot e + K\,e = -F_{ext}$. Then the motors help
# the hand or resist it, and now the wrench $F_{ext}$ must be measured: `state.tau_ext`, turned into a wrench by
# `model.tip_wrench`. The trap: the hand also accelerates the arm.

# %% question="shaped_impedance"
def shaped_impedance(state, target, wrench, model, *, inertia, stiffness, damping):
    """Springs and dampers between the tip and its target, and an inertia of your choice.

    Args:
        state, target, model, stiffness, damping: As for workspace_impedance.
        wrench: Of the hand on the arm's tip, shape (6,), in [N] and [N m].
        inertia: M_d, shape (6, 6), in [kg] and [kg m^2].

    Returns:
        lk.JointTorque of shape (7,) in [N m], the arm's weight included.
    """
    ### BEGIN SOLUTION
    from solutions.impedance.answers import shaped_impedance as answer

    return answer(
        state, target, wrench, model, inertia=inertia, stiffness=stiffness, damping=damping
    )
    ### END SOLUTION


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
# At first the inertia decides how far the tip goes; at rest the stiffness alone does.

# %% [markdown]
# ## Hand in
#
# *Kernel, Restart Kernel and Run All Cells*, save, then run only the last cell once more: it prints a receipt.

# %% setup=true
lk.hand_in("05_impedance")
