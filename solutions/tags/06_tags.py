# %% [markdown]
# # 06 · From pixels to a moving hand
#
# The fourth trajectory of the report follows an AR tag on a board. Looking up the tag took more than a
# second, and every five seconds the arm jerked towards the new position. Here the tag is on a board in the
# simulated world. The picture is rendered, OpenCV detects the tag, and your functions decide whether the arm
# jerks or glides.
#
# | | |
# |---|---|
# | **You need** | numpy; matrices as poses (00), trajectories (01), or the two boxes below |
# | **Given** | the camera, the detector of corners, a filter's update step, an arm that follows a reference |
# | **You write** | a tag's pose from a picture, a sensor's quality, a blend, a prediction |
# | **Time** | core about 2.5 hours, all about 3 hours; 18 points |
#
# Questions marked *core* are for everybody. Those marked *extension* take the rest of the time: they earn points
# too, but no later question depends on them.
#
# > **Box: poses.** $T_{ab}$ converts coordinates in frame b to frame a: $p_a = T_{ab}\,p_b$. We write c for the
# > camera's frame (z forward, x right, y down in the picture), m for the tag's (z out of the paper), w for the world
# > and t for the tip of the arm.
#
# > **Box: samples.** A reference is a function of time that gives `lk.Sample(position, velocity,
# > acceleration)`, three arrays.
#
# Every cell below runs from the start, solved or not. If your part is missing, a stand-in replaces it and
# says so. The functions are marked; play with everything else as you like.

# %% setup=true
import labkit as lk
from labkit.course import check, predict, use

lk.ready()

# %% setup=true
import cv2
import matplotlib.pyplot as plt
import numpy as np

from labkit import se3
from labkit.tags import detection
from labkit.tags import stream as estimation
from labkit.tags.board import Board

# %% [markdown]
# ## A picture
#
# An arm, a board with an AprilTag of 10 cm, and a camera beside it. (The report's tag was an AR tag. An AprilTag is
# another kind of printed square; for this notebook the difference does not matter.)

# %%
world = lk.World()
arm = lk.Arm("left", world=world)
arm.reset(arm.robot.ready)
T_wt = arm.model.pose(arm.robot.ready)
board = Board(world, lk.Tag(), se3.pose(np.eye(3), T_wt[:3, 3] - [0.0, 0.0, 0.2]))
eye = T_wt[:3, 3] + [0.65, -0.1, 0.35]
camera = lk.Camera(world, lk.looking_at(eye, T_wt[:3, 3] - [0.1, 0.0, 0.1]))

picture = camera.image()
seen = lk.detect_tags(picture, camera, 0.1)
plt.figure(figsize=(7, 5.2), layout="constrained")
plt.imshow(picture)
for tag in seen:
    plt.plot(*np.vstack([tag.corners, tag.corners[:1]]).T, "C1-")
    plt.plot(*tag.corners[0], "C3o", mfc="none", ms=12)
plt.axis("off")
lk.plotting.show(
    f"What the camera sees: the arm above a board with {len(seen)} tag, its outline drawn and its upper "
    "left corner ringed."
)
print(f"corners in pixels:\n{seen[0].corners.round(2)}")

# %% [markdown]
# Those pixels are all that the detector knows. To compute a pose from them, it must know where the corners
# are *on the tag*: in which frame, in which order, and of which square. Two mistakes are common. Corners in
# the opposite order show the tag from behind. And the size is that of the black square, not of the paper. Here they
# are, clockwise as one looks at the tag, from the upper left:

# %%
def tag_corners(size):
    """The corners of a tag's black square in the tag's frame, shape (4, 3) in [m]."""
    h = size / 2
    return np.array([[-h, h, 0.0], [h, h, 0.0], [h, -h, 0.0], [-h, -h, 0.0]])


print(tag_corners(0.1))

# %% [markdown]
# ## A pose
#
# Four points of a plane and their four pixels almost determine the pose. A small square looks nearly the same
# when it is tilted in one direction or in the opposite one. So the method for planes (IPPE) gives two
# candidates, and the error that is left in the picture says which is right. If the tag almost faces the
# camera, the two errors are nearly equal, and no program can tell which candidate is right.

# %% question="tag_pose"
def tag_pose(pixels, K, size):
    """The pose of a tag from its corners in a picture.

    Args:
        pixels: Corners in the order of tag_corners, shape (4, 2) in [px].
        K: The camera's matrix, shape (3, 3) in [px].
        size: Side of the black square, in [m].

    Returns:
        T_cm, the tag's pose in the camera's frame, shape (4, 4).
    """
    ### BEGIN SOLUTION
    from solutions.tags.answers import tag_pose as answer

    return answer(pixels, K, size)
    ### END SOLUTION


# %%
my_tag_pose = use("tag_pose", tag_pose, lambda pixels, K, size: detection.tag_pose(pixels, camera, size))
T_cm = my_tag_pose(seen[0].corners, camera.intrinsics.matrix, 0.1)
T_wm = camera.T_wc @ T_cm
print(f"the tag is at {T_wm[:3, 3].round(4)} m; in truth at {board.T_wm[:3, 3].round(4)} m")
print(f"the other candidate fits {seen[0].ratio:.1f} times worse")

# %% [markdown]
# ## How good is it?
#
# A sensor has two kinds of error. A *bias* is the same each time, so averaging does not help. A *spread*
# changes from picture to picture, and the mean of n pictures has a spread that is $\sqrt n$ times smaller. A
# simulation knows the truth, so both can be measured. The error is truth minus estimate: three numbers for
# the position, and for the orientation the rotation vector of $R_{truth} R_{estimate}^T$. A tag that faces
# the camera is rotated by half a turn, which is exactly where Euler angles jump.

# %% question="sensor_quality"
def sensor_quality(estimates, truth):
    """Bias and covariance of a sensor of poses.

    Args:
        estimates: Poses T_cm, shape (n, 4, 4).
        truth: The pose as it was, shape (4, 4).

    Returns:
        (bias, covariance): of the error, truth minus estimate, shapes (6,) and (6, 6), n - 1 in the
        denominator of the covariance.
    """
    ### BEGIN SOLUTION
    from solutions.tags.answers import sensor_quality as answer

    return answer(estimates, truth)
    ### END SOLUTION


# %%
def first_picture_alone(estimates, truth):
    """The stand-in: the error of the first estimate, and no spread at all."""
    return se3.pose_error(truth, estimates[0]), np.zeros((6, 6))


my_quality = use("sensor_quality", sensor_quality, first_picture_alone)

noisy = lk.Camera(world, camera.T_wc, noise=6.0, seed=1)
truth = se3.inverse(noisy.T_wc) @ board.T_wm
shots = [lk.detect_tags(noisy.tag_image(), noisy, 0.1) for _ in range(25)]
estimates = [tags[0].T_cm for tags in shots if tags]
bias, covariance = my_quality(np.array(estimates), truth)
spread = np.sqrt(np.diag(covariance))
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 2.6), layout="constrained")
for ax, part, scale, unit in ((left, slice(0, 3), 1e3, "mm"), (right, slice(3, 6), 57.3, "degrees")):
    ax.errorbar(range(3), scale * bias[part], scale * spread[part], fmt="o", capsize=6)
    ax.axhline(0.0, color="0.7", linewidth=0.8)
    ax.set_xticks(range(3), ["x (right)", "y (down)", "z (forward)"])
    ax.set_ylabel(f"error [{unit}]")
lk.plotting.show(
    f"Error of place and of tilt from {len(estimates)} of 25 pictures; dots: bias, bars: one standard "
    f"deviation. Along z it is {1e3 * spread[2]:.2f} mm, across {1e3 * spread[:2].max():.2f} mm."
)

# %%
def depth_spread(distance, pictures=12):
    """Standard deviation of the depth of a tag that faces the camera askew, in [m]."""
    place = board.T_wm[:3, 3]
    view = np.array([0.6, -0.1, 0.5]) / np.linalg.norm([0.6, -0.1, 0.5])
    there = lk.Camera(world, lk.looking_at(place + distance * view, place), noise=6.0, seed=2)
    shots = [lk.detect_tags(there.tag_image(), there, 0.1) for _ in range(pictures)]
    return np.std([tags[0].T_cm[2, 3] for tags in shots if tags], ddof=1)


near, far = depth_spread(0.6), depth_spread(1.2)
print(f"the depth spreads by {1e3 * near:.2f} mm at 0.6 m and by {1e3 * far:.2f} mm at 1.2 m")
print("Twelve pictures tell a spread to a fifth, so their ratio is uncertain by 30 %. From 300 pictures")
print("at each distance it is about 3: the square of the distance gives 4, but the detector looks at no")
print("more than 1,500 pixels, which are a smaller share of a near tag.")

# %% [markdown]
# The position along the line of sight is measured worst, because a tag that comes nearer changes the picture
# least. In the figure with the bars, each bar reaches one standard deviation of a single picture to either side of
# its dot, and more pictures do not make it shorter. The dot is the mean of 25 pictures, which scatters five times
# less. So a dot that is farther from zero than half of this standard deviation shows a bias, and more pictures would
# not move it to zero. The book shows the same over distance, angle, resolution and noise.
#
# ## Algorithm 1, and why it jerks
#
# The report's algorithm looks at the tag, draws a line from where the tip is to where the tag was, follows
# the line, and looks again five seconds later. Each line begins at rest, although the arm may be moving. Here
# the tag moves at 5 cm/s and jumps aside once. Look at the speed of the *reference*: no controller can follow
# a step.

# %%
def tag_place(t):
    """Where the tag is, in one coordinate: along at 5 cm/s, and 10 cm aside after 6 s."""
    return 0.05 * t + 0.1 * (t > 6.0)


def algorithm_1(times, every=5.0, takes=3.0):
    """The reference of the report's Algorithm 1."""
    here, line, began, samples = 0.0, None, 0.0, []
    for t in times:
        if line is None or t - began >= every:
            goal, began = tag_place(t), t
            line = lk.Trajectory(lk.Line(np.array([here]), np.array([goal])), lk.BangBang(takes))
        samples.append(line(t - began))
        here = samples[-1].position[0]
    return samples


times = np.arange(0.0, 16.0, 0.01)
report = algorithm_1(times, takes=6.0)


def show_reference(samples, title):
    """Position and velocity of a reference over time, beside the tag."""
    figure, (above, below) = plt.subplots(2, 1, figsize=(8, 4), sharex=True, layout="constrained")
    above.plot(times, [tag_place(t) for t in times], "0.6", label="tag")
    above.plot(times, [x.position[0] for x in samples], "C0--", label="reference")
    above.set_ylabel("position [m]")
    above.legend(frameon=False)
    below.plot(times, [x.velocity[0] for x in samples], "C3")
    below.set_ylabel("velocity [m/s]")
    below.set_xlabel("time [s]")
    above.set_title(title, loc="left", fontsize="medium")
    fastest = max(abs(x.velocity[0]) for x in samples)
    lk.plotting.show(
        f"{title}: position and velocity over time. The largest speed is {fastest:.2f} m/s."
    )


show_reference(report, "Algorithm 1, lines of 6 s, a look every 5 s")

# %% [markdown]
# The cure is not a better controller but a better reference: one that begins with the reference's present
# motion. A polynomial of fifth order has six coefficients, enough for position, velocity and acceleration at
# both ends.

# %% question="blend"
def blend(t, reference, goal, duration):
    """From a reference in motion to a goal in motion, without a jump.

    Args:
        t: Time since the blend began, in [s], at least 0.
        reference: lk.Sample of what the reference did when it began, shape (n,) each.
        goal: lk.Sample of where to be at the end, how fast, with what acceleration, shape (n,) each.
        duration: How long it lasts, in [s].

    Returns:
        lk.Sample at time t; after the end the goal's velocity goes on.
    """
    ### BEGIN SOLUTION
    from solutions.tags.following import blend as answer

    return answer(t, reference, goal, duration)
    ### END SOLUTION


# %%
def given_blend(t, reference, goal, duration):
    """No blend: stay where the reference was."""
    return lk.Sample(reference.position, 0 * reference.velocity, 0 * reference.acceleration)


my_blend = use("blend", blend, given_blend)


def blended(times, every=0.5, ahead=1.0):
    """A look every half second, each bending the reference towards the tag a second ahead."""
    zero = np.zeros(1)
    start = goal = lk.Sample(zero, zero, zero)
    began, samples = 0.0, []
    for k, t in enumerate(times):
        if k % round(every / 0.01) == 0:
            start, began = (samples[-1] if samples else start), t
            place = np.array([tag_place(t) + 0.05 * ahead])
            goal = lk.Sample(place, np.array([0.05]), zero)
        samples.append(lk.Sample(*my_blend(t - began, start, goal, ahead)))
    return samples


show_reference(blended(times), "Blends of 1 s, a look every 0.5 s")

# %% [markdown]
# ## The age of a picture
#
# The step in the speed is gone. Where the tag jumps, the reference is faster than before, because it covers 10 cm in about
# a second. But it does so smoothly, and an arm can follow that.
#
# In that figure the reference knew the tag's speed and saw it without delay. A real reading is late: by the
# time the picture is taken, sent and understood, it is 100 ms old, and at 0.1 m/s the tag is 10 mm further
# on. So estimate a position *and a velocity*, and carry both forward to the present. The estimate has a mean
# $m$ (position, velocity) and a covariance $P$. If unknown pushes act like white noise of power $q$, then
# $\tau$ seconds later
#
# $$ m' = F m, \quad P' = F P F^T + Q, \quad F = \begin{bmatrix} I & \tau I \\ 0 & I \end{bmatrix}, $$
#
# and $Q$ is the uncertainty that the pushes add: $\int_0^\tau F(s)\,\mathrm{diag}(0, qI)\,F(s)^T ds$. Compute
# this integral. It must vanish with $\tau$, and two half steps must give the same as one whole step.

# %% question="carry_forward"
def carry_forward(mean, covariance, age, accel_noise):
    """Carry a belief forward in time.

    Args:
        mean: Position [m] and velocity [m/s], shape (6,).
        covariance: Of the mean, in the squares of its units, shape (6, 6).
        age: How far forward, in [s].
        accel_noise: Power of the unknown acceleration, in [m^2/s^3].

    Returns:
        (mean, covariance) then.
    """
    ### BEGIN SOLUTION
    from solutions.tags.following import carry_forward as answer

    return answer(mean, covariance, age, accel_noise)
    ### END SOLUTION


# %% [markdown]
# ## Everything together, on the arm
#
# The board goes round on a circle with a radius of 15 cm at 0.1 m/s. The camera takes ten pictures a second; each reading
# is 100 ms old when it arrives. Between the readings your `carry_forward` says where the tag is, your `blend`
# bends the reference towards it, and the arm follows the reference in position mode. The filter's update is
# given.

# %%
def given_carry_forward(mean, covariance, age, accel_noise):
    """No prediction: the old picture is taken for now."""
    return mean, covariance + 1e-4 * np.eye(6)


my_carry_forward = use("carry_forward", carry_forward, given_carry_forward)

offset = np.array([0.0, 0.0, 0.2])
radius, speed = 0.15, 0.1
centre = T_wt[:3, 3] - offset - [0.0, radius, 0.0]


def round_it_goes(t):
    w = speed / radius
    out = np.array([-np.sin(w * t), np.cos(w * t), 0.0])
    on = np.array([-out[1], out[0], 0.0])
    return lk.Sample(centre + radius * out, speed * on, -speed * w * out)


class Follower:
    """Readings in, a smooth reference out."""

    def __init__(self, ahead=0.45):
        zero = np.zeros(3)
        self.belief, self.ahead, self.began = None, ahead, 0.0
        self.start = self.goal = lk.Sample(T_wt[:3, 3], zero, zero)

    def __call__(self, t, readings):
        for reading in readings:
            place, noise = reading.T_wm[:3, 3], reading.covariance[:3, :3]
            if self.belief is None:
                self.belief = estimation.first_estimate(reading.stamp, place, noise, speed)
            else:
                age = reading.stamp - self.belief.t
                then = my_carry_forward(self.belief.mean, self.belief.covariance, age, 0.005)
                self.belief = estimation.update(estimation.Estimate(reading.stamp, *then), place, noise)
        if readings:
            mean, _ = my_carry_forward(*self.belief[1:], t + self.ahead - self.belief.t, 0.005)
            self.start, self.began = self.sample(t), t
            self.goal = lk.Sample(mean[:3] + offset, mean[3:], np.zeros(3))
        point = self.sample(t)
        still = np.zeros(3)
        return lk.PoseSample(
            se3.pose(T_wt[:3, :3], point.position),
            np.concatenate([point.velocity, still]),
            np.concatenate([point.acceleration, still]),
        )

    def sample(self, t):
        return lk.Sample(*my_blend(t - self.began, self.start, self.goal, self.ahead))


def position_mode(state, target):
    """Joint angles for the reference's pose; the arm's own position mode does the rest."""
    shown(state.t - began)
    return lk.JointPosition(arm.model.inverse_kinematics(target.pose, state.q, posture=arm.robot.ready))


arm.reset(arm.robot.ready)
board.place(se3.pose(np.eye(3), round_it_goes(0.0).position))
board.move(round_it_goes)
watching = lk.Camera(world, lk.looking_at(centre + [0.75, -0.1, 0.45], centre))
follow = lk.TagTarget(lk.TagStream(watching, board.tag, rate=10.0, delay=0.1), Follower())
shown, began = lk.plotting.progress("following the tag", 10.0), world.t
log = lk.run(arm, follow, position_mode, rate=100.0, duration=10.0)
shown(10.0)

goal = np.array([round_it_goes(t).position + offset for t in log.t])
tips = np.array([arm.model.pose(q)[:3, 3] for q in log.q])
error = 1e3 * np.linalg.norm(goal - tips, axis=1)
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.4), layout="constrained")
left.plot(goal[:, 0], goal[:, 1], "0.6", linewidth=4, label="above the tag")
left.plot(tips[:, 0], tips[:, 1], "C0--", label="tip")
left.axis("equal")
left.set_xlabel("x [m]")
left.set_ylabel("y [m]")
left.legend(frameon=False)
right.plot(log.t, error, "C3")
right.set_xlabel("time [s]")
right.set_ylabel("following error [mm]")
late = error[len(error) // 2 :]
lk.plotting.show(
    "The tip follows the tag: its path from above, and how far it is off. In the second half of the run the "
    f"following error is {np.sqrt(np.mean(late**2)):.1f} mm RMS, {late.max():.1f} mm at most."
)

# %% [markdown]
# If all functions are yours, the tip stays about 6 mm outside the circle. The cause is neither the arm nor
# noise: after each reading, which is 0.1 s old, the reference aims at where the tag will be in 0.45 s if it moves
# straight on. A tag on a circle does not move straight on: in these 0.55 s it leaves its tangent by
# $v^2 t^2 / 2 r$, which is 10 mm. The next reading bends the reference anew before it gets there. What would
# help, besides looking less far ahead?
#
# Here is the same run as an arm. Its error is the distance from the reference, not from the tag: it shows how
# well the arm follows once the reference is smooth.

# %%
lk.replay.show(lk.replay.motion_of(log, "The arm in the same run", label="the hand"))

# %% [markdown]
# Now move the tag yourself. Press *Start* and drag it with the mouse: the hand follows, some tenths of a
# second behind, and overshoots where you turn. Where it cannot reach, it waits. Drag the tag out of the
# camera's sight: what does the prediction do? (While this runs, only this cell can use the arm; *Stop* releases it.)

# %%
def by_camera(state, target):
    try:
        q = arm.model.inverse_kinematics(target.pose, state.q, posture=arm.robot.ready)
    except lk.errors.Unreachable:  # wait until the tag comes back
        q = state.q
    return lk.JointPosition(q)


arm.reset(arm.robot.ready)
board.place(se3.pose(np.eye(3), T_wt[:3, 3] - offset))
stream = lk.TagStream(watching, board.tag, rate=10.0, delay=0.1)
mine = my_carry_forward is not given_carry_forward and my_blend is not given_blend
law = "position mode after your prediction" if mine else "position mode after a stand-in"
view = lk.live(arm, lk.TagTarget(stream, Follower()), {law: by_camera}, rate=100.0, title="You move the tag")
view

# %% [markdown]
# ## Hand in
#
# Run everything once more from the top (*Kernel, Restart Kernel and Run All Cells*) and save the file. Then
# run only the last cell once more: it prints a receipt for the saved file; keep it. `!labkit submit-check 06_tags.ipynb`
# in a new cell runs a copy of that file and says what is missing. Hand in the file without renaming it, in the way your course asks. The grader runs your
# functions on further cases; the text above each stub says what kind of cases.

# %% setup=true
lk.hand_in("06_tags")
