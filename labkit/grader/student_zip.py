"""What students are given: a zip of notebooks, labkit without the grader, and a start page."""

from __future__ import annotations

import base64
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

import jupytext
import nbformat

from ..course.authoring.layout import Course
from ..errors import LabkitError
from .pages import render

NOT_FOR_STUDENTS = ("labkit/grader", "labkit/course/authoring")
"""The parts of labkit that students do not get."""
STUDENT = ".ci/student"
"""The files that students get besides labkit and notebooks."""
PICTURE = "book/static/baxter.png"
BOOK = "book/_build/html"
"""The folder of the built book."""
_NO_BYTECODE = shutil.ignore_patterns("__pycache__")


def student_zip(
    course: Course, names: Sequence[str], to: Path, book: str | None = None, url: str = ""
) -> tuple[str, ...]:
    """Write the zip that students get.

    Args:
        course: The course.
        names: The assignments to include; none means all that are released, in a term those of it.
        to: The file to write.
        book: The address of the book; None includes the book itself, if it is built.
        url: The public GitHub repository where browsers find what is in the zip; "" for none.

    Returns:
        The assignments in it.

    Raises:
        LabkitError: An assignment is not released, or the course is not the whole repository, or
            the wheel could not be built.
    """
    there = sorted(path.name for path in course.release.iterdir() if path.is_dir())
    if course.term.exists():
        there = [name for name in there if (course.bundle / f"{name}.json").exists()]
    for name in names:
        if name not in there:
            raise LabkitError(f"{name} is not released in this term; type: labkit release {name}")
    with tempfile.TemporaryDirectory() as folder:
        top = Path(folder) / "baxter-lab"
        _fill(course, names or there, top, book, url)
        to.parent.mkdir(parents=True, exist_ok=True)
        with zipfile.ZipFile(to, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(filter(Path.is_file, top.rglob("*"))):
                archive.write(path, path.relative_to(folder))
    return tuple(names or there)


def _fill(course: Course, names: Sequence[str], top: Path, book: str | None, url: str) -> None:
    """Write what students get to the new folder ``top``."""
    shutil.copytree(course.root / STUDENT, top, ignore=_NO_BYTECODE)
    for name in names:
        shutil.copytree(course.release / name, top / "assignments" / name)
    shutil.copy(course.root / "LICENSE", top)
    if book is None and (course.root / BOOK / "index.html").exists():
        shutil.copytree(course.root / BOOK, top / "book")
        book = "book/index.html"
    wheel(course.root, top)
    page = render("start.html.j2", names=names, book=book, url=url).encode()
    (top / "START.html").write_bytes(page)
    _start_here(top / "assignments", names, course.root / PICTURE, book)
    for path in (top / "assignments").rglob("*.ipynb") if url else ():
        _open_in(top, path, url)


def _open_in(top: Path, path: Path, url: str) -> None:
    """Begin a notebook with links that open it, and a cell that fetches what is missing there."""
    notebook, (name,) = nbformat.read(path, as_version=4), (x.name for x in top.glob("*.whl"))
    text = render("open_in.py.j2", url=url, name=path.stem, place=path.relative_to(top), wheel=name)
    links, fetch = jupytext.reads(text, fmt="py:percent").cells
    notebook.cells[0].source = f"{links.source}\n\n{notebook.cells[0].source}"
    fetch.id = "fetch"
    notebook.cells.insert(1, fetch)
    nbformat.write(notebook, path)


def _start_here(folder: Path, names: Sequence[str], picture: Path, book: str | None) -> None:
    """Write the notebook that JupyterLab opens first."""
    notebooks = [(name, *_about(folder / name / f"{name}.ipynb")) for name in names]
    practice = next(filter(None, (_first_prediction(folder, name) for name in names)), None)
    text = render("start_here.py.j2", notebooks=notebooks, book=book, practice=practice)
    notebook = jupytext.reads(text, fmt="py:percent")
    image = base64.b64encode(picture.read_bytes()).decode()
    notebook.cells[0]["attachments"] = {picture.name: {"image/png": image}}
    notebook.metadata = {"kernelspec": {"name": "python3", "display_name": "Python 3"}}
    nbformat.write(notebook, folder / "START_HERE.ipynb")


def _about(path: Path) -> tuple[str, str]:
    """A notebook's title and how long it takes, from its first cell."""
    first = nbformat.read(path, as_version=4).cells[0].source
    title = re.search(r"^# (?:\d+ · )?(.*)$", first, re.MULTILINE)
    time = re.search(r"\*\*Time\*\* \| (.*?)(\. | \|)", first)
    return (title[1] if title else path.stem), (time[1] if time else "")


def _first_prediction(folder: Path, name: str) -> tuple[str, str] | None:
    """A notebook's name and its first prediction that is worth one point; or None."""
    text = (folder / name / f"{name}.ipynb").read_text(encoding="utf-8")
    found = re.search(r"\*\*Predict first: `(\w+)`\*\* · 1 point", text)
    return (name, found[1]) if found else None


def wheel(root: Path, to: Path) -> None:
    """Build the students' wheel from a copy, which has no files left by earlier builds.

    Args:
        root: The folder of the course, a git checkout.
        to: The folder to write to.

    Raises:
        LabkitError: The wheel could not be built.
    """
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        shutil.copytree(root / "labkit", copy / "labkit", ignore=_NO_BYTECODE)
        for name in NOT_FOR_STUDENTS:
            shutil.rmtree(copy / name)
        for name in ("pyproject.toml", "README.md", "LICENSE"):
            shutil.copy(root / name, copy)
        words = ["wheel", "--quiet", "--no-deps", "-w", str(to), str(copy)]
        command = [sys.executable, "-m", "pip", *words]
        done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["pip gave no reason"])[-1]
        raise LabkitError(f"labkit's wheel could not be built: {last}")
