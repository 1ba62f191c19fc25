# %% [markdown]
# # 06 · From pixels to a moving hand
#
# The report's fourth trajectory follows an AR tag. Its Algorithm 1 looks, draws a line, follows it, and looks
# again five seconds later: the arm jerked. Here a picture is rendered, OpenCV finds the tag's corners, and your
# functions decide whether the arm jerks, glides or runs away.
#
# | | |
# |---|---|
# | **You need** | poses as matrices (00), trajectories (01), or the box below |
# | **Given** | the camera, the detector, a hand that follows a reference, an arm |
# | **You write** | which pose fits a picture, Algorithm 1, a blend, a servo that glides |
# | **Time** | core 3 hours, 18 points; all 4.1 hours, 26 points. After 3 hours, stop writing and read the rest. |
#
# > **Box.** $T_{ab}$ takes coordinates in frame b to frame a, so neighbouring subscripts match: $T_{wt} T_{tc}
# > T_{cm}$. Frames: w world, t tip, c camera (z forward, x right, y down), m tag (z out of the paper). A
# > reference is a function of time that gives `lk.Sample(position, velocity, acceleration)`.

# %% setup=true
import cv2
import matplotlib.pyplot as plt
import numpy as np

import labkit as lk
from labkit import se3, servo
from labkit.course import check, predict, use
from labkit.tags import Board

lk.ready()

# %% [markdown]
# ## A picture, and two poses
#
# A tag of 10 cm below the tip, and a camera beside the arm.

# %%
world = lk.World()
arm = lk.Arm("left", world=world)
arm.reset(arm.robot.ready)
T_wt = arm.model.pose(arm.robot.ready)
board = Board(world, lk.Tag(), se3.pose(np.eye(3), T_wt[:3, 3] - [0.0, 0.0, 0.2]))
eye = T_wt[:3, 3] + [0.65, -0.1, 0.35]
camera = lk.Camera(world, lk.looking_at(eye, T_wt[:3, 3] - [0.1, 0.0, 0.1]))
picture = camera.image()
seen = lk.detect_tags(picture, camera, 0.1)[0]
plt.figure(figsize=(6, 4.5), layout="constrained")
plt.imshow(picture)
plt.plot(*np.vstack([seen.corners, seen.corners[:1]]).T, "C1-")
plt.plot(*seen.corners[0], "C3o", mfc="none", ms=12)
plt.axis("off")
lk.plotting.show("What the camera sees: the tag's outline, with its upper left corner ringed.")

# %% [markdown]
# Four pixels are all that the detector knows. A pose needs the same corners *on the tag*, in metres and in the
# same order: clockwise from the upper left. Their square looks nearly the same when it is tilted to one side or
# to the other, so the method for planes (IPPE) gives two candidates. Only the picture can tell which is right:
# project the corners with each, and see which come nearer.

# %%
def tag_corners(size):
    """The corners of a tag's black square in the tag's frame, shape (4, 3) in [m]."""
    h = size / 2
    return np.array([[-h, h, 0.0], [h, h, 0.0], [h, -h, 0.0], [-h, -h, 0.0]])


def two_candidates(pixels, K, size):
    """Both poses T_cm that a flat square may have, shape (2, 4, 4)."""
    found = cv2.solvePnPGeneric(tag_corners(size), pixels, K, None, flags=cv2.SOLVEPNP_IPPE_SQUARE)
    return np.array([se3.pose(cv2.Rodrigues(r)[0], p[:, 0]) for r, p in zip(*found[1:3])])


# %% question="tag_pose"
def tag_pose(candidates, pixels, K, size):
    """The better candidate and its error.

    Args:
        candidates: Two poses T_cm, shape (2, 4, 4), in no order.
        pixels: Corners, ordered as in tag_corners, shape (4, 2) in [px].
        K: The camera's matrix, shape (3, 3) in [px].
        size: Side of the black square, in [m].

    Returns:
        (T_cm, error), the error in [px].
    """
    ### BEGIN SOLUTION
    from solutions.tags.answers import tag_pose as answer

    return answer(candidates, pixels, K, size)
    ### END SOLUTION


# %%
my_tag_pose = use("tag_pose", tag_pose, lambda candidates, pixels, K, size: (candidates[0], np.nan))
K = camera.intrinsics.matrix
T_cm, error = my_tag_pose(two_candidates(seen.corners, K, 0.1)[::-1], seen.corners, K, 0.1)
print(f"the tag is at {(camera.T_wc @ T_cm)[:3, 3].round(4)} m, with an error of {error:.3f} px")
print(f"in truth it is at {board.T_wm[:3, 3].round(4)} m")

# %% [markdown]
# How good is such a reading? A *bias* is the same each time, so averaging does not help; a *spread* changes from
# picture to picture. A simulation knows the truth, so it can tell the two apart.

# %%
noisy = lk.Camera(world, camera.T_wc, noise=6.0, seed=1)
truth = se3.inverse(noisy.T_wc) @ board.T_wm
shots = [lk.detect_tags(noisy.tag_image(), noisy, 0.1) for _ in range(25)]
estimates = np.array([tags[0].T_cm for tags in shots if tags])
off = 1e3 * (truth - estimates)[:, :3, 3]
plt.figure(figsize=(5, 2.4), layout="constrained")
plt.errorbar(range(3), off.mean(axis=0), off.std(axis=0, ddof=1), fmt="o", capsize=6)
plt.axhline(0.0, color="0.7", linewidth=0.8)
plt.xticks(range(3), ["x (right)", "y (down)", "z (forward)"])
plt.ylabel("error [mm]")
lk.plotting.show(
    f"Error of the tag's place in {len(estimates)} pictures: dots the mean, bars one standard deviation. Along z "
    f"it is {off[:, 2].std(ddof=1):.2f} mm, across {off[:, :2].std(axis=0, ddof=1).max():.2f} mm."
)

# %% [markdown]
# What you should have seen: depth is measured worst, because a tag that comes nearer changes the picture least.
#
# ## Algorithm 1
#
# Now the camera sits in the hand. A sighting says where the tag was *in the camera*, at its stamp; when it
# arrives, the hand has moved on. So it needs the hand of then. The trap is a law that looks right while the arm
# is at rest.

# %% question="servo_step"
def servo_step(t, memory, sighting, hand, T_tc, T_mg, *, every, moved, seconds):
    """One step of Algorithm 1.

    Args:
        t: Now, in [s].
        memory: servo.Memory(goal, line, began, looked): the goal's pose T_wg, the reference as a function of
            the seconds since `began`, and when it last looked.
        sighting: (stamp, T_cm), or None if the latest picture shows no tag.
        hand: A function of time that gives T_wt, the tip's pose then.
        T_tc: The camera in the tip's frame.
        T_mg: The tip's goal in the tag's frame.
        every: Seconds between two looks.
        moved: How far the goal must have moved for a new line, in [m].
        seconds: Duration of a new line.

    Returns:
        The new servo.Memory.
    """
    ### BEGIN SOLUTION
    from solutions.tags.answers import servo_step as answer

    return answer(
        t, memory, sighting, hand, T_tc, T_mg, every=every, moved=moved, seconds=seconds
    )
    ### END SOLUTION


# %%
my_step = use("servo_step", servo_step, lambda t, memory, *frames, **options: memory)
T_tc = se3.pose(se3.rotation([0.0, 0.54, 0.0]), [-0.12, 0.0, 0.0])
T_mg = se3.inverse(board.T_wm) @ T_wt
LOOK = {"every": 1.0, "moved": 0.005, "seconds": 2.0}


def show_chase(runs):
    """Place along the belt and speed of the reference, for runs by name."""
    figure, (above, below) = plt.subplots(2, 1, figsize=(7.5, 4), sharex=True, layout="constrained")
    first = next(iter(runs.values()))
    above.plot(first.t, first.goal[:, 0], "0.6", linewidth=4, label="goal")
    for (name, run), style in zip(runs.items(), ("C0--", "C3-", "C2-.")):
        above.plot(run.t, run.tip[:, 0], style, label=f"tip, {name}")
        below.plot(run.t, run.velocity[:, 0], style)
    span = np.ptp(first.goal[:, 0])
    above.set_ylim(first.goal[:, 0].min() - span, first.goal[:, 0].max() + span)
    above.set_ylabel("x [m]")
    above.legend(frameon=False)
    below.set_ylim(-0.1, 0.2)
    below.set_ylabel("speed of the\nreference [m/s]")
    below.set_xlabel("time [s]")
    said = "; ".join(
        f"{name}: {m['rms_mm']:.3g} mm RMS, largest step of the speed {m['speed_step']:.3g} m/s"
        for name, m in ((name, run.measured()) for name, run in runs.items())
    )
    lk.plotting.show(f"The tip behind a tag on a belt at 3 cm/s. {said}.")


belt = servo.Conveyor(speed=0.03)
show_chase({"a line every second": belt.follow(my_step, T_tc, T_mg, **LOOK)})

# %% [markdown]
# What you should have seen: a saw. Each line begins at rest although the tag moves, so the tip stays 7 cm behind, and the
# speed of the *reference* jumps. No controller can follow a step; the cure is a better reference. (With the
# report's look every 5 s each line ends before the next look, and you would see stops instead.)
#
# ## A blend
#
# A polynomial of fifth order has six coefficients: position, velocity and acceleration at both ends. So a new
# reference can begin with the motion of the old one.

# %% question="blend"
def blend(t, reference, goal, duration):
    """From a reference in motion to a goal in motion, without a jump.

    Args:
        t: Time since the blend began, in [s], at least 0.
        reference: lk.Sample at its beginning, shape (n,) each.
        goal: lk.Sample at its end, shape (n,) each.
        duration: How long it lasts, in [s].

    Returns:
        lk.Sample at time t.
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
start = lk.Sample(np.array([0.0]), np.array([0.1]), np.zeros(1))
end = lk.Sample(np.array([0.05]), np.array([-0.05]), np.zeros(1))
times = np.linspace(0.0, 1.5, 151)
curve = [my_blend(t, start, end, 1.0) for t in times]
plt.figure(figsize=(6, 2.4), layout="constrained")
plt.plot(times, [x.velocity[0] for x in curve], "C3", label="blend")
plt.axhline(0.1, color="0.7", linewidth=0.8)
plt.axhline(-0.05, color="0.7", linewidth=0.8)
plt.xlabel("time [s]")
plt.ylabel("speed [m/s]")
lk.plotting.show("The speed of a blend of 1 s, between the two speeds that it joins (grey).")

# %% [markdown]
# ## A servo that glides
#
# A sighting is late. From several of them, each with its stamp, a straight line gives the tag's velocity, and
# so where it will be. Aim there. `servo.Bend(start, goal, duration)` is your blend as a value that a memory can
# keep.

# %% predict="hand_of_then"

# %% question="servo_smooth"
def servo_smooth(t, memory, sightings, hand, T_tc, T_mg, *, ahead, patience):
    """Bend the reference towards where the goal will be.

    Args:
        t, memory, hand, T_tc, T_mg: As for servo_step.
        sightings: The last few (stamp, T_cm), oldest first.
        ahead: How far ahead it aims, in [s].
        patience: How old the newest sighting may be, in [s].

    Returns:
        The new servo.Memory, whose line is a servo.Bend.
    """
    ### BEGIN SOLUTION
    from solutions.tags.answers import servo_smooth as answer

    return answer(t, memory, sightings, hand, T_tc, T_mg, ahead=ahead, patience=patience)
    ### END SOLUTION


# %%
my_smooth = use("servo_smooth", servo_smooth, lambda t, memory, *frames, **options: memory)
AHEAD = {"ahead": 0.6, "patience": 1.8}


def hand_of_now(t, memory, sightings, hand, *frames, **options):
    """The same servo, told that the hand was always where it is now."""
    return my_smooth(t, memory, sightings, lambda s: hand(t), *frames, **options)


late = servo.Conveyor(speed=0.03, age=0.5)
runs = {
    "every second": late.follow(my_step, T_tc, T_mg, **LOOK),
    "glides": late.follow(my_smooth, T_tc, T_mg, 8, **AHEAD),
    "hand of now": late.follow(hand_of_now, T_tc, T_mg, 8, **AHEAD),
}
if my_smooth is servo_smooth:
    behind = (runs["hand of now"].goal - runs["hand of now"].tip)[-40:, 0]
    predict("hand_of_then", truth="c" if np.ptp(behind) > 1.0 else "ab"[int(behind.mean() < 0.0)])
else:
    print("This is a stand-in: the truth is shown here once your servo is right.")

# %%
if hand_of_then is not None:
    show_chase(runs)

# %% [markdown]
# What you should have seen: the servo that glides is within 3 mm although it sees everything half a second late. With
# the hand of now it takes its own motion for the tag's: the tag seems to flee, the hand follows, and each
# swing is larger than the last. At rest both laws give the same.
#
# ## The arm, and real pictures
#
# Now the arm does it, in position mode, with rendered pictures: five a second, each 0.1 s old when it arrives.

# %%
R_tip = T_wt[:3, :3]
still = np.zeros(3)


class InHand:
    """A target for the arm: pictures from the camera in the hand go in, your servo's reference comes out."""

    def __init__(self):
        self.t = np.inf

    def __call__(self, t):
        if t < self.t:  # a new run
            here = lk.Sample(arm.model.pose(arm.truth().q)[:3, 3], still, still)
            self.memory = servo.Memory(T_wt, servo.Bend(here, here, 1.0), t, t)
            self.times, self.places, self.sightings, self.due = [], [], [], t
        self.t = t
        T_now = arm.model.pose(arm.truth().q)
        self.times, self.places = [*self.times, t][-400:], [*self.places, T_now[:3, 3]][-400:]
        hand = servo.Hand(np.array(self.times), np.array(self.places), R_tip)
        if t >= self.due:
            self.due += 0.2
            camera.place(T_now @ T_tc)
            found = lk.detect_tags(camera.tag_image(), camera, 0.1)
            self.sightings += [(t, tag.T_cm) for tag in found]
        come = [s for s in self.sightings if s[0] <= t - 0.1][-4:]
        self.memory = my_smooth(t, self.memory, come, hand, T_tc, T_mg, **AHEAD)
        p, v, a = self.memory.line(t - self.memory.began)
        return lk.PoseSample(se3.pose(R_tip, p), np.r_[v, still], np.r_[a, still])


def position_mode(state, target):
    """Joint angles for the reference; where it is out of reach, wait."""
    try:
        return lk.JointPosition(
            arm.model.inverse_kinematics(target.pose, state.q, posture=arm.robot.ready)
        )
    except lk.errors.Unreachable:
        return lk.JointPosition(state.q)


def along(t):
    """The tag on a belt at 3 cm/s, sideways."""
    speed = np.array([0.0, -0.03, 0.0])
    return lk.Sample(T_wt[:3, 3] - [0.0, 0.0, 0.2] + speed * t, speed, still)


arm.reset(arm.robot.ready)
board.move(along)
began = world.t
log = lk.run(arm, InHand(), position_mode, rate=50.0, duration=8.0)
tips = np.array([arm.model.pose(q)[:3, 3] for q in log.q])
goals = np.array([board.pose_at(began + t)[:3, 3] for t in log.t]) + [0.0, 0.0, 0.2]
miss = 1e3 * np.linalg.norm(goals - tips, axis=1)
plt.figure(figsize=(6, 2.4), layout="constrained")
plt.plot(log.t, miss, "C3")
plt.xlabel("time [s]")
plt.ylabel("distance from the goal [mm]")
after = miss[log.t > 3.0] if log.t[-1] > 3.0 else miss
lk.plotting.show(f"The arm behind the tag: {np.sqrt(np.mean(after**2)):.1f} mm RMS after 3 s.")

# %%
lk.replay.show(lk.replay.motion_of(log, "The arm in the same run", label="the hand"))

# %% [markdown]
# Now move the tag yourself: press *Start* and drag it. The hand follows some tenths of a second behind, and
# overshoots where you turn: it believes in straight lines. Hide the tag from the camera: for how long does the
# hand go on? (While this runs, only this cell can use the arm; *Pause* releases it.)

# %%
arm.reset(arm.robot.ready)
board.place(se3.pose(np.eye(3), T_wt[:3, 3] - [0.0, 0.0, 0.2]))
law = "your servo" if my_smooth is servo_smooth else "a stand-in, which waits"
view = lk.live(arm, InHand(), {law: position_mode}, rate=50.0, title="You move the tag")
view

# %% [markdown]
# ## Appendix: two extensions
#
# **A sensor's quality in six numbers.** An error has a place and an orientation: three numbers, and the rotation
# vector of $R_{truth} R_{estimate}^T$. A tag that faces the camera is rotated by half a turn, exactly where Euler
# angles jump.

# %% question="sensor_quality"
def sensor_quality(estimates, truth):
    """Bias and covariance of a sensor of poses.

    Args:
        estimates: Poses T_cm, shape (n, 4, 4).
        truth: The pose as it was, shape (4, 4).

    Returns:
        (bias, covariance), shapes (6,) and (6, 6), with n - 1 in the covariance's denominator.
    """
    ### BEGIN SOLUTION
    from solutions.tags.answers import sensor_quality as answer

    return answer(estimates, truth)
    ### END SOLUTION


# %% [markdown]
# **How sure one is of where it will be.** A filter keeps a mean $m$ (position, velocity) and a covariance $P$. If
# unknown pushes act like white noise of power $q$, then $\tau$ seconds later $m' = F m$, $P' = F P F^T + Q$ with
#
# $$ F = \begin{bmatrix} I & \tau I \\ 0 & I \end{bmatrix}, \quad Q = \int_0^\tau F(s)\,\mathrm{diag}(0, qI)\,F(s)^T
# ds. $$
#
# Compute the integral. It must vanish with $\tau$, and two half steps must give the same as one whole step.

# %% question="carry_forward"
def carry_forward(mean, covariance, age, accel_noise):
    """Carry a belief forward in time.

    Args:
        mean: Position [m] and velocity [m/s], shape (6,).
        covariance: Of the mean, shape (6, 6).
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
# ## Hand in
#
# *Kernel, Restart Kernel and Run All Cells*, save, then run only the last cell once more: it prints a receipt.

# %% setup=true
lk.hand_in("06_tags")
