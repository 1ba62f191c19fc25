"""The call at which a check stopped, as values that one can run."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from ..errors import LabkitError
from .question import Call
from .student import desk


def case(name: str) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """The arguments of the call at which the last check of a question stopped, to try it yourself.

    Args:
        name: The question's name.

    Returns:
        (args, kwargs), for ``function(*args, **kwargs)``.

    Raises:
        UnknownName: No such question.
        LabkitError: The last check stopped at no call of the function.
    """
    question = desk().question(name)
    last = desk().checked.get(name)
    stopped = {test.name: test.call for test in last[1].tests if test.call} if last else {}
    for test in question.tests:
        for one in test.cases:
            if last and isinstance(one, Call) and one.shown(name) == stopped.get(test.name):
                with suppress(LabkitError, ArithmeticError, TypeError, ValueError):
                    if question.judge(one.ask(last[0]), one.expected) is None:
                        continue  # another call that looks alike
                return one.args, dict(one.kwargs)
    raise LabkitError(f"the last check of {name} stopped at no call of it; run its check first")
