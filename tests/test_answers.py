"""The wrong answers of `tests/answers` are whole: each can be asked, and no two are alike."""

import ast
from collections import Counter

import pytest
from answers import TOPICS, read


@pytest.mark.parametrize("topic", TOPICS)
def test_each_answer_defines_its_question_and_none_is_there_twice(topic):
    """Each question has the same ten."""
    answers = read(topic)
    for answer in answers:
        defined = [x.name for x in ast.parse(answer.source).body if isinstance(x, ast.FunctionDef)]
        assert answer.question in defined, answer.says
    assert len({answer.source for answer in answers}) == len(answers)
    assert set(Counter(answer.question for answer in answers).values()) == {10}
