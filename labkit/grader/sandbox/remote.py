"""A student's function as one that lives here: each call is put to the session that has it."""

from __future__ import annotations

import builtins
import time
from collections.abc import Mapping
from typing import Any

from ... import errors
from ...course.question import Question
from ...course.reply import Failed, answer
from ...course.serialize import encode
from ..clean import clean_line
from .protocol import Disconnected, MessageTooLarge, Timeout
from .session import Session

_KNOWN = (
    {name for name, thing in vars(errors).items() if isinstance(thing, type)}
    | {"ArgumentChanged", "LinAlgError"}
    | {
        name
        for name, thing in vars(builtins).items()
        if isinstance(thing, type) and issubclass(thing, BaseException)
    }
)
MOST_LOST = 3
"""After so many calls of one question that died or hung, it is not asked any more."""


class RemoteFunction:
    """Called as the student's function would be; raises `Failed` where no answer came.

    Attributes:
        left: Seconds that its answers may still take, those to hidden cases included.
        lost: How many calls died or hung.
    """

    def __init__(self, question: Question, session: Session) -> None:
        self.question, self.session = question, session
        self.left = session.limits.question
        self.lost = 0
        self._constant: Mapping[str, Any] | None = None

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """The answer to one call."""
        if self.lost >= MOST_LOST or self.session.over or self.left <= 0.0:
            raise Failed("TimeoutError", "TimeoutError: too much time was spent already")
        before = self._constant
        again = (
            before is not None
            and kwargs.keys() == before.keys()
            and all(x is before[key] for key, x in kwargs.items())
        )
        try:
            if self.session.open(self.question):
                again = False
            message = {
                "args": [encode(x) for x in args],
                "kwargs": None if again else {key: encode(x) for key, x in kwargs.items()},
            }
            self._constant = dict(kwargs)
            return self._answer(message)
        except Timeout:
            self.lost += 1
            limit = self.session.limits.call
            raise Failed(
                "TimeoutError", f"TimeoutError: it did not come back within {limit:g} s"
            ) from None
        except MessageTooLarge as much:
            self.lost += 1
            raise Failed("TypeMismatch", str(much)) from None
        except Disconnected:
            self.lost += 1
            raise Failed("SystemExit", "SystemExit: it ended its own process") from None

    def _answer(self, message: dict[str, Any]) -> Any:
        """What came of one call; reading it counts as the student's time."""
        began = time.monotonic()
        try:
            reply = self.session.ask(message, self.left)
            if "raised" not in reply:
                return answer(reply, self.question.withheld)
        finally:
            self.left -= time.monotonic() - began
        kind, says = str(reply["raised"]), clean_line(str(reply.get("says", "")))
        if kind == "TimeUp":
            self.lost += 1
            kind = "TimeoutError"
        if kind not in _KNOWN:
            kind = "Exception"  # a name of its own could carry a secret out
        return answer({"raised": kind, "says": says}, self.question.withheld)
