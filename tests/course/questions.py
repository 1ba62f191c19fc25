"""A small question for the tests, made by hand."""

from labkit.course import Call, Close, Mistake, Outcome, Question, Test, TestResult
from labkit.course.messages import why


def says(difference):
    """The sentence about a difference."""
    return why(TestResult("a test", 1.0, Outcome.WRONG, difference=difference))


def double(x):
    return 2.0 * x


def square(x):
    return x * x


CALLS = tuple(Call((x,), expected=2.0 * x) for x in (2.0, 3.0, -1.0))
HIDDEN = Call((7.5,), expected=15.0, hidden=True)
DOUBLE = Question(
    name="double",
    points=4.0,
    asks="Give twice the number.",
    judge=Close(),
    tests=(
        Test("two", CALLS[:1], weight=0.0),
        Test("three", CALLS[1:2], weight=3.0),
        Test("negative", CALLS[2:], weight=1.0, also="any number"),
    ),
    withheld=("numpy.multiply",),
    hints=("Think of a pair.", "x + x", "return 2 * x"),
    mistakes=(Mistake("squared", "That is the square.", "Add x to x.", (4.0, 9.0, 1.0)),),
)
