"""What notebook 08 asks of functions: nothing; people mark it."""

from labkit.course.authoring.problem import Problem

PROBLEMS: tuple[Problem, ...] = ()
