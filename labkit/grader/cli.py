"""What an instructor types, in the order of a term: a function for each verb.

A function returns the exit code: 0, or 1 if a person must look at what is named.  What it needs is
imported when it runs, so that help is quick.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable
from datetime import datetime
from pathlib import Path

import click

from ..course.authoring.layout import DEFENCE, Course
from ..errors import LabkitError
from .clean import clean_text, few, how_many
from .each import Failures

Paths = tuple[Path, ...]
PATH = click.Path(path_type=Path)
VERBS: list[click.Command] = []
LAYOUTS = ("questions", "canvas", "moodle", "gradescope")
TIME = click.DateTime(["%Y-%m-%d %H:%M"])
_DEFENCE = f"{DEFENCE} is marked by: labkit defence STUDENT --mark A B C"
_PUBLIC = "without a term anyone can compute the hidden cases; begin one: labkit term new"


def verb(example: str) -> Callable[[Callable[..., int]], click.Command]:
    """Make a function the verb of its name, whose help ends with an example."""

    def make(function: Callable[..., int]) -> click.Command:
        name = function.__name__.replace("_", "-")
        epilog = f"example: labkit {name} {example}".rstrip()
        VERBS.append(click.command(name, epilog=epilog)(function))
        return VERBS[-1]

    return make


def _assignment(context: click.Context, _: click.Parameter, name: str | None) -> str:
    """The name of an assignment that the course has a notebook of."""
    course: Course = context.params["course"]
    if name is None:
        there = {path.name for path in course.submitted.glob("*/*")}
        handed_in = [x for x in course.names() if x in there]
        which = ", ".join(handed_in or course.names())
        raise LabkitError(f"which assignment? {'handed in' if handed_in else 'all'}: {which}")
    if name == DEFENCE:
        raise LabkitError(_DEFENCE)
    course.notebook_source(name)
    return name


_course = click.option(
    "--course",
    type=PATH,
    metavar="DIR",
    is_eager=True,
    callback=lambda context, option, place: Course.here(place),
    help="Folder of the course; by default the one you are in.",
)
_of_assignment = click.argument("assignment", required=False, callback=_assignment)
_names = click.argument("names", nargs=-1, metavar="[NAME]...")
_students = click.option("--student", multiple=True, metavar="S", help="Only this one; repeatable.")
_to = click.option("--to", type=PATH, metavar="FILE", help="Write to FILE, not to the screen.")


def _tell(sentences: Iterable[object], doubtful: bool = False) -> None:
    """Print sentences as they come."""
    for sentence in sentences:
        said = clean_text(str(sentence))
        print(said, file=sys.stderr if doubtful else sys.stdout, flush=True)


def _write(text: str, to: Path | None) -> None:
    """Write a text to a file or, without one, to the screen."""
    if to is None:
        sys.stdout.write(clean_text(text))
    else:
        to.write_text(text, encoding="utf-8")
        print(f"written: {to}")


# Before the term


@verb("")
def doctor() -> int:
    """Check whether this machine can grade safely.

    The sandbox is tried from inside. If it cannot be made, what your machine needs is printed.
    """
    from .doctor import examine

    bad = False
    for finding in examine():
        print(finding, flush=True)
        bad |= not finding.fine
    return int(bad)


@verb("new 01_paths")
@click.argument("action", type=click.Choice(["new", "forget"]), metavar="new|forget")
@_names
@click.option("--yes", is_flag=True, help="new: even with students; forget: delete, not only list.")
@_course
def term(course: Course, action: str, names: tuple[str, ...], yes: bool) -> int:
    """Begin a term, or delete a student's records.

    \b
    new     archives the last term in course_private/ and releases each NAME,
            or all assignments, with a new secret; refuses, without --yes, if
            the last term has students, submissions or marks
    forget  lists the folders and files named after each student NAME, in all
            terms; with --yes it deletes them. It lists what else has the name.

    The law may say how long marks must be kept.
    """  # noqa: D301
    from .rules import FILE
    from .term import forget, new_term

    if action == "new":
        old, made = new_term(course, names, yes)
        _tell([*[f"archived: {old}"] * bool(old), *made])
        print(f"write the due dates in {FILE}, and keep a copy of {course.term.parent}")
        return 0
    for student in names or [""]:
        theirs, others = forget(course, student, yes)
        for what, paths in (("deleted" if yes else "would go", theirs), ("also has it", others)):
            _tell(f"{student}: {what}: {path.relative_to(course.root)}" for path in paths)
    print("delete by hand what also has the name, and downloads, tables, zips, backups")
    if not yes:
        print("nothing is deleted yet; add --yes")
    return 0


@verb("01_paths")
@_names
@click.option("--plain", type=PATH, metavar="DIR", help="Also write a course for nbgrader alone.")
@_course
def release(course: Course, names: tuple[str, ...], plain: Path | None) -> int:
    """Make the students' notebooks.

    Each NAME is an assignment, such as 01_paths. Without a NAME all assignments are made. If one is
    refused, the others are still made. A course in DIR is graded by nbgrader's own commands,
    without a sandbox: its notebooks hold the hidden cases, as nbgrader's hidden tests.
    """
    from .plain import write_plain
    from .release import release
    from .seeds import seed_of

    names, made = names or course.names(), list[str]()
    for name in names:
        course.notebook_source(name)
    with Failures() as failures:
        for name in names:
            try:
                print(release(course, name, seed_of(course)), flush=True)
                made.append(name)
            except LabkitError as error:
                failures.append(f"{name} is not released: {error}")
        if made:
            _tell([_PUBLIC] * (not course.term.exists()))
            print(f"for students: {course.release}\nfor graders, with hidden cases: {course.build}")
        if plain and made:
            write_plain(course, made, plain)
            print(f"for nbgrader alone, with hidden cases: {plain}")
    return failures.code


@verb("participants.csv")
@click.argument("file", type=PATH, metavar="LIST.csv")
@_course
def roster(course: Course, file: Path) -> int:
    """Add the students of a list to the roster.

    The list comes from Moodle or Canvas, or is any table with a row for each student. Who has
    another role is left out, and named. A student keeps the folder of the first list.
    """
    from .roster import FILE, import_list

    found = import_list(course, file)
    print(f"{FILE}: {how_many(len(found.students), 'student')}, {len(found.new)} of them new")
    says = {"left out, as they are no students": found.others, "not in this list": found.absent}
    _tell(f"{what}: {', '.join(who)}" for what, who in says.items() if who)
    return 0


@verb("--to week1.zip")
@_names
@click.option("--to", type=PATH, metavar="FILE", help="By default dist/baxter-lab.zip.")
@click.option("--book", metavar="ADDRESS", help="Link to the book, instead of packing it.")
@click.option("--open-in", metavar="ADDRESS", default="", help="GitHub repository with the files.")
@_course
def student_zip(
    course: Course, names: tuple[str, ...], to: Path | None, book: str | None, open_in: str
) -> int:
    """Write the zip that students unpack and start.

    Without a NAME the zip holds every assignment that was released in this term.
    """
    from .student_zip import student_zip

    to = to or course.root / "dist" / "baxter-lab.zip"
    names = student_zip(course, names, to, book, open_in.rstrip("/"))
    print(f"{to}: {', '.join(names)}; {to.stat().st_size / 1e6:.1f} MB")
    return 0


# After each deadline


@verb("01_paths moodle.zip")
@_of_assignment
@click.argument("sources", nargs=-1, required=True, type=PATH, metavar="ZIP|DIR...")
@click.option("--unverified", is_flag=True, help="Exchange: take what unknown users handed in.")
@click.option("--at", type=TIME, metavar="TIME", help="'2026-11-05 12:00', if it has no times.")
@_course
def collect(
    course: Course,
    assignment: str,
    sources: tuple[Path, ...],
    unverified: bool,
    at: datetime | None,
) -> int:
    """Collect what students handed in, from any platform.

    A source is a zip from Moodle or Canvas, or the inbound folder of nbgrader's exchange. Every
    notebook that was taken is kept, in attempts/. A file that fits no one student of the roster is
    named and left, with exit code 1. Put files from elsewhere into submitted/STUDENT/ASSIGNMENT/.
    """
    from .collect import collect

    bad = False
    for source in sources:
        for one in collect(course, assignment, source, at, unverified):
            _tell([one], doubtful=not one.fine)
            bad |= not one.fine
    return int(bad)


@verb("01_paths --student ada")
@_of_assignment
@_students
@click.option("--jobs", type=click.IntRange(1), metavar="N", help="By default one a core.")
@click.option("--again", is_flag=True, help="Also grade what is already graded.")
@click.option("--diff", is_flag=True, help="Change no mark; list the marks that would change.")
@click.option("--dask", metavar="ADDRESS", help="A Dask scheduler whose workers see this folder.")
@click.option("--isolation", type=click.Choice(["bubblewrap", "user"]), default="bubblewrap")
@_course
def grade(
    course: Course,
    assignment: str,
    student: tuple[str, ...],
    jobs: int | None,
    again: bool,
    diff: bool,
    dask: str | None,
    isolation: str,
) -> int:
    """Grade every submission that is not graded yet.

    Each submission is graded in a sandbox of its own. After you have changed a test and released
    the assignment, all submissions are graded again, and a mark may fall: look with --diff first.
    A mark that you gave by hand in formgrader stays.
    If a file is rejected, such as the notebook of another assignment, the exit code is 1.

    With --isolation user, for root in a container without bubblewrap, a user id and limits isolate.
    """
    from ..course.authoring.bundle import Bundle
    from .batch import GradeOptions, changes, grade_class
    from .gradebook import record
    from .rules import read_rules
    from .sandbox.launch import Isolation
    from .submission import misnamed, none_of, students

    jobs = jobs or len(os.sched_getaffinity(0))
    options = GradeOptions(jobs, Isolation(isolation), dask, again)
    with Failures() as failures:
        read_rules(course)  # an error in them stops here, not after an hour
        found = students(course, assignment)
        who = [*student] or found
        if not student:
            failures += [f"not graded: {one}" for one in misnamed(course, assignment)]
        for name in who or [""] * (not failures.code):
            if name not in found:
                raise LabkitError(none_of(course, assignment, name))
        graded = grade_class(course, assignment, who, options, change=not diff)
        done = failures.sift(graded, "not graded")
        if diff:
            _tell(changes(list(done)))
            return failures.code
        results = []
        for number, one in enumerate(done, start=1):
            results.append(one.result)
            says = f" ({one.says})" if one.says else ""
            print(f"[{number}/{len(who)}] {one.result}{says}", flush=True)
        written = record(course, assignment, results)
        _tell(failures.sift(written, "not in the gradebook"))
        if by_hand := Bundle.of(course, assignment).by_hand:
            print(f"not included: {how_many(by_hand, 'point')}, marked in formgrader")
        if results:
            print(f"isolation: {results[-1].isolation}\nresults: {course.results / assignment}")
    return failures.code or int(any(result.rejected for result in results))


@verb("01_paths --to report.md")
@_of_assignment
@_to
@_course
def class_report(course: Course, assignment: str, to: Path | None) -> int:
    """Report what the class got right and wrong.

    The report counts mistakes by their names, and names no student.
    """
    from ..course.authoring.bundle import Bundle
    from .class_report import report
    from .marks import marks_of

    with Failures() as failures:
        marks = marks_of(course, assignment)
        if not any(mark.result for mark in marks):
            raise _nobody(assignment, next((m.missing for m in marks if m.missing), ""))
        out = [mark for mark in marks if mark.missing and not mark.lines]
        failures += [f"left out: {mark.student}: {mark.missing}" for mark in out]
        problems = {p.name: p for p in course.problems(assignment)}
        asked = Bundle.of(course, assignment).questions
        truths = {p.name: p.truth for p in course.predictions(assignment)}
        _write(report(assignment, marks, problems, asked, truths), to)
    return failures.code


@verb("01_paths --student ada")
@_of_assignment
@_students
@click.option("--moodle", type=PATH, metavar="ZIP", help="Also write a zip of pages for Moodle.")
@click.option("--unmarked", is_flag=True, help="Write pages before all is marked by hand.")
@_course
def feedback(
    course: Course, assignment: str, student: tuple[str, ...], moodle: Path | None, unmarked: bool
) -> int:
    """Write a feedback page for each student.

    Some answers are marked by hand, in formgrader. No page is written until they are all marked;
    the page of one --student waits for the answers of that student alone. With --unmarked no page
    waits.
    """
    from .collect import for_exchange
    from .feedback import moodle_zip, write_feedback
    from .marks import marks_of

    with Failures() as failures:
        everybody = [mark for mark in marks_of(course, assignment) if not mark.absent]
        marks = [mark for mark in everybody if not student or mark.student in student]
        if not marks or {*student} - {mark.student for mark in marks}:
            raise _nobody(assignment)
        waiting = {mark.student: ", ".join(mark.open) for mark in marks if mark.open}
        if waiting and not unmarked:
            who = few([f"{student} ({names})" for student, names in waiting.items()])
            raise LabkitError(f"not marked yet in formgrader: {who}; add --unmarked not to wait")
        pages = write_feedback(course, assignment, marks)
        made = list(failures.sift(pages, "no page"))
        print(f"pages in {course.root / 'feedback'}: {len(made)}")
        sent = for_exchange(course, assignment, made)
        if any(list(failures.sift(sent, "not for the exchange"))):
            print(f"back to the exchange: nbgrader release_feedback {assignment}")
        if moodle:
            count = moodle_zip(course, assignment, made, moodle)
            print(f"for Moodle, {count} of {len(made)}: {moodle}")
    return failures.code


@verb("01_paths --to marks.csv")
@click.argument("assignment", required=False)
@click.option("--layout", type=click.Choice(LAYOUTS), default="questions", help="For whom.")
@click.option("--column", metavar="NAME", help="canvas, moodle: its name there: 'Paths (4711)'.")
@_to
@_course
def export(
    course: Course, assignment: str | None, layout: str, column: str | None, to: Path | None
) -> int:
    """Write marks.

    The marks are those of an assignment or, without ASSIGNMENT, of the term: every assignment that
    was graded, and the total with the weights of course.toml. The layout gradescope is the zip with
    which Gradescope grades ASSIGNMENT itself.
    """
    from .export import LAYOUTS, as_csv, of_term, remarks
    from .marks import marks_of
    from .rules import FILE as RULES
    from .rules import read_rules

    if assignment is None and layout != "questions":
        raise LabkitError(f"name the assignment: labkit export ASSIGNMENT --layout {layout}")
    if assignment not in (None, DEFENCE):
        course.notebook_source(assignment)
    if layout == "gradescope":
        from .gradescope import autograder

        to = to or course.root / "dist" / f"{assignment}-gradescope.zip"
        autograder(course, str(assignment), to)
        print(f"written: {to}; it holds the hidden cases, so give it to Gradescope alone")
        return 0
    rules = read_rules(course)
    names = [x.stem for x in sorted(course.bundle.glob("*.json"))]
    all_marks = {}
    for name in [assignment] if assignment else [*names, DEFENCE]:
        marks = marks_of(course, name)
        if not all(mark.absent for mark in marks):
            _tell((f"{name}: {says}" for says in remarks(layout, marks, name)), doubtful=True)
            all_marks[name] = marks
    if not all_marks:
        raise _nobody(assignment or "any assignment")
    everybody = [mark for marks in all_marks.values() for mark in marks]
    if assignment is None:
        table = of_term(all_marks, {name: rules.weight(name) for name in all_marks})
    else:
        table = LAYOUTS[layout](column or assignment, all_marks[assignment])
        if layout == "moodle":
            full = max(mark.points for mark in everybody)
            _tell([f"in Moodle the maximum of {assignment} must be {full:g}"], doubtful=True)
    _write(as_csv(table), to)
    idle = {x.student for x in rules.extensions} - {mark.student for mark in everybody}
    says = (f"{RULES} has an extension for {x[:60]!a}, whom nobody knows" for x in sorted(idle))
    _tell(says, doubtful=True)
    return int(bool(idle) or any(mark.missing for mark in everybody))


def _nobody(assignment: str, why: str = "") -> LabkitError:
    """The error if nothing is graded yet; ``why`` says why no result can be read."""
    how = _DEFENCE if assignment == DEFENCE else f"type: labkit grade {assignment}"
    return LabkitError(f"nobody asked for is graded in {assignment}; {why or how}")


# When a student asks, and at the end


@verb("01_paths ada bang_bang")
@_of_assignment
@click.argument("student")
@click.argument("question")
@_course
def explain(course: Course, assignment: str, student: str, question: str) -> int:
    """Explain the mark of an answer, with its numbers.

    The answer runs once more in the sandbox. You see what the student may be shown, and then,
    for you alone, the hidden case that decided the mark. Numbers and runs are written to a page.
    """
    from .explain import explain

    print(explain(course, assignment, student, question))
    return 0


@verb("ada --mark 2 3 1")
@click.argument("student")
@click.option("--mark", nargs=3, type=click.IntRange(0, 3), help="Record the points.")
@_course
def defence(course: Course, student: str, mark: tuple[int, ...] | None) -> int:
    """Print the page of a student's oral examination.

    It asks about three functions of theirs that were accepted, each with a mistake put into it, or
    as many as there are; for the rest you choose work of theirs to ask about.
    The second side has the answers. Which functions and mistakes follows from a key of the term.
    """
    from .defence import ASKED, draw, give_mark, write_page

    if mark is not None:
        give_mark(course, student, mark)
        print(f"{student}: {how_many(sum(mark), 'point')} for the defence")
        return 0
    asked = draw(course, student)
    path = write_page(course, student, asked)
    print(f"{', '.join(one.of.question.name for one in asked) or 'no function'}: {path}")
    if len(asked) < ASKED:
        print(f"ask about more work of theirs; what is recorded are {ASKED} numbers")
    return 0
