"""Bring a student's work into a corrected release of the same assignment."""

from __future__ import annotations

import ast
import copy
import re
from collections.abc import Callable
from typing import Any

from ..errors import LabkitError
from .handin import defines

Cells = list[dict[str, Any]]


def merge(mine: Cells, new: Cells) -> Cells:
    """The new release's cells with the student's answers, and the cells that he added.

    Args:
        mine: The student's cells.
        new: The cells of the new release.

    Returns:
        The new release, in its order.  An answer is found by the function that it defines, else by
        the question that its cell was made for; a cell of the student's own follows the cell that
        it followed.

    Raises:
        LabkitError: None of the student's cells answers any of the release's questions.
    """
    merged = copy.deepcopy(new)
    home = _homes(new)
    asked = [cell for cell in merged if cell["metadata"].get("nbgrader", {}).get("solution")]
    answers = [_answer(mine, _purpose(cell)) for cell in asked]
    if asked and not any(_cells_for(mine, _purpose(cell)) for cell in asked):
        raise LabkitError(
            f"your notebook answers nothing that the new one asks ({_purpose(asked[0])}, ...); "
            "are they two releases of the same assignment?"
        )
    for cell, answer in zip(asked, answers, strict=True):
        if answer is not None:
            cell["source"] = answer
    anchor = -1
    after: dict[int, Cells] = {}
    for cell in mine:
        place = home(cell)
        if place is not None:
            anchor = place
        elif _is_own(cell, new):
            after.setdefault(anchor, []).append(copy.deepcopy(cell))
    result = after.get(-1, [])
    for k, cell in enumerate(merged):
        result += [cell, *after.get(k, [])]
    return result


def _homes(new: Cells) -> Callable[[dict[str, Any]], int | None]:
    """A function that tells where in the new release a released cell belongs.

    Ids count the cells of a release, so where a question was added they mean other cells from there
    on; what a cell is for and what it says are better signs.
    """
    purposes = {_purpose(cell): k for k, cell in enumerate(new) if _purpose(cell)}
    sources = {cell["source"]: k for k, cell in enumerate(new)}
    ids = {cell["id"]: k for k, cell in enumerate(new)}

    def home(cell: dict[str, Any]) -> int | None:
        for found in (purposes.get(_purpose(cell)), sources.get(cell["source"])):
            if found is not None:
                return found
        return ids.get(cell.get("id"))

    return home


def _purpose(cell: dict[str, Any]) -> str:
    return str(cell["metadata"].get("nbgrader", {}).get("grade_id", ""))


def _is_own(cell: dict[str, Any], new: Cells) -> bool:
    """Whether the student added a cell; one of an older release has an id of the release's form."""
    stem = new[0]["id"].rpartition("-")[0]
    released = re.fullmatch(rf"{re.escape(stem)}-\d+", str(cell.get("id", "")))
    return not _purpose(cell) and not released and bool(cell["source"].strip())


def _answer(mine: Cells, name: str) -> str | None:
    """The last cell in which something was written, which is the one that counts in marking."""
    sources = [str(cell["source"]) for cell in _cells_for(mine, name)]
    return next((source for source in reversed(sources) if not _is_stub(source)), None)


def _cells_for(mine: Cells, name: str) -> Cells:
    """The cells that define an answer, else those that were made for it."""
    defining = [cell for cell in mine if defines(cell, name)]
    return defining or [cell for cell in mine if _purpose(cell) == name]


def _is_stub(source: str) -> bool:
    """Whether a cell holds nothing but functions that say that they are still to be written."""
    try:
        written = [
            x for x in ast.parse(source).body if not isinstance(x, ast.Import | ast.ImportFrom)
        ]
    except SyntaxError:
        return False
    return all(isinstance(x, ast.FunctionDef) and _is_to_be_written(x) for x in written)


def _is_to_be_written(function: ast.FunctionDef) -> bool:
    body = function.body[1:] if ast.get_docstring(function) else function.body
    return len(body) == 1 and ast.unparse(body[0]).startswith("raise NotImplementedError")
