"""The inspection before handing in: is the notebook complete, and what did its checks say?

It reads the file and runs no code.
"""

from __future__ import annotations

import platform
import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from importlib.metadata import version
from itertools import chain
from pathlib import Path
from typing import Any

from ..errors import listed
from ..sim import chosen
from .brief import words_in_all
from .checks_file import read_checks
from .definitions import cells_that_count, changed_since, defined_late, judged_another
from .forms import COMMITTED, OWN_ARM
from .gaps import (
    calculated_from_runs,
    first_error,
    how_to_restore,
    left_behind,
    misnamed,
    review_texts,
    undefined_names,
    unreadable,
)
from .messages import head
from .notebook import check_id, defines, grade_id, last_verdict, read_cells
from .serialize import decode
from .source import Analysis, analyse
from .verdict import Outcome, Verdict
from .withheld import withheld_tools

LARGEST = 10.0
"""Size in megabytes above which a learning platform may reject a notebook."""


@dataclass(frozen=True)
class HandIn:
    """What was found in a notebook that is about to be handed in.

    Attributes:
        assignment: Its assignment.
        problems: Sentences about what to correct before handing in.
        notes: Sentences about what is worth knowing.
        verdicts: The last verdict in the file on each question; None if its check was not run.
        predictions: Names of the questions that ask for a prediction.
        texts: The number of words in each text that a person marks.
        old: Names of the questions whose answers changed after their checks.
    """

    assignment: str
    problems: tuple[str, ...]
    notes: tuple[str, ...]
    verdicts: Mapping[str, Verdict | None]
    predictions: Collection[str] = ()
    texts: Mapping[str, int] = field(default_factory=dict)
    old: Collection[str] = ()

    @property
    def lines(self) -> list[str]:
        """The verdict on each question in words."""
        before = dict.fromkeys(self.old, " (This was before your last change.)")
        return [
            head(v) + before.get(name, "") if v else f"{name}: not run"
            for name, v in self.verdicts.items()
        ]

    def __str__(self) -> str:
        lines = [f"[fix] {text}" for text in self.problems]
        lines += [f"[note] {text}" for text in self.notes]
        lines += [f"  {line}" for line in self.lines]
        for name, n in self.texts.items():
            said = f"{words_in_all(n)}; your instructor may read it" if n else "not written"
            lines.append(f"  {name}: {said}")
        right = {name for name, v in self.verdicts.items() if v is not None and v.right}
        tasks = self.verdicts.keys() - set(self.predictions)
        counts = []
        if tasks:
            of = f"{len(right & tasks)} of {len(tasks)}"
            counts.append(f"{of} tasks were right, as far as can be tested here")
        if self.predictions:
            committed = len(right & set(self.predictions))
            counts.append(f"{committed} of {len(self.predictions)} predictions were committed")
        ran = f"; in its last run, {', and '.join(counts)}" if counts else ""
        if self.verdicts and not any(self.verdicts.values()):
            ran = "; none of its checks has left a result"
        end = (
            "correct what is marked with [fix] first."
            if self.problems
            else "run the notebook from the top, save it, and look again."
            if self.old
            else f"the notebook can be handed in as it is{ran}."
        )
        if empty := [name for name, n in self.texts.items() if not n]:
            end += f" Without a text, {listed(empty)} will earn nothing."
        return "\n".join([*lines, f"{self.assignment}: {end}"])

    def for_the_forum(self) -> str:
        """A block to copy into a forum: verdicts and versions, but no answers."""
        tools = ", ".join(
            f"{name} {version(name)}" for name in ("labkit", "numpy", chosen(), "pin")
        )
        lines = [f"{self.assignment}; {tools}; Python {platform.python_version()}"]
        return "\n".join(["```", *lines, *self.lines, "```"])


def examine(path: Path) -> HandIn:
    """Inspect a notebook that is about to be handed in.

    Args:
        path: The notebook; ``checks.json`` must be in the same folder.

    Raises:
        LabkitError: The file is missing or is not a notebook, or its questions are missing.
    """
    cells, folder = read_cells(path), path.resolve().parent
    data = read_checks(folder)
    name, questions = data["assignment"], data["questions"]
    problems, notes = [], []
    if path.name != f"{name}.ipynb":
        called = "".join(x if x.isprintable() else "\ufffd" for x in path.name)
        problems.append(f"the file is called {called}; rename it to {name}.ipynb")
    if (size := path.stat().st_size / 1e6) > LARGEST:
        problems.append(
            f"the file has {size:.0f} MB, but the limit is {LARGEST:g}; clear the largest outputs"
        )
    tests = {x["name"]: [test["name"] for test in x["tests"]["items"]] for x in questions}
    asked, predictions = [*tests], [each for each in tests if tests[each] == [COMMITTED]]
    for each in asked:
        more, worth_knowing = _review(cells, each, name, each in predictions)
        problems += more
        notes += worth_knowing
    again = {name: [*judged_another(cells, name, asked)] for name in asked}
    problems += [*chain(*again.values()), *unreadable(cells), *undefined_names(cells, asked)]
    code = [cell["source"] for cell in cells if cell["cell_type"] == "code"]
    runs = [calculated_from_runs(code, each) for each in asked if OWN_ARM in tests[each]]
    problems += filter(None, [*runs, first_error(cells)])
    count = [*cells_that_count(cells, asked).values()]
    verdicts = {question["name"]: _verdict(cells, question, count) for question in questions}
    problems += [
        f"{head(verdict)} Write it yourself."
        for verdict in verdicts.values()
        if verdict is not None and verdict.withheld
    ]
    lost, told = left_behind(folder, cells)
    problems += lost
    notes += told
    problems += [
        f"the cell of {name} says None, although you had committed to a prediction; the cell is "
        "what is marked, so write your prediction into it again and run it"
        for name in predictions
        if (said := verdicts[name]) and said.right and _lacks_prediction(code, name)
    ]
    notes += chain(*(defined_late(cells, name, asked) for name in asked))
    # The mouse writes a prediction after its cell ran.
    old = [x for x in tests if x not in predictions and not again[x] and changed_since(cells, x)]
    if old:
        notes.append(
            f"changed since the last check: {', '.join(old)}; run the notebook from the top and "
            "save it, so that the check tries what will be marked"
        )
    if unrun := sum(verdict is None for verdict in verdicts.values()):
        notes.append(
            f"{unrun} of {len(verdicts)} checks have left no result in the saved file; if you have "
            "run them, save the file and try again (all checks are run when it is marked)"
        )
    texts, lost, told = review_texts(cells, data["texts"], name)
    problems += lost
    notes += told
    unsaid = [name for name in predictions if (v := verdicts[name]) and not v.right]
    fine = (Outcome.RIGHT, Outcome.NOT_ATTEMPTED)
    wrong = [n for n, v in verdicts.items() if v and v.outcome not in fine and n not in predictions]
    for names, says in (
        (wrong, "not yet right: {}; the parts that are right count all the same"),
        (unsaid, "not predicted yet: {}; a prediction counts, whether it is right or wrong"),
    ):
        if names:
            notes.append(says.format(", ".join(names)))
    return HandIn(name, tuple(problems), tuple(notes), verdicts, predictions, texts, old)


def _lacks_prediction(code: list[str], name: str) -> bool:
    """Whether the last cell that makes a prediction holds None in its place."""
    pattern = rf"^{name}\s*=\s*predict\(\s*['\"]{name}['\"]\s*(,\s*(said\s*=\s*)?(None)?\s*)?\)"
    made = [cell for cell in code if re.search(rf"^{name}\s*=", cell, re.MULTILINE)]
    return bool(made) and bool(re.search(pattern, made[-1], re.MULTILINE))


def _review(
    cells: list[dict[str, Any]], question: str, name: str, prediction: bool
) -> tuple[list[str], list[str]]:
    """Problems and notes about the cells of a question."""
    problems, notes = [], []
    ids = Counter(map(grade_id, cells))
    if not any(defines(cell, question) for cell in cells):
        homes = [cell for cell in cells if grade_id(cell) == question]
        magic = next((x for x in (analyse(cell["source"])["magic"] for cell in homes) if x), "")
        problems.append(
            f"the cell of {question} begins with %%{magic}, so the notebook does not see what it "
            "defines; delete that line"
            if magic
            else f"the cell of {question} is not code any more; click on it, press Esc and then Y"
            if any(cell["cell_type"] != "code" for cell in homes)
            else misnamed(homes, question, prediction)
            or f"no cell defines {question}. {how_to_restore(name)}"
        )
    others = [] if problems else [question]  # a problem says already that this cell is gone
    for each in (*others, check_id(question)):
        if not ids[each]:
            notes.append(
                f"the cell of {each} is gone or damaged; {question} is marked all the same, and "
                "labkit merge restores the cell"
            )
    return problems, notes


def _verdict(
    cells: list[dict[str, Any]], question: Mapping[str, Any], count: Iterable[Analysis]
) -> Verdict | None:
    """The last verdict of the question's check, unless the answer now uses a withheld tool.

    Args:
        cells: The cells of the notebook.
        question: The question.
        count: The cells of code that matter in marking.
    """
    name = question["name"]
    if tools := withheld_tools(count, name, decode(question["withheld"])):
        points = float(question["points"])
        return Verdict(name, Outcome.NOT_COUNTED, 0.0, points, withheld=tools)
    return last_verdict(cells, name)
