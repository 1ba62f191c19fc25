"""The plausible answers of `tests/answers` are whole: each can be asked, and no two are alike."""

import ast
from collections import Counter

import pytest
from answers import TOPICS, read


@pytest.mark.parametrize("topic", TOPICS)
def test_each_answer_defines_its_question_and_no_author_writes_one_twice(topic):
    """Each answer defines its question's function; only two different authors share a source."""
    answers = read(topic)
    for answer in answers:
        defined = [x.name for x in ast.parse(answer.source).body if isinstance(x, ast.FunctionDef)]
        assert answer.question in defined, answer.says
    # two authors may well write the same
    assert len({(answer.author, answer.source) for answer in answers}) == len(answers)


def test_each_question_has_eleven_wrong_answers_and_six_right_ones():
    """Each of the 42 questions has at least eleven wrong answers and at least six right ones."""
    counts = Counter((a.topic, a.question, a.right) for topic in TOPICS for a in read(topic))
    assert len(counts) == 2 * 42
    assert all(n >= (6 if right else 11) for (_, _, right), n in counts.items())


def test_about_half_of_the_first_wrong_answers_are_held_back_and_all_of_later_ones():
    """Between 40 % and 60 % of the first author's are held, and all 420 of each later author's."""
    wrong = [answer for topic in TOPICS for answer in read(topic) if not answer.right]
    first = [answer.held for answer in wrong if not answer.author]
    assert 0.4 < sum(first) / len(first) < 0.6
    later = [answer for answer in wrong if answer.author]
    counts = Counter(answer.author for answer in later)
    assert counts == dict.fromkeys(("second", "third", "fourth"), 420)
    assert all(answer.held for answer in later)
