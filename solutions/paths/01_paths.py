# %% [markdown]
# # 01 · Paths and time
#
# The arm should draw a line, a circle and a square. Before any controller can help, it needs a target: *where the
# tip should be at every moment*, at what velocity and with what acceleration. Here you write that target.
#
# | | |
# |---|---|
# | **You need** | numpy; the derivative of a product and of a function of a function |
# | **Given** | the simulated arm, a controller that follows, figures |
# | **You write** | a time scaling and its duration, a circle, a trajectory from a path and a schedule, a search for the active segment |
# | **Time** | core 2.5 hours, 17 points; all 3.1 hours, 21 points. After 3 hours, stop writing and read the rest. |
#
# A *path* is geometry: a curve with a parameter `s` from 0 to 1, and no time in it. A *time scaling* is the
# schedule `s(t)`. Together they are a *trajectory*: any path can be used with any schedule.

# %% setup=true
import matplotlib.pyplot as plt
import numpy as np

import labkit as lk
from labkit.course import check, predict, use

lk.ready()

# %% [markdown]
# ## The schedule: when to be where
#
# If you ask for too much at the start, the motors cannot follow: the arm lags and then overshoots. So a
# schedule starts and ends at rest. The simplest is *bang-bang*: full acceleration for half of the time, full
# braking for the other half. The report that this lab grew out of moved Baxter like this. With the
# duration $T$ and a constant acceleration $a$ the first half is
#
# $$ \ddot s = a, \qquad \dot s = a\,t, \qquad s = \tfrac12 a t^2 . $$
#
# At $T/2$ half of the distance must be covered; that determines $a$. The second half is the first, run
# backwards from the end. The trap: a controller also asks before the start and after the end.

# %% question="bang_bang"
def bang_bang(t, duration):
    """At any t [s] the tuple (s, ds, dds), in [1], [1/s], [1/s^2]; at rest outside the motion."""
    ### BEGIN SOLUTION
    from solutions.paths.answers import bang_bang as answer

    return answer(t, duration)
    ### END SOLUTION


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
# Where the lowest curve jumps, the arm jerks. Smoothness is paid for with a higher peak.
#
# ## How long does it take?
#
# The report's equation 1 says: the duration is 5 times the distance. What is the unit of that 5? It is s/m, so a
# metre takes 5 s; and a centimetre takes 0.05 s, for which bang-bang needs 16 m/s². Limits belong to the arm,
# not to the path: a top speed $v_{max}$ in m/s and a top acceleration $a_{max}$ in m/s². Speed up at $a_{max}$, cruise at
# $v_{max}$, brake at $a_{max}$: the graph of the speed is a *trapezoid*, and its area is the distance. The trap:
# over a short distance the arm never reaches $v_{max}$, and the trapezoid becomes a triangle.

# %% question="duration_for"
def duration_for(distance, v_max, a_max):
    """In [s], for a distance > 0 in [m], v_max in [m/s] and a_max in [m/s^2]."""
    ### BEGIN SOLUTION
    from solutions.paths.answers import duration_for as answer

    return answer(distance, v_max, a_max)
    ### END SOLUTION


# %%
def five_seconds_a_metre(distance, v_max, a_max):
    """The stand-in: the report's equation 1."""
    return 5.0 * distance


my_duration_for = use("duration_for", duration_for, five_seconds_a_metre)
distances = np.linspace(0.005, 0.4, 80)
plt.figure(figsize=(8, 2.8), layout="constrained")
for function, style, name in ((my_duration_for, "-", "within limits"), (five_seconds_a_metre, "--", "5 s/m")):
    plt.plot(distances, [function(d, 0.2, 0.4) for d in distances], style, label=name)
plt.xlabel("distance [m]")
plt.ylabel("duration [s]")
plt.legend(frameon=False)
lk.plotting.show(
    "Durations within 0.2 m/s and 0.4 m/s², and by the report's 5 s/m. 1 cm takes "
    f"{my_duration_for(0.01, 0.2, 0.4):.2f} s and 0.05 s, 30 cm take {my_duration_for(0.3, 0.2, 0.4):.2f} s and 1.50 s."
)

# %% [markdown]
# Up to $v_{max}^2 / a_{max}$, here 10 cm, the duration grows like a square root, then linearly.
#
# ## The path: where
#
# A straight line from $p_0$ to $p_1$ is $p(s) = p_0 + s\,(p_1 - p_0)$: its derivative with respect to $s$ is
# $p_1 - p_0$ everywhere, and the second one is zero. `lk.Line` is this path. It returns an `lk.Sample`:

# %%
lk.Line([0.6, 0.3, 0.1], [0.8, 0.1, 0.1])(0.5)

# %% [markdown]
# A circle takes a little more. In the report its centre was an AR tag on the table, below the gripper. The report
# measured the radius in space, from the gripper down to the tag, and left the angle of the start out of
# the velocity, though not out of the position. Write the circle correctly.

# %% question="circle"
def circle(s, start, centre):
    """At s from 0 to 1 an lk.Sample of three arrays (3,); start and centre are (3,), in [m]."""
    ### BEGIN SOLUTION
    from solutions.paths.answers import circle as answer

    return answer(s, start, centre)
    ### END SOLUTION


# %% [markdown]
# ## Path and schedule make a trajectory
#
# The tip is at $p(s(t))$. Differentiate once with the chain rule, then the result with the
# product rule. The trap: one of the two terms of the acceleration vanishes on a line, the other one at constant speed,
# so a test on a line alone cannot tell whether you have both.

# %% question="compose"
def compose(path, scaling, t):
    """At time t [s] an lk.Sample in [m], [m/s], [m/s^2], (3,) each.

    path(s) gives an lk.Sample with derivatives by s, scaling(t) gives (s, ds, dds).
    """
    ### BEGIN SOLUTION
    from solutions.paths.answers import compose as answer

    return answer(path, scaling, t)
    ### END SOLUTION


# %% [markdown]
# ## Let the arm draw
#
# `lk.run` evaluates your trajectory two hundred times a second; the model
# converts positions of the tip to joint angles, and a controller passes on the wanted speeds.

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

# %%
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


line = lk.Line(start, start + [0.1, -0.15, 0.1])
log_line = follow(line, Schedule(my_bang_bang, 2.0, 2.0))
ring = lambda s: my_circle(s, start, start + [0.0, -0.15, -0.2])
log_circle = follow(ring, lk.Quintic(6.0))

# %%
lk.plotting.tracking(log_line)
lk.plotting.show(lk.plotting.describe(log_line))
lk.plotting.tracking(log_circle)
lk.plotting.show(lk.plotting.describe(log_circle))

speed = [np.linalg.norm(my_compose(ring, lk.Quintic(6.0), t).velocity) for t in log_circle.t]
plt.figure(figsize=(8, 2.5), layout="constrained")
plt.plot(log_circle.t, speed, label="promised by compose")
actual = [np.linalg.norm(model.tip_jacobian(q)[:3] @ dq) for q, dq in zip(log_circle.q, log_circle.dq)]
plt.plot(log_circle.t, actual, "--", label="of the arm")
plt.xlabel("time [s]")
plt.ylabel("speed [m/s]")
plt.legend(frameon=False)
lk.plotting.show(
    f"Speed of the tip on the circle: at most {max(speed):.2f} m/s as promised, {max(actual):.2f} m/s by "
    "the arm."
)

# %% [markdown]
# With your own parts in place the two speeds coincide: the arm moves as `compose` promises.

# %% predict="twice_the_time"

# %%
def largest_acceleration(duration):
    """Of a tip that follows such a circle exactly, in [m/s^2]."""
    target = lk.Trajectory(lk.Circle(start, start + [0.0, -0.15, 0.0]), lk.Quintic(duration))
    return max(np.linalg.norm(target(t).acceleration) for t in np.linspace(0.0, duration, 301))


predict("twice_the_time", truth=largest_acceleration(12.0) / largest_acceleration(6.0))

# %% [markdown]
# <details><summary>After your prediction: why?</summary>Both terms of the acceleration carry $1/T^2$, whatever the path
# and the schedule.</details>
#
# ## Several segments
#
# A square is four lines in a row, each with its own schedule. A function must say which line is active, and
# since when. The trap: before the start a careless search gives the index -1, which in
# Python means the last element, and the arm begins with the last line.

# %% question="segment_at"
def segment_at(durations, t):
    """At any t [s] the tuple (index, local_time [s]); durations is a list, in [s]."""
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

# %%
corners = start + np.array([[0, 0, 0], [0.12, 0, 0], [0.12, -0.12, 0], [0, -0.12, 0], [0, 0, 0]])
sides = [lk.Line(a, b) for a, b in zip(corners[:-1], corners[1:])]
schedules = [lk.Trapezoid(side.length, 0.2, 0.4) for side in sides]
durations = [schedule.duration for schedule in schedules]


def square(t):
    k, local = my_segment_at(durations, t)
    return my_compose(sides[k], schedules[k], local)


# %% [markdown]
# Let the arm go round the square with your `compose` and `segment_at`; the see-through arm does it
# correctly. To see what a wrong function does, add `anyway=True` to its `use(...)` in the folded cell above.

# %%
arm.reset(q0)
tour = lk.Chain([lk.Trajectory(side, schedule) for side, schedule in zip(sides, schedules)])
as_it_should = lk.run(arm, model.joint_trajectory(tour, q0), passes_on)

poses = lk.PosePath(square, model.pose(q0)[:3, :3])  # your square, with the hand turned as at the start


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
# At every corner the tip comes to rest: that is the price of sharp corners.

# %% [markdown]
# ## Appendix: an extension
#
# No later question depends on it. `duration_for` gives the end of the trapezoid; here you write all of it. The trap: $s$ has no unit, so a limit in metres does not bound $\dot s$ but $d\,\dot s$, where $d$ is
# the distance.

# %% question="trapezoid"
def trapezoid(t, distance, v_max, a_max):
    """At any t [s] the tuple (s, ds, dds); distance [m], v_max [m/s], a_max [m/s^2]."""
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
# ## Hand in
#
# Run all cells, save, and run the last one once more: it prints a receipt.

# %% setup=true
lk.hand_in("01_paths")
