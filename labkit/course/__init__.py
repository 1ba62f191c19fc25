"""Checks: a question, a function, a verdict in words.

A notebook uses `check`, `hint` and `use`; graders use `mark` on the same questions.
"""

from __future__ import annotations

from .equivalence import AtTip, Response, TipTorque
from .judges import AtMost, Close, Gains, Within
from .marking import fingerprint, mark
from .predictions import Choose, Curve, Number, Prediction, Rank
from .question import Call, Choice, Loop, Mistake, Question, Raised, Test, Tuned
from .reply import Failed
from .reveal import predict
from .serialize import question_data, read_question
from .student import check, hint, use
from .verdict import Outcome, TestResult, Verdict

__all__ = [
    "AtMost",
    "AtTip",
    "Call",
    "Choice",
    "Choose",
    "Close",
    "Curve",
    "Failed",
    "Gains",
    "Loop",
    "Mistake",
    "Number",
    "Outcome",
    "Prediction",
    "Question",
    "Raised",
    "Rank",
    "Response",
    "Test",
    "TestResult",
    "TipTorque",
    "Tuned",
    "Verdict",
    "Within",
    "check",
    "fingerprint",
    "hint",
    "mark",
    "predict",
    "question_data",
    "read_question",
    "use",
]
