"""What a person must delete by hand to forget a student, and whom a name may mean."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from shlex import quote

from ...course.authoring.layout import Course
from ...course.own_arm import Arms
from ...errors import LabkitError
from ..rules import FILE as RULES
from ..rules import rules_in
from ..students.enrol import agreements, marks
from ..students.identity import all_lms_users
from ..students.roster import Roster, read_roster, same_name
from ..submission import did_you_mean, is_name
from .forget import all_terms, pages_of_mates

_ZIP = "dist/baxter-lab.zip"


def left_by_hand(course: Course, terms: Sequence[Course], student: str) -> Iterator[str]:
    """A sentence for each thing about a student that only a person can delete."""
    for file in (term.root / RULES for term in terms):
        try:
            granted = any(one.student == student for one in rules_in(file).extensions)
        except LabkitError as error:
            yield f"{error}, and see whether it names an extension of theirs"
        else:
            if granted:
                name = file.relative_to(course.root)
                yield f"{name} names an extension of theirs; delete it there afterwards"
    for term, alike in _perhaps_theirs(course, terms, student):
        if alike:
            where = term.submitted.relative_to(course.root)
            yield (
                f"in {where}, perhaps theirs too: {', '.join(alike)}; look, and for each that is "
                "theirs type: labkit term forget --student FOLDER"
            )
    for page in pages_of_mates(course, student) if course in terms else ():
        mate, assignment = page.parts[-3:-1]
        yield (
            f"{page.relative_to(course.root)} says that {student} handed in; once it is deleted, "
            f"write it again: labkit feedback {assignment} --student {quote(mate)}"
        )
    if any((x.root / _ZIP).exists() and student in Arms.of(x.root).handles for x in terms):
        yield f"{_ZIP} may still hold their arm; make it again: labkit student-bundle"
    yield (
        "copies elsewhere are yours to delete: downloads, exported tables and reports, "
        "the zip of feedback, backups, the exchange, the platform itself"
    )


def unknown(course: Course, student: str, names: Collection[str]) -> LabkitError:
    """The error for a student about whom these terms store nothing, with similar names."""
    terms, key = all_terms(course).values(), student.casefold()
    people = [one for term in terms for one in read_roster(term).students]
    folders = {path.name for term in terms for path in term.submitted.glob("*")}
    known = {name: name for name in folders if is_name(name)} | {x.id: str(x) for x in people}
    meant = sorted({str(x) for x in people if key in marks(x).values()})
    near = f"; did you mean {', '.join(meant)}?" if meant else did_you_mean(student, known.values())
    where = ", ".join(names) or "this term or an earlier one"
    return LabkitError(f"no student {student!r} in {where}{near}")


def _perhaps_theirs(
    course: Course, terms: Iterable[Course], student: str
) -> Iterator[tuple[Course, list[str]]]:
    """Other folders that may belong to the same person, in each term.

    Such a folder belongs to another student of a roster with the same login, address or number, or
    with the same name if nothing contradicts it; or to somebody outside the roster who has the same
    name or is the same user of a platform.
    """
    me = Roster(tuple(one for term in terms if (one := read_roster(term).get(student))))
    used = [u[student] for term in terms for u in all_lms_users(term).values() if student in u]
    names = {same_name(x) for x in (*(y.name for y in me.students), *(z.name for z in used)) if x}
    keys = {one.key for one in used if one.system != "moodle"}  # whose numbers change
    for term in all_terms(course).values():
        roster, known = read_roster(term), all_lms_users(term).values()
        found = {
            folder
            for users in known
            for folder, one in users.items()
            if folder not in roster
            and (same_name(one.name) in names or one.key in keys or me.whose(one))
        }
        for one in roster.students if student not in roster else ():
            ties = [x for mine in me.students for x in agreements(one, mine)]
            if any(ties) or (not ties and same_name(one.name) in names):
                found.add(one.id)
        yield term, sorted(found - {student})
