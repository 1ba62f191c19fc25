"""The attacks in this grader, by a class of attackers with a few honest students."""

from __future__ import annotations

import csv
import io
import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest.mock import patch

from soak.attacks.attack import CANARY, Attack
from soak.attacks.family import Family
from soak.attacks.others import VICTIM
from soak.attacks.place import NAME, Place

from labkit.__main__ import main
from labkit.course.authoring.layout import Course
from labkit.grader.batch import GradeOptions, grade_class
from labkit.grader.each import Failure
from labkit.grader.sandbox.limits import Limits

LIMITS = Limits(cell=2.0, call=1.0, question=8.0, wall=40.0)
HONEST = ("adam", "s0", VICTIM)
"""Honest students before, among and after the attackers; the last is a victim of some attacks."""
MORE = {"feedback": ["--unmarked"]}
"""Options of the commands, because attacks leave texts that nobody marks."""
COMMANDS = re.compile(
    r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]|^\[9/9\] everybody", re.M
)
"""Characters that a terminal obeys, and text that looks like a line of the grader."""
MOST = 2_000_000
"""The largest size of a result file, in bytes."""
NOT_SAID = ("source", "own", "motion", "hashes")
"""Parts of a result that the grader did not make, or that are not text."""


@dataclass
class Class:
    """The results of grading a class.

    Attributes:
        attackers: The name of each student's attack.
        accomplices: The name of the attack of each accomplice, who was graded next.
        results: The data of the result files, by student.
        sizes: The sizes of the result files, by student.
        pages: The feedback pages, by student.
        marks: The exported marks, by student.
        failed: The grader's messages about students whom it could not grade.
        codes: The exit codes of the commands.
        printed: The whole output of the commands.
        left: The processes that outlived the grader.
        loot: The data that was taken out.
        stolen: Whether a file of an honest student was changed.
    """

    attackers: dict[str, str] = field(default_factory=dict)
    accomplices: dict[str, str] = field(default_factory=dict)
    results: dict[str, Any] = field(default_factory=dict)
    sizes: dict[str, int] = field(default_factory=dict)
    pages: dict[str, str] = field(default_factory=dict)
    marks: dict[str, str] = field(default_factory=dict)
    failed: list[str] = field(default_factory=list)
    codes: dict[str, object] = field(default_factory=dict)
    printed: str = ""
    left: list[str] = field(default_factory=list)
    loot: list[str] = field(default_factory=list)
    stolen: list[str] = field(default_factory=list)


def defended(attacks: Mapping[str, Attack], here: Place) -> Class:
    """Grade a class of attackers, write its pages, export its marks and write its report."""
    made = Class()
    solved = {who: _hand_in_solved(here, who) for who in HONEST}
    for number, (name, attack) in enumerate(attacks.items()):
        student, filled = f"s{number:03d}", here.filled(attack)
        made.attackers[student] = name
        here.hand_in(student, filled.planted(here.notebook()))
        if attack.then:
            made.accomplices[f"{student}-then"] = name
            here.hand_in(f"{student}-then", filled.accomplice(here.notebook()))
    pairs = [s for s in made.attackers if f"{s}-then" in made.accomplices]
    with patch.dict(os.environ, LABKIT_CANARY=CANARY), Family() as family:
        _grade(here, [who for student in pairs for who in (student, f"{student}-then")], 1, made)
        _grade(here, sorted({*made.attackers, *HONEST} - set(pairs)), 1 + (len(attacks) > 50), made)
        for verb in ("grade", "feedback", "export", "class-report"):
            _run(verb, here, made)
        made.left = family.left()
    read(here.course, (*made.attackers, *made.accomplices, *HONEST), made)
    made.loot = sorted(p.name for p in here.loot.iterdir() if p.name != "socket")
    made.stolen = [
        who for who, data in solved.items() if _handed_in(here, who).read_bytes() != data
    ]
    return made


def _handed_in(here: Place, who: str) -> Path:
    return here.course.submitted / who / NAME / f"{NAME}.ipynb"


def _hand_in_solved(here: Place, who: str) -> bytes:
    path = _handed_in(here, who)
    if not path.exists():
        here.hand_in(who, here.notebook(solved=True))
    return path.read_bytes()


def _grade(here: Place, students: list[str], jobs: int, made: Class) -> None:
    how = GradeOptions(jobs=jobs, limits=LIMITS)
    done = grade_class(here.course, NAME, students, how) if students else ()
    made.failed += [str(one) for one in done if isinstance(one, Failure)]


def _run(verb: str, here: Place, made: Class) -> None:
    """Run one command of the instructor and note its results."""
    more = MORE.get(verb, [])
    out, err = io.StringIO(), io.StringIO()
    try:
        with redirect_stdout(out), redirect_stderr(err):
            made.codes[verb] = main([verb, NAME, "--course", str(here.course.root), *more])
    except BaseException as error:
        made.codes[verb] = f"{type(error).__name__}: {error}"[:300]
    made.printed += out.getvalue() + err.getvalue()
    if verb == "export":
        with suppress(KeyError):
            made.marks = {
                row["student"]: row["score"] for row in csv.DictReader(io.StringIO(out.getvalue()))
            }


def read(course: Course, students: Iterable[str], made: Class) -> None:
    """Read the results and pages of some students."""
    for student in students:
        with suppress(OSError, ValueError):
            text = (course.root / "results" / NAME / f"{student}.json").read_text()
            made.sizes[student], made.results[student] = len(text.encode()), json.loads(text)
        with suppress(OSError):
            page = course.root / "feedback" / student / NAME / f"{NAME}.html"
            made.pages[student] = page.read_text(errors="replace")


def said(data: Any) -> Iterator[str]:
    """All texts of a result that a student's code could have influenced."""
    if isinstance(data, str):
        yield data
    elif isinstance(data, Mapping):
        for key, inner in data.items():
            if key not in NOT_SAID:
                yield from said(inner)
    elif isinstance(data, Iterable):
        for inner in data:
            yield from said(inner)


def wins(name: str, attack: Attack, made: Class) -> Iterator[str]:
    """The gains of an attack in spite of the defence."""
    student = next(s for s, n in made.attackers.items() if n == name)
    for who in (student, *(s for s, n in made.accomplices.items() if n == name)):
        if who not in made.results:
            yield "no result"
            continue
        deserved = attack.earns if who == student else 0.0
        score = made.results[who]["score"]
        if score > deserved:
            yield f"{score:g} points, deserved {deserved:g}"
        yield from spoken(made.results[who], made.sizes[who], made.pages.get(who))


def spoken(result: Any, size: int, page: str | None) -> Iterator[str]:
    """The forbidden texts in a result and in a page."""
    words = [*said(result), page or ""]
    text = "\n".join(words)
    for secret in ("GOT", CANARY):
        if secret in text:
            yield f"it says {text[max(0, text.find(secret) - 20) :][:80]!r}"
    if size > MOST:
        yield f"a result of {size:,} bytes"
    if found := next((word for word in words if COMMANDS.search(word)), None):
        at = COMMANDS.search(found)
        yield f"a terminal's command in {found[max(0, at.start() - 20) :][:60]!r}"
    if page is None:
        yield "no page"
