"""The secret of a term, and what is derived from it: one key for each purpose.

The secret has 128 random bits and stays in `course_private`.  A key tells neither the secret nor
another key, so what is handed out gives nothing else away.
"""

from __future__ import annotations

import hmac
import json

from ..course.authoring.layout import PUBLIC_SEED, Course
from ..errors import LabkitError


def key_of(course: Course, purpose: str) -> str:
    """The key for a purpose, such as "seed", as 64 digits: HMAC-SHA256 under the term's secret.

    If no term was begun, the public seed takes the place of the secret.

    Raises:
        LabkitError: The term's record cannot be read.
    """
    secret = str(PUBLIC_SEED).encode()
    if course.term.exists():
        try:
            secret = bytes.fromhex(json.loads(course.term.read_text(encoding="utf-8"))["secret"])
            if len(secret) < 16:
                raise ValueError
        except (ValueError, KeyError, TypeError):
            says = f"{course.term} is damaged and holds no secret; restore it from your copy"
            raise LabkitError(says) from None
    return hmac.new(secret, purpose.encode(), "sha256").hexdigest()


def seed_of(course: Course) -> int:
    """The seed of the hidden cases: the term's, or the public one if no term was begun.

    Raises:
        LabkitError: As for `key_of`.
    """
    return int(key_of(course, "hidden cases"), 16) if course.term.exists() else PUBLIC_SEED


def rank(key: str, *what: str) -> bytes:
    """What is drawn by lot for things of a student: HMAC-SHA256 under a key."""
    return hmac.digest(key.encode(), "/".join(what).encode(), "sha256")
