"""The zip that Gradescope takes as an autograder: labkit, one release's bundle, two scripts."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import Course
from ...course.own_arm import HANDLES, Arms
from ..pages import TEMPLATES
from ..students.roster import Student, read_roster
from ..terms.student_bundle import check_repository, wheel


def autograder(course: Course, assignment: str, to: Path) -> list[Student]:
    """Write the zip of an assignment; it holds the hidden cases.

    Args:
        course: The course.
        assignment: The assignment.
        to: The file to write.

    Returns:
        Students whose own arm Gradescope cannot find, as the roster has no address for them.

    Raises:
        LabkitError: The assignment was not released, the course is not the whole repository, or
            the wheel could not be built.
    """
    check_repository(course.root)
    bundle = Bundle.of(course, assignment)
    files = {f"build/course/bundle/{assignment}.json": json.dumps(bundle.data)}
    handles, roster = bundle.arms.handles, read_roster(course).students
    own = bundle.of_student(next(iter(handles), "")) is not bundle  # one student stands for all
    if own:
        by_mail = {x.email.casefold(): handles[x.id] for x in roster if x.email and x.id in handles}
        files[HANDLES] = Arms(bundle.arms.key, by_mail).text()
    to.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, ZipFile(to, "w", ZIP_DEFLATED) as archive:
        os.chmod(to, 0o600)
        wheel(course.root, Path(folder))
        for path in Path(folder).glob("*.whl"):
            archive.write(path, path.name)
        archive.write(course.root / "constraints.txt", "constraints.txt")
        for name, text in files.items():
            archive.writestr(name, text)
        for name, template in (("setup.sh", "setup"), ("run_autograder", "run")):
            script = ZipInfo(name, (2026, 1, 1, 0, 0, 0))
            script.external_attr = 0o755 << 16
            archive.writestr(script, (TEMPLATES / f"gradescope_{template}.sh").read_text())
    return [x for x in roster if own and x.id in handles and not x.email]
