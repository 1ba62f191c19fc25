# %% [markdown]
# # 00 · Warm-up
#
# Three things go wrong in a first robot program, and none of them raises an error: an array has the wrong
# shape and numpy stretches it, a vector is in the wrong axes, or two orientations are subtracted as if they
# were numbers. Here you meet all three, on an arm that shows you at once.
#
# | | |
# |---|---|
# | **You need** | Python with numpy; products of matrices |
# | **Given** | the simulated arm, figures, the logarithm of a rotation |
# | **You write** | a joint error, a tag's pose in the world, an orientation error |
# | **Time** | 1.5 hours, 11 points. After 3 hours, stop writing and read the rest. |

# %% setup=true
import matplotlib.pyplot as plt
import numpy as np

import labkit as lk
from labkit.course import check, predict, use

lk.ready()

# %% [markdown]
# ## Arrays that mislead you
#
# Seven joints, seven numbers: in labkit a vector has the shape `(7,)`, with one index. A column of shape
# `(7, 1)` holds the same numbers, and numpy happily combines the two into a table of all combinations:

# %%
wanted = np.array([[0.1], [0.2], [0.3]])  # a column, (3, 1)
actual = np.array([0.1, 0.2, 0.3])  # a vector, (3,)
wanted - actual

# %% [markdown]
# The errors should have been three zeros. The sum of that table *is* zero, so a test of the sum passes. The
# authors of the report of 2019 that this lab grew out of lost days to such shapes. labkit never stretches an array;
# it raises an error:

# %%
try:
    lk.JointVelocity(np.zeros((7, 1)))
except lk.LabkitError as error:
    print(error)

# %% [markdown]
# ## What the arm reports, and what it should do
#
# An arm reports an `lk.State`: the time, the joint angles `q` and the joint speeds `dq`. What it should do is
# an `lk.Sample`: position, velocity and acceleration, here of the joints.

# %%
arm = lk.Arm("left")
model, q0 = arm.model, arm.robot.ready
arm.reset(q0)
state = arm.state()
print("t: ", state.t, "s")
print("q: ", state.q.round(3), "rad")
print("dq:", state.dq, "rad/s")

# %% [markdown]
# In this course an *error* is always **target minus actual**: it points to where the arm should go, and a gain
# in front of it is positive.

# %% question="joint_error"
def joint_error(target, state):
    """Target minus actual, of the joint angles.

    Args:
        target: lk.Sample: position [rad], velocity [rad/s], acceleration [rad/s^2], (7,) each.
        state: lk.State: t [s], q [rad] and dq [rad/s], (7,) each.
    """
    ### BEGIN SOLUTION
    from solutions.warmup.answers import joint_error as answer

    return answer(target, state)
    ### END SOLUTION


# %% [markdown]
# ## The arm goes where the error points
#
# The simplest controller turns each joint at a speed proportional to its error. The error then shrinks like
# $e^{-kt}$, because the speed of a joint *is* the rate at which its error falls: $\dot e = -\dot q = -k\,e$.

# %%
def stays(target, state):
    """The stand-in: no error, so the arm stays where it is."""
    return np.zeros(7)


my_joint_error = use("joint_error", joint_error, stays)

# %%
def towards_target(state, target, k=2.0):
    return lk.JointVelocity(k * my_joint_error(target, state))


q1 = q0 + [0.5, 0.2, 0.0, -0.3, 0.0, 0.1, 0.4]
arm.reset(q0)
log = lk.run(arm, lk.Hold(q1, 3.0), towards_target)

# %%
error = log.target.position - log.q
plt.figure(figsize=(8, 3), layout="constrained")
for j, style in ((0, "-"), (3, "-."), (6, ":")):
    plt.plot(log.t, error[:, j], style, label=f"joint {arm.robot.joint_names[j][-2:]}")
plt.plot(log.t, error[0, 0] * np.exp(-2.0 * log.t), "k--", linewidth=1, label="0.5 exp(-2 t)")
plt.xlabel("time [s]")
plt.ylabel("error [rad]")
plt.legend(frameon=False)
lk.plotting.show(
    f"The errors of three joints, and 0.5 exp(-2 t) dashed: that of the first joint is "
    f"{error[0, 0]:.2f} rad at the start and {error[-1, 0]:.4f} rad after {log.t[-1]:.0f} s."
)

# %% [markdown]
# With your error in place, the first joint's curve lies on the dashed one. Here is the run; press *Play*. The
# see-through arm is the target.

# %%
lk.replay.show(lk.replay.motion_of(log, "Towards a place in joint space"))

# %% [markdown]
# ## Frames that cancel
#
# A *frame* is an origin with three axes. The pose of frame b seen from frame a is $T_{ab}$, a 4 by 4
# matrix: the rotation $R_{ab}$ in its upper left, the position of b's origin in its upper right. It
# converts coordinates in b to coordinates in a, and poses chain,
#
# $$ p_a = T_{ab}\,p_b, \qquad T_{ac} = T_{ab}\,T_{bc}. $$
#
# Where two of them meet, the letters must be equal (Murray, Li and Sastry, *A Mathematical Introduction to Robotic
# Manipulation*, section 2.3). The trap: every product of two poses is a pose, so a wrong order raises no error.
#
# A camera in the hand sees a tag. The model knows where the tip is in the world, $T_{wt}$, and
# `lk.se3.inverse` turns a pose round: tip from hand and camera from hand give the camera from the tip.

# %%
T_wt = model.pose(q0)
T_tc = lk.se3.inverse(arm.robot.T_hand_tip) @ arm.robot.T_hand_camera
T_cm = lk.se3.pose(lk.se3.rotation([np.pi, 0.0, 0.0]), [0.05, 0.02, 0.3])
print(T_wt.round(3))

# %% question="tag_in_world"
def tag_in_world(T_wt, T_tc, T_cm):
    """The tag's pose in the world, T_wm.

    Args:
        T_wt: Pose of the tip in the world, (4, 4).
        T_tc: Pose of the camera in the tip's frame, (4, 4).
        T_cm: Pose of the tag (marker) in the camera's frame, (4, 4).
    """
    ### BEGIN SOLUTION
    from solutions.warmup.answers import tag_in_world as answer

    return answer(T_wt, T_tc, T_cm)
    ### END SOLUTION


# %%
def nobody_knows(T_wt, T_tc, T_cm):
    """The stand-in: not a number."""
    return np.full((4, 4), np.nan)


my_tag_in_world = use("tag_in_world", tag_in_world, nobody_knows)
T_wm = my_tag_in_world(T_wt, T_tc, T_cm)
print("the tip in the world:", T_wt[:3, 3].round(3), "  the tag in the world:", T_wm[:3, 3].round(3))
print("the tag's z axis in the world:", T_wm[:3, 2].round(3))

# %% [markdown]
# The camera sits 14 cm behind the tip and sees the tag 30 cm ahead, so the tag lies 16 cm below the tip; its z axis points
# up, at the camera. In notebook 06 the arm finds a tag by just this chain.
#
# ## How far is the hand turned?
#
# The hand should point straight down, but it is tilted by a few degrees. What is the error? It is tempting to
# write both orientations as roll, pitch and yaw and to subtract, as the report did. But these angles are three
# turns, one after the other, about axes that the earlier turns have moved: they are no vector. The error that a controller can use is *one*
# turn, about one axis, that takes the actual orientation to the desired one:
#
# $$ E\,R_{wt} = R_{wd} . $$
#
# Its axis times its angle is a vector in world axes, the *logarithm* of $E$: it points along the axis about which the hand
# should turn. `lk.se3.rotation_log` gives it for any rotation (Lynch and Park, *Modern Robotics*, sections 3.2.3
# and 11.3.3).

# %% question="orientation_error"
def orientation_error(R_wd, R_wt):
    """The turn from the actual to the desired orientation, in world axes, (3,), in [rad].

    Args:
        R_wd: Desired orientation in the world, (3, 3).
        R_wt: Actual orientation of the tip in the world, (3, 3).
    """
    ### BEGIN SOLUTION
    from solutions.warmup.answers import orientation_error as answer

    return answer(R_wd, R_wt)
    ### END SOLUTION


# %% [markdown]
# ## Let the arm decide
#
# The hand starts 12 degrees off, and a controller turns it at a speed proportional to the error. (The
# Jacobian, notebook 02, converts this to joint speeds.) Three runs differ only in the error that the controller uses:
# your error; roll, pitch and yaw subtracted; your error, but by mistake in the tool's axes.

# %% predict="farthest_off"

# %%
my_orientation_error = use("orientation_error", orientation_error, lk.se3.orientation_error)


def angles(R):
    """Roll, pitch and yaw."""
    tilt = np.hypot(R[2, 1], R[2, 2])
    return np.arctan2([R[2, 1], -R[2, 0], R[1, 0]], [R[2, 2], tilt, R[0, 0]])


def euler_difference(R_wd, R_wt):
    return angles(R_wd) - angles(R_wt)


def in_tool_axes(R_wd, R_wt):
    return R_wt.T @ my_orientation_error(R_wd, R_wt)


tilted = lk.se3.pose(T_wt[:3, :3] @ lk.se3.rotation([0.15, 0.12, 0.06]), T_wt[:3, 3])
q_tilted = model.inverse_kinematics(tilted, q0)


def turn_the_hand(error, k=2.0):
    """A run that starts tilted and turns the tip by k times the error; returns the log."""

    def controller(state, target):
        turn = error(target.pose[:3, :3], model.pose(state.q)[:3, :3])
        twist = np.concatenate([np.zeros(3), np.clip(k * turn, -1.0, 1.0)])
        return lk.JointVelocity(np.linalg.pinv(model.tip_jacobian(state.q)) @ twist)

    arm.reset(q_tilted)
    return lk.run(arm, lk.Hold(T_wt, 1.5), controller)


runs = {
    "one turn, in world axes": turn_the_hand(my_orientation_error),
    "roll, pitch, yaw subtracted": turn_the_hand(euler_difference),
    "in the tool's axes": turn_the_hand(in_tool_axes),
}
off = {
    name: np.degrees([lk.se3.angle_between(T_wt[:3, :3], model.pose(q)[:3, :3]) for q in run.q])
    for name, run in runs.items()
}
predict("farthest_off", truth="abc"[int(np.argmax([angle[-1] for angle in off.values()]))])

# %%
if farthest_off is not None:
    plt.figure(figsize=(8, 3), layout="constrained")
    for (name, angle), style in zip(off.items(), ("-", "--", "-.")):
        plt.plot(runs[name].t, angle, style, label=name)
    plt.xlabel("time [s]")
    plt.ylabel("hand off by [degrees]")
    plt.legend(frameon=False)
    lk.plotting.show(
        "How far the hand is turned away, over 1.5 s. At the end: "
        + "; ".join(f"{name}, {angle[-1]:.1f} degrees" for name, angle in off.items())
        + "."
    )

# %%
right, *wrong = runs
turning = lk.replay.motion_of(
    runs[right],
    "Turning the hand upright",
    label=right,
    ghosts={name: runs[name] for name in wrong},
)
lk.replay.show(turning) if farthest_off else None

# %% [markdown]
# If the hand's axes were those of the world, turned about the vertical only, all three errors would be the same.
# That is why so many programs get away with it. When you test an orientation error, point the hand down and
# tilt it.

# %% [markdown] why="why_farthest_off"
# What did you see the hand do when its error was given in the tool's axes, and why? Look at the columns of `T_wt`:
# say which components of the error change their sign, and what the controller then does.
#
# ### BEGIN SOLUTION
# The hand turned away from its target instead of towards it. In these runs the gripper points down and its x axis
# points back, so the tool's x and z axes point against the world's, or nearly so. Those two components of the error
# have the wrong sign: the feedback about x and z is positive, and the error grows, while y at first decays.
# ### END SOLUTION

# %% [markdown]
# ## Hand in
#
# Run all cells, save, and run the last one once more: it prints a receipt. (START_HERE says it step by step.)

# %% setup=true
lk.hand_in("00_warmup")
