"""Steps for nbgrader's own ``autograde``, so that it and formgrader's button are safe too.

`Repair` comes first of ``Autograde.sanitize_preprocessors`` and brings a submission into the
release's form; `Isolated` takes the place of nbgrader's ``Execute`` and runs nothing here.
"""

from __future__ import annotations

from contextlib import closing
from typing import Any

from nbgrader.preprocessors import NbGraderPreprocessor

from .batch import job
from .course import Course
from .limits import Limits
from .pool import Worker, result_of
from .results import Bundle, Result
from .submission import Submission
from .written import in_release_form, release_source, with_verdicts


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
        source = release_source(Course.here(), about["assignment"])
        return in_release_form(source, _grade(about)), resources


_known: dict[tuple[str, str], Result] = {}


def _grade(about: dict[str, Any]) -> Result:
    """The result of the submission that nbgrader is at, graded once for both steps."""
    course = Course.here()
    key = (about["assignment"], about["student"])
    result = _known.pop(key, None)
    if result is None:
        bundle = Bundle.of(course, about["assignment"])
        submission = Submission.of(course, about["assignment"], about["student"])
        todo = job(course, bundle, submission, Limits())
        with closing(Worker()) as worker:
            result = Result.read(result_of(todo, worker.ask(todo)))
        _known[key] = result
    return result
