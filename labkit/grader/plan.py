"""Plan which cells of a submission run, and which functions answer which questions.

Cells are matched with the release's manifest by their id, by the names that they define and by
their text.  What a student's metadata says about points and roles is never read.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Any

from ..course.source import analyse, plain
from ..errors import listed
from .sandbox.session import Step

Cell = Mapping[str, Any]


@dataclass(frozen=True)
class Plan:
    """What runs, in order.

    Attributes:
        steps: The cells to run.
        places: For each question, the number of the cell that answers it.
        unread: For each question that no cell answers, the text of the cells meant for it, if any.
        notes: What was unusual, by question; under "" what concerns the whole notebook.
        own: The student's own cells, each with its ``type``, its ``source`` and the released cell
            ``after`` which it comes.
        written: The text of each cell that a person marks, by the name of the cell.
        looks: How each step uses names; see `labkit.course.source.analyse`.
    """

    steps: tuple[Step, ...]
    places: Mapping[str, int]
    unread: Mapping[str, str] = field(default_factory=dict)
    notes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    own: tuple[Mapping[str, str], ...] = ()
    written: Mapping[str, str] = field(default_factory=dict)
    looks: tuple[Cell, ...] = ()

    def source(self, question: str) -> str:
        """The text of the cell that answers a question or is meant to; empty if there is none."""
        place, unread = self.places.get(question), self.unread.get(question, "")
        return next((step.source for step in self.steps if step.number == place), unread)

    def causes(self, question: str, wrong: set[str], passed: set[str]) -> Iterator[str]:
        """Notes on an answer that is not right and uses others that are not, or their stand-ins.

        Args:
            question: The question that it answers.
            wrong: The questions whose answers are not right.
            passed: Those whose answers are right on all public cases, so that `use` returns them.
        """
        if question not in wrong:
            return
        parts = [part for cell in self.looks for part in cell["definitions"]]
        mine = [x["outside"] for x in parts if question in x["binds"] and not x["stub"]]
        names = {*mine[-1]} if mine else set[str]()
        asked = {x for part in parts if names & {*part["binds"]} for x in part["asks"]}
        if own := sorted((names | asked & passed) & wrong - {question}):
            is_, it = ("are", "them") if own[1:] else ("is", "it")
            yield f"it uses your {listed(own)}, which {is_} not right either; correct {it} first"
        if replaced := sorted(asked & self.places.keys() - passed):
            it = "them" if replaced[1:] else "it"
            yield f"it uses a stand-in for your {listed(replaced)}; correct {it} first"

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
    setup = [m["source"] for m in manifest if m["kind"] == "setup" and m["type"] == "code"]
    walk = {_strip(m["source"]) for m in manifest if m["kind"] == "walk" and m["type"] == "code"}
    released = _released(manifest)
    notes: dict[str, list[str]] = {}
    places: dict[str, int] = {}
    ignored: set[int] = set()
    unread: dict[str, set[int]] = {}
    code = {k: cell for k, cell in enumerate(cells) if cell["type"] == "code"}
    own = {k: cell for k, cell in code.items() if _strip(cell["source"]) not in released}
    for m in manifest:
        if m["kind"] == "answer" and "points" not in m:
            said = notes.setdefault(m["grade_id"], [])
            place, others = _answer(own, m, said)
            ignored |= others
            if place is not None:
                places[m["grade_id"]] = place
            elif home := _home_cells(own, m):
                unread[m["grade_id"]] = home
    in_order = [places[m["grade_id"]] for m in manifest if m.get("grade_id") in places]
    if in_order != sorted(in_order):
        notes.setdefault("", []).append("the cells are in another order than in the release")
    needed = _needed_cells(code, places.values())
    by_hand = {m["grade_id"]: _find_cells(cells, m) for m in manifest if "points" in m}
    known = (*by_hand.values(), *unread.values())
    steps = [Step(k - len(setup), source) for k, source in enumerate(setup)]
    looks: list[Cell] = [analyse(source) for source in setup]
    for k, cell in code.items():
        if (k in own and k not in ignored) or (k in needed and _strip(cell["source"]) in walk):
            answers = tuple(name for name, place in places.items() if place == k)
            steps.append(Step(k, cell["source"], answers))
            looks.append(cell)
    return Plan(
        tuple(steps),
        places,
        notes={name: tuple(said) for name, said in notes.items() if said},
        unread={name: _join_sources(cells, sorted(found)) for name, found in unread.items()},
        own=tuple(_own_cells(cells, manifest, {*places.values(), *chain(*known)})),
        written={name: _join_sources(cells, found) for name, found in by_hand.items() if found},
        looks=tuple(looks),
    )


def _written_cells(cells: Mapping[int, Cell], home: Collection[int], name: str) -> list[int]:
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


def _needed_cells(cells: Mapping[int, Cell], places: Iterable[int]) -> set[int]:
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


def imports(manifest: Sequence[Cell]) -> tuple[str, ...]:
    """Modules that the setup cells of the release import; every submission runs these cells."""
    found: dict[str, None] = {}
    for m in manifest:
        if m["kind"] == "setup" and m["type"] == "code":
            for node in ast.walk(ast.parse(plain(m["source"]))):
                if isinstance(node, ast.Import):
                    found |= dict.fromkeys(alias.name for alias in node.names)
                elif isinstance(node, ast.ImportFrom) and node.module:
                    found[node.module] = None
    return tuple(found)


def _own_cells(
    cells: Sequence[Cell], manifest: Sequence[Cell], places: set[int]
) -> Iterator[dict[str, str]]:
    """Cells that the release does not have."""
    released, ids, after = _released(manifest), {m["id"] for m in manifest}, ""
    for k, cell in enumerate(cells):
        after = cell["id"] if cell["id"] in ids else after
        if k not in places and cell["source"].strip() and _strip(cell["source"]) not in released:
            yield {"after": after, "type": cell["type"], "source": cell["source"]}


def _find_cells(cells: Sequence[Cell], m: Mapping[str, Any]) -> list[int]:
    """The positions in a submission of a cell of the release, found by its name or its id."""
    named = [k for k, cell in enumerate(cells) if cell["grade_id"] == m["grade_id"]]
    return named or [
        k for k, cell in enumerate(cells) if not cell["grade_id"] and cell["id"] == m["id"]
    ]


def _join_sources(cells: Sequence[Cell], found: Sequence[int]) -> str:
    """The text of the cells that make one answer; the text of a duplicated cell occurs once."""
    return "\n\n".join(dict.fromkeys(cells[k]["source"] for k in found))


def _answer(
    own: Mapping[int, Cell], m: Mapping[str, Any], notes: list[str]
) -> tuple[int | None, set[int]]:
    """The cell that answers a question, and the empty stubs that must not replace it."""
    name = m["grade_id"]
    home = _home_cells(own, m)
    stubs = {k for k, cell in own.items() if name in cell["stubs"]}
    written = _written_cells(own, home, name)
    if len(written) > 1:
        notes.append(f"{len(written)} cells define {name}; the last one counts")
    if written:
        place = written[-1]
        stub_only = {k for k in stubs if len(own[k]["binds"]) == 1}
        if stubs:
            notes.append(f"there is an empty {name}, too; it is ignored")
        if place not in home:
            notes.append(f"{name} was found by its name, outside its own cell")
        return place, stub_only
    if stubs:
        return max(stubs), set()
    cells = [own[k] for k in sorted(home)]
    why = [
        f"its cell cannot be read by Python: {cell['broken']}" for cell in cells if cell["broken"]
    ]
    why += [
        f"its cell begins with %%{cell['magic']}, so the notebook does not see what it defines"
        for cell in cells
        if cell["magic"]
    ]
    notes.append(f"{name}: {why[0] if why else 'no cell defines it'}")
    return None, set()


def _home_cells(own: Mapping[int, Cell], m: Mapping[str, Any]) -> set[int]:
    """The positions of the cells meant for a question, found by name or by id."""
    named = {k for k, cell in own.items() if cell["grade_id"] == m["grade_id"]}
    return named | {k for k, cell in own.items() if not cell["grade_id"] and cell["id"] == m["id"]}


def _released(manifest: Sequence[Cell]) -> set[str]:
    """The texts of the cells of the release that students are not meant to change."""
    return {_strip(m["source"]) for m in manifest if m["kind"] != "answer"}


def _strip(source: str) -> str:
    """The text of a cell without the white space that editors change on their own."""
    return "\n".join(line.rstrip() for line in source.replace("\r\n", "\n").strip().split("\n"))
