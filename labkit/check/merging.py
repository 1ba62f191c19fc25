"""Bring a student's work into a corrected release of the same assignment."""

from __future__ import annotations

import copy
from typing import Any

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
    """
    merged = copy.deepcopy(new)
    known = {cell["id"] for cell in new}
    for cell in merged:
        grading = cell["metadata"].get("nbgrader", {})
        if grading.get("solution"):
            answer = _answer(mine, grading["grade_id"])
            if answer is not None and "raise NotImplementedError" not in answer:
                cell["source"] = answer
    anchor = -1
    place = {cell["id"]: k for k, cell in enumerate(merged)}
    after: dict[int, Cells] = {}
    for cell in mine:
        if cell.get("id") in known:
            anchor = place[cell["id"]]
        elif "nbgrader" not in cell.get("metadata", {}) and cell["source"].strip():
            after.setdefault(anchor, []).append(copy.deepcopy(cell))
    result = after.get(-1, [])
    for k, cell in enumerate(merged):
        result += [cell, *after.get(k, [])]
    return result


def _answer(mine: Cells, name: str) -> str | None:
    """The last cell that answers, which is the one that counts in marking."""
    defining = [cell for cell in mine if defines(cell, name)]
    made_for = [
        cell for cell in mine if cell["metadata"].get("nbgrader", {}).get("grade_id") == name
    ]
    return next((str(cell["source"]) for cell in reversed(defining or made_for)), None)
