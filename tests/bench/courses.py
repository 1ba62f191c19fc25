"""A temporary course for measurements."""

import shutil
import tempfile
from contextlib import contextmanager
from pathlib import Path

from labkit.course.authoring.layout import Course

ROOT = Path(__file__).parents[2]


@contextmanager
def fresh_course():
    """A course of these sources without a release, which is deleted after the block."""
    with tempfile.TemporaryDirectory(prefix="labkit-bench-") as folder:
        (Path(folder) / "solutions").symlink_to(ROOT / "solutions")
        shutil.copy(ROOT / "nbgrader_config.py", folder)
        yield Course(Path(folder))
