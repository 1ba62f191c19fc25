"""Make all recorded data again, and print what has changed: ``make record``.

After a change to the physics, the recorded runs, trials and campaign, the students' notebooks
and the verdicts on all known answers no longer agree with the code.  This program makes them again
in order, and names each verdict that changed and why.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from labkit.course.authoring.layout import PUBLIC_SEED, Course
from labkit.course.authoring.problem import Problem
from labkit.course.calling import called
from labkit.course.marking import mark
from labkit.course.verdict import Verdict

ROOT = Path(__file__).parents[2]
VERDICTS = Path(__file__).with_name("verdicts.json")
"""What each known answer earns with the public seed, and why."""
MAKERS = (
    ("solutions.study.baseline",),
    ("solutions.study.trials",),
    ("solutions.study", "--keep"),
    ("solutions.study.assumptions",),
)
"""Modules that record runs; ``labkit release`` comes after them."""

Answer = Callable[..., Any]
Verdicts = Mapping[str, Mapping[str, Any]]
"""For each "assignment/question/answer" the points, each test's outcome and the mistake's name."""


def answers(problem: Problem) -> Iterator[tuple[str, Answer]]:
    """Every known answer to a problem, with its name."""
    yield "the answer", problem.answer
    for number, variant in enumerate(problem.variants):
        yield f"right {number}: {getattr(variant, '__name__', type(variant).__name__)}", variant
    for wrong in problem.wrong:
        yield wrong.name, wrong.function


def verdicts(course: Course, names: tuple[str, ...]) -> Verdicts:
    """The verdict on each known answer of some assignments."""
    found = {}
    for name in names:
        for problem in course.problems(name):
            question = problem.question(PUBLIC_SEED)
            for label, function in answers(problem):
                found[f"{name}/{problem.name}/{label}"] = as_data(mark(question, called(function)))
    return found


def as_data(verdict: Verdict) -> Mapping[str, Any]:
    """The part of a verdict that is recorded, as JSON data."""
    return {
        "earned": verdict.earned,
        "tests": [[test.name, test.outcome.value] for test in verdict.tests],
        "mistake": verdict.mistake.name if verdict.mistake else None,
    }


def changes(before: Verdicts, after: Verdicts) -> Iterator[str]:
    """A sentence for each verdict that has changed."""
    for key in sorted({*before, *after}):
        old, new = before.get(key), after.get(key)
        if old is None or new is None:
            yield f"{key}: {'no longer asked' if new is None else 'asked for the first time'}"
        elif old != new:
            moved = [
                f"{name}: {was} before, {now} now"
                for (name, was), (_, now) in zip(old["tests"], new["tests"], strict=False)
                if was != now
            ]
            if old["mistake"] != new["mistake"]:
                moved.append(f"taken for {old['mistake']} before, for {new['mistake']} now")
            yield f"{key}: {old['earned']:g} points before, {new['earned']:g} now; {moved}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Record, release, mark, and print what changed."""
    parser = argparse.ArgumentParser(prog="python -m solutions.study.record", description=__doc__)
    parser.add_argument("--verdicts", action="store_true", help="mark known answers only")
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 at a change")
    parser.add_argument("names", nargs="*", metavar="NAME", help="assignments; all by default")
    options = parser.parse_args(arguments)
    course = Course(ROOT)
    if not (options.verdicts or options.check):
        for maker in MAKERS:
            subprocess.run([sys.executable, "-m", *maker], cwd=ROOT, check=True)
        subprocess.run([sys.executable, "-m", "labkit", "release"], cwd=ROOT, check=True)
    names = tuple(options.names) or course.names()
    old = json.loads(VERDICTS.read_text()) if VERDICTS.exists() else {}
    asked = {key: row for key, row in old.items() if key.partition("/")[0] in names}
    new = verdicts(course, names)
    found = [*changes(asked, new)]
    print(f"Known answers marked: {len(new)}; verdicts changed: {len(found)}.", *found, sep="\n")
    if options.check:
        return bool(found)
    kept = {key: row for key, row in old.items() if options.names and key not in asked}
    rows = sorted({**kept, **new}.items())
    lines = ",\n".join(f"{json.dumps(key)}: {json.dumps(row)}" for key, row in rows)
    VERDICTS.write_text(f"{{\n{lines}\n}}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
