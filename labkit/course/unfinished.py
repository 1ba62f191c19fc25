"""Answers that are not finished: their cell stopped with an error, or they raise as a stub does."""

from __future__ import annotations

import re
from typing import Any

from .source import analyse

_DEFINES = re.compile(r"^(?:def|class)\s+(\w+)|^(\w+)\s*=", re.MULTILINE)


def defined_in(source: str) -> set[str]:
    """The names that a cell should define, even if Python cannot read the cell."""
    found = analyse(source)
    if not found["broken"]:
        return set(found["binds"])
    return {function or value for function, value in _DEFINES.findall(source)}


def still_raises(cells: list[str], name: str) -> str:
    """What to do where a function has more in it than a stub but raises as a stub does, or ""."""
    own = "".join([cell for cell in cells if name in analyse(cell)["functions"]][-1:])
    if name in analyse(own)["stubs"] or "NotImplementedError" not in own:  # a library raises it too
        return ""
    return (
        "Your function reaches its line `raise NotImplementedError`; delete this line once your "
        "own lines return the answer, and run the cell again."
    )


def watch(shell: Any) -> set[str]:
    """Follow the cells that run in an IPython shell.

    Returns:
        A set that is kept up to date.  It has the names that the last cell for them did not define,
        because of an error in the cell.
    """
    unfinished: set[str] = set()
    before: dict[str, Any] = {}

    def begins(_: Any) -> None:
        before.clear()
        before.update(shell.user_ns)

    def ends(result: Any) -> None:
        names = defined_in(result.info.raw_cell or "")
        unfinished.difference_update(names)
        if not result.success:
            _say_quotes(result.info.raw_cell or "", result.error_in_exec)
            unfinished.update(x for x in names if shell.user_ns.get(x) is before.get(x))

    shell.events.register("pre_run_cell", begins)
    shell.events.register("post_run_cell", ends)
    return unfinished


def _say_quotes(source: str, error: BaseException | None) -> None:
    """Explain, after an error from ``predict("name", c)``, that the letter needs quotes."""
    name = error.name if isinstance(error, NameError) else None
    if name and re.search(rf"""\bpredict\(\s*["']\w+["'],\s*{name}\s*\)""", source):
        print(f"Put the letters of a prediction in quotes: {name!r}")
