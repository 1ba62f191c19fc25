"""The solved notebook for after the deadline, with the source of the answers."""

from __future__ import annotations

import copy
import inspect
from collections.abc import Mapping

from ...errors import LabkitError
from ..notebook import Notebook, grade_id, kind
from ..source import needed
from .problem import Problem


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
    """The source of an answer as one cell, with the imports and helpers that it needs.

    Raises:
        LabkitError: The answer depends on something that cannot be copied.
    """
    function = inspect.unwrap(problem.answer)
    module = inspect.getmodule(function)
    assert module is not None
    parts = needed(inspect.getsource(module), function.__name__)
    imports = [part for part in parts if part.startswith(("import ", "from "))]
    for line in imports:
        if line.startswith(("import solutions", "from solutions", "from .")):
            raise LabkitError(
                f"the answer of {problem.name} needs `{line}`, which students do not have; define "
                "what it imports in the answer's own module"
            )
    bodies = [part for part in parts if part not in imports]
    return "\n\n\n".join(["\n".join(imports), *bodies] if imports else bodies)
