"""Which cells answer the questions, and whether a check judged what will be marked.

Answers are marked after all cells have run, with the last definition of every name.
"""

from __future__ import annotations

import ast
import builtins
import hashlib
import sys
import textwrap
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from types import ModuleType
from typing import Any

from ..errors import listed
from .gaps import the_cell
from .notebook import grade_id, is_edited, kind, last_judged
from .source import Analysis, analyse, dotted, parsed

Cells = Sequence[dict[str, Any]]
_Part = Mapping[str, Any]
"""A statement, as the ``definitions`` of `analyse` describe it."""


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


def needed_cells(cells: Mapping[int, Analysis], places: Iterable[int]) -> set[int]:
    """The positions of the cells on which others depend, directly or through other cells.

    Args:
        cells: What `analyse` found in each cell of code, by position.
        places: The positions of the others, which are returned as well.
    """
    binders: dict[str, list[int]] = {}
    for k, cell in cells.items():
        for name in cell["binds"]:
            binders.setdefault(name, []).append(k)
    needed, waiting = {*places}, [*places]
    while waiting:
        for name in cells[waiting.pop()]["uses"]:
            found = {*binders.pop(name, ())} - needed
            needed |= found
            waiting += found
    return needed


def cells_that_count(cells: Cells, asked: Iterable[str]) -> dict[int, Analysis]:
    """The cells of code that matter in marking: all but given ones on which no answer depends.

    Args:
        cells: The cells of the notebook.
        asked: The names of its questions.
    """
    code = _code(cells)
    needed = needed_cells(code, (k for name in asked for k in _answering(cells, name)[-1:]))
    given = {k for k in code if kind(cells[k]) == "walk" and not is_edited(cells[k])}
    return {k: found for k, found in code.items() if k in needed or k not in given}


def changed_since(cells: Cells, question: str) -> bool:
    """Whether an answer, or what it uses, was changed after its check."""
    judged, (check, _) = last_judged(cells, question), _last_check(cells, question)
    above = [cells[k]["source"] for k in _code(cells) if k <= check]
    below = [cells[k]["source"] for k in _code(cells) if k > check]
    # The cells below may have run before the check, and those above once more after them.
    orders = above, above + below, below + above
    same = [answer_hash(order, question) for order in orders]
    return bool(judged) and judged not in same


def answer_hash(sources: Iterable[str], question: str) -> str:
    """A short hash of an answer, of what it uses, and of what changes that; "" without one.

    Args:
        sources: The texts of the cells, in the order in which they ran.
        question: The question's name.
    """
    last, found = _last_parts(map(analyse, sources)), dict[str, str]()
    waiting = [question]
    while waiting:
        if (name := waiting.pop()) in last and name not in found:
            parts = last[name].values()
            found[name] = " ".join(part["mean"].get(name, part["text"]) for part in parts)
            waiting += [x for part in parts for x in part["outside"]]
    text = "\n".join(f"{name} {found[name]}" for name in sorted(found))
    return hashlib.sha256(text.encode()).hexdigest()[:12] if question in found else ""


def _last_parts(cells: Iterable[Analysis]) -> dict[str, dict[str, _Part]]:
    """For each name its last definition and what changes that at once, each statement by its text.

    A stub does not replace an answer.
    """
    last: dict[str, dict[str, _Part]] = {}
    for part in (part for cell in cells for part in cell["definitions"]):
        binds, fills = {*part["binds"]}, {*part["fills"]}
        roots = {x.partition(".")[0] for x in part["changes"]} & fills  # `x[k] = 1`
        changes = {x for x in roots if not any(x in y["mean"] for y in last.get(x, {}).values())}
        changes |= binds & fills - {*part["later"]}  # `x += 1`, but not `def f(): f.calls += 1`
        for name in binds | changes:
            if name in changes and name in last:
                last[name][part["text"]] = part
            elif name in binds and (not part["stub"] or name not in last):
                last[name] = {part["text"]: part}
    return last


def judged_another(cells: Cells, question: str, asked: Collection[str]) -> Iterator[str]:
    """Why a check judged another answer than the one that will be marked, as sentences.

    Args:
        cells: The cells of the notebook.
        question: The question's name.
        asked: The names of all questions.
    """
    count, written = cells_that_count(cells, asked), _answering(cells, question)
    check, tried = _last_check(cells, question)
    if tried not in ("", question):
        rename = f", or rename {tried} to {question} and check it again"
        yield (
            f"the check of {question} tried {textwrap.shorten(tried, 60, placeholder=' ...')}, but "
            f"{question} is marked; check {question} itself{rename if tried.isidentifier() else ''}"
        )
    parts = _parts(count)
    own = [(k, part) for k, part in parts if question in part["binds"] and k in written]
    above = [pair for pair in own if pair[0] <= check]
    if not above:
        return
    if not _same(question, above[-1][1], own[-1][1]):
        yield (
            f"{the_cell(cells[own[-1][0]]['source'])} defines {question} again below its check, "
            "and that later one is marked; delete it, or check again below it"
        )
        return
    for k, found in count.items():
        if written[-1] < k <= check and question in {*found["binds"]} - {*found["stubs"]}:
            yield (
                f"the check of {question} tried what {the_cell(cells[k]['source'])} defines, but "
                f"{the_cell(cells[written[-1]]['source'])} is marked; write your answer there"
            )
    anew: dict[tuple[int, str, str], list[str]] = {}
    for name, place, does, instead in _used_anew(parts, above[-1][1], check):
        anew.setdefault((place, does, instead), []).append(name)
    for (place, does, instead), names in anew.items():
        those = "those" if names[1:] else f"that {names[0]}"
        yield (
            f"{question} uses {listed(names)}, which {the_cell(cells[place]['source'])} "
            f"{does} below the check, and {question} is marked with {those}; {instead}, or check "
            f"{question} again below it"
        )


def defined_late(cells: Cells, question: str, asked: Collection[str]) -> Iterator[str]:
    """Sentences about an answer, and names that it uses later, that only a later cell defines.

    Args:
        cells: The cells of the notebook.
        question: The question's name.
        asked: The names of all questions.
    """
    parts, (check, _) = _parts(cells_that_count(cells, asked)), _last_check(cells, question)
    answers = _known(parts, question, check)
    used = [name for answer in answers for name in _used_later(_met(parts, answer, check))]
    for name in used if answers else [question]:
        stars = [k for k, part in parts if _binds(part, "*")]  # any of them may define the name
        late = [k for k, part in parts if _binds(part, name)] or stars
        if late and min([late[0], *stars]) > check and not hasattr(builtins, name):
            uses = f", which {question} uses" if answers else ""
            yield (
                f"only {the_cell(cells[late[0]]['source'])} defines {name}{uses}, and it is below "
                f"the check of {question}; move it above the check, so that the check can try "
                "the answer (it is marked all the same)"
            )


def _used_anew(
    parts: Sequence[tuple[int, _Part]], answer: _Part, check: int
) -> Iterator[tuple[str, int, str, str]]:
    """Names that an answer uses when it is called, and that a cell below its check makes another.

    What the answer changes itself, such as a record of its calls, may be changed.

    Yields:
        The name, the position of the last such cell, what it does, and what to do instead.
    """
    met = _met(parts, answer, check)
    uses, fills = ({x for part in met for x in part[key]} for key in ("uses", "fills"))
    for name in _used_later(met):
        known = _known(parts, name, check)
        module = any(name in part["mean"] for part in known)
        for k, part in reversed([pair for pair in parts if pair[0] > check]):
            changes = {x for x in part["changes"] if x.partition(".")[0] == name}
            if module:  # `np.pi = 3` changes what uses np.pi, but `np.append` changes nothing
                changes = (changes & uses) - {name}
            if _binds(part, name):
                if not _same(name, known[0], part) if known else hasattr(builtins, name):
                    only = "import only the names that you need"
                    rename = only if "*" in part["mean"] else "change one of the two names"
                    yield name, k, "defines again", rename
                break
            if changes and known and name not in fills:
                rename = "do not change it" if module else "give the changed value another name"
                yield min(changes) if module else name, k, "changes", rename
                break


def _met(parts: Sequence[tuple[int, _Part]], answer: _Part, check: int) -> list[_Part]:
    """An answer, and the definitions above its check that it meets when it is called."""
    met, seen, waiting = list[_Part](), set[str](), [answer]
    while waiting:
        met.append(waiting.pop())
        names = {*met[-1]["later"]} - seen
        seen |= names
        waiting += [part for name in names for part in _known(parts, name, check)]
    return met


def _used_later(met: Iterable[_Part]) -> list[str]:
    return sorted({name for part in met for name in part["later"]})


def _known(parts: Sequence[tuple[int, _Part]], name: str, check: int) -> list[_Part]:
    """The last definition of a name at or above a check, if there is one."""
    return [part for k, part in parts if k <= check and _binds(part, name)][-1:]


def _binds(part: _Part, name: str) -> bool:
    """Whether a statement defines a name, and not with an empty stub."""
    return name in part["binds"] and not part["stub"]


def _same(name: str, one: _Part, other: _Part) -> bool:
    """Whether two statements define a name in the same words."""
    same_import = name in one["mean"] and one["mean"][name] == other["mean"].get(name)
    return bool(one["text"] == other["text"] or same_import)


def _parts(code: Mapping[int, Analysis]) -> list[tuple[int, _Part]]:
    """All statements with the positions of their cells."""
    return [(k, _with_all(part)) for k, found in code.items() for part in found["definitions"]]


def _with_all(part: _Part) -> _Part:
    """A statement; an import of everything from a loaded module binds each name, and not "*"."""
    module = part["mean"].get("*", "").removesuffix(".*")
    if module not in sys.modules:
        return part
    found = vars(sys.modules[module])
    names = found.get("__all__") or [x for x in found if x[0] != "_"]
    mean = part["mean"] | {x: _full_name(module, x, found.get(x)) for x in names}
    return {**part, "binds": [*{*part["binds"]} - {"*"}, *names], "mean": mean}


def _full_name(module: str, name: str, thing: object) -> str:
    """The name that an import gives a thing; a module, such as ``np``, has one of its own."""
    return thing.__name__ if isinstance(thing, ModuleType) else f"{module}.{name}"


def _code(cells: Cells) -> dict[int, Analysis]:
    return {k: analyse(x["source"]) for k, x in enumerate(cells) if x["cell_type"] == "code"}


def _answering(cells: Cells, question: str) -> list[int]:
    home = {k for k, cell in enumerate(cells) if grade_id(cell) == question}
    return written_cells(_code(cells), home, question)


def _last_check(cells: Cells, question: str) -> tuple[int, str]:
    """Where a question's last check is, else the end; and what it tries, or ""."""
    for k, found in reversed(_code(cells).items()):
        source, broken = cells[k]["source"], found["broken"]
        calls = [] if broken or question not in source else [*_checks(source, question)]
        if calls:
            return k, ast.unparse(max(calls, key=lambda x: (x.lineno, x.col_offset)))
    return len(cells), ""


def _checks(source: str, question: str) -> Iterator[ast.expr]:
    """What each check of a question in a cell tries."""
    for node in ast.walk(parsed(source)[1]):
        if isinstance(node, ast.Call) and dotted(node.func).rpartition(".")[2] == "check":
            given = dict(zip(("name", "function"), node.args, strict=False))
            given |= {x.arg or "": x.value for x in node.keywords}
            asked, tried = given.get("name"), given.get("function")
            if isinstance(asked, ast.Constant) and asked.value == question and tried:
                yield tried
