"""Before handing in: is the notebook whole, is it run, and what do its checks say?

It reads the file and runs nothing.
"""

from __future__ import annotations

import json
import platform
import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ..errors import LabkitError
from .marking import Outcome, Verdict
from .messages import head
from .output import last_verdict
from .serialize import decode
from .source import look as look_at
from .student import read_checks
from .withheld_names import withheld_tools

LARGEST = 10.0
"""Above this many megabytes a notebook may not pass a learning platform's upload."""
Cell = Mapping[str, Any]


@dataclass(frozen=True)
class HandIn:
    """What a look at a notebook found.

    Attributes:
        assignment: Which.
        problems: What to mend before handing in, sentences.
        notes: What is worth knowing.
        verdicts: The last verdict in the file for each question, None where it was not run.
    """

    assignment: str
    problems: tuple[str, ...]
    notes: tuple[str, ...]
    verdicts: Mapping[str, Verdict | None]

    @property
    def lines(self) -> list[str]:
        """Each question's verdict in words."""
        return [head(v) if v else f"{name}: not run" for name, v in self.verdicts.items()]

    def __str__(self) -> str:
        lines = [f"[mend] {text}" for text in self.problems]
        lines += [f"[note] {text}" for text in self.notes]
        lines += [f"  {line}" for line in self.lines]
        right = sum(v is not None and v.outcome is Outcome.RIGHT for v in self.verdicts.values())
        end = (
            "mend the above first."
            if self.problems
            else f"whole; when it was last run, {right} of {len(self.verdicts)} tasks were right."
        )
        return "\n".join([*lines, f"{self.assignment}: {end}"])

    def for_the_forum(self) -> str:
        """A block to copy into a question to others: verdicts and versions, and no answer."""
        tools = ", ".join(
            f"{name} {version(name)}" for name in ("labkit", "numpy", "pybullet", "pin")
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
        problems.append(f"the file is called {path.name}; rename it to {name}.ipynb")
    size = path.stat().st_size / 1e6
    if size > LARGEST:
        problems.append(
            f"it has {size:.0f} MB, more than {LARGEST:g}; clear the outputs of large cells"
        )
    for question in questions:
        more, worth_knowing = _cells_of(cells, question["name"])
        problems += more
        notes += worth_knowing
    verdicts = {question["name"]: _verdict(cells, question) for question in questions}
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
    unrun = [name for name, verdict in verdicts.items() if verdict is None]
    if unrun:
        notes.append(f"not run since it was opened: {', '.join(unrun)}; marking runs them again")
    wrong = [name for name, v in verdicts.items() if v and v.outcome is not Outcome.RIGHT]
    if wrong:
        notes.append(f"not yet right: {', '.join(wrong)}; what is right counts all the same")
    return HandIn(name, tuple(problems), tuple(notes), verdicts)


def _cells_of(cells: list[dict[str, Any]], question: str) -> tuple[list[str], list[str]]:
    """What is to be mended in the cells of a question, and what is worth knowing of them."""
    problems, notes = [], []
    ids = Counter(map(grade_id, cells))
    if not any(defines(cell, question) for cell in cells):
        homes = [cell for cell in cells if grade_id(cell) == question]
        magic = next((x for x in (look_at(cell["source"])["magic"] for cell in homes) if x), "")
        problems.append(
            f"the cell of {question} begins with %%{magic}, which keeps what it defines to itself; "
            "take that line away"
            if magic
            else f"no cell defines {question}; bring it back with: labkit merge"
        )
    for each in (question, f"{question}-check"):
        if not ids[each]:
            notes.append(f"the cell of {each} is gone or damaged; it is marked all the same")
        elif ids[each] > 1:
            problems.append(
                f"the cell of {each} is there {ids[each]} times; keep one, for the last one counts"
            )
    return problems, notes


def read_cells(path: Path) -> list[dict[str, Any]]:
    """The cells of a notebook file.

    Raises:
        LabkitError: It is not there, or is not a notebook.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        return [
            {
                **cell,
                "cell_type": cell["cell_type"],
                "metadata": dict(cell.get("metadata") or {}),
                "source": "".join(cell["source"]),
            }
            for cell in data["cells"]
        ]
    except FileNotFoundError:
        raise LabkitError(f"there is no file {path}") from None
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise LabkitError(
            f"{path.name} is not a notebook, or was cut off while saving; open it in Jupyter, or "
            "restore an older version"
        ) from None


def grade_id(cell: Cell) -> str:
    """What a cell was made for: a question's name, that with "-check", or ""."""
    nbgrader = cell["metadata"].get("nbgrader")
    return str(nbgrader.get("grade_id", "")) if isinstance(nbgrader, dict) else ""


def defines(cell: Cell, name: str) -> bool:
    """Whether a code cell defines a function, a class or a value of that name."""
    if cell["cell_type"] != "code":
        return False
    found = look_at(cell["source"])
    if found["broken"]:
        pattern = rf"^(def|class)\s+{name}\b|^{name}\s*="
        return bool(re.search(pattern, cell["source"], re.MULTILINE))
    return name in found["binds"]


def _changed_since(cells: list[dict[str, Any]], question: str) -> bool:
    """Whether the cell that defines an answer was run after its check, or not at all."""
    defined = [cell.get("execution_count") for cell in cells if defines(cell, question)]
    checked = [
        cell.get("execution_count") for cell in cells if f'check("{question}"' in cell["source"]
    ]
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
