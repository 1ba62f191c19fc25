"""Cells of a notebook, their briefs, and the file of questions beside it.

No other module interprets the metadata of a cell.  A course's cells are of six kinds: "setup"
cells, which students leave alone; "walk" cells, which they may change; for each question and
prediction a "brief", an "answer" and a "check"; and the "why", a text that a person marks.  The
grade_id in nbgrader of an answer is the question's name, and that of its check is the name with
"-check".
"""

from __future__ import annotations

import json
import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import LabkitError
from ..formats import check_stamp, stamp
from .question import Question, in_points
from .serialize import read_record, record_data
from .source import analyse
from .verdict import Verdict

if TYPE_CHECKING:
    from .predictions import Prediction

FILE = "checks.json"


def read_checks(folder: Path) -> dict[str, Any]:
    """The data in a notebook's folder: its ``assignment``, ``questions``, ``texts`` and ``stubs``.

    The texts, which a person marks, map the name of each to the id of its cell, and the stubs the
    name of each answer to its cell's text.

    Raises:
        LabkitError: The file is missing or damaged.
    """
    file = folder / FILE
    remedy = "fetch the assignment's whole folder again"
    try:
        data = {"texts": {}, "stubs": {}, **json.loads(file.read_text(encoding="utf-8"))}
        check_stamp(data, f"{FILE} in {folder.name!r}", remedy)
        if not isinstance(data["assignment"], str) or not isinstance(data["questions"], list):
            raise TypeError
    except (FileNotFoundError, KeyError, TypeError, ValueError) as error:
        there = "no" if isinstance(error, FileNotFoundError) else "only a damaged"
        raise LabkitError(
            f"there is {there} {FILE} in {folder.name!r}; it came with the notebook and belongs "
            f"beside it, so {remedy}"
        ) from None
    return data


WORDS, WHY_POINTS = (25, 80), 2.0
"""The smallest and the largest number of words in a why, and its points."""
RUBRIC = (
    "2 points: the right cause, and how it leads to what you saw. 1 point: the right cause, but "
    "a step is missing or wrong. 0 points: another cause, or only a repetition of what you saw."
)
"""The rubric by which a person marks a why."""
PLACEHOLDER = "*Double-click here and write your text in place of this line.*"
"""The initial text of a why; nbgrader's settings have the same text."""


def words_of(text: str) -> list[str]:
    """The words that a reader sees, without placeholder, HTML comments and invisible characters."""
    text = re.sub(r"<!--(-?>|.*?(-->|\Z))", "", text.replace(PLACEHOLDER, ""), flags=re.DOTALL)
    return "".join(x for x in text if unicodedata.category(x) != "Cf").split()


def words_in_all(count: int) -> str:
    """A number of words with its unit, such as "1 word" or "30 words"."""
    return f"{count} word{'s' * (count != 1)}"


def brief_of_why(name: str, points: float, asks: str) -> str:
    """The text above a why, with its rubric."""
    least, most = WORDS
    head = f"**Why? `{name}`** · {in_points(points)} · {least} to {most} words of your own"
    return f"{head}\n\n{asks}\n\n<details><summary>How it is marked</summary>{RUBRIC}</details>"


def heading(does: str, name: str, points: float, core: bool) -> str:
    """The first line of a brief: what to do, for how many points, and whether it is core."""
    return f"**{does}: `{name}`** · {in_points(points)} · {'core' if core else 'extension'}"


def brief(question: Question) -> str:
    """The text above a stub: the task, the points, and what the answer may not use."""
    head = heading("Your turn", question.name, question.points, question.core)
    names = " or ".join(f"`{name.replace('labkit.', 'lk.')}`" for name in question.withheld)
    return f"{head}\n\n{question.asks}" + (f" Do not use {names}." if names else "")


Cell = Mapping[str, Any]
Notebook = Any
KERNEL = {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"}
_CHECK = "-check"
_OUTPUT = "labkit"
"""Metadata key of a check's output that holds the verdict."""


def read_cells(path: Path, text: bytes | None = None) -> list[dict[str, Any]]:
    """The cells of a notebook file.

    Args:
        path: The file.
        text: Its content, if it has been read already.

    Raises:
        LabkitError: The file is missing, or is not a notebook.
    """
    if text is None and path.exists() and not path.is_file():  # opening a pipe waits for ever
        raise LabkitError(f"{path} is a folder, a pipe or a device; give a notebook's file")
    try:
        data = json.loads(path.read_text(encoding="utf-8") if text is None else text)
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


def kind(cell: Cell) -> str:
    """The kind of a released cell, one of the six; "" for any other cell."""
    return str(_metadata(cell).get("lab", ""))


def grade_id(cell: Cell) -> str:
    """What a cell was made for: a question's name, the name with "-check", or ""."""
    found = nbgrader_info(cell).get("grade_id")
    return found if isinstance(found, str) else ""


def cells_made_for(cells: Sequence[dict[str, Any]], name: str, home: str) -> list[dict[str, Any]]:
    """The cells made for an answer, found as the grader does, by its name, else by the id."""
    named = [cell for cell in cells if grade_id(cell) == name]
    return named or [cell for cell in cells if not grade_id(cell) and cell.get("id") == home]


def nbgrader_info(cell: Cell) -> Mapping[str, Any]:
    """A cell's metadata for nbgrader: grade_id, grade, solution, points; empty for most cells."""
    found = _metadata(cell).get("nbgrader")
    return found if isinstance(found, dict) else {}


def check_id(question: str) -> str:
    """The grade_id of a question's check."""
    return question + _CHECK


def question_of(grade_id: str) -> str:
    """The question to which a cell belongs, by its grade_id."""
    return grade_id.removesuffix(_CHECK)


def by_hand(cell: Cell) -> bool:
    """Whether a person marks a released cell: nbgrader's manual answer, or its manual task."""
    found = nbgrader_info(cell)
    return bool(found.get("task") or (found.get("grade") and found.get("solution")))


def verdict_metadata(verdict: Verdict) -> dict[str, Any]:
    """The metadata of an output that shows a verdict, for programs that read the file."""
    return {_OUTPUT: {**stamp(), "verdict": record_data(verdict)}}


def last_verdict(cells: Iterable[Cell], question: str) -> Verdict | None:
    """The last verdict on a question in the outputs of cells, or None."""
    lists = [x for cell in cells if isinstance(x := cell.get("outputs"), list)]
    found = [verdict_in(output) for outputs in lists for output in outputs]
    return next((x for x in reversed(found) if x and x.name == question), None)


def verdict_in(output: Any) -> Verdict | None:
    """The verdict in an output of a notebook's file; None if it has no complete one."""
    try:
        data = output["metadata"][_OUTPUT]
        current = data.items() >= stamp().items()
        return read_record(Verdict, data["verdict"]) if current else None
    except (LabkitError, KeyError, TypeError, AttributeError):
        return None


def manifest(source: Notebook) -> list[dict[str, Any]]:
    """What each released cell is, in order, so that a grader need not trust a submission."""
    return [
        {
            "id": cell.id,
            "type": cell.cell_type,
            "kind": kind(cell),
            "grade_id": grade_id(cell) or None,
            "source": cell.source,
            **({"points": float(nbgrader_info(cell)["points"])} if by_hand(cell) else {}),
        }
        for cell in source.cells
    ]


def source_notebook(
    path: Path,
    questions: Mapping[str, Question],
    predictions: Sequence[Prediction] = (),
) -> Notebook:
    """The notebook that nbgrader takes as its source, with the solutions inside.

    In the source text, a code cell with ``question="name"`` holds a stub whose solution region
    imports or is the answer; a cell ``tests`` is left out.  An empty code cell with
    ``predict="name"`` marks the place of a prediction.  A Markdown cell with ``why="name"``, or
    ``task="name" points=3`` for a longer text, asks for a text and holds a model answer in a
    solution region.  ``setup=true`` marks cells that students should leave alone; the code of
    cells with what `FOLDED` finds is folded.  The brief before a stub and the check after it are
    generated from the question.

    Args:
        path: The source, in jupytext's percent format.
        questions: The questions of the notebook, by name.
        predictions: Its predictions.

    Raises:
        LabkitError: Stubs and questions do not match.
    """
    import jupytext  # both are slow to load, and only a release needs them
    import nbformat

    text = jupytext.read(path, fmt="py:percent")
    by_name = {prediction.name: prediction for prediction in predictions}
    cells: list[dict[str, Any]] = []
    asked: list[str] = []
    for cell in text.cells:
        if cell.metadata.get("title") == "tests":
            continue
        name = next((cell.metadata[x] for x in _ASKS if x in cell.metadata), None)
        if name is not None:
            asked.append(name)
        if "why" in cell.metadata or "task" in cell.metadata:
            cells += _text_cells(path, str(name), cell)
        elif name in by_name and "question" not in cell.metadata:
            cells += _value_cells(by_name[name])
        elif name in questions and "question" in cell.metadata:
            _check_stub(path, str(name), cell)
            cells += _question_cells(questions[str(name)], cell)
        elif name is not None:
            stub = "question" in cell.metadata
            listed = "PROBLEMS of problems.py" if stub else "PREDICTIONS of predictions.py"
            tests = ", nor has tests below its cell" if stub else ""
            raise LabkitError(f"{path.name} asks {name!r}, which is not in {listed}{tests}")
        else:
            setup = cell.metadata.get("setup", False)
            meta = _nbgrader(f"setup-{len(cells)}", locked=True) if setup else {}
            cells.append(_cell(cell.cell_type, cell.source, "setup" if setup else "walk", meta))
            if cell.cell_type == "code" and FOLDED.search(cell.source):
                cells[-1]["metadata"]["jupyter"] = {"source_hidden": True}
    for name in (*questions, *by_name):
        if asked.count(name) != 1:
            raise LabkitError(f"{path.name} has {asked.count(name)} stubs of {name}, and needs one")
    for number, cell in enumerate(cells):
        cell["id"] = f"{path.stem.replace('_', '-')}-{number:02d}"
    meta = {"kernelspec": KERNEL, "language_info": {"name": "python"}}
    return nbformat.from_dict(
        {"cells": cells, "metadata": meta, "nbformat": 4, "nbformat_minor": 5}
    )


FOLDED = re.compile(r"^(import|from) |\buse\(|\bplt\.|\blk\.plotting\.", re.MULTILINE)
"""What is in cells whose code is folded at first: set-up, stand-ins and plotting."""
_ASKS = ("question", "predict", "why", "task")


def _question_cells(question: Question, stub: Cell) -> Iterator[dict[str, Any]]:
    """The three cells of a question."""
    name = question.name
    yield _cell("markdown", brief(question), "brief", {})
    yield _cell("code", stub["source"], "answer", _nbgrader(name, solution=True))
    yield _check(name, question.points)


def _value_cells(asked: Prediction) -> Iterator[dict[str, Any]]:
    """The three cells of a value; the text under `BLANK` is the answer cell in students' copies.

    The check of a prediction is there for nbgrader, and out of sight: `predict` says the same.
    """
    yield _cell("markdown", asked.brief(), "brief", {})
    cell = _cell("code", asked.solved(), "answer", _nbgrader(asked.name, solution=True))
    cell["metadata"][BLANK] = asked.cell()
    yield cell
    checked = _check(asked.name, asked.points)
    checked["metadata"]["jupyter"] = {"source_hidden": True, "outputs_hidden": True}
    yield checked


BLANK = "blank"
"""Metadata key of a source cell; its value replaces the solution in the students' copy."""


def _check(name: str, points: float) -> dict[str, Any]:
    meta = _nbgrader(check_id(name), locked=True, grade=True, points=points)
    return _cell("code", f'check("{name}", {name})', "check", meta)


def _text_cells(path: Path, name: str, cell: Cell) -> Iterator[dict[str, Any]]:
    """The brief, and the cell for a text, which a person marks in nbgrader."""
    asks, begins, model = cell["source"].partition("### BEGIN SOLUTION")
    if not begins or not model.rstrip().endswith("### END SOLUTION"):
        raise LabkitError(
            f"{path.name}: the why {name} needs a model answer at its end, between a line "
            "### BEGIN SOLUTION and a line ### END SOLUTION"
        )
    points = float(cell["metadata"].get("points", WHY_POINTS))
    asks = asks.strip()
    text = brief_of_why(name, points, asks) if "why" in cell["metadata"] else asks
    yield _cell("markdown", text, "brief", {})
    meta = _nbgrader(name, solution=True, grade=True, points=points)
    yield _cell("markdown", begins + model, "why", meta)


def _check_stub(path: Path, name: str, cell: Cell) -> None:
    marks = [line.strip() for line in cell["source"].splitlines() if "### " in line]
    if marks != ["### BEGIN SOLUTION", "### END SOLUTION"]:
        raise LabkitError(
            f"{path.name}: the stub of {name} needs one region between a line ### BEGIN SOLUTION "
            "and a line ### END SOLUTION"
        )
    if name not in analyse(cell["source"])["binds"]:
        raise LabkitError(f"{path.name}: the stub of {name} does not define {name}")


def _metadata(cell: Cell) -> Mapping[str, Any]:
    found = cell.get("metadata")
    return found if isinstance(found, dict) else {}


def _cell(kind: str, source: str, lab: str, nbgrader: dict[str, Any]) -> dict[str, Any]:
    metadata: dict[str, Any] = {"lab": lab}
    if nbgrader:
        metadata |= {"nbgrader": nbgrader, "deletable": False}
        metadata["editable"] = not nbgrader["locked"]
    cell = {"cell_type": kind, "metadata": metadata, "source": source}
    return cell | ({"outputs": [], "execution_count": None} if kind == "code" else {})


def _nbgrader(grade_id: str, **flags: Any) -> dict[str, Any]:
    base = {"grade": False, "locked": False, "solution": False, "task": False}
    return {"schema_version": 3, "grade_id": grade_id, **base, **flags}
