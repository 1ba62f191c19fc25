"""Checks: a question, a function, a verdict in words.

A notebook uses `check`, `hint` and `use`; graders use `mark` on the same questions.
"""

from __future__ import annotations

from .cases import Call, Choice, Loop, Tuned
from .judges import AtMost, AtTip, Close, Gains, Response, TipTorque, Within
from .marking import Outcome, TestResult, Verdict, fingerprint, mark
from .question import Mistake, Question, Raised, Test
from .question_codec import question_data, read_question
from .reply import Failed
from .student import also, check, hint, use

__all__ = [
    "AtMost",
    "AtTip",
    "Call",
    "Choice",
    "Close",
    "Failed",
    "Gains",
    "Loop",
    "Mistake",
    "Outcome",
    "Question",
    "Raised",
    "Response",
    "Test",
    "TestResult",
    "TipTorque",
    "Tuned",
    "Verdict",
    "Within",
    "also",
    "check",
    "fingerprint",
    "hint",
    "mark",
    "question_data",
    "read_question",
    "use",
]
