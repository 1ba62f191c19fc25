"""Which cells of a submission run, and which functions answer which questions.

Cells are known by the release's manifest: by id, by what they define, by their text.  What a
student's metadata says about points and roles is never read.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Any

from ...course.source import analyse, plain
from ..sandbox.session import Step

Cell = Mapping[str, Any]


@dataclass(frozen=True)
class Plan:
    """What to run, in order.

    Attributes:
        steps: The cells.
        places: For each question, the number of the cell that answers it.
        unread: For each question without one, the texts of its own cells.
        notes: What was unusual, by question; under "" what concerns the whole notebook.
        own: The student's own cells: the released cell ``after`` which each stands, its ``type``
            and ``source``.
        written: For each cell that a person marks, by its name, its text.
        looks: What each step does with names, see `labkit.course.source.analyse`.
        tricks: What in the student's own cells may be a way around a withheld tool, sentences.
    """

    steps: tuple[Step, ...]
    places: Mapping[str, int]
    unread: Mapping[str, str] = field(default_factory=dict)
    notes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    own: tuple[Mapping[str, str], ...] = ()
    written: Mapping[str, str] = field(default_factory=dict)
    looks: tuple[Cell, ...] = ()
    tricks: tuple[str, ...] = ()

    def source(self, question: str) -> str:
        """The text of the cell that answers a question, or is to; empty if there is none."""
        place, unread = self.places.get(question), self.unread.get(question, "")
        return next((step.source for step in self.steps if step.number == place), unread)


def plan(cells: Sequence[Cell], manifest: Sequence[Cell]) -> Plan:
    """Match the cells of a submission with those of the release.

    Args:
        cells: As `sandbox.parse.read` returns them.
        manifest: As `release.manifest` returns it.
    """
    setup = [m["source"] for m in manifest if m["kind"] == "setup" and m["type"] == "code"]
    walk = {_same(m["source"]) for m in manifest if m["kind"] == "walk" and m["type"] == "code"}
    released = _released(manifest)
    notes: dict[str, list[str]] = {}
    places: dict[str, int] = {}
    spare: set[int] = set()
    unread: dict[str, set[int]] = {}
    code = {k: cell for k, cell in enumerate(cells) if cell["type"] == "code"}
    own = {k: cell for k, cell in code.items() if _same(cell["source"]) not in released}
    for m in manifest:
        if m["kind"] == "answer" and "points" not in m:
            said = notes.setdefault(m["grade_id"], [])
            place, others = _answer(own, m, said)
            spare |= others
            if place is not None:
                places[m["grade_id"]] = place
            else:
                unread[m["grade_id"]] = _at_home(own, m)
    in_order = [places[m["grade_id"]] for m in manifest if m.get("grade_id") in places]
    if in_order != sorted(in_order):
        notes.setdefault("", []).append("the cells are in another order than in the release")
    needed = _needed(code, places.values())
    by_hand = {m["grade_id"]: _at(cells, m) for m in manifest if "points" in m}
    known = (*by_hand.values(), *unread.values())
    steps = [Step(k - len(setup), source) for k, source in enumerate(setup)]
    looks: list[Cell] = [analyse(source) for source in setup]
    for k, cell in code.items():
        if (k in own and k not in spare) or (k in needed and _same(cell["source"]) in walk):
            answers = tuple(name for name, place in places.items() if place == k)
            steps.append(Step(k, cell["source"], answers))
            looks.append(cell)
    return Plan(
        tuple(steps),
        places,
        notes={name: tuple(said) for name, said in notes.items() if said},
        unread={name: _together(cells, sorted(found)) for name, found in unread.items()},
        own=tuple(_own(cells, manifest, {*places.values(), *chain(*known)})),
        written={name: _together(cells, found) for name, found in by_hand.items() if found},
        looks=tuple(looks),
        tricks=tuple(f"cell {k + 1} {what}" for k, cell in own.items() for what in cell["tricks"]),
    )


def imports(manifest: Sequence[Cell]) -> tuple[str, ...]:
    """Modules that the release's setup cells import, which every submission runs."""
    found: dict[str, None] = {}
    for m in manifest:
        if m["kind"] == "setup" and m["type"] == "code":
            for node in ast.walk(ast.parse(plain(m["source"]))):
                if isinstance(node, ast.Import):
                    found |= dict.fromkeys(alias.name for alias in node.names)
                elif isinstance(node, ast.ImportFrom) and node.module:
                    found[node.module] = None
    return tuple(found)


def _own(
    cells: Sequence[Cell], manifest: Sequence[Cell], places: set[int]
) -> Iterator[dict[str, str]]:
    """Cells that the release does not have."""
    released, ids, after = _released(manifest), {m["id"] for m in manifest}, ""
    for k, cell in enumerate(cells):
        after = cell["id"] if cell["id"] in ids else after
        if k not in places and cell["source"].strip() and _same(cell["source"]) not in released:
            yield {"after": after, "type": cell["type"], "source": cell["source"]}


def _at(cells: Sequence[Cell], m: Mapping[str, Any]) -> list[int]:
    """Where a cell of the release is in a submission, by its name or its id."""
    named = [k for k, cell in enumerate(cells) if cell["grade_id"] == m["grade_id"]]
    return named or [
        k for k, cell in enumerate(cells) if not cell["grade_id"] and cell["id"] == m["id"]
    ]


def _together(cells: Sequence[Cell], found: Sequence[int]) -> str:
    """The text of cells that are one answer; one that was doubled loses nothing."""
    return "\n\n".join(dict.fromkeys(cells[k]["source"] for k in found))


def _answer(
    own: Mapping[int, Cell], m: Mapping[str, Any], notes: list[str]
) -> tuple[int | None, set[int]]:
    """The cell that answers a question, and empty stubs that must not take its place."""
    name = m["grade_id"]
    at_home = _at_home(own, m)
    defines = {k for k, cell in own.items() if name in cell["functions"]}
    binds = {k for k, cell in own.items() if name in cell["binds"]}
    stubs = {k for k in defines if name in own[k]["stubs"]}
    written = (defines - stubs) or (binds & at_home) - stubs or binds - stubs
    if len(written) > 1:
        notes.append(f"{len(written)} cells define {name}; the last one counts")
    if written:
        place = max(written)
        lonely = {k for k in stubs if len(own[k]["binds"]) == 1}
        if stubs:
            notes.append(f"there is an empty {name} too; it is passed over")
        if place not in at_home:
            notes.append(f"{name} was found by its name, outside its own cell")
        return place, lonely
    if stubs:
        return max(stubs), set()
    home = [own[k] for k in sorted(at_home)]
    why = [
        f"its cell cannot be read by Python: {cell['broken']}" for cell in home if cell["broken"]
    ]
    why += [
        f"its cell begins with %%{cell['magic']}, which keeps what it defines to itself"
        for cell in home
        if cell["magic"]
    ]
    notes.append(f"{name}: {why[0] if why else 'no cell defines it'}")
    return None, set()


def _at_home(own: Mapping[int, Cell], m: Mapping[str, Any]) -> set[int]:
    """Where the cell of a question is, by its name or its id."""
    named = {k for k, cell in own.items() if cell["grade_id"] == m["grade_id"]}
    return named | {k for k, cell in own.items() if not cell["grade_id"] and cell["id"] == m["id"]}


def _needed(code: Mapping[int, Cell], places: Iterable[int]) -> set[int]:
    """Cells that the answers lean on, directly or through one another."""
    binders: dict[str, list[int]] = {}
    for k, cell in code.items():
        for name in cell["binds"]:
            binders.setdefault(name, []).append(k)
    needed, waiting = set(places), list(places)
    while waiting:
        for name in code[waiting.pop()]["uses"]:
            found = set(binders.pop(name, ())) - needed
            needed |= found
            waiting += found
    return needed


def _released(manifest: Sequence[Cell]) -> set[str]:
    """The texts of the release's cells, but for those that students are to change."""
    return {_same(m["source"]) for m in manifest if m["kind"] != "answer"}


def _same(source: str) -> str:
    """A cell's text without what editors change unasked."""
    return "\n".join(line.rstrip() for line in source.replace("\r\n", "\n").strip().split("\n"))
