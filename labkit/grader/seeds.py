"""The seeds of the hidden cases of a term and of an assignment."""

from __future__ import annotations

import json

from ..course.authoring.layout import Course
from ..course.seed import PUBLIC_SEED
from ..errors import LabkitError


def seed_of(course: Course) -> int:
    """The course's own seed, or the public one if no term was begun.

    Raises:
        LabkitError: The term's record cannot be read.
    """
    file = course.term
    if not file.exists():
        return PUBLIC_SEED
    try:
        return int(json.loads(file.read_text(encoding="utf-8"))["seed"])
    except (ValueError, KeyError, TypeError):
        raise LabkitError(
            f"{file} is damaged and holds no seed; restore it, or write the term's as "
            '{"seed": 123}'
        ) from None


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
        try:
            seed = int(json.loads(bundle.read_text(encoding="utf-8"))["seed"])
        except (TypeError, ValueError, KeyError) as error:
            raise LabkitError(
                f"{bundle} is damaged, and the seed of its hidden cases is lost ({error}); restore "
                f"it, or name a seed: labkit release {assignment} --seed {seed}"
            ) from None
    return seed


def public_warning(seed: int) -> str:
    """A warning about cases made with the public seed; "" for any other seed."""
    if seed != PUBLIC_SEED:
        return ""
    return (
        f"hidden cases made with the public seed {PUBLIC_SEED} are public: anyone can compute "
        "them; begin a term with: labkit term new"
    )
