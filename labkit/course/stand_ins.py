"""Stand-ins, which take the place of answers that are not right, and what is drawn with them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from typing import Any

from .source import look


class StandIns(set[str]):
    """The answers that a stand-in replaces for now."""

    def give(self, name: str, given: Callable[..., Any], shell: Any) -> Callable[..., Any]:
        """The stand-in; from now on captions name it in each cell that draws with it.

        Args:
            name: Of the answer.
            given: What takes its place.
            shell: Of the notebook; None where there is none.
        """
        self.add(name)
        if shell is not None:
            from .. import plotting  # slow to load

            ran = shell.history_manager.input_hist_raw
            plotting.stand_ins = lambda: drawn_with(ran, self)
        return given


def drawn_with(cells: Iterable[str], replaced: Collection[str]) -> list[str]:
    """The answers whose stand-ins the last cell uses, itself or through what others defined.

    A function that this cell defines, or gets from ``use``, counts only if the rest of it uses it.

    Args:
        cells: Their text, in the order in which they ran.
        replaced: The answers that a stand-in replaces.
    """
    means: dict[str, list[Any]] = {}
    waiting: list[Any] = []
    for cell in map(look, cells):
        for part in cell["definitions"]:
            means |= {name: [part] for name in part["binds"]}
            for name in part["fills"]:
                means[name] = [*means.get(name, ()), part]
        kept = {*cell["functions"]}
        waiting = [x for x in cell["definitions"] if not kept & {*x["binds"]} and not _asks(x)]
    found, seen = set[str](), set[str]()
    while waiting:
        part = waiting.pop()
        answers = {*part["outside"]}.intersection(replaced) if _asks(part) else set[str]()
        found |= answers
        names = set() if answers else {chain.partition(".")[0] for chain in part["uses"]} - seen
        seen |= names
        waiting += [other for name in names for other in means.get(name, ())]
    return sorted(found)


def _asks(part: Any) -> bool:
    """Whether a statement keeps what ``use`` gives."""
    return "use" in part["uses"] and bool(part["binds"])
