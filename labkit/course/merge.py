"""Merge: a student's work, brought into a corrected release of the notebook."""

from __future__ import annotations

import ast
import copy
import re
from collections.abc import Callable
from typing import Any

from ..errors import LabkitError
from .notebook import about, defines, grade_id
from .source import is_stub, plain


def merge(mine: list[dict[str, Any]], new: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The new release's cells with the student's answers, and the cells that they added.

    Args:
        mine: The student's cells.
        new: The cells of the new release.

    Returns:
        The new release, in its order.  An answer is found by the function that it defines, else by
        the question that its cell was made for; a cell of the student's own follows the cell that
        it followed.

    Raises:
        LabkitError: The new notebook is not a release, or none of the student's cells answers any
            of its questions.
    """
    if not new or not all(isinstance(cell.get("id"), str) for cell in new):
        raise LabkitError("the new notebook is not a release; fetch the assignment's folder again")
    merged = copy.deepcopy(new)
    home = _homes(new)
    asked = [cell for cell in merged if _is_asked(cell)]
    answers = [_answer(mine, grade_id(cell)) for cell in asked]
    if asked and not any(_cells_for(mine, grade_id(cell)) for cell in asked):
        raise LabkitError(
            f"your notebook answers nothing that the new one asks ({grade_id(asked[0])}, ...); "
            "are they two releases of the same assignment?"
        )
    for cell, answer in zip(asked, answers, strict=True):
        if answer is not None:
            cell["source"] = answer
    anchor = -1
    after: dict[int, list[dict[str, Any]]] = {}
    for cell in mine:
        place = home(cell)
        if place is not None:
            anchor = place
        elif _is_own(cell, new):
            number = sum(map(len, after.values()))
            after.setdefault(anchor, []).append(copy.deepcopy(cell) | {"id": f"own-{number:04d}"})
    result = after.get(-1, [])
    for k, cell in enumerate(merged):
        result += [cell, *after.get(k, [])]
    return result


def _homes(new: list[dict[str, Any]]) -> Callable[[dict[str, Any]], int | None]:
    """A function that tells where in the new release a released cell belongs.

    Ids count the cells of a release, so where a question was added they mean other cells from there
    on; what a cell is for and what it says are better signs.
    """
    purposes = {grade_id(cell): k for k, cell in enumerate(new) if grade_id(cell)}
    sources = {cell["source"]: k for k, cell in enumerate(new)}
    ids = {cell["id"]: k for k, cell in enumerate(new)}

    def home(cell: dict[str, Any]) -> int | None:
        for found in (purposes.get(grade_id(cell)), sources.get(cell["source"])):
            if found is not None:
                return found
        return ids.get(str(cell.get("id")))

    return home


def _is_asked(cell: dict[str, Any]) -> bool:
    return bool(about(cell).get("solution"))


def _is_own(cell: dict[str, Any], new: list[dict[str, Any]]) -> bool:
    """Whether the student added a cell; one of an older release has an id of the release's form."""
    stem = new[0]["id"].rpartition("-")[0]
    released = re.fullmatch(rf"{re.escape(stem)}-\d+", str(cell.get("id", "")))
    return not grade_id(cell) and not released and bool(cell["source"].strip())


def _answer(mine: list[dict[str, Any]], name: str) -> str | None:
    """The last cell in which something was written, which is the one that counts in marking."""
    sources = [str(cell["source"]) for cell in _cells_for(mine, name)]
    return next((source for source in reversed(sources) if not _is_unwritten(source)), None)


def _cells_for(mine: list[dict[str, Any]], name: str) -> list[dict[str, Any]]:
    """The cells that define an answer, else those that were made for it."""
    defining = [cell for cell in mine if defines(cell, name)]
    return defining or [cell for cell in mine if grade_id(cell) == name]


def _is_unwritten(source: str) -> bool:
    """Whether a cell holds nothing but functions that say that they are still to be written."""
    try:
        written = ast.parse(plain(source)).body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return False
    return all(is_stub(x) for x in written if not isinstance(x, ast.Import | ast.ImportFrom))
