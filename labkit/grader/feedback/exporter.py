"""An exporter that makes nbgrader's button and command for feedback write our page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from nbconvert import HTMLExporter

from ...course.authoring.layout import Course
from ...errors import LabkitError
from ..marks.table import marks_of
from ..rules import read_rules
from .page import page


class StudentPage(HTMLExporter):
    """Turns an autograded notebook into the page that `labkit feedback` writes."""

    def from_filename(  # type: ignore[override]
        self, filename: str, resources: dict[str, Any] | None = None, **_: Any
    ) -> tuple[str, dict[str, Any]]:
        """The page of a student, and the resources for nbconvert's writer.

        Raises:
            LabkitError: The student has no mark.
        """
        about = dict(resources or {})
        course, known = Course.here(Path.cwd()), about["nbgrader"]
        for mark in marks_of(course, known["assignment"], known["student"]):
            if mark.result is not None and (mark.lines or not mark.missing):
                about |= {"output_extension": ".html", "outputs": {}}
                return page(mark.result, mark, read_rules(course).name), about
            raise LabkitError(f"{mark.student}: {mark.missing}")
        raise LabkitError(f"there is no mark of {known['student']}")
