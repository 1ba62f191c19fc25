"""Copies of this course for tests."""

import shutil
from pathlib import Path

import solutions
from labkit.course.authoring.layout import Course

ROOT = Path(__file__).parents[1]
SYNTHETIC = ROOT / "tests/synthetic/course/solutions"
"""The sources of the course of three questions, beside which the real ones can be imported."""
if str(SYNTHETIC) not in solutions.__path__:
    solutions.__path__.append(str(SYNTHETIC))


def copied(root):
    """Copy this course's sources, without a release, into another folder."""
    shutil.copytree(ROOT / "solutions", root / "solutions")
    shutil.copy(ROOT / "nbgrader_config.py", root)
    return Course(root)


def synthetic(root):
    """The course of three questions, without a release, in a folder."""
    root.mkdir(parents=True, exist_ok=True)
    (root / "solutions").symlink_to(SYNTHETIC)
    shutil.copy(ROOT / "nbgrader_config.py", root)
    return Course(root)


def rejected_below(question):
    """The points below which a wrong answer must stay: half, or just more than one large part."""
    weights = [test.weight for test in question.tests]
    share = max(weights) / sum(weights)
    return (share + 1e-9 if 0.5 < share <= 0.67 else 0.5) * question.points
