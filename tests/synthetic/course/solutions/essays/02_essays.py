# %% [markdown]
# # 02 · Essays
#
# Texts that a person marks, if they are drawn. 15 points.

# %% setup=true
import labkit as lk
from labkit.course import check, predict

# %% predict="guess"

# %% [markdown] why="why_slow"
# Why slow?
#
# ### BEGIN SOLUTION
# Because.
# ### END SOLUTION

# %% [markdown] why="why_time"
# Why time?
#
# ### BEGIN SOLUTION
# Because.
# ### END SOLUTION

# %% [markdown] why="why_weak"
# Why weak?
#
# ### BEGIN SOLUTION
# Because.
# ### END SOLUTION

# %% [markdown] why="why_friction"
# Why friction?
#
# ### BEGIN SOLUTION
# Because.
# ### END SOLUTION

# %% [markdown] why="why_gravity"
# Why gravity?
#
# ### BEGIN SOLUTION
# Because.
# ### END SOLUTION

# %% [markdown] why="why_lag"
# Why lag?
#
# ### BEGIN SOLUTION
# Because.
# ### END SOLUTION

# %% setup=true
lk.hand_in("02_essays")
