"""The seeds of the hidden cases of a term and of an assignment."""

from __future__ import annotations

import json
from pathlib import Path

from ..course.authoring.layout import Course
from ..course.seed import PUBLIC_SEED
from ..errors import LabkitError


def seed_of(course: Course) -> int:
    """The course's own seed, or the public one if no term was begun.

    Raises:
        LabkitError: The term's record cannot be read.
    """
    if not course.term.exists():
        return PUBLIC_SEED
    return _seed_in(course.term, 'write into it the term\'s, as {"seed": 123}')


def seed_for(course: Course, assignment: str) -> int:
    """The seed of an assignment that is released without one.

    It is the seed of the term.  If no term was begun, it is that of the last release, so that a
    correction keeps the hidden cases; for a first release it is the public seed.

    Raises:
        LabkitError: The bundle of the last release is damaged, and its seed lost.
    """
    seed = seed_of(course)
    bundle = course.bundle / f"{assignment}.json"
    if seed == PUBLIC_SEED and bundle.exists():
        return _seed_in(bundle, f"name a seed: labkit release {assignment} --seed {seed}")
    return seed


def _seed_in(file: Path, instead: str) -> int:
    """The seed in a file; if it is damaged, the error says what can be done ``instead``."""
    try:
        return int(json.loads(file.read_text(encoding="utf-8"))["seed"])
    except (ValueError, KeyError, TypeError):
        says = f"{file} is damaged and holds no seed; restore it, or {instead}"
        raise LabkitError(says) from None


def public_warning(seed: int) -> str:
    """A warning about cases made with the public seed; "" for any other seed."""
    if seed != PUBLIC_SEED:
        return ""
    return (
        f"hidden cases made with the public seed {PUBLIC_SEED} are public: anyone can compute "
        "them; begin a term with: labkit term new"
    )
