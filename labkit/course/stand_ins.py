"""Stand-ins, which drive the arm in place of answers that are not right, and name themselves."""

from __future__ import annotations

import dis
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import wraps
from typing import Any

import numpy as np

from ..trajectory import PoseSample, Sample
from .source import analyse

STAND_IN, WRONG = "a stand-in for", "your wrong"


class StandIns(dict[str, str]):
    """The answers that are not right; each has a `STAND_IN`, or is used although it is `WRONG`."""

    ran: Iterable[str] = ()
    given: Mapping[str, Callable[..., Any]] = {}  # what was last returned, by its name in captions

    def give(
        self, name: str, kind: str, given: Callable[..., Any], shell: Any
    ) -> Callable[..., Any]:
        """Return a function; captions name it from now on in each cell that draws with it.

        Args:
            name: Name of the answer.
            kind: `STAND_IN` or `WRONG`.
            given: The function.
            shell: Shell of the notebook, or None outside a notebook.
        """
        self[name] = kind
        self.given = {**self.given, f"{kind} {name}": given}
        if shell is not None:
            from .. import plotting  # slow to load

            self.ran = shell.history_manager.input_hist_raw
            plotting.drawn_by = lambda: [f"{self[x]} {x}" for x in drawn_with(self.ran, self)]
        return given

    def used_by(self, function: Callable[..., Any]) -> list[str]:
        """What a function calls of all that was returned, such as "a stand-in for bang_bang".

        A wrong answer that it calls by the answer's own name is left out.
        """
        called = globals_of(function).items()
        return [
            words
            for words, given in self.given.items()
            if any(x is given and not words.endswith(f" {name}") for name, x in called)
        ]

    def wrong(self) -> list[str]:
        """The student's wrong answers on which a prediction's truth in the last cell depends."""
        return [x for x in drawn_with(self.ran, self, ("predict",)) if self[x] == WRONG]


def globals_of(function: Callable[..., Any]) -> dict[str, Any]:
    """The global names that a Python function reads, with their values; else nothing."""
    steps = dis.get_instructions(function) if hasattr(function, "__code__") else ()
    read = dict.fromkeys(step.argval for step in steps if step.opname == "LOAD_GLOBAL")
    known = getattr(function, "__globals__", {})
    return {name: known[name] for name in read if name in known}


def in_form(function: Callable[..., Any], right: Any) -> Callable[..., Any]:
    """A function whose lists and tuples become what a right answer is, as the check accepts them.

    Args:
        function: The student's function.
        right: One right answer; only for samples and arrays the results are converted.
    """
    kind = type(right)
    if kind not in (Sample, PoseSample, np.ndarray):
        return function

    @wraps(function)
    def formed(*args: Any, **kwargs: Any) -> Any:
        result = function(*args, **kwargs)
        if type(result) not in (list, tuple):
            return result
        return np.asarray(result) if kind is np.ndarray else kind(*map(np.asarray, result))

    return formed


def drawn_with(
    cells: Iterable[str], replaced: Collection[str], where: Collection[str] = ()
) -> list[str]:
    """The answers that are not right and that the last cell uses, directly or through other cells.

    A function that this cell defines, or that ``use`` returns in it, counts only if the rest of the
    cell uses that function.

    Args:
        cells: The text of the cells, in the order in which they ran.
        replaced: The answers that are not right.
        where: If not empty, only statements that call one of these functions count.
    """
    means: dict[str, list[Any]] = {}
    waiting: list[Any] = []
    for cell in map(analyse, cells):
        for part in cell["definitions"]:
            means |= {name: [part] for name in part["binds"] if name not in part["fills"]}
            for name in part["fills"]:
                if not any(name in x["mean"] for x in means.get(name, ())):  # not a module
                    means[name] = [*means.get(name, ()), part]
        kept = {*cell["functions"]}
        waiting = [x for x in cell["definitions"] if not kept & {*x["binds"]}]
        waiting = [x for x in waiting if not (x["asks"] and x["binds"])]
    if where:
        waiting = [x for x in waiting if {*where} & {*x["uses"]}]
    found, seen = set[str](), set[str]()
    while waiting:
        part = waiting.pop()
        answers = {*part["asks"], *part["outside"]} & {*replaced} if part["asks"] else set[str]()
        found |= answers
        names = set() if answers else {chain.partition(".")[0] for chain in part["uses"]} - seen
        seen |= names
        waiting += [other for name in names for other in means.get(name, ())]
    return sorted(found)
