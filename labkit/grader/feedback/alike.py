"""The same text in several hand-ins: whom to ask how they came to it; the same is not yet copied.

What was changed on the way is for JPlag to find: `labkit class-report --jplag`.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

from ...course.verdict import Outcome
from ..grading.results import Result

LONG = 3
"""Lines of an answer; among answers that are no longer, the same text is to be expected."""


def same_text(graded: Sequence[Result], who: Mapping[str, str]) -> Iterator[str]:
    """Three or more whose answers of some length are the same letter for letter, at least twice."""
    by_text: dict[tuple[str, str], set[str]] = defaultdict(set)
    for result in graded:
        for q in result.questions:
            lines = [line for line in q.source.splitlines() if line.strip()]
            if len(lines) > LONG and q.verdict.outcome is not Outcome.NOT_ATTEMPTED:
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
