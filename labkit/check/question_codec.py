"""Questions as JSON and back: how they travel to a notebook and to a grader.

The hidden cases of a question have a form of their own, one line of text.
"""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

from .cases import Call, Case, Choice, Loop, Tuned
from .codec import decode, encode
from .judge import JUDGES
from .question import Mistake, Question, Raised, Test

_CASES: dict[str, Any] = {kind.__name__: kind for kind in (Call, Loop, Choice, Tuned)}


def question_data(question: Question) -> dict[str, Any]:
    """A question as JSON data, all its cases included."""
    judge = {"kind": type(question.judge).__name__, **asdict(question.judge)}
    return {
        "name": question.name,
        "points": question.points,
        "asks": question.asks,
        "judge": judge,
        "withheld": list(question.withheld),
        "hints": list(question.hints),
        "tests": [
            {
                "name": test.name,
                "weight": test.weight,
                "also": test.also,
                "cases": [case_data(case) for case in test.cases],
            }
            for test in question.tests
        ],
        "mistakes": [
            {"name": m.name, "says": m.says, "answers": [_answer_data(a) for a in m.answers]}
            for m in question.mistakes
        ],
    }


def read_question(data: Mapping[str, Any]) -> Question:
    """The question that `question_data` wrote."""
    judge = dict(data["judge"])
    kind = JUDGES[judge.pop("kind")]
    judge = {key: tuple(x) if isinstance(x, list) else x for key, x in judge.items()}
    return Question(
        name=data["name"],
        points=data["points"],
        asks=data["asks"],
        judge=kind(**judge),
        tests=tuple(
            Test(t["name"], tuple(map(_case, t["cases"])), t["weight"], t["also"])
            for t in data["tests"]
        ),
        withheld=tuple(data["withheld"]),
        hints=tuple(data["hints"]),
        mistakes=tuple(
            Mistake(m["name"], m["says"], tuple(map(_answer, m["answers"])))
            for m in data["mistakes"]
        ),
    )


def pack_hidden(question: Question) -> str:
    """The hidden cases of a question as one line of text."""
    data = {
        test.name: [case_data(case) for case in test.cases if case.hidden]
        for test in question.tests
    }
    text = json.dumps({name: cases for name, cases in data.items() if cases})
    return base64.b85encode(zlib.compress(text.encode(), 9)).decode()


def with_hidden(question: Question, packed: str) -> Question:
    """The same question with the hidden cases that `pack_hidden` wrote, in place of its own."""
    more = json.loads(zlib.decompress(base64.b85decode(packed)))
    return replace(
        question,
        tests=tuple(
            replace(test, cases=(*test.cases, *map(_case, more.get(test.name, ()))))
            for test in question.public().tests
        ),
    )


def case_data(case: Case) -> dict[str, Any]:
    """A case as JSON data."""
    fields = {
        key: case_data(value) if isinstance(value, Loop) else encode(value)
        for key, value in vars(case).items()
    }
    return {"case": type(case).__name__, **fields}


def _case(data: Mapping[str, Any]) -> Case:
    fields = {
        key: _case(value) if isinstance(value, dict) and "case" in value else decode(value)
        for key, value in data.items()
        if key != "case"
    }
    case: Case = _CASES[data["case"]](**fields)
    return case


def _answer_data(answer: Any) -> Any:
    return {"raises": answer.kind} if isinstance(answer, Raised) else {"is": encode(answer)}


def _answer(data: Mapping[str, Any]) -> Any:
    return Raised(data["raises"]) if "raises" in data else decode(data["is"])
