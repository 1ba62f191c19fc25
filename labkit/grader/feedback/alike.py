"""Find groups of students with identical answers, whom an instructor can ask how they found them.

Identical answers do not prove copying.  JPlag finds answers that were edited: type
``labkit class-report --jplag``.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

from ...course.verdict import Outcome
from ..grading.results import Result

SHORT = 3
"""Answers of no more lines than this are often identical by chance, and are not compared."""


def same_text(graded: Sequence[Result], who: Mapping[str, str]) -> Iterator[str]:
    """A sentence for each of the ten largest groups of three or more who share two long answers."""
    by_text: dict[tuple[str, str], set[str]] = defaultdict(set)
    for result in graded:
        for q in result.questions:
            lines = [line for line in q.source.splitlines() if line.strip()]
            if len(lines) > SHORT and q.verdict.outcome is not Outcome.NOT_ATTEMPTED:
                by_text[q.verdict.name, q.source.strip()].add(who[result.student])
    shared = [(name, those) for (name, _), those in by_text.items() if len(those) > 2]
    common = {frozenset(x & y) for (_, x), (_, y) in combinations(shared, 2)}
    groups: list[frozenset[str]] = []
    for those in sorted(common, key=lambda group: (-len(group), sorted(group))):
        if len(those) > 2 and not any(those <= group for group in groups):
            groups.append(those)
    for those in groups[:10]:
        names = [name for name, others in shared if those <= others]
        ask = " and ".join(f"`{name}`" for name in names[:2])
        yield (
            f"{', '.join(sorted(those))} handed in the same text in {len(names)} answers; this "
            f"proves nothing, so ask each of them how they came to {ask}"
        )
