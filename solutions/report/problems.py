"""What notebook 08 asks of functions: nothing; people mark it."""

from labkit.course.problem import Problem

PROBLEMS: tuple[Problem, ...] = ()
