"""The students' bundle: one zip with labkit, the notebooks and a page on how to begin."""

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

START = """\
<!doctype html><html lang="en"><meta charset="utf-8"><title>Start here</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>body{{font:1.1rem/1.6 system-ui,sans-serif;max-width:40rem;margin:2rem auto;padding:0 1rem}}
pre{{background:#f3f3f3;padding:1rem;overflow:auto}}</style>
<main><h1>Trajectory tracking with Baxter</h1>
<p>You need Linux on x86-64 (on Windows: WSL 2), Python 3.11, 2 GB of disk and 1 GB of memory. No
graphics card.</p>
<ol><li>Open a terminal in this folder.</li>
<li>Type <pre>sh start.sh</pre> It makes a folder <code>.venv</code> with all that is needed, the
first time only, and opens Jupyter in your browser.</li>
<li>Open one of: {names}. Run the cells from the top: the second one says that the arm moved.</li>
<li>Where a cell says <em>Your code goes here</em>, write; the check answers in words.</li></ol>
<p>To hand in, give back the notebook file with its name as it is. Beside it lies
<code>checks.json</code>, which the checks need: leave it there.</p></main></html>
"""

STUDENT_TOOLS = ("environment.yml", "find_python.sh", "need.sh")
"""What ``.ci/start.sh`` calls."""
GRADER = "labkit/grader"
"""What students' labkit comes without."""


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
        (top / "START.html").write_text(START.format(names=", ".join(names)), encoding="utf-8")
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
