"""Making the files of a release from the course's sources: for nbgrader, graders and solutions.

A release is first prepared, and may be refused, and is then written; between these steps the grader
makes room for it in the gradebook.
"""

from __future__ import annotations

import copy
import inspect
import json
import math
import re
import shutil
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import nbformat

from ...errors import LabkitError
from ...formats import stamp
from ..notebook import BLANK, FILE, Notebook, grade_id, kind, manifest, source_notebook
from ..question import Question
from ..serialize import question_data
from ..source import needed
from .bundle import write_bundle
from .layout import Course
from .problem import Problem
from .refusals import refusals


def solution_notebook(source: Notebook, problems: Mapping[str, Problem]) -> Notebook:
    """The notebook with the answers' source in place of stubs, and model texts in place of whys."""
    notebook = copy.deepcopy(source)
    for cell in notebook.cells:
        if kind(cell) == "answer" and grade_id(cell) in problems:
            cell.source = inlined(problems[grade_id(cell)])
        elif kind(cell) == "why":
            cell.source = "\n".join(cell.source.splitlines()[1:-1])
    return notebook


def inlined(problem: Problem) -> str:
    """The source of an answer as one cell, with the imports and helpers of its module it needs."""
    function = inspect.unwrap(problem.answer)
    module = inspect.getmodule(function)
    assert module is not None
    parts = needed(inspect.getsource(module), function.__name__)
    imports = [part for part in parts if part.startswith(("import ", "from "))]
    bodies = [part for part in parts if part not in imports]
    return "\n\n\n".join(["\n".join(imports), *bodies] if imports else bodies)


@dataclass(frozen=True)
class Prepared:
    """An assignment that may be released, before its files are written.

    Attributes:
        course: The course.
        name: Name of the assignment.
        seed: Seed of the hidden cases.
        source: The notebook for nbgrader, with the solutions inside.
        solved: The solved notebook.
        questions: The questions by name, with their hidden cases.
    """

    course: Course
    name: str
    seed: int
    source: Notebook
    solved: Notebook
    questions: Mapping[str, Question]


def prepare(course: Course, name: str, seed: int) -> Prepared:
    """Make an assignment without writing any file.

    Args:
        course: The course.
        name: Name of the assignment, such as "01_paths".
        seed: Seed of the hidden cases; use a secret one, because the repository's is public.

    Raises:
        UnknownName: There is no such assignment.
        LabkitError: A question withholds a tool that does not exist, gives points for no work, or
            cannot tell two known mistakes apart.
    """
    problems = {problem.name: problem for problem in course.problems(name)}
    questions = {key: problem.question(seed) for key, problem in problems.items()}
    predictions = course.predictions(name)
    source = source_notebook(course.notebook_source(name), questions, predictions)
    if reasons := refusals(source, problems, questions):
        folder = course.notebook_source(name).parent.relative_to(course.root)
        raise LabkitError("\n".join([f"{folder}:", *reasons]))
    solved = solution_notebook(source, problems)
    questions |= {prediction.name: prediction.question() for prediction in predictions}
    return Prepared(course, name, seed, source, solved, questions)


def write(made: Prepared) -> None:
    """Write the source for nbgrader, the solved notebook and the graders' bundle.

    A question whose public cases differ from those of the last release only by rounding stays as it
    was, so that a release on another machine leaves the files under git unchanged.

    Args:
        made: What `prepare` made.
    """
    public = _checks(made)
    _write(made.course.source / made.name, _at_home(made.source), public)
    _write(made.course.solution / made.name, made.solved, public)
    cells = manifest(made.source)
    write_bundle(made.course, made.name, made.seed, cells, made.questions)


def _at_home(source: Notebook) -> Notebook:
    """The source, whose answers find the course's ``solutions``, so nbgrader can validate it."""
    notebook = copy.deepcopy(source)
    for cell in notebook.cells:
        if kind(cell) == "answer":
            cell.source = re.sub(
                r"^( *)### BEGIN SOLUTION\n",
                r'\g<0>\1__import__("sys").path.insert(0, "../../../..")\n',
                cell.source,
                flags=re.MULTILINE,
            )
    return notebook


def _checks(made: Prepared) -> str:
    """The text of `FILE`: a test or a known mistake is one line."""
    before: dict[str, object] = {}
    with suppress(OSError, ValueError, KeyError):  # without a release, or with a damaged one
        old = json.loads((made.course.release / made.name / FILE).read_text(encoding="utf-8"))
        before = {question["name"]: question for question in old["questions"]}
    questions = []
    for name, question in made.questions.items():
        data = json.loads(json.dumps(question_data(question.public())))
        kept = before.get(name)
        questions.append(_lines(kept if same_but_for_rounding(kept, data) else data))
    texts = {m["grade_id"]: m["id"] for m in manifest(made.source) if "points" in m}
    answers = [cell for cell in made.source.cells if kind(cell) == "answer"]
    stubs = {grade_id(cell): _stub(cell) for cell in answers}
    head = _lines({**stamp(), "assignment": made.name, "texts": texts, "stubs": stubs})
    return f'{head[:-1]},\n"questions":[\n' + ",\n".join(questions) + "\n]}\n"


def _stub(cell: Any) -> str:
    """An answer's cell as students get it."""
    region = r"^( *)### BEGIN SOLUTION\n.*### END SOLUTION$"
    todo = r"\1# Your code goes here\n\1raise NotImplementedError"
    blank: str | None = cell.metadata.get(BLANK)
    return blank or re.sub(region, todo, cell.source, flags=re.MULTILINE | re.DOTALL)


def _lines(data: Any) -> str:
    """JSON data of a mapping, one field a line, and one item a line of its tests and mistakes."""

    def text(x: object) -> str:
        return json.dumps(x, ensure_ascii=False, separators=(",", ":"))

    fields = []
    for key, value in data.items():
        says = text(value)
        if key in ("tests", "mistakes") and value["items"]:
            items = ",\n".join(map(text, value["items"]))
            says = f"{text({**value, 'items': []})[:-2]}\n{items}\n]}}"
        fields.append(f"{text(key)}:{says}")
    return "{" + ",\n".join(fields) + "}"


def same_but_for_rounding(a: object, b: object, rtol: float = 1e-9, atol: float = 1e-10) -> bool:
    """Whether two JSON values differ only by what another machine rounds in another manner.

    The default limits hold for derivatives by differences, too.
    """
    same = partial(same_but_for_rounding, rtol=rtol, atol=atol)
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(same(a[k], b[k]) for k in a)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, float) and isinstance(b, int | float):
        return math.isclose(a, b, rel_tol=rtol, abs_tol=atol)
    return a == b


def _write(folder: Path, notebook: Notebook, checks: str) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    nbformat.write(notebook, folder / f"{folder.name}.ipynb")
    (folder / FILE).write_text(checks, encoding="utf-8")
