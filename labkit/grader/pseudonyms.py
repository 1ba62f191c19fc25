"""Stable names for students that reveal nothing, even to readers with the class list."""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Callable
from functools import partial

from ..course.authoring.layout import Course
from .atomic import write

FILE = "course_private/pseudonyms.key"
"""The key that links pseudonyms to students; it is archived with the term."""


def pseudonyms(course: Course) -> Callable[[str], str]:
    """A function that gives each student a name, which nobody can compute without the key."""
    file = course.root / FILE
    if not file.exists():
        write(file, secrets.token_hex(16) + "\n")
    return partial(pseudonym, file.read_bytes())


def pseudonym(key: bytes, student: str) -> str:
    """The pseudonym of a student under a term's key."""
    return f"S-{hmac.new(key, student.encode(), 'sha256').hexdigest()[:8]}"
