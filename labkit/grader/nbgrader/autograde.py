"""Steps for nbgrader's own ``autograde``, so that it and formgrader's button are safe too.

`FitNames` is made before nbgrader goes through the folders; `unlink_foreign` comes before it
copies what lies beside a notebook; `Repair` is the first of ``Autograde.sanitize_preprocessors``
and brings a submission into the release's form; `Isolated` replaces nbgrader's ``Execute`` and runs
nothing here.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

from nbconvert.exporters import NotebookExporter
from nbgrader.converters.base import NbGraderException
from nbgrader.preprocessors import NbGraderPreprocessor

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..each import Failure, for_student
from ..grading.batch import GradeOptions, grade_without_saving, keep_unless_lower
from ..grading.current_results import how_to_grade
from ..grading.results import Result, Results
from ..lock import exclusive_run
from ..submission import Submission, is_name, unfit_name
from .autograded_notebook import in_release_form, release_source, with_verdicts
from .gradebook import recorded


class FitNames(NotebookExporter):
    """Makes nbgrader skip and name each folder whose name is not allowed, and exit with 1.

    nbgrader finds out whose a folder is by an expression that takes no line break, and ends where
    it does not match: one such name would keep the whole class from being graded.
    """

    def __init__(self, parent: Any, **options: Any) -> None:
        super().__init__(parent=parent, **options)  # type: ignore[no-untyped-call]
        found, grade_all = parent.assignments, parent.convert_notebooks
        names = {folder: Path(folder).parts[-2:] for folder in found}  # student, assignment
        bad = [name for both in names.values() for name in both if not is_name(name)]
        parent.assignments = {x: found[x] for x in found if all(map(is_name, names[x]))}

        def grade_all_and_tell() -> None:
            try:
                grade_all()
            finally:
                for name in bad:
                    parent.log.error("not graded: %s", unfit_name(name))
            raise NbGraderException("some folders have names that are not allowed")

        if bad:
            parent.convert_notebooks = grade_all_and_tell


class Isolated(NbGraderPreprocessor):  # type: ignore[misc]
    """Grades a submission in the sandbox and writes its marks where nbgrader looks for them."""

    def preprocess(self, nb: Any, resources: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
        """The notebook with verdicts for outputs."""
        return with_verdicts(nb, _grade(resources["nbgrader"])), resources


class Repair(NbGraderPreprocessor):  # type: ignore[misc]
    """Brings a submission into the release's form: no doubled cells, no metadata of its own."""

    def preprocess(self, nb: Any, resources: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
        """The release's cells with the student's answers."""
        about = resources["nbgrader"]
        _check(Course.here(Path.cwd()), about["assignment"], about["student"])
        source = release_source(Course.here(Path.cwd()), about["assignment"])
        return in_release_form(source, _grade(about)), resources


def unlink_foreign(notebooks: Iterable[str], **_: str) -> None:
    """Replace each link and special file beside the notebooks to be graded by a note.

    nbgrader copies what it finds there into ``autograded/`` and from there into ``feedback/``: what
    a link leads to would come to the student, and a device would fill the disk.

    Args:
        notebooks: As nbgrader's ``pre_convert_hook`` names them.
    """
    for folder in {Path(notebook).parent for notebook in notebooks}:
        for path in _foreign(folder):
            led = f" to {os.readlink(path)!a}" if path.is_symlink() else ""
            path.unlink()
            path.write_text(f"Here was a link{led} or a special file; only files are graded.\n")


def _foreign(folder: Path) -> list[Path]:
    """Links and special files in a folder; none if the folder is a link itself, see `_check`."""
    if folder.is_symlink() or folder.parent.is_symlink():
        return []
    found = (Path(top, name) for top, *names in os.walk(folder) for part in names for name in part)
    return [x for x in found if x.is_symlink() or not (x.is_file() or x.is_dir())]


def _check(course: Course, assignment: str, student: str) -> None:
    """Refuse a submission of which nbgrader must not copy anything.

    `unlink_foreign` may have failed; nbgrader makes a note of it and goes on.
    """
    folder = Submission.of(course, assignment, student).folder
    if folder.is_symlink() or folder.parent.is_symlink():
        raise LabkitError(f"the folder {folder} is a link; put the student's own files there")
    if _foreign(folder):
        raise LabkitError(f"there is a link or a special file, {_foreign(folder)[0]}; remove it")


_known: dict[tuple[str, str], Result] = {}


def _grade(about: dict[str, Any]) -> Result:
    """The result of the submission that nbgrader processes, graded once for both steps."""
    course = Course.here(Path.cwd())
    key = (about["assignment"], about["student"])
    result = _known.pop(key, None)
    if result is None:
        bundle = Bundle.of(course, about["assignment"])
        submission = Submission.of(course, about["assignment"], about["student"])
        results = Results(course, about["assignment"])
        options = GradeOptions(recorded=partial(recorded, course, about["assignment"]))
        with exclusive_run(results.folder):
            (graded,) = grade_without_saving(course, bundle, [submission], options)
            if isinstance(graded, Failure):
                raise LabkitError(str(graded))
            kept = for_student(graded.student, partial(keep_unless_lower, results, graded, options))
            if isinstance(kept, Failure):
                raise LabkitError(str(kept))
        result = kept.result
        if result.asked != graded.asked:
            raise LabkitError(f"{result.student}: {kept.says}; {how_to_grade(*key)} --lower")
        _known[key] = result
    return result
