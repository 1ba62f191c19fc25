"""Which cell answers a question, and whether its check judged what will be marked.

Answers are marked after all cells have run, with the last definition of every name.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from .gaps import first_line
from .notebook import checks, defines, grade_id, last_judged
from .source import Analysis, analyse, parsed

Cells = Sequence[dict[str, Any]]


def written_cells(cells: Mapping[int, Analysis], home: Collection[int], name: str) -> list[int]:
    """The positions of the cells that answer a question; the last one counts.

    An empty stub answers nothing.  A function counts in any cell; a value counts in another cell
    only if the one that was made for it does not define it.

    Args:
        cells: What `analyse` found in each cell of code, by position.
        home: The positions of the cells that were made for the question.
        name: The question's name.
    """
    functions = {k for k, cell in cells.items() if name in cell["functions"]}
    binds = {k for k, cell in cells.items() if name in cell["binds"]}
    stubs = {k for k in functions if name in cells[k]["stubs"]}
    return sorted((functions - stubs) or (binds & {*home}) - stubs or binds - stubs)


def changed_since(cells: Cells, question: str) -> bool:
    """Whether the answer that a check judged was changed or run after the check, or was not run."""
    checked = _checks(cells, question)
    defining = [k for k, cell in enumerate(cells) if defines(cell, question)]
    written = _answering(cells, question) or defining
    above = [k for k in written if k <= max(checked, default=len(cells))]
    if not written:
        return False
    answer, judged = cells[(above or written)[-1]], last_judged(cells, question)
    count = answer.get("execution_count")
    ran = [x for k in checked if isinstance(x := cells[k].get("execution_count"), int)]
    if ran and (not isinstance(count, int) or count > max(ran)):
        return True
    return bool(judged) and judged != fingerprint(answer["source"], question)


def fingerprint(source: str, name: str) -> str:
    """A short hash of the last statement that defines a name in a cell, comments aside, or ""."""
    if name not in analyse(source)["binds"]:
        return ""
    try:
        texts = [ast.unparse(x) for x in parsed(source)[1].body]
    except RecursionError:
        return ""
    last = next((x for x in reversed(texts) if name in analyse(x)["binds"]), "")
    return hashlib.sha256(last.encode(errors="surrogatepass")).hexdigest()[:12]


def defined_again(cells: Cells, question: str, asked: Collection[str]) -> Iterator[str]:
    """A sentence for each name that is defined again below a check, so that another answer counts.

    Args:
        cells: The cells of the notebook.
        question: The question's name.
        asked: The names of all questions.
    """
    written = _answering(cells, question)
    check = max(_checks(cells, question), default=len(cells))
    checked = [k for k in written if k <= check][-1:]
    if not checked:
        return
    if _differs(cells, question, checked[0], written[-1]):
        yield (
            f"the cell that begins with `{first_line(cells[written[-1]]['source'])}` defines "
            f"{question} again below its check, and counts; delete it, or check again below it"
        )
        return
    parts = [(k, part) for k, found in _code(cells).items() for part in found["definitions"]]
    waiting = [part for k, part in parts if k == checked[0] and question in part["binds"]]
    seen = {*asked}
    while waiting:
        for name in sorted({*waiting.pop()["outside"]} - seen):
            seen.add(name)
            bound = [(k, part) for k, part in parts if name in part["binds"] and not part["stub"]]
            for first, known in [pair for pair in bound if pair[0] <= check][-1:]:
                waiting.append(known)
                last, again = bound[-1]
                imported_again = name in known["mean"].keys() & again["mean"].keys()
                if imported_again and known["mean"][name] == again["mean"][name]:
                    continue
                if _differs(cells, name, first, last):
                    yield (
                        f"{question} uses {name}, which the cell that begins with "
                        f"`{first_line(cells[last]['source'])}` defines again below the check, and "
                        f"{question} is marked with that {name}; change one of the two names"
                    )


def _differs(cells: Cells, name: str, first: int, last: int) -> bool:
    """Whether two cells define a name in different words."""
    return fingerprint(cells[first]["source"], name) != fingerprint(cells[last]["source"], name)


def _code(cells: Cells) -> dict[int, Analysis]:
    return {k: analyse(x["source"]) for k, x in enumerate(cells) if x["cell_type"] == "code"}


def _answering(cells: Cells, question: str) -> list[int]:
    home = {k for k, cell in enumerate(cells) if grade_id(cell) == question}
    return written_cells(_code(cells), home, question)


def _checks(cells: Cells, question: str) -> list[int]:
    return [k for k, x in enumerate(cells) if x["cell_type"] == "code" and checks(x, question)]
