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
from .notebook import read_checks

LARGEST = 10.0
"""Above this many megabytes a notebook may not pass a learning platform's upload."""


@dataclass(frozen=True)
class HandIn:
    """What a look at a notebook found.

    Attributes:
        assignment: Which.
        problems: What to mend before handing in, sentences.
        notes: What is worth knowing.
        verdicts: The last verdict in the file for each question, or "not run".
    """

    assignment: str
    problems: tuple[str, ...]
    notes: tuple[str, ...]
    verdicts: Mapping[str, str]

    def __str__(self) -> str:
        lines = [f"[mend] {text}" for text in self.problems]
        lines += [f"[note] {text}" for text in self.notes]
        lines += [f"  {verdict}" for verdict in self.verdicts.values()]
        right = sum(": right." in verdict for verdict in self.verdicts.values())
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
        return "\n".join(["```", *lines, *self.verdicts.values(), "```"])


def look(path: Path) -> HandIn:
    """Look through a notebook that is about to be handed in.

    Args:
        path: The notebook; the assignment's ``checks.json`` must lie beside it.

    Raises:
        LabkitError: The file is missing or no notebook, or its questions are not there.
    """
    cells = read_cells(path)
    data = read_checks(path.resolve().parent)
    name, questions = data["assignment"], [q["name"] for q in data["questions"]]
    problems, notes = [], []
    if path.name != f"{name}.ipynb":
        problems.append(f"the file is called {path.name}; rename it to {name}.ipynb")
    size = path.stat().st_size / 1e6
    if size > LARGEST:
        problems.append(
            f"it has {size:.0f} MB, more than {LARGEST:g}; clear the outputs of large cells"
        )
    ids = Counter(cell["metadata"].get("nbgrader", {}).get("grade_id") for cell in cells)
    verdicts = {}
    for question in questions:
        if not any(defines(cell, question) for cell in cells):
            problems.append(f"no cell defines {question}; bring it back with: labkit merge")
        for grade_id in (question, f"{question}-check"):
            if not ids[grade_id]:
                notes.append(
                    f"the cell of {grade_id} is gone or damaged; it is marked all the same"
                )
            elif ids[grade_id] > 1:
                problems.append(
                    f"the cell of {grade_id} is there {ids[grade_id]} times; keep one, for the "
                    "last one counts"
                )
        verdicts[question] = _verdict(cells, question)
    stale = [name for name in questions if _changed_since(cells, name)]
    if stale:
        notes.append(
            f"changed since it was checked: {', '.join(stale)}; the verdicts below are old, run "
            "the notebook from the top and save it"
        )
    unrun = [name for name, verdict in verdicts.items() if verdict.endswith("not run")]
    if unrun:
        notes.append(f"not run since it was opened: {', '.join(unrun)}; marking runs them again")
    wrong = [
        name for name, says in verdicts.items() if name not in unrun and ": right." not in says
    ]
    if wrong:
        notes.append(f"not yet right: {', '.join(wrong)}; what is right counts all the same")
    return HandIn(name, tuple(problems), tuple(notes), verdicts)


def read_cells(path: Path) -> list[dict[str, Any]]:
    """The cells of a notebook file.

    Raises:
        LabkitError: It is not there, or is no notebook.
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
    except (ValueError, KeyError, TypeError, UnicodeDecodeError):
        raise LabkitError(
            f"{path.name} is no notebook, or was cut off while saving; open it in Jupyter, or "
            "restore an older version"
        ) from None


def defines(cell: Mapping[str, Any], name: str) -> bool:
    """Whether a code cell defines a function, a class or a value of that name."""
    pattern = rf"^(def|class)\s+{name}\b|^{name}\s*="
    return cell["cell_type"] == "code" and bool(re.search(pattern, cell["source"], re.MULTILINE))


def _changed_since(cells: list[dict[str, Any]], question: str) -> bool:
    """Whether the cell that defines an answer was run after its check, or not at all."""
    defined = [cell.get("execution_count") for cell in cells if defines(cell, question)]
    checked = [
        cell.get("execution_count") for cell in cells if f'check("{question}"' in cell["source"]
    ]
    ran = [count for count in checked if count]
    return bool(ran) and any(not count or count > max(ran) for count in defined)


def _verdict(cells: list[dict[str, Any]], question: str) -> str:
    """The first line that the question's check printed last."""
    for cell in reversed(cells):
        for output in cell.get("outputs", ()):
            text = "".join(output.get("text", ()))
            if match := re.search(rf"^{question}: .*points\.$", text, re.MULTILINE):
                return match.group()
    return f"{question}: not run"
