"""Answers that are alike: whom to ask how they came to them; alike is not yet copied."""

from __future__ import annotations

import ast
import warnings
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations, islice

from ...course.verdict import Outcome
from ..grading.results import Result

ALIKE = 0.9
"""Answers that share this much of their structure are looked at together."""
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


def pairs_alike(graded: Sequence[Result], who: Mapping[str, str]) -> Iterator[str]:
    """Pairs whose wrong or unusual answers have one structure, and what to ask them."""
    shapes: dict[str, dict[str, frozenset[str]]] = {}
    common: Counter[tuple[str, frozenset[str]]] = Counter()
    for result in graded:
        shapes[result.student] = {
            q.verdict.name: _shape(q.source)
            for q in result.questions
            if q.verdict.outcome is not Outcome.NOT_ATTEMPTED
        }
        common.update((name, shape) for name, shape in shapes[result.student].items() if shape)
    rare = max(2, len(graded) // 20)
    pairs = []
    for a, b in combinations(sorted(shapes), 2):
        alike = [
            (name, len(x & y) / len(x | y))
            for name, x in shapes[a].items()
            if (y := shapes[b].get(name)) and len(x) > 12 and common[name, x] <= rare
        ]
        alike = [(name, share) for name, share in alike if share >= ALIKE]
        if len(alike) >= 2:
            pairs.append((sum(share for _, share in alike), a, b, [name for name, _ in alike]))
    for _, a, b, names in sorted(pairs, reverse=True)[:10]:
        ask = " and ".join(f"`{name}`" for name in names[:2])
        yield f"{who[a]} and {who[b]}: {len(names)} answers alike; ask both how they came to {ask}"


def _shape(source: str) -> frozenset[str]:
    """The structure of an answer, without names and texts: triples of neighbouring nodes."""
    try:
        with warnings.catch_warnings(action="ignore"):
            some = islice(ast.walk(ast.parse(source)), 404)
            nodes = [type(node).__name__ for node in some]
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return frozenset()
    windows = ["".join(nodes[k : k + 5]) for k in range(len(nodes) - 4)]
    return frozenset(f"{w}{windows[:k].count(w)}" for k, w in enumerate(windows[:400]))
