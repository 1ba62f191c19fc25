"""Gradescope: the zip that it takes as an autograder, and what runs in its container.

The container cannot make namespaces, so submissions are isolated by user id; see
`sandbox.forkserver.AsUser`.  The manual, gradescope-autograders.readthedocs.io, describes the files
under "Autograder Specifications", and under "Troubleshooting" the limits:
half a processor, 768 MB and 10 minutes, after which it says so itself and nothing counts.
"""

from __future__ import annotations

import json
import os
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from ..course.authoring.bundle import Bundle
from ..course.authoring.layout import Course
from ..course.messages import summary
from .files import write
from .grade import grade, rejection
from .plan import imports
from .results import Result
from .sandbox.launch import Isolation, Sandbox
from .sandbox.limits import Limits
from .submission import Submission

PLACE = "LABKIT_AUTOGRADER"
"""The variable with which a test replaces the folder ``/autograder``."""
LIMITS = replace(Limits().scaled(2.5), memory=384)
"""What a submission may use on half a processor and in 768 MB."""
BY_HAND = "A person marks this answer; its points are not among those of the autograder."


def main() -> None:
    """Grade what was handed in."""
    place = Path(os.environ.get(PLACE, "/autograder"))
    os.chmod(place, 0o700)
    source = Course(place / "source")
    (path,) = source.bundle.glob("*.json")
    bundle = Bundle.of(source, path.stem)
    student = "student"  # Gradescope knows whose it is
    data, note, why = Submission(student, path.stem, place / "submission").read()
    with Sandbox(imports(bundle.data["cells"]), isolation=Isolation.USER) as sandbox:
        if why:
            result = rejection(why, student, bundle, sandbox.level)
        else:
            result = grade(data, student, bundle, sandbox, LIMITS, note)
    write(place / "results/results.json", json.dumps(gradescope_results(bundle, result)))
    print(result, result.isolation, sep="\n")


def gradescope_results(bundle: Bundle, result: Result) -> dict[str, Any]:
    """What Gradescope reads: points and words for each question, then what a person marks.

    Args:
        bundle: What was asked.
        result: The result of grading.
    """
    tests: list[dict[str, Any]] = []
    for answer in result.questions:
        verdict = answer.verdict
        lines = [*summary(verdict), *(f"Note: {note}." for note in answer.notes)]
        about = {"name": verdict.name, "score": verdict.earned, "max_score": verdict.points}
        tests.append(about | {"output": "\n".join(lines), "visibility": "visible"})
    for cell in (m for m in bundle.data["cells"] if "points" in m):
        said = "\n\n".join(filter(None, [BY_HAND, result.written.get(cell["grade_id"])]))
        tests.append({"name": cell["grade_id"], "output": said, "visibility": "visible"})
    look = f"Isolated by: {result.isolation}"
    tests.append({"name": "for the instructor", "output": look, "visibility": "hidden"})
    lines = [f"Note: {note}." for note in result.notes]
    lines += [f"It could not be graded: {result.rejected}."] if result.rejected else []
    lines += [f"Cell {x['cell'] + 1} failed: {x['error']}" for x in result.cells]
    return {"score": result.score, "output": "\n".join(filter(None, lines)), "tests": tests}


def autograder(course: Course, assignment: str, to: Path) -> None:
    """Write the zip of an assignment: labkit, the release's bundle with hidden cases, two scripts.

    Args:
        course: The course.
        assignment: The assignment.
        to: The file to write.

    Raises:
        LabkitError: The assignment was not released, the course is not the whole repository, or
            the wheel could not be built.
    """
    from .pages import TEMPLATES  # the container has no package of instructors
    from .student_zip import wheel

    bundle = Bundle.of(course, assignment)
    to.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, ZipFile(to, "w", ZIP_DEFLATED) as archive:
        os.chmod(to, 0o600)
        wheel(course.root, Path(folder))
        for path in Path(folder).glob("*.whl"):
            archive.write(path, path.name)
        archive.write(course.root / "hashes.txt", "hashes.txt")
        archive.writestr(f"build/course/bundle/{assignment}.json", json.dumps(bundle.data))
        for name, template in (("setup.sh", "setup"), ("run_autograder", "run")):
            script = ZipInfo(name, (2026, 1, 1, 0, 0, 0))
            script.external_attr = 0o755 << 16
            archive.writestr(script, (TEMPLATES / f"gradescope_{template}.sh").read_text())


if __name__ == "__main__":
    main()
