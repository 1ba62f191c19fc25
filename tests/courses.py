"""Copies of this course for tests."""

import shutil
from pathlib import Path

from labkit.course.authoring.layout import Course

ROOT = Path(__file__).parents[1]


def copied(root):
    """Copy this course's sources, without a release, into another folder."""
    shutil.copytree(ROOT / "solutions", root / "solutions")
    shutil.copy(ROOT / "nbgrader_config.py", root)
    return Course(root)
