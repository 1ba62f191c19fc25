"""nbgrader's own engine: it runs a student's code in one process with the hidden cases.

It is what the attacks are compared with, and what honest marks must equal.
"""

from __future__ import annotations

from dataclasses import dataclass

from labkit.grader.gradebook import quiet_database
from labkit.grader.nbgrader_api import reason, settings


@dataclass(frozen=True)
class Mark:
    """What a student got for an assignment.

    Attributes:
        score: Points, or None where grading failed.
        points: What full marks would be.
        says: Why it failed, if it did.
    """

    score: float | None
    points: float
    says: str = ""


def grade_with_nbgrader(course, name, student):
    """Grade one submission by the steps that nbgrader takes unless it is told otherwise."""
    from nbgrader.apps import NbGraderAPI
    from nbgrader.coursedir import CourseDirectory

    config = settings(course)
    for steps in ("sanitize_preprocessors", "autograde_preprocessors"):
        config.Autograde.pop(steps, None)
    api = NbGraderAPI(CourseDirectory(config=config), config=config)
    with quiet_database():
        result = api.autograde(name, student, force=True, create=True)
        with api.gradebook as book:
            try:
                submission = book.find_submission(name, student)
            except Exception:
                return Mark(None, 0.0, reason(result))
            if not result["success"]:
                return Mark(None, submission.max_score, reason(result))
            return Mark(submission.score, submission.max_score)
