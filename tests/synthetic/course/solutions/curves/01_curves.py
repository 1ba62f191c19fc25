# %% [markdown]
# # 01 · Curves
#
# A schedule and a circle, for the tests of the grader. 24 points.

# %% setup=true
import labkit as lk
from labkit.course import check, predict, use

lk.ready()

# %% setup=true
import numpy as np


# %% question="bang_bang"
def bang_bang(t, duration):
    """Bang-bang time scaling: (s, ds, dds) at a time."""
    ### BEGIN SOLUTION
    from solutions.curves.problems import bang_bang as answer

    return answer(t, duration)
    ### END SOLUTION


# %%
def given_bang_bang(t, duration):
    """The stand-in: at an even speed."""
    return np.clip(t / duration, 0.0, 1.0), 1.0 / duration, 0.0


my_bang_bang = use("bang_bang", bang_bang, given_bang_bang)


# %% question="circle"
def circle(s, start, centre):
    """A level circle: lk.Sample of the point and its derivatives by s."""
    ### BEGIN SOLUTION
    from solutions.curves.problems import circle as answer

    return answer(s, start, centre)
    ### END SOLUTION


# %% question="length"
def length(points):
    """The length of a polyline in the plane."""
    ### BEGIN SOLUTION
    from solutions.curves.problems import length as answer

    return answer(points)
    ### END SOLUTION


# %% predict="twice_the_time"

# %%
predict("twice_the_time", truth=0.25)

# %% [markdown] why="why_slower"
# Why is a slow motion easier for an arm?
#
# ### BEGIN SOLUTION
# Its acceleration falls with the square of the time.
# ### END SOLUTION

# %% setup=true
lk.hand_in("01_curves")
