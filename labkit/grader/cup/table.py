"""The cup's table by handle: as text, as a page with replays, and as a bonus in the gradebook."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ...course.authoring.layout import CUP, Course
from ...course.baxter_cup import benchmarks
from ...course.own_arm import Arms
from ..nbgrader.gradebook import open_gradebook
from ..nbgrader.unreleased import enter_tasks
from ..pages import render_page
from ..rules import read_rules
from .entries import Entry

BONUS = "benchmarks_beaten"
"""The name of the bonus in the gradebook."""


def lines(found: Mapping[str, Entry]) -> Iterator[tuple[float, str, Entry | None]]:
    """Benchmarks and entries by handle: score in [mm], name, and the entry; the best first."""
    everyone = [(score, f"benchmark: {name}", None) for name, score in benchmarks().items()]
    yield from sorted(
        [*everyone, *((x.score, name, x) for name, x in found.items())], key=lambda line: line[:2]
    )


def as_text(found: Mapping[str, Entry]) -> Iterator[str]:
    """A line for each entry and benchmark."""
    for score, name, entry in lines(found):
        said = f"; {entry.why}" if entry and entry.why else ""
        yield f"{score:8.1f} mm  {name}{said}"


def page(course: Course, found: Mapping[str, Entry], final: bool) -> str:
    """The table as one file, with a replay of each entry's first run."""
    return render_page(
        "cup.html.j2",
        replays=True,
        course=read_rules(course).name,
        title="The Baxter Cup: " + ("the final" if final else "the board"),
        lines=list(lines(found)),
        most=len(benchmarks()),
    )


def give_bonus(course: Course, found: Mapping[str, Entry]) -> None:
    """Write how many benchmarks an entry beats as extra credit of all who have its handle now.

    Students who had extra credit before, and whose handle has no entry now, get 0.
    """
    handles = Arms.of(course.root).handles
    with open_gradebook(course) as book:
        had = {x.student.id for x in book.assignment_submissions(CUP)}
        for student in sorted(had | handles.keys() | {x.student for x in found.values()}):
            handle = handles.get(student, student)
            mine = {name: entry for name, entry in found.items() if name == handle}
            if not (mine or student in had):
                continue
            text = "```text\n{}\n```".format("\n".join(as_text(mine)))
            for grade in enter_tasks(course, book, CUP, student, {BONUS: text}, 0):
                grade.auto_score = 0.0
                grade.extra_credit = float(sum(x.beaten for x in mine.values()))
                grade.needs_manual_grade = False
        book.db.commit()
