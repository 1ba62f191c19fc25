"""Two repositories out of one: what students may see, and everything.

The answers are public in this repository; hidden cases stop hard-coding, not copying.  A course
that cares gives its students a repository without them.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from ..course.layout import Course
from ..errors import LabkitError
from .handout import GRADER, STUDENT_TOOLS
from .release import FORBIDDEN

FOR_STUDENTS = (
    "labkit/",
    "assignments/",
    *(f".ci/{tool}" for tool in STUDENT_TOOLS),
    "LICENSE",
    "constraints.txt",
    "pyproject.toml",
)

README = """\
# Trajectory tracking with Baxter: the notebooks

On Linux (x86-64) with Python 3.11 type `sh start.sh`: it makes `.venv`, the first time only, and
opens Jupyter on `assignments/`. Begin with the lowest number.
"""


def export_course(course: Course, to: Path) -> tuple[Path, Path]:
    """Write the students' repository and the private one side by side.

    Args:
        course: The course, a git checkout.
        to: A folder that does not exist yet.

    Returns:
        The students' folder and the private one.

    Raises:
        LabkitError: The folder is there already, this is no git checkout, or an answer would have
            leaked.
    """
    if to.exists():
        raise LabkitError(f"{to} is there already; give a folder that is not")
    files = _tracked(course.root)
    student, private = to / "student", to / "private"
    for name in files:
        if name.startswith(FOR_STUDENTS) and not name.startswith(f"{GRADER}/"):
            _copy(course.root / name, student / name)
        _copy(course.root / name, private / name)
    (student / "README.md").write_text(README, encoding="utf-8")
    _copy(course.root / ".ci/start.sh", student / "start.sh")
    for path in student.rglob("*.ipynb"):
        text = path.read_text(encoding="utf-8")
        if leak := next((word for word in FORBIDDEN if word in text), None):
            shutil.rmtree(to)
            raise LabkitError(f"{path.name} holds {leak!r}; release it again before exporting")
    return student, private


def _tracked(root: Path) -> list[str]:
    command = ["git", "-C", str(root), "ls-files", "-z"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise LabkitError(f"{root} is no git checkout: {done.stderr.strip()}")
    return [name for name in done.stdout.split("\0") if name and (root / name).is_file()]


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy2(source, target)
