# %% [markdown]
# # 01 · Paths and time
#
# The arm should draw a line, then a circle, and then go round several corners. Before any controller can
# help, the arm needs a target: *where the tip should be at every moment*, at what velocity, and with what
# acceleration. In this notebook you write that target.
#
# | | |
# |---|---|
# | **You need** | numpy; the derivative of a product and of a function of a function |
# | **Given** | the simulated arm, a controller that follows (you write your own in notebook 03), figures |
# | **You write** | two time scalings, a circle, a trajectory from a path and a schedule, a search for the active segment |
# | **Time** | core about 2.5 hours, all about 3 hours; 19 points |
#
# Questions marked *core* are for everybody. Those marked *extension* take the rest of the time: they earn points
# too, but no later question depends on them.
#
# A *path* is geometry: a curve with a parameter `s` from 0 to 1, and no time in it. A *time scaling* is the
# schedule `s(t)`. Together they are a *trajectory*. Because the two are separate, any path can be used with
# any schedule.
#
# Every cell below runs from the start, solved or not. If your part is missing, a stand-in replaces it and
# says so. After each stub a check tells you in words what it found. The functions and your predictions are
# marked; play with everything else as you like.

# %% setup=true
import labkit as lk
from labkit.course import check, hint, predict, use

lk.ready()

# %% setup=true
import matplotlib.pyplot as plt
import numpy as np

# %% [markdown]
# ## The schedule: when to be where
#
# If you ask for too much at the start, the motors cannot follow: the arm lags and then overshoots. So a
# schedule must start and end at rest and keep speed and acceleration within what the arm can do. The simplest
# schedule that does so is *bang-bang*: full acceleration for half of the time, full braking for the other
# half. The report that this lab grew out of moved Baxter like this.
#
# Call the duration $T$. With constant acceleration $a$ the first half is
#
# $$ \ddot s = a, \qquad \dot s = a\,t, \qquad s = \tfrac12 a t^2 . $$
#
# At $T/2$ half of the distance must be covered; that determines $a$. The second half is the first half, run
# backwards from the end. Your function may be called with any time, also before the start and after the end.

# %% question="bang_bang"
def bang_bang(t, duration):
    """Bang-bang time scaling.

    Args:
        t: Time since the start, in [s]; any real number.
        duration: How long the motion lasts, in [s].

    Returns:
        (s, ds, dds): s from 0 to 1, its speed in [1/s] and its acceleration in [1/s^2]. At rest,
        all derivatives 0, before the start and from the end of the motion on.
    """
    ### BEGIN SOLUTION
    from solutions.paths.answers import bang_bang as answer

    return answer(t, duration)
    ### END SOLUTION


# %% [markdown]
# Here is your schedule as a picture. Look at the lowest curve: where it jumps, the arm jerks. Whoever never jumps
# pays with a higher peak.

# %%
def given_bang_bang(t, duration):
    """The stand-in: at an even speed, with a jerk at both ends."""
    on = 0.0 < t < duration
    return min(max(t / duration, 0.0), 1.0), 1.0 / duration if on else 0.0, 0.0


my_bang_bang = use("bang_bang", bang_bang, given_bang_bang)


class Schedule:
    """A function (t, ...) -> (s, ds, dds) with its numbers filled in, and its duration."""

    def __init__(self, function, duration, *numbers):
        self.function, self.duration, self.numbers = function, duration, numbers

    def __call__(self, t):
        return self.function(t, *self.numbers)


bang = Schedule(my_bang_bang, 3.0, 3.0)
schedules = (lk.BangBang(3.0), lk.Quintic(3.0))
peaks = [max(abs(schedule(t)[2]) for t in np.linspace(0, 3, 601)[:-1]) for schedule in schedules]
lk.plotting.scaling(("bang-bang", bang), ("cubic", lk.Cubic(3.0)), ("quintic", lk.Quintic(3.0)))
lk.plotting.show(
    "Three schedules over 3 s: s, its speed and its acceleration. The acceleration of the cubic jumps at the "
    "ends, that of the quintic nowhere. Where does yours jump? The peak of the acceleration is "
    f"{peaks[0]:.2f} 1/s² with bang-bang and {peaks[1]:.2f} 1/s² with the quintic."
)

# %% [markdown]
# ## Limits are in metres
#
# A longer distance in the same time needs more speed. Usually the duration is not given: the arm has a top
# speed $v_{max}$ and a top acceleration $a_{max}$, in m/s and m/s², and the duration follows from the
# distance. Speed up at $a_{max}$, cruise at $v_{max}$, brake at $a_{max}$: the graph of the speed is a
# *trapezoid*.
#
# There are two traps. Over a short distance the arm never reaches $v_{max}$, and the trapezoid becomes a
# triangle. And $s$ has no unit: a limit in metres does not bound $\dot s$ but $d\,\dot s$, where $d$ is the
# distance.

# %% question="trapezoid"
def trapezoid(t, distance, v_max, a_max):
    """Trapezoidal time scaling of a path of given length.

    Args:
        t: Time since the start, in [s]; any real number.
        distance: Length of the path, in [m], greater than 0.
        v_max: Top speed, in [m/s].
        a_max: Top acceleration, in [m/s^2].

    Returns:
        (s, ds, dds): s from 0 to 1, its speed in [1/s] and its acceleration in [1/s^2]. At rest,
        all derivatives 0, before the start and from the end of the motion on.
    """
    ### BEGIN SOLUTION
    from solutions.paths.answers import trapezoid as answer

    return answer(t, distance, v_max, a_max)
    ### END SOLUTION


# %%
def given_trapezoid(t, distance, v_max, a_max):
    """The stand-in: at an even speed, whatever the limits."""
    return given_bang_bang(t, lk.Trapezoid(distance, v_max, a_max).duration)


my_trapezoid = use("trapezoid", trapezoid, given_trapezoid)


def within_limits(distance, v_max=0.2, a_max=0.4):
    """Your schedule for a path of this length."""
    duration = lk.Trapezoid(distance, v_max, a_max).duration
    return Schedule(my_trapezoid, duration, distance, v_max, a_max)


long, short = within_limits(0.30), within_limits(0.05)
lk.plotting.scaling(("0.30 m: a trapezoid", long), ("0.05 m: a triangle", short))
lk.plotting.show(
    f"Two distances within the same limits. A trapezoid over 0.30 m takes {long.duration:.2f} s and cruises; "
    f"over 0.05 m it is a triangle of {short.duration:.2f} s, which never reaches the top speed."
)

# %% [markdown]
# ## The path: where
#
# A straight line from $p_0$ to $p_1$ is $p(s) = p_0 + s\,(p_1 - p_0)$: its derivative with respect to $s$ is
# $p_1 - p_0$ everywhere, and the second one is zero. `lk.Line` is this path. It returns an `lk.Sample`, three
# arrays with names:

# %%
lk.Line([0.6, 0.3, 0.1], [0.8, 0.1, 0.1])(0.5)

# %% [markdown]
# A circle takes a little more. It is level, begins and ends at a start point and goes round the vertical axis
# through a centre. In the report the centre was an AR tag on the table, below the gripper. The report's
# equations measured the radius in space, from the gripper down to the tag, and left the angle of the start out of
# the velocity, though not out of the position. Write the circle correctly.

# %% question="circle"
def circle(s, start, centre):
    """A level circle through `start` about the vertical axis through `centre`.

    Args:
        s: Where on the circle, from 0 to 1.
        start: Where it begins and ends, shape (3,) in [m].
        centre: A point on its axis, shape (3,) in [m], at any height.

    Returns:
        lk.Sample(position, velocity, acceleration): the point and its first and second derivative
        with respect to s, each of shape (3,).
    """
    ### BEGIN SOLUTION
    from solutions.paths.answers import circle as answer

    return answer(s, start, centre)
    ### END SOLUTION


# %% [markdown]
# ## Path and schedule make a trajectory
#
# The tip is at $p(s(t))$. Differentiate once with the chain rule, and then differentiate the result with the
# product rule. One of the two terms of the acceleration vanishes on a line, the other one at constant speed.
# So a test on a line alone, or at constant speed alone, cannot tell whether you have both.

# %% question="compose"
def compose(path, scaling, t):
    """The motion of a path on a schedule.

    Args:
        path: A function of s that gives an lk.Sample of three arrays of shape (3,): the point in
            [m] and its derivatives with respect to s.
        scaling: A function of t that gives (s, ds, dds), three numbers.
        t: Time since the start, in [s].

    Returns:
        lk.Sample(position, velocity, acceleration) at time t, each of shape (3,), in [m], [m/s] and
        [m/s^2].
    """
    ### BEGIN SOLUTION
    from solutions.paths.answers import compose as answer

    return answer(path, scaling, t)
    ### END SOLUTION


# %% [markdown]
# ## Let the arm draw
#
# `lk.run` evaluates your trajectory two hundred times a second and lets the simulated arm follow. The model
# converts the positions of the tip to joint angles once, beforehand. Then a velocity controller simply passes
# on the wanted speeds (you write a better one in notebook 03).

# %%
def given_circle(s, start, centre):
    """The stand-in: a triangle through the start, about the same axis."""
    corners = [lk.Circle(start, centre)(k / 3).position for k in range(4)]
    k = min(int(3 * s), 2)
    return lk.Sample(*(scale * x for scale, x in zip((1, 3, 1), lk.Line(*corners[k : k + 2])(3 * s - k))))


def given_compose(path, scaling, t):
    """The stand-in: the place alone, as if the tip stood still there."""
    s, _, _ = scaling(t)
    place = path(s).position
    return lk.Sample(place, 0 * place, 0 * place)


my_circle = use("circle", circle, given_circle)
my_compose = use("compose", compose, given_compose)

arm = lk.Arm("left")
model, q0 = arm.model, arm.robot.ready
start = model.pose(q0)[:3, 3]


def passes_on(state, target):
    """Feed-forward: turn the joints at the wanted speeds."""
    return lk.JointVelocity(target.velocity)


def follow(path, schedule):
    """Let the arm follow a path on a schedule; returns the log."""
    arm.reset(q0)
    return lk.run(arm, model.joint_trajectory(lk.Trajectory(path, schedule), q0), passes_on)


goal = start + [0.1, -0.15, 0.1]
line = lk.Line(start, goal)
log = follow(line, within_limits(line.length))
lk.plotting.tracking(log)
lk.plotting.show(lk.plotting.describe(log))

# %% [markdown]
# Now your circle, about an axis 15 cm to the side. If your `compose` is right, the arm moves at the speed
# that your trajectory promises.

# %%
centre = start + [0.0, -0.15, -0.2]
ring = lambda s: my_circle(s, start, centre)
log = follow(ring, lk.Quintic(6.0))
lk.plotting.tracking(log)
lk.plotting.show(lk.plotting.describe(log))

speed = [np.linalg.norm(my_compose(ring, lk.Quintic(6.0), t).velocity) for t in log.t]
plt.figure(figsize=(8, 2.5), layout="constrained")
plt.plot(log.t, speed, label="promised by compose")
actual = [np.linalg.norm(model.tip_jacobian(q)[:3] @ dq) for q, dq in zip(log.q, log.dq)]
plt.plot(log.t, actual, "--", label="of the arm")
plt.xlabel("time [s]")
plt.ylabel("speed [m/s]")
plt.legend(frameon=False)
lk.plotting.show(
    f"Speed of the tip on the circle: at most {max(speed):.2f} m/s as promised, {max(actual):.2f} m/s by "
    "the arm."
)

# %% predict="twice_the_time"

# %%
def largest_acceleration(duration):
    """Of a tip that follows such a circle exactly, in [m/s^2]."""
    target = lk.Trajectory(lk.Circle(start, start + [0.0, -0.15, 0.0]), lk.Quintic(duration))
    return max(np.linalg.norm(target(t).acceleration) for t in np.linspace(0.0, duration, 301))


predict("twice_the_time", truth=largest_acceleration(12.0) / largest_acceleration(6.0))

# %% [markdown]
# ## Several segments
#
# A square is four lines in a row, each with its own schedule. A function must say which line is active, and
# since when. It is easy to get this wrong: before the start a careless search gives the index -1, which in
# Python means the last element, and the arm begins with the last line.

# %% question="segment_at"
def segment_at(durations, t):
    """Which of several segments is on.

    Args:
        durations: How long each lasts, a list of numbers in [s].
        t: Time since the start of the first, in [s]; any real number.

    Returns:
        (index, local_time): its number, counted from 0, and the time since it began, in [s]: below
        0 before the first begins, and longer than it lasts after the end of the last.
    """
    ### BEGIN SOLUTION
    from solutions.paths.answers import segment_at as answer

    return answer(durations, t)
    ### END SOLUTION


# %%
def given_segment_at(durations, t):
    """The stand-in: the first segment, and then the last one."""
    first = t < durations[0]
    return (0, t) if first else (len(durations) - 1, t - sum(durations[:-1]))


my_segment_at = use("segment_at", segment_at, given_segment_at)

corners = start + np.array([[0, 0, 0], [0.12, 0, 0], [0.12, -0.12, 0], [0, -0.12, 0], [0, 0, 0]])
sides = [lk.Line(a, b) for a, b in zip(corners[:-1], corners[1:])]
schedules = [within_limits(side.length) for side in sides]
durations = [schedule.duration for schedule in schedules]


def square(t):
    k, local = my_segment_at(durations, t)
    return my_compose(sides[k], schedules[k], local)


t = np.linspace(0.0, sum(durations), 400)
points = np.array([square(x).position for x in t])
plt.figure(figsize=(4, 4), layout="constrained")
plt.plot(points[:, 0], points[:, 1], label="the tip's path")
plt.plot(*corners[:, :2].T, "o", mfc="none", label="corners")
plt.axis("equal")
plt.xlabel("x [m]")
plt.ylabel("y [m]")
plt.legend(frameon=False)
lk.plotting.show(
    f"Your path from above over {t[-1]:.1f} s, and the corners of a square with sides of 12 cm."
)

# %% [markdown]
# Let the arm go round the square with your own functions: your trapezoid, your `compose`, your `segment_at`.
# A wrong function may drive the arm too: write `use("segment_at", segment_at, given_segment_at, anyway=True)`
# above and run the cells again. The see-through arm goes round the square correctly. Drag to look around,
# move the slider to go back and forth in time.

# %%
arm.reset(q0)
tour = lk.Chain([lk.Trajectory(side, lk.Trapezoid(side.length, 0.2, 0.4)) for side in sides])
as_it_should = lk.run(arm, model.joint_trajectory(tour, q0), passes_on)

upright = model.pose(q0)[:3, :3]
poses = lk.PosePath(square, upright)  # your square, with the hand turned as at the start


def follows_the_square(state, target, k=8.0):
    """Feed-forward and feedback; at most 0.5 m/s, should your square jump."""
    twist = target.twist + k * lk.se3.pose_error(target.pose, model.pose(state.q))
    twist = twist * min(1.0, 0.5 / max(np.linalg.norm(twist[:3]), 1e-9))
    return lk.JointVelocity(np.linalg.pinv(model.tip_jacobian(state.q)) @ twist)


arm.reset(q0)
log_square = lk.run(arm, poses, follows_the_square, duration=sum(durations))
lk.replay.show(
    lk.replay.motion_of(
        log_square, "Round four corners", label="your square", ghosts={"the square": as_it_should}
    )
)

# %% [markdown]
# ## Hand in
#
# Run everything once more from the top (*Kernel, Restart Kernel and Run All Cells*) and save the file. Then
# run only the last cell once more: it prints a receipt for the saved file; keep it. `!labkit submit-check 01_paths.ipynb`
# in a new cell runs a copy of that file and says what is missing. Hand in the file without renaming it, in the way your course asks. The grader runs your
# functions on further cases; the text above each stub says what kind of cases.

# %% setup=true
lk.hand_in("01_paths")
