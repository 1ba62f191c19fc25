"""What students are given: a zip with labkit and notebooks, or a repository without answers.

The answers are public in this repository; hidden cases stop hard-coding, not copying.  A course
that cares gives its students a repository without them.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

from ..course.layout import Course
from ..errors import LabkitError
from .pages import TEMPLATES, render
from .release import FORBIDDEN

STUDENT_TOOLS = ("environment.yml", "find_python.sh", "need.sh")
"""What ``.ci/start.sh`` calls."""
GRADER = "labkit/grader"
"""What students' labkit comes without."""

FOR_STUDENTS = (
    "labkit/",
    "assignments/",
    *(f".ci/{tool}" for tool in STUDENT_TOOLS),
    "LICENSE",
    "constraints.txt",
    "pyproject.toml",
)


def student_bundle(course: Course, names: Sequence[str], to: Path) -> Path:
    """Write the zip that students get.

    Args:
        course: The course; its assignments must be released.
        names: Which assignments go in; none means all that are released.
        to: The file to write.

    Returns:
        ``to``.

    Raises:
        LabkitError: An assignment is not released, or the wheel could not be built.
    """
    names = names or sorted(path.name for path in course.release.iterdir() if path.is_dir())
    for name in names:
        course.notebook_source(name)
        if not (course.release / name).is_dir():
            raise LabkitError(f"{name} is not released; first run: labkit release {name}")
    with tempfile.TemporaryDirectory() as folder:
        top = Path(folder) / "baxter-lab"
        for name in names:
            shutil.copytree(course.release / name, top / "assignments" / name)
        _wheel(course.root, top)
        shutil.copy(course.root / "constraints.txt", top)
        (top / ".ci").mkdir()
        for tool in STUDENT_TOOLS:
            shutil.copy(course.root / ".ci" / tool, top / ".ci")
        shutil.copy(course.root / ".ci" / "start.sh", top)
        start = render("start.html.j2", names=names)
        (top / "START.html").write_text(start, encoding="utf-8")
        to.parent.mkdir(parents=True, exist_ok=True)
        with zipfile.ZipFile(to, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(top.rglob("*")):
                if path.is_file():
                    archive.write(path, path.relative_to(folder))
    return to


def _wheel(root: Path, to: Path) -> None:
    """Build it from a copy: beside its sources lies what earlier builds left, gone modules too."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        unwanted = shutil.ignore_patterns("__pycache__")
        shutil.copytree(root / "labkit", copy / "labkit", ignore=unwanted)
        shutil.rmtree(copy / GRADER)
        for name in ("pyproject.toml", "README.md", "LICENSE"):
            shutil.copy(root / name, copy)
        words = ["wheel", "--quiet", "--no-deps", "-w", str(to), str(copy)]
        command = [sys.executable, "-m", "pip", *words]
        done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["pip gave no reason"])[-1]
        raise LabkitError(f"labkit's wheel could not be built: {last}")


def export_course(course: Course, to: Path) -> tuple[Path, Path]:
    """Write the students' repository and the private one side by side.

    Args:
        course: The course, a git checkout.
        to: A folder that does not exist yet.

    Returns:
        The students' folder and the private one.

    Raises:
        LabkitError: The folder exists already, this is not a git checkout, or an answer would have
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
    shutil.copy(TEMPLATES / "student_readme.md", student / "README.md")
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
        raise LabkitError(f"{root} is not a git checkout: {done.stderr.strip()}")
    return [name for name in done.stdout.split("\0") if name and (root / name).is_file()]


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy2(source, target)
