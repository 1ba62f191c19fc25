"""The word for a prediction."""

from labkit.course.judges import COMMITTED
from labkit.course.messages import is_prediction, outcome_word
from labkit.course.verdict import Outcome, TestResult, Verdict


def test_a_prediction_is_committed_and_not_right():
    """Its point is for being made, so no page calls it right; an answer that is right is."""
    for name, says in ((COMMITTED, "committed"), ("on a circle", "right")):
        test = TestResult(name, 1.0, Outcome.RIGHT)
        verdict = Verdict("it", Outcome.RIGHT, 1.0, 1.0, (test,))
        assert outcome_word(verdict) == says and is_prediction(verdict) == (says == "committed")
