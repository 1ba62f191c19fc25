"""Remarks on students and on lists of them, as sentences."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from ...course.authoring.layout import Course
from ..clean import clean_line, few, how_many
from ..rules import FILE as RULES
from ..rules import read_rules
from ..submission import did_you_mean
from .class_list import GUESS, Entry, Student, encoding_of
from .platforms import LmsUser
from .roster import FILE, Roster, read_roster, same_name


def about_encoding(file: Path, students: Iterable[Student]) -> Iterator[str]:
    """Names that may be wrong, as the encoding of the list is a guess."""
    names = dict.fromkeys(one.name for one in students if not one.name.isascii())
    if names and encoding_of(file.read_bytes()) == GUESS:
        yield (
            f"{file} is not in UTF-8, and was read as Windows-1252; check these names: "
            f"{few([*names])}. If one is wrong, save the list in UTF-8, delete students who are "
            f"new from {FILE} before any of their work is collected, and import the list again"
        )


def about_teams(rows: Sequence[tuple[Entry, Student]]) -> Iterator[str]:
    """A remark on a list's teams, which may be groups that were made for another purpose."""
    teams = Counter(entry.student.team for entry, _ in rows if entry.student.team)
    if teams:
        names, most = [*map(repr, sorted(teams))], how_many(max(teams.values()), "student")
        yield (
            f"teams in this list: {len(teams)} ({few(names)}), the largest of "
            f"{most}; a team has one arm and hands in one report. If "
            "these are other groups, such as tutorials, delete their column from the list, clear "
            f"the column team of {FILE}, and import the list again"
        )


def about_odd_teams(rows: Sequence[tuple[Entry, Student]]) -> Iterator[str]:
    """Remarks on teams that are probably two groups, and on students without a team."""
    teams = {entry.student.team for entry, _ in rows if entry.student.team}
    named = {student.id for entry, student in rows if entry.student.team}
    if two := [repr(team) for team in sorted(teams) if "," in team]:
        yield (
            f"teams with a comma: {few(two)}; Moodle writes this for a student in two groups, "
            "and labkit takes it for another team; leave one group for each student in the list, "
            "and import it again"
        )
    stay = [f"{x} in {x.team!r}" for _, x in rows if x.team and x.id not in named]
    if teams and stay:
        yield (
            f"without a team in this list, and still in the team they had: {few(stay)}; to take "
            f"somebody out of a team, clear their cell in the column team of {FILE}, and import "
            "the list again; they then get an arm of their own, and no longer the mark of the "
            "team's report"
        )


def about_changed_teams(before: Roster, rows: Iterable[tuple[Entry, Student]]) -> Iterator[str]:
    """Students whom a list gives another team, and with it another arm and another report."""
    changed = [
        f"{now} from {f'{old.team!r}' if old.team else 'no team'} to {now.team!r}"
        for now in dict.fromkeys(student for _, student in rows)
        if (old := before.get(now.id)) and old.team != now.team
    ]
    if changed:
        yield (
            f"teams changed: {few(changed)}; their arm is now the new team's, and so is their mark "
            "for the report, unless they hand in one themselves. At the next grading, this changes "
            "marks that they already have. If somebody wrote the report with the earlier team, "
            "import the list with that team, and change it after the report's marks have been "
            "exported. To give them the new arm, make the zip again (labkit student-bundle) and "
            "hand it out"
        )


def about_doubles(absent: Iterable[Student], new: Iterable[Student]) -> Iterator[str]:
    """New students who may have been in the roster before, with another address or number."""
    before = {same_name(one.name): one.id for one in absent if one.name}
    pairs = [f"{x} and {before[name]}" for x in new if (name := same_name(x.name)) in before]
    if pairs:
        yield (
            "new, with the name of a student who was in the roster before and is not in this list: "
            f"{few(pairs)}; if the two are one student, delete the new row from {FILE}, write the "
            "new address, login or number into the other row, and import the list again"
        )


def about_namesakes(roster: Roster, known: Mapping[str, Mapping[str, LmsUser]]) -> Iterator[str]:
    """Students with the same name, and the assignments in which their numbers differ."""
    for group in roster.namesakes():
        told_apart = [
            assignment
            for assignment, users in known.items()
            if all((user := users.get(x.id)) and user.system == "moodle" for x in group)
        ]
        yield (
            f"{len(group)} students have the same name: {', '.join(map(str, group))}; Moodle's zip "
            "does not say which is which, so import the grading worksheet of each assignment, with "
            "--assignment"
            + f"; this is done for {', '.join(sorted(told_apart))}"
            * bool(told_apart)
        )


def about_extensions(course: Course) -> Iterator[str]:
    """A sentence for each extension whose student is unknown."""
    known = {student.id for student in read_roster(course).students}
    known |= {path.name for path in course.submitted.glob("*")}
    for name in sorted({x.student for x in read_rules(course).extensions} - known):
        whom = f"{clean_line(name, 60)!r}, who is neither in {FILE} nor in submitted/"
        yield f"{RULES} has an extension for {whom}{did_you_mean(name, known)}"
