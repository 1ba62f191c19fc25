# %% [markdown]
# # 02 · The model
#
# A controller that knows the arm can do more than one that only sees an error. What it needs is one equation,
#
# $$ M(q)\,\ddot q + C(q, \dot q)\,\dot q + g(q) = \tau , $$
#
# and one matrix, the Jacobian, which says how the tip moves when the joints do. Here you compute
# them from the arm's seven bodies, and learn how to find out whether they are
# right. The report that this lab grew out of had no such test; its gravity was off by a factor of thirty, and
# nobody could tell.
#
# | | |
# |---|---|
# | **You need** | numpy; the cross product, derivatives in several variables; 1-D arrays, twists as (v, w), `T_ab` (notebook 00) |
# | **Given** | the simulated arm; where its joints and bodies are (`model.links`) |
# | **You write** | the Jacobian, the mass matrix, gravity; as extensions the Coriolis matrix and the power balance |
# | **Time** | core 2.5 hours, 13 points; all 3.5 hours, 21 points. After 3 hours, stop writing and read the rest. |

# %% setup=true
import matplotlib.pyplot as plt
import numpy as np

import labkit as lk
from labkit.course import check, predict, use

lk.ready()

# %% [markdown]
# ## Seven bodies
#
# Each of the seven bodies turns about the z axis of its own frame. `model.links(q)` lists them at the
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
# Freeze all joints but one. Everything beyond joint $k$ turns about its axis $z_k$, like a door on its
# hinge: at unit speed a point at the vector $r$ from the hinge moves with the velocity $z_k \times r$,
# and the door itself turns with $z_k$. The motions of all joints add up,
#
# $$ \begin{pmatrix} \dot p \\ \omega \end{pmatrix} = J(q)\,\dot q, $$
#
# so a column of $J$ is what one joint does at unit speed (Siciliano, *Robotics: Modelling,
# Planning and Control*, section 3.1.3). The trap: several matrices are called "the Jacobian". This one
# gives the velocity of the *tip*, in *world* axes.

# %% question="jacobian"
def jacobian(axes, origins, tip):
    """In world axes.

    Args:
        axes: Unit vectors along the joints' axes, (7, 3).
        origins: A point on each axis, (7, 3), in [m].
        tip: The tip, (3,), in [m].
    """
    ### BEGIN SOLUTION
    from solutions.model.answers import jacobian as answer

    return answer(axes, origins, tip)
    ### END SOLUTION


# %% [markdown]
# A Jacobian is a derivative, so you can test it without another one: move the arm round a circle, and compare
# the velocity from the tip's places with that from your Jacobian.

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

# %% [markdown]
# With a right Jacobian the coloured curves cover the grey ones; a stand-in moves two joints only.

# %%
lk.replay.show(lk.replay.motion_of(log, "A circle, to try the Jacobian on"))

# %% [markdown]
# ## The mass matrix: how hard it is to start moving
#
# The kinetic energy of a body is that of its centre of mass plus that of its rotation,
# $\tfrac12 m |v|^2 + \tfrac12 \omega^T I \omega$. Both $v$ and $\omega$ are linear in the joint speeds,
# through the Jacobian of that body's centre of mass. Summed over the bodies it is a
# quadratic form, and $M$ is its matrix (Murray, Li and Sastry, *A Mathematical Introduction to Robotic
# Manipulation*, section 4.3):
#
# $$ T = \tfrac12\,\dot q^T M(q)\,\dot q . $$
#
# The trap is the axes: an inertia is tabulated in the body's own axes, where it never changes;
# the angular velocity that the Jacobian gives is in world axes.

# %% question="mass_matrix"
def mass_matrix(masses, inertias, rotations, com_jacobians):
    """In [kg m^2].

    Args:
        masses: (7,), in [kg].
        inertias: About each centre of mass, in the link's own axes, (7, 3, 3), in [kg m^2].
        rotations: R_wl, orientation of each link in the world, (7, 3, 3).
        com_jacobians: Of each centre of mass, rows (v, w) in world axes, (7, 6, 7).
    """
    ### BEGIN SOLUTION
    from solutions.model.answers import mass_matrix as answer

    return answer(masses, inertias, rotations, com_jacobians)
    ### END SOLUTION


# %% [markdown]
# Two things must hold for any mass matrix, whatever the arm: it is symmetric, and no motion has *zero* energy, so its smallest
# eigenvalue is above zero.

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
# The inertia depends on the pose: the stretched arm is harder to swing about the shoulder.
#
# ## Gravity: what it takes to stay
#
# Turn joint $k$ by a little: the potential energy grows by the torque that you have to hold there, times the
# angle, $g_k = \partial V / \partial q_k$. You already know how each centre of mass moves with each
# joint: it is a Jacobian. The trap: a formula with the height alone works until somebody mounts the arm on a wall.

# %% question="gravity"
def gravity(masses, com_jacobians, g_w):
    """In [N m].

    Args:
        masses: (7,), in [kg].
        com_jacobians: Of each centre of mass, rows (v, w) in world axes, (7, 6, 7).
        g_w: Acceleration of free fall in world axes, (3,): (0, 0, -9.81) m/s^2 on a level floor.
    """
    ### BEGIN SOLUTION
    from solutions.model.answers import gravity as answer

    return answer(masses, com_jacobians, g_w)
    ### END SOLUTION


# %% [markdown]
# Command your torque and nothing else, and the arm should float where it is. Beside it is the report's
# formula, $M J^T (0, 0, 0.981, 0, 0, 0)^T$: only the tip has
# weight, only a tenth of it, and the result does not have the unit of a torque.

# %%
def gravity_at(q):
    """Your gravity at the angles q, on a level floor."""
    parts = model.links(q)
    masses, jacobians = (np.array([getattr(x, of) for x in parts]) for of in ("mass", "com_jacobian"))
    return gravity(masses, jacobians, np.array([0.0, 0.0, -9.81]))


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

# %% [markdown]
# In a third of a second the report's arm has fallen. (The real Baxter adds its own gravity compensation to whatever torque it is sent; there you
# must add nothing. This simulated arm, `lk.IDEAL`, does not.)

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
# <details><summary>After your prediction: why?</summary>The axis of s0 is vertical, so turning it raises nothing: gravity is a slope, not
# a load. On a wall it would be different.</details>

# %% [markdown]
# ## Appendix: two extensions
#
# No later question depends on them.
#
# ### Coriolis: what the speed of one joint does to the others
#
# While the arm moves, $M$ changes under it, and the joints feel each other's speed. These torques
# follow from the derivatives of $M$ alone (Murray, Li and Sastry, eq. 4.23):
#
# $$ C_{ij} = \tfrac12 \sum_k \left( \frac{\partial M_{ij}}{\partial q_k}
# + \frac{\partial M_{ik}}{\partial q_j} - \frac{\partial M_{jk}}{\partial q_i} \right) \dot q_k . $$
#
# Compute the derivatives by central differences: shift one joint by $+h$ and by $-h$, and divide by $2h$.

# %% question="coriolis"
def coriolis(mass_matrix, q, dq):
    """In [kg m^2/s]; mass_matrix(q) is (7, 7), q [rad] and dq [rad/s] are (7,)."""
    ### BEGIN SOLUTION
    from solutions.model.answers import coriolis as answer

    return answer(mass_matrix, q, dq)
    ### END SOLUTION


# %% [markdown]
# One famous test is that $\dot M - 2C$ must be skew: then no energy is made or lost. But
# $C = \dot M / 2$, a bold guess, passes, because zero is skew. The second test is the torque itself: Lagrange's
# equation gives $C\dot q = \dot M \dot q - \nabla T$. A matrix that fails it is wrong; one that fails only the first cannot be used
# in proofs.

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
# Does it matter? A quick move under torques from the model (notebook 04), with $C\dot q$ and without:

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
# ### The power balance: a test for everything at once
#
# The arm's energy $T + V$ grows by the power of the motors, $\tau \cdot \dot q$, and shrinks by the power of friction. So
#
# $$ \frac{d}{dt}(T + V) - \tau \cdot \dot q $$
#
# is zero for an arm without friction, if masses, inertias, gravity and the log are all right, under any controller; with
# friction it *is* the power of friction.

# %% question="power_balance"
def power_balance(log, model):
    """In [W], (N,).

    Args:
        log: lk.Log with torques: t (N,), q, dq, tau (what the motors gave) and command, (N, 7) each.
        model: lk.Model: kinetic_energy(q, dq) and potential_energy(q) in [J].
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
# Run all cells, save, and run the last one once more: it prints a receipt.

# %% setup=true
lk.hand_in("02_model")
