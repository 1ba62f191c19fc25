"""Questions that stand whole in the notebook's text: the answer is a cell, and so are its tests.

A cell ``# %% question="double" points=2`` defines the answer; the first line of its docstring is
the task.  In each cell ``# %% tests message="..."`` below it, every call of the function is a case,
and the answer says what is expected.  Calls between nbgrader's ``### BEGIN HIDDEN TESTS`` and
``### END HIDDEN TESTS`` are hidden; they may use ``random``, a generator.
"""

from __future__ import annotations

import linecache
import re
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path
from textwrap import indent
from types import ModuleType
from typing import Any

from ...errors import LabkitError
from ..advice import full_description
from ..question import Call
from ..source import needed
from .problem import Problem, Trial, call


def short_problems(path: Path) -> tuple[Problem, ...]:
    """The problems whose answers and tests are cells of a notebook's text.

    Raises:
        LabkitError: A cell of theirs raises an error, or tests follow another question.
    """
    if "\n# %% tests" not in path.read_text(encoding="utf-8"):
        return ()
    import jupytext  # slow to load

    found, name, code = dict[str, Problem](), "", ""
    for cell in jupytext.read(path, fmt="py:percent").cells:
        meta, source = cell.metadata, re.sub(r"\n *### (BEGIN|END) SOLUTION", "", cell.source)
        name, tests = meta.get("question", name), meta.get("title") == "tests"
        if tests and name not in found:
            raise LabkitError(
                f"{path.name}: tests follow {name!r}, which has no points=... in its cell"
            )
        try:
            if tests:
                trials = (*found[name].trials, _trial(found[name], code, cell))
                found[name] = replace(found[name], trials=trials)
            elif cell.cell_type == "code":
                code += f"\n{source}"
            if "question" in meta and "points" in meta:
                answer = _loaded(f"{path.stem}.{name}", code, name)
                asks = (answer.__doc__ or "").split("\n")[0]
                found[name] = Problem(name, meta["points"], asks, answer, ())
        except Exception as error:  # an author's code may raise anything
            raise LabkitError(f"{path.name}: {name}: {full_description(error)}") from error
    return tuple(problem for problem in found.values() if problem.trials)


def _trial(problem: Problem, code: str, cell: Any) -> Trial:
    """The cases of a cell, which pass or fail together."""
    shown, _, kept = cell.source.partition("### BEGIN HIDDEN TESTS")
    says, also = cell.metadata.get("message", "cases"), "others like these" if kept else ""
    cases = partial(_cases, problem, code)
    return Trial(says, cases(shown, None), partial(cases, kept), also)


def _cases(problem: Problem, code: str, text: str, random: Any) -> tuple[Call, ...]:
    """The calls in a text, which may use what is defined above it."""
    made: list[Call] = []

    def asked(*args: Any, **kwargs: Any) -> Any:
        made.append(call(*args, **kwargs))
        return made[-1].ask(problem.answer)

    body = indent(f"{text}\npass", "    ")
    source = f"{code}\ndef _tests({problem.name}, random):\n{body}"
    _loaded(f"tests of {problem.name}", source, "_tests")(asked, random)
    return tuple(made)


def _loaded(title: str, code: str, name: str) -> Any:
    """What a name means after code, of which only what it needs is run, as a module of its own."""
    text = "\n\n\n".join(needed(code, name))
    module = sys.modules[title] = ModuleType(title)
    module.__file__ = file = f"<{title}>"
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    exec(compile(text, file, "exec"), module.__dict__)
    return module.__dict__[name]
