"""What drives in the place of answers that are not right, and what is drawn with it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from typing import Any

from .source import analyse

STAND_IN, WRONG = "a stand-in for", "your wrong"


class StandIns(dict[str, str]):
    """The answers that are not right, and what drives for each now: `STAND_IN` or `WRONG`."""

    ran: Iterable[str] = ()

    def give(
        self, name: str, kind: str, given: Callable[..., Any], shell: Any
    ) -> Callable[..., Any]:
        """What drives; from now on captions name it in each cell that draws with it.

        Args:
            name: Of the answer.
            kind: `STAND_IN` or `WRONG`.
            given: What drives.
            shell: Of the notebook; None where there is none.
        """
        self[name] = kind
        if shell is not None:
            from .. import plotting  # slow to load

            self.ran = shell.history_manager.input_hist_raw
            plotting.drawn_by = lambda: [f"{self[x]} {x}" for x in drawn_with(self.ran, self)]
        return given

    def wrong(self) -> list[str]:
        """The student's wrong answers that made the truth of a prediction in the last cell."""
        return [x for x in drawn_with(self.ran, self, ("predict",)) if self[x] == WRONG]


def drawn_with(
    cells: Iterable[str], replaced: Collection[str], where: Collection[str] = ()
) -> list[str]:
    """The answers that are not right and that the last cell uses, itself or through others.

    A function that this cell defines, or gets from ``use``, counts only if the rest of it uses it.

    Args:
        cells: Their text, in the order in which they ran.
        replaced: The answers that are not right.
        where: Only what a call of one of these functions uses; anywhere in the cell if empty.
    """
    means: dict[str, list[Any]] = {}
    waiting: list[Any] = []
    for cell in map(analyse, cells):
        for part in cell["definitions"]:
            means |= {name: [part] for name in part["binds"] if name not in part["fills"]}
            for name in part["fills"]:
                if not any(name in x["mean"] for x in means.get(name, ())):  # no module
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
