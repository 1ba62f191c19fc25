# %% [markdown]
# # 02 · The model
#
# A controller that knows the arm can do more than one that only sees an error. All that it needs to know is
# one equation,
#
# $$ M(q)\,\ddot q + C(q, \dot q)\,\dot q + g(q) = \tau , $$
#
# and one matrix, the Jacobian, which says how the tip moves when the joints do. In this notebook you compute
# all of them from the arm's seven bodies. Just as important, you learn how to find out whether they are
# right. The report that this lab grew out of had no such test; its gravity was off by a factor of thirty, and
# nobody could tell.
#
# | | |
# |---|---|
# | **You need** | numpy; vectors, the cross product, derivatives in several variables; notebook 00 or its conventions: 1-D arrays, twists as (v, w), `T_ab` |
# | **Given** | the simulated arm; where its joints and bodies are at any angles (`model.links`) |
# | **You write** | the Jacobian, the mass matrix, gravity, the Coriolis matrix, the power balance |
# | **Time** | core about 2 hours, all about 3.5 hours; 21 points |
#
# Questions marked *core* are for everybody. Those marked *extension* take the rest of the time: they earn points
# too, but no later question depends on them.
#
# Every cell runs from the start, solved or not. If your part is missing, a stand-in replaces it and says so.
# After each stub a check tells you in words what it found. The functions and your prediction are marked; play with
# everything else as you like.

# %% setup=true
import labkit as lk
from labkit.course import check, hint, predict, use

lk.ready()

# %% setup=true
import matplotlib.pyplot as plt
import numpy as np

# %% [markdown]
# ## Seven bodies
#
# The arm is seven bodies, each turning about the z axis of its own frame. `model.links(q)` lists them at the
# angles `q`: the mass, the inertia and the pose of each, and how its centre of mass moves.

# %%
arm = lk.Arm("left")
model, q0 = arm.model, arm.robot.ready
names = [name.removeprefix("left_") for name in arm.robot.joint_names]

for name, link in zip(names, model.links(q0)):
    print(f"{name}: {link.mass:.2f} kg, centre of mass at {link.com.round(3)} m")

# %% [markdown]
# ## The Jacobian: what one joint does to the tip
#
# Freeze all joints but one. Everything beyond this joint $k$ turns about the joint's axis $z_k$, like a door on its
# hinge. At unit speed, a point of the door at the vector $r$ from the hinge moves with the velocity $z_k \times r$,
# and the door itself turns with the angular velocity $z_k$. The motions of all joints simply add up,
#
# $$ \begin{pmatrix} \dot p \\ \omega \end{pmatrix} = J(q)\,\dot q, $$
#
# so a column of $J$ is what one joint does at unit speed. Derive it: the tip is at $p$, a point on the
# joint's axis at $p_k$, all in world axes (Siciliano, *Robotics: Modelling,
# Planning and Control*, section 3.1.3). Beware: several matrices are called "the Jacobian". This one
# gives the velocity of the *tip*, in *world* axes.

# %% question="jacobian"
def jacobian(axes, origins, tip):
    """The Jacobian of the tip, in world axes.

    Args:
        axes: Unit vectors along the seven joints' axes, in the world, shape (7, 3).
        origins: A point on each axis, in the world, shape (7, 3), in [m].
        tip: The tip in the world, shape (3,), in [m].

    Returns:
        Shape (6, 7): rows 0 to 2 give the tip's velocity, rows 3 to 5 the angular velocity.
    """
    ### BEGIN SOLUTION
    from solutions.model.answers import jacobian as answer

    return answer(axes, origins, tip)
    ### END SOLUTION


# %% [markdown]
# A Jacobian is a derivative, so you can test it without another Jacobian: move the arm, and look. Here the
# arm goes round a circle. The velocity of the tip is computed once from its positions, and once from your
# Jacobian and the joint speeds.

# %%
def jacobian_at(q):
    """Your Jacobian at the angles q."""
    parts = model.links(q)
    axes = np.array([part.T_wl[:3, 2] for part in parts])
    origins = np.array([part.T_wl[:3, 3] for part in parts])
    return jacobian(axes, origins, model.pose(q)[:3, 3])


def shoulder_alone(q):
    """The stand-in: as if only the first two joints moved the tip."""
    return model.tip_jacobian(q) * (np.arange(7) < 2)


tip_jacobian = use("jacobian", jacobian, shoulder_alone, yours=jacobian_at)


def passes_on(state, target):
    """Feed-forward: turn the joints at the wanted speeds."""
    return lk.JointVelocity(target.velocity)


start = model.pose(q0)[:3, 3]
circle = lk.Trajectory(lk.Circle(start, start + [0.0, -0.15, 0.0]), lk.Quintic(6.0))
arm.reset(q0)
log = lk.run(arm, model.joint_trajectory(circle, q0), passes_on)

places = np.array([model.pose(q)[:3, 3] for q in log.q])
measured = np.gradient(places, log.t, axis=0)
predicted = np.array([tip_jacobian(q)[:3] @ dq for q, dq in zip(log.q, log.dq)])

plt.figure(figsize=(8, 3), layout="constrained")
for k, (axis, style) in enumerate(zip("xyz", ("-", "--", ":"))):
    plt.plot(log.t, measured[:, k], "0.7", linewidth=4, label="from the places" if k == 0 else None)
    plt.plot(log.t, predicted[:, k], f"C{k}{style}", label=f"{axis}, from J dq")
plt.xlabel("time [s]")
plt.ylabel("speed of the tip [m/s]")
plt.legend(frameon=False)
lk.plotting.show(
    "The tip's velocity on a circle, from its places and from J dq: they differ by "
    f"{1e3 * np.abs(measured - predicted).max():.2f} mm/s at most."
)

# %%
lk.replay.show(lk.replay.motion_of(log, "A circle, to try the Jacobian on"))

# %% [markdown]
# ## The mass matrix: how hard it is to start moving
#
# The kinetic energy of a body is that of its centre of mass plus that of its rotation,
# $\tfrac12 m |v|^2 + \tfrac12 \omega^T I \omega$. Both $v$ and $\omega$ are linear in the joint speeds,
# through the Jacobian of that body's centre of mass. Summed over the bodies, the kinetic energy is a
# quadratic form, and $M$ is its matrix (Murray, Li and Sastry, *A Mathematical Introduction to Robotic
# Manipulation*, section 4.3):
#
# $$ T = \tfrac12\,\dot q^T M(q)\,\dot q . $$
#
# Be careful with the axes. The inertia of a body is tabulated in the body's own axes, where it never changes;
# the angular velocity that the Jacobian gives is in world axes.

# %% question="mass_matrix"
def mass_matrix(masses, inertias, rotations, com_jacobians):
    """The mass matrix of the arm.

    Args:
        masses: Of the seven links, shape (7,), in [kg].
        inertias: About each centre of mass, in the link's own axes, shape (7, 3, 3), in [kg m^2].
        rotations: R_wl, orientation of each link in the world, shape (7, 3, 3).
        com_jacobians: For each link the velocity of its centre of mass (rows 0 to 2) and its angular
            velocity (rows 3 to 5), in world axes, for each joint: shape (7, 6, 7).

    Returns:
        Shape (7, 7), in [kg m^2].
    """
    ### BEGIN SOLUTION
    from solutions.model.answers import mass_matrix as answer

    return answer(masses, inertias, rotations, com_jacobians)
    ### END SOLUTION


# %% [markdown]
# Three things must hold for any mass matrix, whatever the arm: it is symmetric, no motion has negative
# energy, and no motion has *zero* energy, so its smallest eigenvalue is above zero. The picture shows that
# the inertia depends on the pose: if you stretch the elbow, the shoulder has far more to move.

# %%
def mass_matrix_at(q):
    """Your mass matrix at the angles q."""
    parts = model.links(q)
    return mass_matrix(
        np.array([part.mass for part in parts]),
        np.array([part.inertia for part in parts]),
        np.array([part.T_wl[:3, :3] for part in parts]),
        np.array([part.com_jacobian for part in parts]),
    )


def stretched_out(q):
    """The stand-in: the inertia of the stretched arm, wherever the arm is."""
    return model.mass_matrix(np.zeros(7))


M = use("mass_matrix", mass_matrix, stretched_out, yours=mass_matrix_at)

print(f"symmetric to {np.abs(M(q0) - M(q0).T).max():.1e} kg m²")
print(f"smallest eigenvalue {np.linalg.eigvalsh(M(q0))[0]:.1e} kg m²")

elbow = np.linspace(0.0, 2.4, 60)
felt = np.array([np.diag(M([*q0[:3], e, *q0[4:]])) for e in elbow])
plt.figure(figsize=(8, 3), layout="constrained")
for j, style in ((0, "-"), (1, "--"), (3, ":")):
    plt.plot(elbow, felt[:, j], style, label=f"joint {names[j]}")
plt.xlabel("elbow e1 [rad]: near 0 the arm is stretched")
plt.ylabel("inertia felt [kg m²]")
plt.legend(frameon=False)
lk.plotting.show(
    "Inertia felt by three joints as the elbow bends from 0 to 2.4 rad: that of s1 is "
    f"{felt[0, 1]:.2f} kg m² at first and {felt[-1, 1]:.2f} kg m² at the end."
)

# %% [markdown]
# ## Gravity: what it takes to stay
#
# Raise joint $k$ by a little: the potential energy grows by the torque that you have to hold there, times the
# angle. So $g_k = \partial V / \partial q_k$, and $V$ is the sum of $m\,g_0\,z$ over the bodies, with $g_0$ =
# 9.81 m/s² and $z$ the height of the centre of mass. You already know how fast that height changes with each
# joint: it is a row of a Jacobian.

# %% question="gravity"
def gravity(masses, com_jacobians):
    """The torque that holds the arm still against its weight.

    Args:
        masses: Of the seven links, shape (7,), in [kg].
        com_jacobians: For each link the velocity of its centre of mass (rows 0 to 2) and its angular
            velocity (rows 3 to 5), in world axes, for each joint: shape (7, 6, 7).

    Returns:
        Shape (7,), in [N m].
    """
    ### BEGIN SOLUTION
    from solutions.model.answers import gravity as answer

    return answer(masses, com_jacobians)
    ### END SOLUTION


# %% [markdown]
# The best test is to try it: command your torque and nothing else, and the arm should float where it is. The
# figure also shows the report's formula, $M J^T (0, 0, 0.981, 0, 0, 0)^T$. In this formula only the tip has
# weight, and only a tenth of it, and the result does not have the unit of a torque.

# %%
def gravity_at(q):
    """Your gravity at the angles q."""
    parts = model.links(q)
    return gravity(
        np.array([part.mass for part in parts]), np.array([part.com_jacobian for part in parts])
    )


def half_the_weight(q):
    """The stand-in: half of what the arm weighs."""
    return 0.5 * model.gravity(q)


g = use("gravity", gravity, half_the_weight, yours=gravity_at)
your_g = "yours" if g is gravity_at else "a stand-in"


def floats(state, target):
    return lk.JointTorque(g(state.q))


def as_in_the_report(state, target):
    up = np.array([0.0, 0.0, 0.981, 0.0, 0.0, 0.0])
    return lk.JointTorque(M(state.q) @ tip_jacobian(state.q).T @ up)


floating = {}
still = lk.Hold(q0, 0.35)
for name, controller in ((your_g, floats), ("the report's", as_in_the_report)):
    arm.reset(q0)
    floating[name] = lk.run(arm, still, controller)

plt.figure(figsize=(8, 2.8), layout="constrained")
drops = {}
for (name, run), style in zip(floating.items(), ("-", "--")):
    height = np.array([model.pose(q)[2, 3] for q in run.q])
    plt.plot(run.t, height, style, label=name)
    drops[name] = height[0] - height[-1]
plt.xlabel("time [s]")
plt.ylabel("height of the tip [m]")
plt.legend(frameon=False)
lk.plotting.show(
    "Height of the tip while only a gravity torque is commanded, for 0.35 s. It drops by "
    + ", ".join(f"{1e3 * drop:.1f} mm with {name}" for name, drop in drops.items())
    + "."
)

# %% predict="base_joint"

# %%
if base_joint is not None:
    print(f"g at the ready pose [N m], {your_g}:", ", ".join(f"{x:.1f}" for x in g(q0)))
s0, elbow_torque = abs(g(q0)[0]), abs(g(q0)[3])
predict("base_joint", truth="c" if s0 < 0.05 * elbow_torque else "a" if s0 > elbow_torque else "b")

# %%
lk.replay.show(
    lk.replay.motion_of(
        floating[your_g],
        "Held by a gravity torque alone",
        label=your_g,
        ghosts={"the report's": floating["the report's"]},
        reference=False,
    )
)

# %% [markdown]
# (The real Baxter adds its own gravity compensation to whatever torque it is sent, so there you
# must add nothing. This simulated arm, `lk.IDEAL`, does not.)
#
# ## Coriolis: what the speed of one joint does to the others
#
# While the arm moves, $M$ changes under it, and the joints feel each other's speed. These torques are
# quadratic in $\dot q$ and follow from the derivatives of $M$ alone (Murray, Li and Sastry, eq. 4.23):
#
# $$ C_{ij} = \tfrac12 \sum_k \left( \frac{\partial M_{ij}}{\partial q_k}
# + \frac{\partial M_{ik}}{\partial q_j} - \frac{\partial M_{jk}}{\partial q_i} \right) \dot q_k . $$
#
# All you need is a function that returns $M$. Compute its derivatives by central differences: shift one joint
# by $+h$ and by $-h$, and divide by $2h$.

# %% question="coriolis"
def coriolis(mass_matrix, q, dq):
    """The Coriolis matrix by Christoffel's symbols.

    Args:
        mass_matrix: A function of q that gives the mass matrix, shape (7, 7).
        q: Joint angles, shape (7,), in [rad].
        dq: Joint speeds, shape (7,), in [rad/s].

    Returns:
        Shape (7, 7), in [kg m^2/s].
    """
    ### BEGIN SOLUTION
    from solutions.model.answers import coriolis as answer

    return answer(mass_matrix, q, dq)
    ### END SOLUTION


# %% [markdown]
# How would you know that it is right? One famous test is that $\dot M - 2C$ must be skew: then $C\dot q$
# does exactly the work that the changing $M$ takes up, and no energy is made or lost. Now try the test on
# $C = \dot M / 2$, a bold guess. It passes, because $\dot M - 2C$ is then zero, and zero is skew. So you need
# a second test, of the torque itself: Lagrange's equation gives $C\dot q = \dot M \dot q - \nabla T$. A
# matrix that fails the second test is wrong. A matrix that fails only the first gives the right torque, but
# cannot be used in the proofs, which need $\dot M - 2C$ to be skew.

# %%
def coriolis_at(q, dq):
    """Your Coriolis matrix at the angles q and speeds dq."""
    return coriolis(model.mass_matrix, q, dq)


def nothing_turns(q, dq):
    """The stand-in: no Coriolis torques."""
    return np.zeros((7, 7))


C = use("coriolis", coriolis, nothing_turns, yours=coriolis_at)

q, dq, h = q0 + 0.2, np.array([0.5, -0.4, 0.3, 0.6, -0.8, 0.7, 1.0]), 1e-5
M_rate = (model.mass_matrix(q + h * dq) - model.mass_matrix(q - h * dq)) / (2 * h)
slope_T = [
    (model.kinetic_energy(q + d, dq) - model.kinetic_energy(q - d, dq)) / (2 * h)
    for d in h * np.eye(7)
]
torque = M_rate @ dq - slope_T
print("                  off skew by   torque off by")
your_C = "yours" if C is coriolis_at else "a stand-in"
for name, matrix in ((your_C, C(q, dq)), ("half of dM/dt", 0.5 * M_rate)):
    S = M_rate - 2 * matrix
    off = np.abs(matrix @ dq - torque).max()
    print(f"{name:15}  {np.abs(S + S.T).max():8.1e}      {off:8.1e} N m")

# %% [markdown]
# Does it matter? The arm makes a quick move under torques computed from the model, once with $C\dot q$
# and once without. (How such a controller works is notebook 04.)

# %%
def computed_torque(with_coriolis):
    def controller(state, target):
        pull = target.acceleration + 60.0 * (target.position - state.q)
        pull = pull + 15.0 * (target.velocity - state.dq)
        tau = model.mass_matrix(state.q) @ pull + model.gravity(state.q)
        if with_coriolis:
            tau = tau + C(state.q, state.dq) @ state.dq
        return lk.JointTorque(tau)

    controller.__name__ = "computed torque"
    return controller


swing = lk.Trajectory(lk.Line(q0, q0 + [0.9, 0.2, 0.4, -0.7, 0.6, 0.3, 0.5]), lk.Quintic(1.2))
plt.figure(figsize=(8, 2.8), layout="constrained")
worst = {}
for name, with_coriolis, style in (("with C dq", True, "-"), ("without", False, "--")):
    arm.reset(q0)
    run = lk.run(arm, swing, computed_torque(with_coriolis), rate=500)
    off = 1e3 * np.linalg.norm(lk.metrics.tip_error(run)[:, :3], axis=1)
    plt.plot(run.t, off, style, label=name)
    worst[name] = off.max()
plt.xlabel("time [s]")
plt.ylabel("tip off by [mm]")
plt.legend(frameon=False)
lk.plotting.show(
    "How far the tip is off its target in a quick move: at most "
    + ", ".join(f"{off:.1f} mm {name}" for name, off in worst.items())
    + "."
)

# %% [markdown]
# ## The power balance: a test for everything at once
#
# Energy does not come from nowhere. The arm's energy $T + V$ grows by the power of the motors,
# $\tau \cdot \dot q$, and shrinks by the power of friction. So
#
# $$ \frac{d}{dt}(T + V) - \tau \cdot \dot q $$
#
# is zero for an arm without friction, if masses, inertias, gravity and the log are all right; and with
# friction it *is* the power of friction. The test gives one number for each moment, and it holds under any
# controller.

# %% question="power_balance"
def power_balance(log, model):
    """Growth of the energy less the power of the motors.

    Args:
        log: An lk.Log of a run with torques: t (N,), q, dq, tau (what the motors gave) and command
            (what they were asked for), each (N, 7).
        model: The lk.Model of the arm; kinetic_energy(q, dq) and potential_energy(q) are in [J].

    Returns:
        Shape (N,), in [W].
    """
    ### BEGIN SOLUTION
    from solutions.model.answers import power_balance as answer

    return answer(log, model)
    ### END SOLUTION


# %%
def friction_power(log, model):
    """The stand-in: what the plant's own friction takes, which is what you should find."""
    return -(np.array(log.plant.viscous) * log.dq**2).sum(axis=1)


my_power_balance = use("power_balance", power_balance, friction_power)

friction = np.array([3.0, 3.0, 2.0, 2.0, 0.3, 0.3, 0.3])  # N m per rad/s
sticky = lk.Arm("left", lk.Plant(name="sticky", viscous=friction))
plt.figure(figsize=(8, 3), layout="constrained")
left = {}
for (name, plant), style in zip((("no friction", arm), ("with friction", sticky)), ("C0-", "C1--")):
    plant.reset(q0)
    run = lk.run(plant, swing, computed_torque(True), rate=1000)
    balance = my_power_balance(run, model)
    plt.plot(run.t, balance, style, label=f"{name}: the balance")
    left[name] = balance
plt.plot(run.t, -(friction * run.dq**2).sum(axis=1), "k:", label="what that friction takes")
plt.xlabel("time [s]")
plt.ylabel("power from elsewhere [W]")
plt.legend(frameon=False)
lk.plotting.show(
    "Power that does not come from the motors, during a quick move: "
    + "; ".join(f"{name}, up to {np.abs(x).max():.1f} W" for name, x in left.items())
    + ". With friction the balance follows what friction takes."
)

# %% [markdown]
# ## Hand in
#
# Run everything once more from the top (*Kernel, Restart Kernel and Run All Cells*) and save the file. Then
# run only the last cell once more: it prints a receipt for the saved file; keep it. `!labkit submit-check 02_model.ipynb`
# in a new cell runs a copy of that file and says what is missing. Hand in the file without renaming it, in the way your course asks. The grader runs your
# functions on further cases; the text above each stub says what kind of cases.

# %% setup=true
lk.hand_in("02_model")
