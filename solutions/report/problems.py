"""Notebook 08 has no questions for tests, because people mark it."""

from labkit.course.authoring.problem import Problem

PROBLEMS: tuple[Problem, ...] = ()
