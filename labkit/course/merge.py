"""Merging a student's work into a corrected release of the notebook."""

from __future__ import annotations

import ast
import copy
import re
from collections.abc import Callable
from typing import Any

from ..errors import LabkitError
from .brief import words_of
from .definitions import written_cells
from .notebook import cells_made_for, defines, grade_id, is_edited, kind, nbgrader_info, released
from .source import analyse, is_stub, plain

Cells = list[dict[str, Any]]

KEPT_TEXT = "Your notebook had the following text here; copy from it what you still need."
"""The line above a student's text for a cell that the new release changed or does not have."""


def merge(mine: Cells, new: Cells) -> Cells:
    """The new release's cells with the student's answers and edits, and the cells that they added.

    Args:
        mine: The student's cells.
        new: The cells of the new release.

    Returns:
        The cells in the order of the new release.  An answer is found by the function that it
        defines, else by the question for which its cell was made.  A cell that the student added
        follows the same cell as before.  Any other cell that the student changed keeps their text
        if the new release did not change it; else their text follows the new one as a comment,
        below `KEPT_TEXT`, as does an answer that another cell replaced.

    Raises:
        LabkitError: The new notebook is not a release, or has answers where the student's has none,
            or none of the student's cells answers any of its questions.
    """
    if not new or not all(isinstance(cell.get("id"), str) for cell in new):
        raise LabkitError("the new notebook is not a release; fetch the assignment's folder again")
    if _has_work(new) and not _has_work(mine):
        raise LabkitError(
            "the new notebook has answers, and yours has none; give the notebook in which you "
            "worked first, and then a fresh copy of the release"
        )
    merged = copy.deepcopy(new)
    home = _homes(mine, new)
    asked = [cell for cell in merged if _is_answer(cell)]
    answers = [_answer(mine, cell) for cell in asked]
    if asked and not any(_cells_for(mine, cell) for cell in asked):
        raise LabkitError(
            f"your notebook answers no question of the new one ({grade_id(asked[0])}, ...); "
            "are they two releases of the same assignment?"
        )
    for cell, answer in zip(asked, answers, strict=True):
        if answer is not None:
            cell["source"] = answer
    anchor = -1
    after: dict[int, Cells] = {}
    given = {"", *(cell["source"].strip() for cell in new)}
    for cell in mine:
        place = home(cell)
        anchor = anchor if place is None else place
        own = _is_own(cell, new)
        replaced = kind(cell) == "answer" and cell["source"] not in answers
        lost = replaced and not _is_unwritten(cell["source"])
        if cell["source"].strip() in given or not (own or lost or is_edited(cell)):
            continue
        if place is not None and _may_replace(merged[place], cell):
            merged[place]["source"] = cell["source"]
            continue
        number = sum(map(len, after.values()))
        kept = copy.deepcopy(cell) if own else _as_comment(cell)
        after.setdefault(anchor, []).append(kept | {"id": f"own-{number:04d}"})
    result = after.get(-1, [])
    for k, cell in enumerate(merged):
        result += [cell, *after.get(k, [])]
    return result


def _homes(mine: Cells, new: Cells) -> Callable[[dict[str, Any]], int | None]:
    """A function that returns the index in the new release to which a released cell belongs.

    Ids count the cells of a release, so they shift behind a question that was added.  The purpose
    of a cell, its released text and its present text are more reliable, and are tried first.
    """
    purposes = {grade_id(cell): k for k, cell in enumerate(new) if grade_id(cell)}
    texts = {released(cell): k for k, cell in enumerate(new) if released(cell)}
    sources = {cell["source"]: k for k, cell in enumerate(new)}
    known = {released(cell) for cell in mine} - {""}
    ids = {cell["id"]: k for k, cell in enumerate(new) if released(cell) not in known}

    def home(cell: dict[str, Any]) -> int | None:
        text = None if _is_own(cell, new) else texts.get(released(cell))
        for found in (purposes.get(grade_id(cell)), text, sources.get(cell["source"])):
            if found is not None:
                return found
        return ids.get(str(cell.get("id")))

    return home


def _is_answer(cell: dict[str, Any]) -> bool:
    return bool(nbgrader_info(cell).get("solution"))


def _has_work(cells: Cells) -> bool:
    """Whether a cell that was made for an answer holds a function that is not a stub."""
    found = (analyse(cell["source"]) for cell in cells if _is_answer(cell))
    return any(x["functions"] != x["stubs"] for x in found)


def _is_own(cell: dict[str, Any], new: Cells) -> bool:
    """Whether the student added a cell; a cell of any release has an id of the release's form."""
    stem = new[0]["id"].rpartition("-")[0]
    of_release = re.fullmatch(rf"{re.escape(stem)}-\d+", str(cell.get("id", "")))
    return not grade_id(cell) and not of_release and bool(cell["source"].strip())


def _may_replace(there: dict[str, Any], cell: dict[str, Any]) -> bool:
    """Whether a cell of the new release still has the text that the student was given."""
    same = released(there) == released(cell) and there["cell_type"] == cell["cell_type"]
    return bool(released(cell)) and same and not is_edited(there)


def _as_comment(cell: dict[str, Any]) -> dict[str, Any]:
    """A student's text for a released cell, as a comment or a quotation in a new cell."""
    code = cell["cell_type"] == "code"
    lines = [KEPT_TEXT, *cell["source"].splitlines()]
    text = "\n".join(f"{'#' if code else '>'} {line}".rstrip() for line in lines)
    made: dict[str, Any] = {"metadata": {}, "source": text}
    if code:
        return made | {"cell_type": "code", "outputs": [], "execution_count": None}
    return made | {"cell_type": "markdown"}


def _answer(mine: Cells, asked: dict[str, Any]) -> str | None:
    """What counts in marking: the last cell with a written answer, or all cells of a text."""
    sources = [str(cell["source"]) for cell in _cells_for(mine, asked)]
    if asked["cell_type"] == "markdown":
        return "\n\n".join(dict.fromkeys(filter(words_of, sources))) or None
    return next((source for source in reversed(sources) if not _is_unwritten(source)), None)


def _cells_for(mine: Cells, asked: dict[str, Any]) -> Cells:
    """The cells that define an answer, or if there are none, those that were made for it."""
    name = grade_id(asked)
    likely = [cell for cell in mine if kind(cell) in ("", kind(asked))]  # another may have its id
    made = cells_made_for(likely, name, asked["id"])
    code = {k: analyse(x["source"]) for k, x in enumerate(mine) if x["cell_type"] == "code"}
    home = {k for k in code if any(mine[k] is cell for cell in made)}
    written = [mine[k] for k in written_cells(code, home, name)]
    return written or [cell for cell in mine if defines(cell, name)] or made


def _is_unwritten(source: str) -> bool:
    """Whether a cell holds only stubs and imports."""
    try:
        written = ast.parse(plain(source)).body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return False
    return all(is_stub(x) for x in written if not isinstance(x, ast.Import | ast.ImportFrom))
