"""Observed causes of wrong answers that no known mistake explains.

Each sentence states what holds in all public calls: every number has the other sign, the answer
does not depend on an argument, what an argument adds is there twice, or the same gains are chosen
for arms that differ.  This is true only of a function that answers the same call alike, so a call
is repeated first.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from time import monotonic
from typing import Any

import numpy as np

from .equivalence import accepts
from .judges import factor, numbers
from .marking import Function, PublicResult, ask
from .probes import exchanges, numeric_parts, try_call, variations
from .question import Call, Case, Choice, Question, Raised
from .relations import Parts, all_near, related, same_form
from .verdict import Kind, Misconception, Outcome, Verdict

LONGEST = 3.0
"""Time that is spent on calling a function again, in [s]."""


def diagnosed(
    question: Question, verdict: Verdict, tried: PublicResult, function: Function
) -> Verdict:
    """The verdict on a wrong answer, with the observed cause unless it is a known mistake.

    Args:
        question: The question.
        verdict: The verdict on the answer.
        tried: The result of the public cases.
        function: The student's function, which is called again with one argument changed.
    """
    if verdict.outcome not in (Outcome.WRONG, Outcome.ERROR):
        return verdict
    if _varies(question, tried.answers, function):
        return replace(verdict, mistake=Misconception("", VARIES))
    if verdict.mistake:
        return verdict
    if any(test.difference and test.difference.kind is Kind.TYPE for test in verdict.tests):
        return verdict  # the numbers of another command type reveal nothing
    says = cause(question, tried.answers, function)
    return replace(verdict, mistake=Misconception("", says)) if says else verdict


VARIES = (
    "Your function gives another answer when the same call is repeated. Let it depend on its "
    "arguments alone, not on earlier calls or on chance."
)


def _varies(question: Question, answers: Mapping[Case, Any], function: Function) -> bool:
    """Whether the function answers a public call differently when it is repeated."""
    until = monotonic() + LONGEST
    for call in question.calls:
        if isinstance(call, Call) and call in answers and monotonic() < until:
            before, now = answers[call], ask(call, function)
            if isinstance(before, Raised) or isinstance(now, Raised):
                kinds = [getattr(x, "kind", "") for x in (before, now)]
                if kinds[0] != kinds[1] and "TimeoutError" not in kinds:
                    return True
                continue
            try:
                a, b = numbers(before), numbers(now)
            except (TypeError, ValueError, OverflowError):
                continue
            if a.shape != b.shape or not np.allclose(a, b, rtol=1e-9, atol=1e-12, equal_nan=True):
                return True
    return False


def cause(question: Question, answers: Mapping[Case, Any], function: Function) -> str:
    """A sentence about what is observed of a wrong answer; "" if nothing explains it."""
    if same := _same_gains(question, answers):
        return same
    calls = [call for call in question.calls if isinstance(call, Call) and call in answers]
    if not calls or len(calls) < len(question.calls) or not question.arguments:
        return ""
    given = [numeric_parts(answers[call]) for call in calls]
    expected = [numeric_parts(call.expected) for call in calls]
    if not any(expected):
        return ""
    alike = all(map(same_form, given, expected))
    found = related(question, calls, given, expected) if alike else ""
    found = found or _exchanged(question, calls, function)
    return found or (_probed(question, calls, given, function) if alike else "")


def _same_gains(question: Question, answers: Mapping[Case, Any]) -> str:
    """That the gains which were chosen for arms that differ are the same; else ""."""
    choices = [case for case in question.calls if isinstance(case, Choice)]
    alike = all(case.trials == choices[0].trials for case in choices)
    if alike or len(choices) < len(question.calls):
        return ""
    try:
        for case in choices:
            case.measured(answers[case])  # gains that cannot be tried have a message of their own
        pairs = {tuple(map(float, answers[case])) for case in choices}
    except Exception:  # an odd answer may raise anything
        return ""
    if len(pairs) > 1:
        return ""
    Kp, Kd = pairs.pop()
    return (
        f"Your function returns the same gains, ({Kp:g}, {Kd:g}), for arms that differ. Let it "
        "find the gains of each arm with the runner that it is given."
    )


def _exchanged(question: Question, calls: Sequence[Call], function: Function) -> str:
    """Which change of its arguments, such as an exchange of two, makes the function right."""
    changed = [dict(exchanges(call, question.arguments)) for call in calls]
    for label in changed[0]:
        if all(
            label in one and accepts(question.judge, try_call(one[label], function), call.expected)
            for one, call in zip(changed, calls, strict=True)
        ):
            return f"Your function is right in every call if {label} before it is called."
    return ""


def _probed(
    question: Question, calls: Sequence[Call], given: list[Parts], function: Function
) -> str:
    """How the answer, unlike the right one, reacts to a change of one argument."""
    changed = [dict(variations(call, question.arguments)) for call in calls]
    expected = [numeric_parts(call.expected) for call in calls]
    stays, moves, shares = [], [], []
    until = monotonic() + LONGEST
    for probe in question.probes:
        if monotonic() > until:
            break
        asked = [try_call(one[probe.label], function) for one in changed]
        found, right = [numeric_parts(x) for x in asked], [numeric_parts(x) for x in probe.answers]
        if not all(map(same_form, found, right)):
            continue
        same, should = all(map(all_near, found, given)), all(map(all_near, right, expected))
        if same and not should:
            stays.append(probe.label)
        if should and not same:
            moves.append(probe.label)
        repaired = all(map(lambda x, y: accepts(question.judge, x, y), asked, probe.answers))
        if not should and repaired and (says := _share(given, expected, right)):
            shares.append(says.format(probe.label.split("`")[1], probe.label))
    if shares:
        return shares[0]
    for labels, does, other in ((stays, "stays the same", "changes"), (moves, "changes", "stays")):
        if labels:
            return f"Your answer {does} when {_when(labels)}; the right one {other}."
    return ""


def _when(labels: Sequence[str]) -> str:
    """The end of a sentence about up to three arguments and the values to which they were set."""
    values: dict[str, list[str]] = {}
    for name, value in (label.split(" is ") for label in labels):
        values.setdefault(name, []).append(value)
    each = [f"{name} is set to {' or '.join(said)}" for name, said in values.items()]
    return " or when ".join(each[:3])


_SHARES = {
    -1.0: "The term with `{}` has the wrong sign: if {}, your answer is right.",
    2.0: "The term with `{}` is there twice: if {}, your answer is right.",
}


def _share(given: list[Parts], expected: list[Parts], right: list[Parts]) -> str:
    """The factor by which an argument's contribution to the answer is wrong, in words."""
    g, e, r = (
        np.concatenate([x.ravel() for parts in z for x in parts]) for z in (given, expected, right)
    )
    times = factor(g - r, e - r) or 0.0
    return next((says for value, says in _SHARES.items() if abs(times - value) < 1e-6), "")
