"""Runs a class through every command, and finds the hostile kind that breaks a law.

If the output or the file names a kind, it is that one; otherwise the class is halved until one kind
is left.  Then the commands are run for the rest of the class without these kinds.
"""

from __future__ import annotations

import os
import re
import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from . import laws
from .classes import NAME, Kind, copied, hand_in, hand_in_honest, write_downloads
from .commands import Ended, typed

AT_ONCE = 100
"""Hostile kinds in one class.  `test_hostile_class` has a larger one."""

Told = dict[Kind | None, list[str]]
"""The broken laws by kind; the kind is None if none is responsible."""


@dataclass(frozen=True)
class Step:
    """One command to run for a class.

    Attributes:
        line: The typed line, without the assignment.
        codes: The allowed exit codes.
        needed: Whether later commands need its files.
    """

    line: str
    codes: tuple[int, ...] = (0, 1)
    needed: bool = False

    def words(self, name: str) -> list[str]:
        """The command for an assignment."""
        verb, *rest = self.line.split()
        program = "nbgrader" if verb in {"autograde", "generate_feedback"} else "labkit"
        return [program, verb, name, *rest]


LAYOUTS = ("questions", "nbgrader", "canvas", "moodle", "moodle-worksheet")
EXPORTS = tuple(Step(f"export --layout {layout}") for layout in LAYOUTS)
GRADE, FEEDBACK = Step("grade", needed=True), Step("feedback --unmarked")
REPORT, REGRADE = Step("class-report --to aside/report.md"), Step("grade --diff")
LABKIT = (
    Step("collect downloads/moodle.zip", needed=True),
    Step("collect downloads/canvas.zip", needed=True),
    Step("collect downloads/inbound --unverified", needed=True),
    GRADE,
    Step("grade --json"),
    Step("feedback --unmarked --moodle aside/back.zip"),
    *EXPORTS,
    REPORT,
    Step("class-report --names --jplag aside/jplag"),
    REGRADE,
    EXPORTS[0],
)
BRIEFLY = (*LABKIT[:4], LABKIT[5], EXPORTS[0], REPORT)
"""The commands for the sample of the gate."""
NBGRADER = (
    Step("autograde --create", needed=True),
    Step("generate_feedback"),
    EXPORTS[0],
)
OTHERS = (GRADE, FEEDBACK, EXPORTS[0], REPORT)
"""The commands for assignments other than the first."""


def guilty(kinds: Sequence[Kind], breaks: Callable[[Sequence[Kind]], list[str]]) -> Told:
    """Find the kinds that break a law without the others, and the laws that they break.

    The result is empty if a single kind breaks nothing.
    """
    found: Told = {}
    half = len(kinds) // 2
    for part in (kinds[:half], kinds[half:]) if half else ():
        faults = breaks(part)
        if faults and len(part) == 1:
            found[part[0]] = faults
        elif faults:
            found |= guilty(part, breaks) or {kind: [f"together: {faults[0]}"] for kind in part}
    return found


@dataclass
class Examined:
    """Classes of one course for which commands are run.

    Attributes:
        released: The course, in which nothing has been handed in.
        folder: The folder in which classes are made.
        steps: The commands.
        name: The assignment.
        clean: The files of the honest after each step in a class of only the honest.
    """

    released: Path
    folder: Path
    steps: Sequence[Step]
    name: str = NAME
    clean: list[dict[str, Any]] = field(default_factory=list)

    def __post_init__(self) -> None:
        course = self._course(())
        for step in self.steps:
            ended = typed(course, *step.words(self.name))
            wrong = [*laws.said(ended, (0,))]
            assert not wrong, (wrong, ended.text[-2000:])
            self.clean.append(laws.seen(course, ended, self.name))

    def of(self, kinds: Sequence[Kind]) -> Told:
        """The laws that the kinds break, in classes small enough for halving them quickly."""
        told: Told = {}
        for first in range(0, len(kinds), AT_ONCE):
            for kind, says in self._of_class(kinds[first : first + AT_ONCE]).items():
                told.setdefault(kind, []).extend(says)
        return told

    def _of_class(self, kinds: Sequence[Kind]) -> Told:
        """The laws that the kinds of one class break."""
        told: Told = {}
        left, graded = list(kinds), None
        while True:
            course = self._course(left)
            number, faults = self._through(course, left, told, graded)
            if not faults:
                return told
            graded = graded or self._results_of(course)
            breaks = partial(self._alone, number=number, graded=graded)
            culprits = {left[0]: faults} if len(left) == 1 else guilty(left, breaks)
            for kind, says in culprits.items() or [(None, faults)]:
                told.setdefault(kind, []).extend(says)
            if not culprits:
                return told
            left = [kind for kind in left if kind not in culprits]

    def _course(self, kinds: Sequence[Kind]) -> Path:
        """A class in the folder of the one before, so that the worker keeps its sandbox."""
        course = self.folder / "course"
        shutil.rmtree(course, ignore_errors=True)
        copied(self.released, course)
        (course / "aside").mkdir()
        hand_in_honest(course, self.name)
        for kind in kinds:
            if kind.table != "ENTRIES":
                hand_in(course, kind, self.name)
        if self.steps[0].line.startswith("collect"):
            write_downloads(course, kinds)
        return course

    def _results_of(self, course: Path) -> Path:
        """A copy of a class's results."""
        folder = course / "results" / self.name
        folder.mkdir(parents=True, exist_ok=True)
        return Path(shutil.copytree(folder, self.folder / "graded", dirs_exist_ok=True))

    def _through(
        self, course: Path, kinds: Sequence[Kind], told: Told, graded: Path | None
    ) -> tuple[int, list[str]]:
        """Run all steps for a class, up to the first that breaks a law without naming a kind."""
        for number, step in enumerate(self.steps):
            if step is GRADE and graded is not None:
                self._as_before(course, graded)
            mine, faults = self._do(course, number, kinds)
            for kind, says in mine.items():
                told.setdefault(kind, []).extend(x for x in says if x not in told.get(kind, []))
            if faults:
                return number, faults
        return len(self.steps), []

    def _alone(self, kinds: Sequence[Kind], number: int, graded: Path) -> list[str]:
        """The laws that a part of a graded class breaks at a step."""
        course = self._course(kinds)
        for step in self.steps[: number + 1]:
            if step is GRADE:
                self._as_before(course, graded)
            if step.needed and step is not self.steps[number]:
                typed(course, *step.words(self.name))
        _, faults = self._do(course, number, kinds)
        return faults

    def _as_before(self, course: Path, graded: Path) -> None:
        """Give a class the results that it had before, because grading takes long."""
        folder = course / "results" / self.name
        folder.mkdir(parents=True)
        for student in os.listdir(course / "submitted"):
            result = graded / f"{student}.json"
            if len(os.fsencode(result.name)) < 256 and result.is_file():
                shutil.copy(result, folder)

    def _do(self, course: Path, number: int, kinds: Sequence[Kind]) -> tuple[Told, list[str]]:
        """Run a step; return the broken laws by kind, and those without a known kind."""
        step, since = self.steps[number], time.time()
        ended = typed(course, *step.words(self.name))
        mine: Told = {}
        nameless = []
        for line, says in laws.told(ended, step.codes):
            named = [k for k in kinds if len(k.folder) > 3 and k.folder in line]
            if named:
                mine.setdefault(max(named, key=lambda k: len(k.folder)), []).append(says)
            else:
                nameless.append(says)
        now = laws.seen(course, ended, self.name)
        pages = "feedback" in step.line or (course / "feedback").is_dir()
        due = {k: v for k, v in self.clean[number].items() if pages or not k.endswith("'s html")}
        nameless += (f"{step.line}: {x}" for x in laws.changed(due, now))
        if step.line.startswith("export"):
            nameless += laws.table(ended)
        for path, says in laws.written(course, since - 0.05, self.name):
            owner = next((k for k in kinds if k.folder in {*path.parts, path.stem}), None)
            if owner is None:
                nameless.append(f"{step.line}: {path.name[:60]!a}: {says}")
            else:
                mine.setdefault(owner, []).append(f"{step.line}: {says}")
        if step is GRADE and ended.code in step.codes:
            for kind, says in self._marks(course, kinds, ended):
                mine.setdefault(kind, []).append(f"grade: {says}")
        return mine, nameless

    def _marks(
        self, course: Path, kinds: Sequence[Kind], ended: Ended
    ) -> Iterator[tuple[Kind, str]]:
        """The kinds without a result and without a line, and those with a wrong mark."""
        results = laws.results(course, self.name)
        full = results["ada"]["points"]
        lines = [set(re.findall(r"\w+", line)) for line in ended.text.split("\n")]
        for kind in kinds:
            least = _LEAST.get(kind.table, 0.0) * full
            result = results.get(kind.folder)
            if result is None:
                named = any(set(re.findall(r"\w+", kind.folder)[:3]) <= line for line in lines)
                if kind.table != "ENTRIES" and not named:
                    yield kind, "neither graded nor named"
            elif result["score"] < least and not (result["rejected"] and kind.table in _REFUSED):
                why = result["rejected"] or [
                    q["notes"] or q["verdict"] for q in result["questions"]
                ]
                yield kind, f"{result['score']} of {full}, though right: {str(why)[:200]!a}"


_LEAST = {"TEXTS": 0.85, "MAGICS": 1.0, "PEOPLE": 1.0, "FILE_NAMES": 1.0}
"""The share of the points that right work in an odd form must earn."""
_REFUSED = ("FILE_NAMES",)
"""The tables whose kinds may be refused instead, with a reason."""
