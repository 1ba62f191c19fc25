"""Before handing in: is the notebook whole, is it run, and what do its checks say?

It reads the file and runs nothing.  `merge` brings a student's work into a corrected release.
"""

from __future__ import annotations

import ast
import copy
import platform
import re
from collections import Counter
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ..errors import LabkitError
from ..sim import chosen
from .forms import COMMITTED
from .gaps import first_error, undefined
from .messages import head
from .notebook import (
    PLACEHOLDER,
    WORDS,
    about,
    check_id,
    checks,
    defines,
    grade_id,
    kind,
    last_verdict,
    read_cells,
)
from .serialize import decode
from .source import is_stub, plain
from .source import look as look_at
from .student import read_checks
from .verdict import Outcome, Verdict
from .withheld import withheld_tools

LARGEST = 10.0
"""Above this many megabytes a notebook may not pass a learning platform's upload."""


@dataclass(frozen=True)
class HandIn:
    """What a look at a notebook found.

    Attributes:
        assignment: Which.
        problems: What to correct before handing in, sentences.
        notes: What is worth knowing.
        verdicts: The last verdict in the file for each question, None where it was not run.
        predictions: Those of the questions that ask for a prediction.
        texts: The number of words in each text that a person marks.
    """

    assignment: str
    problems: tuple[str, ...]
    notes: tuple[str, ...]
    verdicts: Mapping[str, Verdict | None]
    predictions: Collection[str] = ()
    texts: Mapping[str, int] = field(default_factory=dict)

    @property
    def lines(self) -> list[str]:
        """Each question's verdict in words."""
        return [head(v) if v else f"{name}: not run" for name, v in self.verdicts.items()]

    def __str__(self) -> str:
        lines = [f"[fix] {text}" for text in self.problems]
        lines += [f"[note] {text}" for text in self.notes]
        lines += [f"  {line}" for line in self.lines]
        lines += [
            f"  {name}: {words} words; a person reads it" for name, words in self.texts.items()
        ]
        right = {name for name, v in self.verdicts.items() if v is not None and v.right}
        tasks = self.verdicts.keys() - set(self.predictions)
        end = f"{len(right & tasks)} of {len(tasks)} tasks were right"
        if self.predictions:
            committed = len(right & set(self.predictions))
            end += f", and {committed} of {len(self.predictions)} predictions committed"
        end = (
            "correct what is marked with [fix] first."
            if self.problems
            else f"whole; when it was last run, {end}."
        )
        return "\n".join([*lines, f"{self.assignment}: {end}"])

    def for_the_forum(self) -> str:
        """A block to copy into a question to others: verdicts and versions, and no answer."""
        tools = ", ".join(
            f"{name} {version(name)}" for name in ("labkit", "numpy", chosen(), "pin")
        )
        lines = [f"{self.assignment}; {tools}; Python {platform.python_version()}"]
        return "\n".join(["```", *lines, *self.lines, "```"])


def look(path: Path) -> HandIn:
    """Look through a notebook that is about to be handed in.

    Args:
        path: The notebook; the assignment's ``checks.json`` must lie beside it.

    Raises:
        LabkitError: The file is missing or not a notebook, or its questions are not there.
    """
    cells = read_cells(path)
    data = read_checks(path.resolve().parent)
    name, questions = data["assignment"], data["questions"]
    problems, notes = [], []
    if path.name != f"{name}.ipynb":
        called = "".join(x if x.isprintable() else "\ufffd" for x in path.name)
        problems.append(f"the file is called {called}; rename it to {name}.ipynb")
    size = path.stat().st_size / 1e6
    if size > LARGEST:
        problems.append(
            f"it has {size:.0f} MB, more than {LARGEST:g}; clear the outputs of large cells"
        )
    for question in questions:
        more, worth_knowing = _cells_of(cells, question["name"], name)
        problems += more
        notes += worth_knowing
    problems += undefined(cells, [question["name"] for question in questions])
    problems += filter(None, [first_error(cells)])
    verdicts = {question["name"]: _verdict(cells, question) for question in questions}
    predictions = [
        question["name"]
        for question in questions
        if [test["name"] for test in question["tests"]["items"]] == [COMMITTED]
    ]
    problems += [
        f"{head(verdict)} Write it yourself."
        for verdict in verdicts.values()
        if verdict is not None and verdict.withheld
    ]
    stale = [name for name in verdicts if _changed_since(cells, name)]
    if stale:
        notes.append(
            f"changed since it was checked: {', '.join(stale)}; the verdicts below are old, run "
            "the notebook from the top and save it"
        )
    unrun = sum(verdict is None for verdict in verdicts.values())
    if unrun:
        notes.append(
            f"for {unrun} of {len(verdicts)} the saved file holds no result; if you have run their "
            "checks, save the file and look again (marking runs them in any case)"
        )
    texts = {}
    for cell in cells:
        if kind(cell) == "why" and grade_id(cell):
            words = texts[grade_id(cell)] = len(cell["source"].replace(PLACEHOLDER, "").split())
            if words < WORDS[0]:
                notes.append(
                    f"{grade_id(cell)} has {words} words; for its "
                    f"{about(cell).get('points', 0):g} points it needs at least {WORDS[0]}"
                )
    wrong = [name for name, v in verdicts.items() if v and not v.right]
    if wrong:
        notes.append(f"not yet right: {', '.join(wrong)}; what is right counts all the same")
    return HandIn(name, tuple(problems), tuple(notes), verdicts, predictions, texts)


def _cells_of(cells: list[dict[str, Any]], question: str, name: str) -> tuple[list[str], list[str]]:
    """What must be corrected in the cells of a question, and what is worth knowing of them."""
    problems, notes = [], []
    ids = Counter(map(grade_id, cells))
    if not any(defines(cell, question) for cell in cells):
        homes = [cell for cell in cells if grade_id(cell) == question]
        magic = next((x for x in (look_at(cell["source"])["magic"] for cell in homes) if x), "")
        problems.append(
            f"the cell of {question} begins with %%{magic}, which keeps what it defines to itself; "
            "take that line away"
            if magic
            else _bring_back(question, name, any(cell["cell_type"] != "code" for cell in homes))
        )
    for each in (question, check_id(question)):
        if not ids[each]:
            notes.append(f"the cell of {each} is gone or damaged; it is marked all the same")
        elif ids[each] > 1:
            problems.append(
                f"the cell of {each} is there {ids[each]} times; keep one, for the last one counts"
            )
    return problems, notes


def _bring_back(question: str, name: str, is_text: bool) -> str:
    """How to get back the cell of a question."""
    if is_text:
        return f"the cell of {question} is not code any more; click on it, press Esc and then Y"
    return (
        f"no cell defines {question}. To bring its cell back, lay a fresh copy of the notebook in "
        "a folder `fresh` beside this file, and run in a new cell: "
        f"!labkit merge {name}.ipynb fresh/{name}.ipynb --to again.ipynb (again.ipynb then holds "
        f"all your work; call it {name}.ipynb)"
    )


def _changed_since(cells: list[dict[str, Any]], question: str) -> bool:
    """Whether the cell that defines an answer was run after its check, or not at all."""
    defined = [cell.get("execution_count") for cell in cells if defines(cell, question)]
    checked = [cell.get("execution_count") for cell in cells if checks(cell, question)]
    ran = [count for count in checked if isinstance(count, int)]
    return bool(ran) and any(not isinstance(count, int) or count > max(ran) for count in defined)


def _verdict(cells: list[dict[str, Any]], question: Mapping[str, Any]) -> Verdict | None:
    """What the question's check said last, or what the answer's text says by now."""
    name = question["name"]
    found = [look_at(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    tools = withheld_tools(found, name, decode(question["withheld"]))
    if tools:
        points = float(question["points"])
        return Verdict(name, Outcome.NOT_COUNTED, 0.0, points, withheld=tools)
    return last_verdict(cells, name)


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
