"""A rehearsal of a term with one assignment and a made-up class, from the download to the marks."""

from __future__ import annotations

import shutil
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path

from labkit.course.authoring.bundle import Bundle
from labkit.course.authoring.layout import PUBLIC_SEED, Course
from labkit.errors import LabkitError
from labkit.grader.batch import GradeOptions, common_failures, grade_class
from labkit.grader.class_report import report
from labkit.grader.collect import collect
from labkit.grader.each import Failure, Failures
from labkit.grader.export import LAYOUTS, as_csv
from labkit.grader.feedback import write_feedback
from labkit.grader.files import write
from labkit.grader.gradebook import record
from labkit.grader.marks import current_results, marks_of
from labkit.grader.release import release
from labkit.grader.roster import Roster, Student, save_roster
from labkit.grader.submission import students

from . import differences, make_class

LAYOUTS_TO_TRY = ("questions", "moodle-worksheet", "canvas")


def rehearse(
    course: Course, name: str, to: Path, count: int, options: GradeOptions
) -> Iterator[str | Failure]:
    """Run a whole term in a separate folder; finished steps are not repeated.

    Args:
        course: The course with the sources; nothing is written there.
        name: The assignment.
        to: The folder in which a course is made.
        count: The number of students.
        options: The options for grading.

    Yields:
        A sentence for each step, with its time, and for each failure.

    Raises:
        LabkitError: The folder has other contents, or a mark is not what the submission deserves.
    """
    stage = Course(to.resolve())
    clock = _Clock()
    _set_up(stage, course)
    download = stage.root / f"{name}-{count}-moodle.zip"
    if not download.exists():
        yield clock.says(str(release(stage, name, PUBLIC_SEED)))
        _hand_in(stage, name, count, download)
        size = download.stat().st_size / 1e6
        yield clock.says(f"{count} hand in; their download has {size:.1f} MB")
    taken = list(collect(stage, name, download))
    yield clock.says(
        f"collected: {sum(t.says.startswith('taken') for t in taken)} of {len(taken)} are new"
    )
    failures = Failures()
    who = students(stage, name)
    graded = list(failures.sift(grade_class(stage, name, who, options), "not graded"))
    new = sum(one.says != "as before" for one in graded)
    yield clock.says(f"graded: {new} of {len(graded)} anew", each=new)
    results = list(failures.sift(current_results(stage, name), "left out"))
    notes = list(failures.sift(record(stage, name, results), "not in the gradebook"))
    yield clock.says(f"in the gradebook: {len(results)}, {len(notes)} to look at")
    marks = list(marks_of(stage, name))
    failures.add("no mark", (Failure(row.student, row.missing) for row in marks if row.missing))
    written = write_feedback(stage, name, [mark for mark in marks if not mark.missing])
    pages = list(failures.sift(written, "no page"))
    size = sum(page.stat().st_size for page in pages) / 1e6
    yield clock.says(f"feedback: {len(pages)} pages, {size:.0f} MB", each=len(pages))
    problems = {p.name: p for p in stage.problems(name)}
    truths = {p.name: p.truth for p in stage.predictions(name)}
    asked = Bundle.of(stage, name).questions
    write(stage.root / "report.md", report(name, marks, problems, str, 1, asked, truths))
    yield clock.says(f"class report: report.md, {len(list(common_failures(results)))} to doubt")
    for layout in LAYOUTS_TO_TRY:
        write(stage.root / f"marks-{layout}.csv", as_csv(LAYOUTS[layout](name, marks)))
    yield clock.says(f"exported: {', '.join(f'marks-{x}.csv' for x in LAYOUTS_TO_TRY)}")
    yield from (Failure("the class", sentence) for sentence in failures.sentences)
    wrong = list(differences(stage, name))
    if wrong:
        raise LabkitError(f"{len(wrong)} marks are not what was deserved: {'; '.join(wrong[:3])}")
    yield clock.says("every mark is what was deserved")


def _set_up(stage: Course, course: Course) -> None:
    """A course that uses the sources of another one, whose true class stays untouched.

    Raises:
        LabkitError: The folder has other contents.
    """
    sources = stage.root / "solutions"
    if not sources.is_symlink():
        if stage.root.exists() and any(stage.root.iterdir()):
            raise LabkitError(f"{stage.root} is no rehearsal's; give a folder that is new or empty")
        stage.root.mkdir(parents=True, exist_ok=True)
        sources.symlink_to(course.root / "solutions")
    shutil.copy(course.root / "nbgrader_config.py", stage.root)


class _Clock:
    """Yield sentences with the time that each step took."""

    def __init__(self) -> None:
        self.last = time.perf_counter()

    def says(self, text: str, each: int = 0) -> str:
        now = time.perf_counter()
        spent, self.last = now - self.last, now
        share = f", {spent / each:.2f} s each" if each else ""
        return f"{text} ({spent / 60:.1f} min{share})"


def _hand_in(stage: Course, name: str, count: int, download: Path) -> None:
    """Let the class in the roster hand in on Moodle, and return the downloaded zip."""
    make_class(stage, name, PUBLIC_SEED, count)
    listed = tuple(Student(who, last_name=who) for who in students(stage, name))
    save_roster(stage, Roster(listed))
    unfinished = download.with_suffix(".new")
    with zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED) as archive:
        for number, student in enumerate(students(stage, name), start=1001):
            folder = stage.submitted / student / name
            for path in sorted(folder.iterdir()):
                archive.write(path, f"{student}_{number}_assignsubmission_file/{path.name}")
            shutil.rmtree(folder.parent)
    unfinished.replace(download)
