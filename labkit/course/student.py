"""The functions that a notebook calls: ``check``, ``case`` and ``use``.

The questions are in a file beside the notebook, see `checks_file`.
"""

from __future__ import annotations

import ast
import dis
import hashlib
import inspect
import json
import linecache
import os
import sys
import textwrap
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import LabkitError, UnknownName
from ..trajectory import PoseSample, Sample
from .advice import line_of, still_raises
from .calling import LocalFunction, captured, copied
from .card import card, picture
from .causes import diagnosed
from .judges import UNSAID
from .marking import Mismatch, mark, not_counted, try_public
from .messages import HEADS, Message, message, untold, wrapped
from .notebook import read_checks, verdict_metadata
from .question import Call, Question
from .serialize import read_question
from .source import analyse, withheld_tools
from .verdict import Outcome, Verdict


class Desk:
    """The questions of one notebook, and the state of the work on them."""

    def __init__(self, questions: dict[str, Question]) -> None:
        self.questions = questions
        self.checked: dict[str, tuple[Any, Verdict]] = {}
        self.failing: dict[str, Call | None] = {}
        self.committed: dict[str, Any] = {}
        self.revealed: set[str] = set()
        self.anyway: set[str] = set()

    @classmethod
    def beside(cls, folder: Path) -> Desk:
        """The desk of the notebook in ``folder``.

        Raises:
            LabkitError: The file of questions is missing or damaged.
        """
        questions = map(read_question, read_checks(folder)["questions"])
        return cls({question.name: question for question in questions})

    def question(self, name: str) -> Question:
        """The question of that name.

        Raises:
            UnknownName: There is no such question.
        """
        if name not in self.questions:
            raise UnknownName("question", name, self.questions)
        return self.questions[name]

    def verdict(
        self, name: str, function: Callable[..., Any]
    ) -> tuple[Verdict, str, Mismatch | None]:
        """The verdict on a function, what the function printed, and the numbers that differ.

        Raises:
            KeyboardInterrupt: The student stopped the function; the message says in which line.
        """
        question = self.question(name)
        self.failing[name] = None
        cells = map(analyse, executed_cells(function))
        used = withheld_tools(cells, name, question.withheld)
        try:
            with captured() as out:
                verdict, found = not_counted(question, used), None
                if not used:
                    here = LocalFunction(function)
                    tried = try_public(question, here)
                    verdict, found = mark(question, here, tried), tried.first_mismatch(question)
                    verdict = diagnosed(question, verdict, tried, here)
                    self.failing[name] = tried.failing
        except KeyboardInterrupt as stop:
            line = line_of(stop)
            where = f" in the line `{line}`" if line else ""
            raise KeyboardInterrupt(
                f"{name} was stopped{where}; does every loop in it end?"
            ) from None
        self.checked[name] = (function, verdict)
        return verdict, out.text, found

    def wrong_dependencies(self, name: str, function: Callable[..., Any]) -> tuple[str, ...]:
        """Other answers that a function calls by name and that are wrong, checked again now."""
        fine = (Outcome.RIGHT, Outcome.NOT_ATTEMPTED)  # to call a stub is an error of its own
        wrong = {other for other, (_, v) in self.checked.items() if v.outcome not in fine} - {name}
        called = {x: now for x, now in globals_of(function).items() if x in wrong}
        return tuple(x for x, now in called.items() if self.verdict(x, now)[0].outcome not in fine)


def globals_of(function: Callable[..., Any]) -> dict[str, Any]:
    """The global names that a Python function reads, with their values; else nothing."""
    steps = dis.get_instructions(function) if hasattr(function, "__code__") else ()
    read = dict.fromkeys(step.argval for step in steps if step.opname == "LOAD_GLOBAL")
    known = getattr(function, "__globals__", {})
    return {name: known[name] for name in read if name in known}


def in_form(function: Callable[..., Any], right: Any) -> Callable[..., Any]:
    """A function whose lists and tuples become what a right answer is, as the check accepts them.

    Args:
        function: The student's function.
        right: One right answer; only for samples and arrays the results are converted.
    """
    kind = type(right)
    if kind not in (Sample, PoseSample, np.ndarray):
        return function

    @wraps(function)
    def formed(*args: Any, **kwargs: Any) -> Any:
        result = function(*args, **kwargs)
        if type(result) not in (list, tuple):
            return result
        return np.asarray(result) if kind is np.ndarray else kind(*map(np.asarray, result))

    return formed


def shell() -> Any:
    """The shell of this notebook, or None outside a notebook."""
    if "IPython" not in sys.modules:
        return None
    from IPython.core.getipython import get_ipython

    return get_ipython()


def executed_cells(function: Callable[..., Any]) -> list[str]:
    """The text of all cells that ran in this notebook; elsewhere, that of the function's file."""
    notebook = shell()
    if notebook is not None:
        return list(notebook.history_manager.input_hist_raw)
    try:
        file = inspect.getsourcefile(inspect.unwrap(function)) or ""
    except (TypeError, ValueError):
        return []
    return ["".join(linecache.getlines(file))]


_desks: dict[Path, Desk] = {}
_ran = [0.0]
"""When the last cell ran that does not hand in."""


def _note_time(result: Any) -> None:
    if "hand_in(" not in (result.info.raw_cell or ""):
        _ran[0] = time.time()


if shell():
    shell().events.register("post_run_cell", _note_time)


def last_run() -> float:
    """When a cell of this notebook ran last, in [s] since 1970, those that hand in left out."""
    return _ran[0]


def desk() -> Desk:
    """The desk of this notebook."""
    folder = Path.cwd()
    if folder not in _desks:
        _desks[folder] = Desk.beside(folder)
    return _desks[folder]


class Points(float):
    """Points earned, which nbgrader reads from a cell's output and students do not see."""

    def _ipython_display_(self) -> None:
        """Show nothing, because the verdict is shown already; in nbgrader, show the number.

        Raises:
            NotImplementedError: nbgrader runs the cell, so IPython should show the number.
        """
        if "NBGRADER_EXECUTION" in os.environ:
            raise NotImplementedError


def check(name: str, function: Any = UNSAID) -> float:
    """Try your function and print the result.

    Args:
        name: The question's name.
        function: The function, or the value, that you wrote.

    Returns:
        The points earned, which nbgrader reads; for an unknown name, which is told, they are 0.
    """
    if function is UNSAID:
        name = getattr(name, "__name__", name)
        print(wrapped(f'Write check("{name}", {name}).'))
        return Points(0.0)
    if name not in desk().questions:
        print(wrapped(f"There is no question {name!r:.60}. The names are {_names()}."))
        return Points(0.0)
    question = desk().question(name)
    verdict, printed, found = desk().verdict(name, function)
    stub = verdict.outcome is Outcome.NOT_ATTEMPTED
    more = [still_raises(function)] if stub else []
    wrong = desk().wrong_dependencies(name, function)
    says = message(question, verdict, printed, wrong, cure=cure_is_due(verdict, function))
    says = replace(says, helps=[*filter(None, more), *says.helps])
    say(says, verdict, found if verdict.mistake else None)
    return Points(verdict.earned)


TRIES = Path(".tries.json")
"""The file beside a notebook with the first text that was wrong for each cause.

It outlives the kernel, so running all cells again tells no cure.
"""


def cure_is_due(verdict: Verdict, function: Any) -> bool:
    """Whether a changed answer is wrong once more for the same cause."""
    known = verdict.mistake
    if known is None or not known.cure:
        return False
    tries: dict[str, str] = {}
    with suppress(OSError, ValueError):
        tries |= json.loads(TRIES.read_text(encoding="utf-8"))
    cause, now = f"{verdict.name}: {known.name or known.says}", _text(function)
    first = tries.setdefault(cause, now)
    if first != now:
        tries[cause] = ""
    with suppress(OSError):  # a folder that is read only
        TRIES.write_text(json.dumps(tries, indent=1), encoding="utf-8")
    return first != now


def _text(function: Any) -> str:
    """A short hash of an answer and of what it calls, without comments and blank space."""
    texts = []
    for part in (function, *globals_of(function).values()):
        with suppress(TypeError, OSError, SyntaxError):
            if inspect.isroutine(part) or inspect.isclass(part):
                texts.append(ast.dump(ast.parse(textwrap.dedent(inspect.getsource(part)))))
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:16]


def _names() -> str:
    return ", ".join(desk().questions)


def case(name: str) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """The arguments of the call at which the last check of a question stopped, for trying it again.

    Args:
        name: The question's name.

    Returns:
        A tuple of the positional arguments, and a dictionary of the arguments by name.

    Raises:
        UnknownName: There is no such question.
        LabkitError: The last check did not stop at a call of the function.
    """
    call = desk().failing.get(desk().question(name).name)
    if call is None:
        raise LabkitError(f"the last check of {name} did not stop at a call; run its check first")
    return copied(call.args), copied(dict(call.kwargs))


def restore(name: str) -> None:
    """Put the cell of an answer, as it was handed out, into a new cell below this one.

    Args:
        name: The answer's name.

    Raises:
        UnknownName: There is no such answer.
    """
    stubs = read_checks(Path.cwd())["stubs"]
    if name not in stubs:
        raise UnknownName("answer", name, stubs)
    if shell() is None:
        print(stubs[name])
    else:
        shell().set_next_input(stubs[name])


def use(
    name: str,
    function: Callable[..., Any],
    given: Callable[..., Any],
    yours: Callable[..., Any] | None = None,
    *,
    anyway: bool = False,
) -> Callable[..., Any]:
    """Your function if it is right, else a stand-in, so that the notebook can always continue.

    Args:
        name: The question's name.
        function: The function that you wrote.
        given: The stand-in, which is a tool of labkit or a simpler function.
        yours: What to use instead of `function` itself, if the notebook wraps it first.
        anyway: Whether to use yours even if it is wrong, to see how the arm then moves.

    Returns:
        One of them; a line says so each time that it is not a right answer of yours, and why.
    """
    known, verdict = desk().checked.get(name, (None, None))
    if known is not function or verdict is None:
        verdict, *_ = desk().verdict(name, function)
    wrong = verdict.outcome is Outcome.WRONG
    calls = (x for x in desk().question(name).calls if isinstance(x, Call))
    yours = yours or in_form(function, getattr(next(calls, None), "expected", None))
    desk().anyway.discard(name)
    if verdict.right:
        return yours
    if anyway and wrong:
        desk().anyway.add(name)
        print(f"[anyway] {name}: your function is not right yet, and is used all the same.")
        return yours
    text = f"[stand-in] {name}: yours is replaced here by a stand-in ({HEADS[verdict.outcome]})."
    if wrong:
        text += " To see what your function does, add anyway=True to this use(...)."
    print(wrapped(text))
    return given


def say(says: Message, verdict: Verdict, found: Mismatch | None) -> None:
    """Print a message; in a notebook, show a card, whose output also stores the verdict."""
    if shell() is None:
        print(says)
        return
    from IPython.display import display

    outcome = Outcome.NOT_TRIED if untold(verdict) else verdict.outcome
    shown = card(says, outcome, found and picture(found))
    display(shown, metadata=verdict_metadata(verdict), raw=True)
