"""Do a step for each student separately: a failure is reported, and the others are done."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

from ..errors import LabkitError
from .clean import clean_line

T = TypeVar("T")


@dataclass(frozen=True)
class Failure:
    """What takes the place of a result if a step failed for one student.

    Attributes:
        student: The student for whom the step failed.
        why: The reason, in a sentence.
    """

    student: str
    why: str

    def __str__(self) -> str:
        return f"{self.student}: {self.why}"


def for_student(
    student: str,
    step: Callable[..., T],
    *arguments: Any,
    of_all: tuple[type[Exception], ...] = (),
) -> T | Failure:
    """Do a step for one student; every loop over students calls it.

    Args:
        student: The student for whom the step is done.
        step: The step.
        arguments: The arguments of the step.
        of_all: Exceptions that concern all students, and are therefore raised.

    Returns:
        What the step returned, or why it failed.
    """
    try:
        return step(*arguments)
    except of_all:
        raise
    except Exception as error:
        says = str(error) if isinstance(error, LabkitError) else f"{type(error).__name__}: {error}"
        if isinstance(error, OSError):
            says = f"{error.filename or type(error).__name__}: {error.strerror or error}"
        return Failure(student, clean_line(says))


class Failures(list[str]):
    """Sentences on what failed in a command, which are printed on stderr when the command ends."""

    @property
    def code(self) -> int:
        """The exit code: 1 if something failed."""
        return int(bool(self))

    def sift(self, outcomes: Iterable[T | Failure], what: str) -> Iterator[T]:
        """Yield the results, and collect the failures.

        Args:
            outcomes: The outcomes of a step, one for each student.
            what: What a failure means, such as "not graded".
        """
        for one in outcomes:
            if isinstance(one, Failure):
                self.append(f"{what}: {one}")
            else:
                yield one

    def __enter__(self) -> Failures:
        return self

    def __exit__(self, *_: object) -> None:
        for sentence in self:
            print(clean_line(sentence), file=sys.stderr, flush=True)
