"""Checks, which try a student's function on a question and give a verdict in words.

A notebook uses `check` and `use`; the graders apply `mark` to the same questions.
"""

from __future__ import annotations

from .handin import hand_in, progress
from .judges import (
    AtMost,
    AtTip,
    Choose,
    Close,
    Curve,
    Gains,
    Letter,
    Number,
    Response,
    TipTorque,
)
from .marking import fingerprint, mark
from .own_arm import PUBLIC_ARMS, PUBLIC_BUGS, Bug, OwnArm, commanded, my_arm, my_bug
from .predictions import Prediction, predict
from .question import Call, Chase, Choice, Loop, Mistake, Question, Raised, Test, Tuned
from .serialize import question_data, read_question
from .student import case, check, restore, use
from .verdict import Outcome, TestResult

__all__ = [
    "PUBLIC_ARMS",
    "PUBLIC_BUGS",
    "AtMost",
    "AtTip",
    "Bug",
    "Call",
    "Chase",
    "Choice",
    "Choose",
    "Close",
    "Curve",
    "Gains",
    "Letter",
    "Loop",
    "Mistake",
    "Number",
    "Outcome",
    "OwnArm",
    "Prediction",
    "Question",
    "Raised",
    "Response",
    "Test",
    "TestResult",
    "TipTorque",
    "Tuned",
    "case",
    "check",
    "commanded",
    "fingerprint",
    "hand_in",
    "mark",
    "my_arm",
    "my_bug",
    "predict",
    "progress",
    "question_data",
    "read_question",
    "restore",
    "use",
]
