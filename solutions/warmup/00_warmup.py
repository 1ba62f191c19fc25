# %% [markdown]
# # 00 · Warm-up
#
# Three things go wrong in a first robot program, and none of them raises an error: an array has the wrong
# shape and numpy stretches it, a vector is in the wrong axes, or two orientations are subtracted as if they
# were numbers. Here you meet all three, on a simulated arm that shows you at once. You write only a few short
# functions; every later notebook uses the ideas in them.
#
# | | |
# |---|---|
# | **You need** | Python with numpy; matrices and their products |
# | **Given** | the simulated arm, figures, the logarithm of a rotation |
# | **You write** | a joint error, a point from frame to frame, an orientation error |
# | **Time** | core about 1.5 hours, all about 2 hours; 11 points |
#
# How it works: run the cells from the top (Shift+Enter). Every cell runs from the start, solved or not. If
# your part is missing, a stand-in replaces it and says so. After each stub a check tells you in words what it
# found. Above the stub you read which tests your function must pass to earn any points at all, and on which
# hidden cases the grader tries it. All questions of this notebook are *core*: everybody should answer them. The
# half hour on top is for the experiments and the text at the end. Later notebooks also have *extensions*, which
# take more time and earn more points. The functions, your predictions and the text at the end are marked; play with everything else as you
# like.

# %% setup=true
import labkit as lk
from labkit.course import check, hint, predict, use

lk.ready()

# %% setup=true
import matplotlib.pyplot as plt
import numpy as np

# %% [markdown]
# ## Arrays that mislead you
#
# Seven joints, seven numbers: in labkit a vector has the shape `(7,)`, with one index only. A column of shape
# `(7, 1)` holds the same numbers, and numpy will happily combine the two, not into seven numbers but into a
# table of all forty-nine combinations. Here are three numbers instead of seven:

# %%
wanted = np.array([[0.1], [0.2], [0.3]])  # a column, (3, 1)
actual = np.array([0.1, 0.2, 0.3])  # a vector, (3,)
wanted - actual

# %% [markdown]
# The errors should have been three zeros. The sum of that table *is* zero, so a test that looks only at the
# sum passes. The students who wrote the report that this lab grew out of lost days to such shapes. So labkit
# never stretches or squeezes an array; it raises an error:

# %%
try:
    lk.JointVelocity(np.zeros((7, 1)))
except lk.LabkitError as error:
    print(error)

# %% [markdown]
# ## What the arm reports, and what it should do
#
# An arm reports an `lk.State`: the time, the joint angles `q` in rad and the joint speeds `dq` in rad/s. The
# target, what the arm should do, is an `lk.Sample`: position, velocity and acceleration, here of the joints.

# %%
arm = lk.Arm("left")
model, q0 = arm.model, arm.robot.ready
arm.reset(q0)
state = arm.state()
print("t: ", state.t, "s")
print("q: ", state.q.round(3), "rad")
print("dq:", state.dq, "rad/s")

# %% [markdown]
# A controller compares the two. In this course an *error* is always **target minus actual**. So the error
# points to where the arm should go, and a gain in front of it is positive.

# %% question="joint_error"
def joint_error(target, state):
    """The error of the joint angles.

    Args:
        target: An lk.Sample of joint angles: position in [rad], velocity in [rad/s] and
            acceleration in [rad/s^2], each of shape (7,).
        state: An lk.State: time t in [s], angles q in [rad] and speeds dq in [rad/s], q and dq
            of shape (7,).

    Returns:
        Target minus actual, shape (7,), in [rad].
    """
    ### BEGIN SOLUTION
    from solutions.warmup.answers import joint_error as answer

    return answer(target, state)
    ### END SOLUTION


# %% [markdown]
# ## The arm goes where the error points
#
# The simplest controller turns each joint at a speed proportional to its error. It has one number, the gain
# `k` in 1/s. The error then shrinks like $e^{-kt}$, because the speed of a joint *is* the rate at which its
# error falls: $\dot e = -\dot q = -k\,e$.
#
# The next cell sends the arm to other angles, at most half a radian away. The dashed line is $e^{-kt}$ for the
# first joint. (While your function is missing, a stand-in reports no error, and the arm does not move.)

# %%
def stays(target, state):
    """The stand-in: no error, so the arm stays where it is."""
    return np.zeros(7)


my_joint_error = use("joint_error", joint_error, stays)


def towards_target(state, target, k=2.0):
    return lk.JointVelocity(k * my_joint_error(target, state))


q1 = q0 + [0.5, 0.2, 0.0, -0.3, 0.0, 0.1, 0.4]
arm.reset(q0)
log = lk.run(arm, lk.Hold(q1, 3.0), towards_target)
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
# Here is the same run in three dimensions. Press *Play*, or move the slider to go back and forth in time;
# drag to look around. The see-through arm is the target, which does not move. (If you save a notebook and
# open it again, you see a picture instead of the replay until you run the cell once more.)

# %%
lk.replay.show(lk.replay.motion_of(log, "Towards a place in joint space"))

# %% [markdown]
# ## Frames that cancel
#
# A *frame* is an origin with three axes. The pose of frame b seen from frame a is written $T_{ab}$, a 4 by 4
# matrix with the rotation $R_{ab}$ in its upper left and the position of b's origin in its upper right. It
# converts coordinates in b to coordinates in a,
#
# $$ p_a = T_{ab}\,p_b, \qquad T_{ac} = T_{ab}\,T_{bc}, $$
#
# and the neighbouring letters must be equal. If you read the subscripts, you avoid most mistakes (Murray, Li
# and Sastry, *A Mathematical Introduction to Robotic Manipulation*, section 2.3).
#
# The model gives the pose of the gripper's tip in the world, $T_{wt}$. (Where a text or a label says *tool*, it means
# this tip; the *hand* is the body that carries the gripper.) With the gripper pointing down
# the tip's z axis, the third column, points down too:

# %%
T_wt = model.pose(q0)
print(T_wt.round(3))

# %% question="transform_point"
def transform_point(T_ab, p_b):
    """A point's coordinates in another frame.

    Args:
        T_ab: Pose of frame b in frame a, shape (4, 4).
        p_b: The point in b, shape (3,), in [m].

    Returns:
        The same point in a, shape (3,), in [m].
    """
    ### BEGIN SOLUTION
    from solutions.warmup.answers import transform_point as answer

    return answer(T_ab, p_b)
    ### END SOLUTION


# %% [markdown]
# Now use it. A camera is mounted in the hand and sees a cup 30 cm ahead of it, a little to the side. Where is
# the cup in the world, and where is it seen from the gripper's tip? `lk.se3.inverse` gives the pose in the other
# direction, of a seen from b: the transpose of a rotation is its inverse.

# %%
def nobody_knows(T_ab, p_b):
    """The stand-in: not a number."""
    return np.full(3, np.nan)


my_transform_point = use("transform_point", transform_point, nobody_knows)

T_hand_tip, T_hand_camera = arm.robot.T_hand_tip, arm.robot.T_hand_camera
T_tip_camera = lk.se3.inverse(T_hand_tip) @ T_hand_camera
cup_camera = np.array([0.05, 0.02, 0.3])
cup_tip = my_transform_point(T_tip_camera, cup_camera)
cup_world = my_transform_point(T_wt, cup_tip)
print("seen by the camera:", cup_camera.round(3))
print("seen by the tip:   ", cup_tip.round(3))
print("in the world:      ", cup_world.round(3))

# %% [markdown]
# ## How far is the hand turned?
#
# Now comes a mistake that misled several teams, among them the students who wrote the report of 2019 from which
# this lab grew. The hand should point
# straight down, but it is tilted by a few degrees. What is the error?
#
# It is tempting to write both orientations as roll, pitch and yaw and to subtract. But these three angles are
# not the components of a vector: they are three turns, one after the other, about axes that the earlier turns
# have moved. The error that a controller can use is *one* turn, about one axis, that takes the actual
# orientation to the desired one:
#
# $$ E\,R_{wt} = R_{wd} . $$
#
# Its axis times its angle is a vector $e_o$, in world axes, the *logarithm* of $E$. It points along the axis
# about which the hand should turn, and its length is the angle. `lk.se3.rotation_log` gives it for any
# rotation (Lynch and Park, *Modern Robotics*, sections 3.2.3 and 11.3.3).

# %% question="orientation_error"
def orientation_error(R_wd, R_wt):
    """The turn that takes the tip from its actual to the desired orientation.

    Args:
        R_wd: Desired orientation in the world, shape (3, 3).
        R_wt: Actual orientation of the tip in the world, shape (3, 3).

    Returns:
        Rotation vector in world axes, shape (3,), in [rad].
    """
    ### BEGIN SOLUTION
    from solutions.warmup.answers import orientation_error as answer

    return answer(R_wd, R_wt)
    ### END SOLUTION


# %%
my_orientation_error = use("orientation_error", orientation_error, lk.se3.orientation_error)

down = np.diag([1.0, -1.0, -1.0])
tilted_down = down @ lk.se3.rotation([0.15, 0.12, 0.06])
in_world = my_orientation_error(down, tilted_down)
in_tool = tilted_down.T @ in_world
print("in world axes:", in_world.round(2), "  in the tool's axes:", in_tool.round(2))

# %% [markdown]
# ## Let the arm decide
#
# The hand starts 12 degrees off, and a controller turns it at a speed proportional to the error. The
# Jacobian, which notebook 02 explains, converts this to joint speeds. There are three runs that differ only
# in the error that the controller uses: (1) your error; (2) the difference of roll, pitch and yaw; (3) your error,
# but by mistake in the tool's axes.

# %% predict="farthest_off"

# %%
def euler_difference(R_wd, R_wt):
    def angles(R):
        return np.array(
            [
                np.arctan2(R[2, 1], R[2, 2]),
                np.arctan2(-R[2, 0], np.hypot(R[2, 1], R[2, 2])),
                np.arctan2(R[1, 0], R[0, 0]),
            ]
        )

    return angles(R_wd) - angles(R_wt)


def in_tool_axes(R_wd, R_wt):
    return R_wt.T @ my_orientation_error(R_wd, R_wt)


T_wd = T_wt
tilted = lk.se3.pose(T_wt[:3, :3] @ lk.se3.rotation([0.15, 0.12, 0.06]), T_wt[:3, 3])
q_tilted = model.inverse_kinematics(tilted, q0)


def turn_the_hand(error, k=2.0):
    """A run that starts tilted and turns the tip by k times the error; returns the log."""

    def controller(state, target):
        turn = error(target.pose[:3, :3], model.pose(state.q)[:3, :3])
        twist = np.concatenate([np.zeros(3), np.clip(k * turn, -1.0, 1.0)])
        return lk.JointVelocity(np.linalg.pinv(model.tip_jacobian(state.q)) @ twist)

    arm.reset(q_tilted)
    return lk.run(arm, lk.Hold(T_wd, 1.5), controller)


runs = {
    "one turn, in world axes": turn_the_hand(my_orientation_error),
    "roll, pitch, yaw subtracted": turn_the_hand(euler_difference),
    "in the tool's axes": turn_the_hand(in_tool_axes),
}
angles = {
    name: np.degrees([lk.se3.angle_between(T_wd[:3, :3], model.pose(q)[:3, :3]) for q in run.q])
    for name, run in runs.items()
}
predict("farthest_off", truth="abc"[int(np.argmax([angle[-1] for angle in angles.values()]))])

# %% [markdown]
# Here is how far each of the three hands was off. (The figure and the replay wait for your prediction.)

# %%
if farthest_off is not None:
    plt.figure(figsize=(8, 3), layout="constrained")
    for (name, angle), style in zip(angles.items(), ("-", "--", "-.")):
        plt.plot(runs[name].t, angle, style, label=name)
    plt.xlabel("time [s]")
    plt.ylabel("hand off by [degrees]")
    plt.legend(frameon=False)
    lk.plotting.show(
        "How far the hand is turned away, over 1.5 s. At the end: "
        + "; ".join(f"{name}, {angle[-1]:.1f} degrees" for name, angle in angles.items())
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
# (The plot under the arm shows the error of the tip's *position*; the tilt is in the figure above.) If the
# hand's axes were those of the world, turned about the vertical only, all three errors would be the same.
# That is why so many programs get away with it. When you test an orientation error, point the hand down and
# tilt it.

# %% [markdown] why="why_farthest_off"
# What did you see the hand do when its error was given in the tool's axes, and why? Look at the columns of `T_wt`,
# which is the target of these runs: say which components of the error change their sign, and what the controller
# then does.
#
# ### BEGIN SOLUTION
# The hand turned away from its target instead of towards it. In these runs the gripper points down and its x axis
# points back, so the tool's x and z axes point against the world's, or nearly so. Those two components of the error
# have the wrong sign: the feedback about x and z is positive, and the error grows, while y at first decays.
# ### END SOLUTION

# %% [markdown]
# ## Hand in
#
# Run everything once more from the top (*Kernel, Restart Kernel and Run All Cells*) and save the file. Then
# run only the last cell once more: it prints a receipt for the saved file; keep it. `!labkit submit-check 00_warmup.ipynb`
# in a new cell runs a copy of that file and says what is missing. Hand in the file without renaming it, in the way your course asks. The grader runs your
# functions on further cases; the text above each stub says what kind of cases.

# %% setup=true
lk.hand_in("00_warmup")
