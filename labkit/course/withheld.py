"""Tools that a question asks students to write, so its answer may not use them.

Only the answer's own text is searched, in the notebook and by the grader alike.  This tells honest
students; whoever hides a tool from it is asked about the answer in the defence.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from .source import Analysis


def name_in_notebook(tool: str) -> str:
    """The name of a tool in a notebook, such as "lk.Circle"."""
    return f"lk.{tool.removeprefix('labkit.')}" if tool.startswith("labkit.") else tool


def withheld_tools(cells: Iterable[Analysis], name: str, tools: Sequence[str]) -> tuple[str, ...]:
    """The withheld tools that an answer uses.

    Args:
        cells: What `source.analyse` returned for each cell, in the order in which they run.
        name: The answer's name.
        tools: Dotted names of the withheld tools, such as "labkit.Circle" or "pinocchio".

    Returns:
        Those that are used, in the order given.  A method such as "labkit.Model.gravity" is used
        where an attribute has its name.
    """
    parts = [part for cell in cells for part in cell["definitions"]] if tools else []
    means = {key: full for part in parts for key, full in part["mean"].items()}
    mine: Mapping[str, Any] = {"uses": (), "attributes": (), "mean": {}}
    for part in parts:
        if name in part["binds"] and not (part["stub"] and mine["uses"]):
            mine = part
    used = [*_full_names(mine["uses"], means | mine["mean"])]
    return tuple(tool for tool in tools if _is_used(tool, used, mine["attributes"]))


def _full_names(chains: Iterable[str], means: Mapping[str, str]) -> Iterator[set[str]]:
    """The parts of each dotted name, whose first part is replaced by what was imported as it."""
    for chain in chains:
        root, *rest = chain.split(".")
        star = means.get("*", "").replace("*", root)
        yield {*means.get(root, star).split("."), *rest}


def _is_used(tool: str, used: Iterable[set[str]], attributes: Iterable[str]) -> bool:
    """Whether a tool is meant by its own name or by that of the module that defines it."""
    first, *rest = tool.split(".")
    if rest[1:] and rest[0][0].isupper():  # a function of the library may share a method's name
        functions = (p for p in used if {first, rest[-1]} <= p and rest[0] not in p)
        return rest[-1] in attributes and not any(functions)
    return any({first, *rest[-1:]} <= parts for parts in used)
