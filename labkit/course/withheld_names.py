"""Which tools that a question withholds does an answer use, as far as its text tells?

It reads the answer's definition, and those of the names that it leans on, in whatever cell.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import ModuleType
from typing import Any

from .source import Look
from .withheld import find


def withheld_tools(cells: Iterable[Look], name: str, withheld: Sequence[str]) -> tuple[str, ...]:
    """The withheld tools that an answer uses.

    What is reached through an instance, such as ``model.gravity``, only a call can tell; see
    `withheld.withhold`.

    Args:
        cells: What `cells.look` found in each cell, in the order in which they run.
        name: The answer's name.
        withheld: Dotted names, such as "labkit.Circle" or "pinocchio".

    Returns:
        Those that are used, in the order given.
    """
    if not withheld:
        return ()
    used = set(_used(_last_definitions(cells), name))
    return tuple(tool for tool in withheld if any(_is(tool, other) for other in used))


def _last_definitions(cells: Iterable[Look]) -> dict[str, Mapping[str, Any]]:
    """What each name means at the end; an empty stub takes no answer's place."""
    means: dict[str, Mapping[str, Any]] = {}
    for cell in cells:
        for definition in cell["definitions"]:
            for name in definition["binds"]:
                if not definition["stub"] or name not in means:
                    means[name] = definition
    return means


def _used(means: Mapping[str, Mapping[str, Any]], name: str) -> Iterator[str]:
    """Everything that a name's definition uses, directly or through others, by its full name."""
    imports = {key: d["mean"][key] for key, d in means.items() if key in d["mean"]}
    waiting, seen = [name], {name}
    while waiting:
        definition = means.get(waiting.pop())
        if definition is None:
            continue
        for chain in definition["uses"]:
            root, dot, rest = chain.partition(".")
            home = definition["mean"].get(root, imports.get(root))
            if home is None and root not in means and "*" in imports:
                home = imports["*"].removesuffix("*") + root
            if home is not None:
                yield f"{home}{dot}{rest}"
            elif root not in seen:
                seen.add(root)
                waiting.append(root)


def _is(tool: str, other: str) -> bool:
    """Whether a dotted name is a withheld tool's, or a part of it, or another name of it."""
    if _within(other, tool):
        return True
    if other.partition(".")[0] != tool.partition(".")[0]:
        return False
    target = find(tool)[1]
    for thing in _loaded(other):
        if isinstance(target, ModuleType):
            home = getattr(thing, "__module__", None)
            if isinstance(home, str) and _within(home, tool):
                return True
        elif thing is not None and thing is target:
            return True
    return False


def _within(name: str, whole: str) -> bool:
    return name == whole or name.startswith(f"{whole}.")


def _loaded(name: str) -> Iterator[Any]:
    """The things along a dotted name; no module is imported for it."""
    first, *parts = name.split(".")
    thing: Any = sys.modules.get(first)
    for part in parts:
        if not isinstance(thing, ModuleType | type):
            return
        thing = getattr(thing, part, None)
        yield thing
