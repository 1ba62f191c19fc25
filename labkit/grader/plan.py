"""Plan which cells of a submission run, and which cell answers which question.

Cells are matched with the release's manifest by their name, their id, the names that they define
and their text.  What a student's metadata says about points and roles is never read.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..course.source import analyse, imported, plain
from .sandbox.session import Step

Cell = Mapping[str, Any]
Cells = Mapping[int, Cell]
"""Cells by their position in the submission."""


@dataclass(frozen=True)
class Plan:
    """What runs, in order.

    Attributes:
        steps: The cells to run.
        looks: How each step uses names; see `labkit.course.source.analyse`.
        places: For each question, the number of the cell that answers it.
        unread: For each question that no cell answers, the text of the cells meant for it.
        notes: For each question what was unusual, in a sentence.
        own: The student's own cells, each with its ``type``, its ``source`` and the released cell
            ``after`` which it comes.
        written: The text of each cell that a person marks, by the name of the cell.
    """

    steps: tuple[Step, ...]
    looks: tuple[Cell, ...]
    places: Mapping[str, int]
    unread: Mapping[str, str] = field(default_factory=dict)
    notes: Mapping[str, str] = field(default_factory=dict)
    own: tuple[Mapping[str, str], ...] = ()
    written: Mapping[str, str] = field(default_factory=dict)

    def source(self, question: str) -> str:
        """The text of the cell that answers a question or is meant to; empty if there is none."""
        place, unread = self.places.get(question), self.unread.get(question, "")
        return next((step.source for step in self.steps if step.number == place), unread)

    def uses(self, question: str) -> set[str]:
        """Names outside its cell that an answer uses, and questions that it asks `use` about."""
        parts = [part for cell in self.looks for part in cell["definitions"]]
        mine = [x["outside"] for x in parts if question in x["binds"] and not x["stub"]]
        names = {*mine[-1]} if mine else set[str]()
        return names | {x for part in parts if names & {*part["binds"]} for x in part["asks"]}

    def emptied(self) -> set[str]:
        """The questions that no cell answers, and in whose own cell are at most comments."""
        lines = {name: text.split("\n") for name, text in self.unread.items()}
        return {k for k, v in lines.items() if all(x.lstrip()[:1] in {"", "#"} for x in v)}


def plan(cells: Sequence[Cell], manifest: Sequence[Cell]) -> Plan:
    """Match the cells of a submission with those of the release.

    Args:
        cells: As `sandbox.parse.read` returns them.
        manifest: As `release.manifest` returns it.
    """
    setup = _setup(manifest)
    released = {_strip(m["source"]) for m in manifest if m["kind"] != "answer"}
    walk = {_strip(m["source"]) for m in manifest if m["kind"] == "walk"}
    code = {k: cell for k, cell in enumerate(cells) if cell["type"] == "code"}
    own = {k: cell for k, cell in code.items() if _strip(cell["source"]) not in released}
    places: dict[str, int] = {}
    notes: dict[str, str] = {}
    unread: dict[str, list[int]] = {}
    written: dict[str, list[int]] = {}
    ignored: set[int] = set()
    for m in manifest:
        name = m.get("grade_id", "")
        if "points" in m:  # a person marks it
            written[name] = _made_for(dict(enumerate(cells)), m)
        if "points" in m or m["kind"] != "answer":
            continue
        home = _made_for(own, m)
        stubs = [k for k, cell in own.items() if name in cell["stubs"]]
        answers = _answers(own, home, name)
        if answers:
            ignored |= {k for k in stubs if len(own[k]["binds"]) == 1}
        if answers or stubs:
            places[name] = (answers or stubs)[-1]
        else:
            unread[name] = home
        if note := _note(name, answers or stubs, [own[k] for k in home]):
            notes[name] = note
    needed = _needed(code, places.values())
    runs = {k: cell for k, cell in code.items() if k in own.keys() - ignored
            or (k in needed and _strip(cell["source"]) in walk)}  # fmt: skip
    steps = [Step(k - len(setup), source) for k, source in enumerate(setup)]
    for k, cell in runs.items():
        steps.append(Step(k, cell["source"], tuple(x for x, place in places.items() if place == k)))
    known = {*places.values()}.union(*unread.values(), *written.values())
    texts = {k: dict.fromkeys(cells[i]["source"] for i in v) for k, v in (unread | written).items()}
    joined = {name: "\n\n".join(found) for name, found in texts.items() if found}
    return Plan(
        tuple(steps),
        (*map(analyse, setup), *runs.values()),
        places,
        {name: joined[name] for name in unread if name in joined},
        notes,
        tuple(_own_cells(cells, {m["id"] for m in manifest}, released, known)),
        {name: joined[name] for name in written if name in joined},
    )


def imports(manifest: Sequence[Cell]) -> tuple[str, ...]:
    """Modules that the setup cells of the release import; every submission runs these cells."""
    nodes = [x for source in _setup(manifest) for x in ast.walk(ast.parse(plain(source)))]
    found = [name.rpartition(".")[0] if isinstance(x, ast.ImportFrom) else name
             for x in nodes for name in imported(x).values()]  # fmt: skip
    return tuple(dict.fromkeys(found))


def _setup(manifest: Sequence[Cell]) -> list[str]:
    """The texts of the setup cells of the release."""
    return [m["source"] for m in manifest if m["kind"] == "setup" and m["type"] == "code"]


def _answers(own: Cells, home: Sequence[int], name: str) -> list[int]:
    """The positions of the cells that answer a question; the last one counts.

    An empty stub answers nothing.  A function counts in any cell; a value counts in another cell
    only if the one that was made for it does not define it.
    """
    binds = [k for k, cell in own.items() if name in cell["binds"] and name not in cell["stubs"]]
    functions = [k for k in binds if name in own[k]["functions"]]
    return functions or [k for k in binds if k in home] or binds


def _note(name: str, found: Sequence[int], home: Sequence[Cell]) -> str:
    """What was unusual about the cells that answer a question, and those that were made for it."""
    if len(found) > 1:
        return f"{len(found)} cells define {name}; the last one counts"
    if found:
        return ""
    for cell in home:
        if cell["broken"]:
            return f"{name}: its cell cannot be read by Python: {cell['broken']}"
        if cell["magic"]:
            return f"{name}: its cell begins with %%{cell['magic']}, which keeps names to itself"
    return f"{name}: no cell defines it"


def _needed(code: Cells, places: Iterable[int]) -> set[int]:
    """The positions of the cells on which others depend, directly or through other cells."""
    binders: dict[str, set[int]] = {}
    for k, cell in code.items():
        for name in cell["binds"]:
            binders.setdefault(name, set()).add(k)
    needed, waiting = {*places}, [*places]
    while waiting:
        for name in code[waiting.pop()]["uses"]:
            found = binders.pop(name, set()) - needed
            needed |= found
            waiting += found
    return needed


def _own_cells(
    cells: Sequence[Cell], ids: set[str], released: set[str], known: set[int]
) -> Iterator[dict[str, str]]:
    """Cells that the release does not have, and that answer nothing."""
    after = ""
    for k, cell in enumerate(cells):
        after = cell["id"] if cell["id"] in ids else after
        if k not in known and cell["source"].strip() and _strip(cell["source"]) not in released:
            yield {"after": after, "type": cell["type"], "source": cell["source"]}


def _made_for(cells: Cells, m: Cell) -> list[int]:
    """The positions of the cells that were made for a cell of the release, by its name or id."""
    named = [k for k, cell in cells.items() if cell["grade_id"] == m["grade_id"]]
    nameless = [k for k, x in cells.items() if not x["grade_id"] and x["id"] == m["id"]]
    return named or nameless


def _strip(source: str) -> str:
    """The text of a cell without the white space that editors change on their own."""
    return "\n".join(line.rstrip() for line in source.replace("\r\n", "\n").strip().split("\n"))
