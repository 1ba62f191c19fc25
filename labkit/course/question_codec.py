"""Questions as JSON and back: how they travel to a notebook and to a grader.

The hidden cases of a question have a form of their own, one line of text.
"""

from __future__ import annotations

import base64
import json
import zlib
from dataclasses import replace
from typing import Any, get_args

from .cases import Case
from .judges import Judge, TipTorque
from .question import Mistake, Question, Raised, Test
from .serialize import TRUSTED, Kinds, decode, encode

_PARTS = (Question, Test, Mistake, Raised, TipTorque, *get_args(Case), *get_args(Judge))
KINDS: Kinds = {**TRUSTED, **{kind.__name__: kind for kind in _PARTS}}
"""What a question is made of."""


def question_data(question: Question) -> dict[str, Any]:
    """A question as JSON data, all its cases included."""
    data: dict[str, Any] = encode(question, KINDS)
    return data


def read_question(data: Any) -> Question:
    """The question that `question_data` wrote."""
    question: Question = decode(data, KINDS)
    return question


def pack_hidden(question: Question) -> str:
    """The hidden cases of a question as one line of text."""
    cases = {test.name: [c for c in test.cases if c.hidden] for test in question.tests}
    text = json.dumps(encode({name: hidden for name, hidden in cases.items() if hidden}, KINDS))
    return base64.b85encode(zlib.compress(text.encode(), 9)).decode()


def with_hidden(question: Question, packed: str) -> Question:
    """The same question with the hidden cases that `pack_hidden` wrote, in place of its own."""
    more = decode(json.loads(zlib.decompress(base64.b85decode(packed))), KINDS)
    return replace(
        question,
        tests=tuple(
            replace(test, cases=(*test.cases, *more.get(test.name, ())))
            for test in question.public().tests
        ),
    )
