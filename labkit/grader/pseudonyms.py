"""Names for students that stay the same and say nothing, even with the list of the class."""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Callable
from functools import partial

from ..course.authoring.layout import Course
from .atomic import write

FILE = "course_private/pseudonyms.key"
"""Without it nobody can tell who is who; it goes with the term."""


def pseudonyms(course: Course) -> Callable[[str], str]:
    """Gives each student a name that only the holder of the course's key can make again."""
    file = course.root / FILE
    if not file.exists():
        write(file, secrets.token_hex(16) + "\n")
    return partial(pseudonym, file.read_bytes())


def pseudonym(key: bytes, student: str) -> str:
    """What a student is called under a term's key."""
    return f"S-{hmac.new(key, student.encode(), 'sha256').hexdigest()[:6]}"
