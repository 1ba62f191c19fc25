"""Defects in a notebook's cells that the file shows: undefined names, errors, missing answers."""

from __future__ import annotations

import builtins
import itertools
import os
import re
import sys
import textwrap
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, distribution, packages_distributions, requires
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import listed
from .advice import IMPORTS
from .brief import WORDS, words_in_all, words_of
from .checks_file import FILE as CHECKS
from .notebook import cells_made_for, grade_id, is_edited, kind, released
from .own_arm import FILE as ARMS
from .source import analyse, plain
from .unfinished import defined_in

_KNOWN = {*vars(builtins), "get_ipython", "display", "In", "Out", "_", "__", "___", "__file__"}
"""Names that every notebook defines."""
_OWN_ARM = {"my_arm", "my_bug"}
"""Functions that the grader does not run."""
_GIVEN = (
    "you were given this cell as it is, so correct what it uses: your answers and cells, which "
    "must be above it"
)
_SETUP = "leave it as you were given it, restart the kernel and run all cells"
_STOPPED = {"walk": _GIVEN, "check": _GIVEN, "setup": _SETUP}
"""What to do about a given cell that stopped, by its kind."""
_FILE = re.compile(r"""["']([\w ./-]+\.\w+)["']""")
"""A text that may name a file."""
_ANYWHERE = {*sys.stdlib_module_names, *(re.split("[ .]", line)[1] for line in IMPORTS.values())}
"""Modules that every notebook may import."""


def _code(cells: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """The cells of code, but no text that became code, which `review_texts` reports."""
    return [cell for cell in cells if cell["cell_type"] == "code" and kind(cell) != "why"]


def undefined_names(cells: list[dict[str, Any]], asked: Collection[str]) -> Iterator[str]:
    """A sentence for each cell that uses names which no cell defines, or none above it.

    Args:
        cells: The cells of the notebook.
        asked: Names of the questions, which are reported elsewhere.
    """
    code = _code(cells)
    above, written = {*_KNOWN}, set[str]().union(*(defined_in(x["source"]) for x in code))
    if "*" in written:  # an import of everything may define any name
        return
    defined = _KNOWN.union(asked, written)
    for cell in code:
        found = analyse(source := cell["source"])
        parts, uses = found["definitions"], {*found["uses"]}
        # An answer's cell may run once more after all others, so only the rest must find its names.
        others = [part for part in parts if not {*part["binds"]} & {*asked}]
        at_once = {name for part in others for name in {*part["outside"]} - {*part["later"]}}
        early = at_once & uses & written - above
        above |= early | defined_in(source)
        if early and kind(cell) != "check":  # marking runs none, and `defined_late` tells of it
            yield (
                f"{the_cell(source)} uses {listed(sorted(early))}, which only a cell below "
                "it defines; move it below that cell, because cells run from the top when the "
                "notebook is marked"
            )
        names = [name for name in found["uses"] if name not in defined]
        defined.update(names)
        if names:
            yield (
                f"no cell defines {' or '.join(names)}, which {the_cell(source)} uses; "
                f"{'; '.join(dict.fromkeys(map(_todo, names)))}"
            )


def _todo(name: str) -> str:
    """What to do about a name that no cell defines."""
    if name in IMPORTS:
        return f"to use {name}, begin the cell with `{IMPORTS[name]}`"
    if hasattr(np, name):
        return f"if you mean NumPy's {name}, write np.{name}"
    return (
        "if you deleted a given cell, copy it from a fresh copy of the notebook, which is in the "
        "zip that you were given; if you deleted a cell of your own, write it again"
    )


def unreadable(cells: list[dict[str, Any]]) -> Iterator[str]:
    """A sentence for each code cell that Python cannot read."""
    for cell in _code(cells):
        if broken := analyse(cell["source"])["broken"]:
            yield (
                f"Python cannot read {the_cell(cell['source'])} ({_shown(broken, 120)}), so what "
                "it defines earns nothing; correct it, run all cells from the top and save the file"
            )


def calculated_from_runs(sources: Iterable[str], question: str) -> str:
    """A sentence if an answer is calculated from runs of the student's own arm, else "".

    Args:
        sources: The text of the cells, in the order in which they ran.
        question: The name of the answer.
    """
    parts = [part for source in sources for part in analyse(source)["definitions"]]
    waiting = [part for part in parts if question in part["binds"]][-1:]
    seen: set[str] = set()
    while waiting:
        part = waiting.pop()
        if any(name.rpartition(".")[2] in _OWN_ARM for name in part["uses"]):
            return (
                f"{question} is calculated from runs of your arm, which are not repeated when it "
                "is marked; type the value itself"
            )
        leans = {*part["outside"]} - seen
        seen |= leans
        waiting += [other for other in parts if leans.intersection(other["binds"])]
    return ""


def first_error(cells: list[dict[str, Any]]) -> str:
    """A sentence about the first cell that ended with an error, or ""."""
    for cell in _code(cells):
        source, outputs = cell["source"], cell.get("outputs")
        if "hand_in(" in source or analyse(source)["broken"]:  # it runs now; see `unreadable`
            continue
        for output in outputs if isinstance(outputs, list) else ():
            if isinstance(output, dict) and output.get("output_type") == "error":
                told = filter(None, (output.get("ename"), output.get("evalue")))
                says = _shown(": ".join(map(str, told)), 120)
                todo = "" if is_edited(cell) else _STOPPED.get(kind(cell))
                return (
                    f"{the_cell(source)} ended with an error ({says}), and Run All Cells "
                    f"stops there; {todo or 'correct or delete it'}"
                )
    return ""


def the_cell(source: str) -> str:
    """What a sentence calls a cell."""
    return f"the cell that begins with `{_first_line(source)}`"


def _first_line(source: str) -> str:
    """The first line of a cell that is not a comment, shortened."""
    lines = (line.strip() for line in source.splitlines())
    return _shown(next((line for line in lines if line and line[0] != "#"), ""), 60)


def _shown(text: str, most: int) -> str:
    """The text as one line of at most `most` printable characters."""
    text = "".join(x if x.isprintable() else " " for x in text)
    return textwrap.shorten(text, most, placeholder=" ...")


def misnamed(homes: Iterable[dict[str, Any]], question: str, prediction: bool) -> str:
    """A sentence if a question's own cells hold code that does not define it, else "".

    Of a prediction the sentence gives the line, so its cell may also be empty.
    """
    sources = [cell["source"] for cell in homes]
    found = [name for x in sources for name in analyse(x)["functions"] or sorted(defined_in(x))]
    if prediction and sources and not found:
        return (
            f"the cell of {question} does not define it; write `{question} = "
            f'predict("{question}", ...)` there, with your prediction in place of the dots'
        )
    if not found and not any(analyse(x)["broken"] for x in sources):
        return ""
    but = f", but {', '.join(found)}" if found else ""
    return f"the cell of {question} does not define {question}{but}; write the name as in the task"


def left_behind(folder: Path, cells: Iterable[dict[str, Any]]) -> tuple[list[str], list[str]]:
    """Problems about modules, and notes about files and libraries, that marking may lack.

    Args:
        folder: The folder of the notebook.
        cells: The cells of the notebook.
    """
    sources = [x["source"] for x in _code(cells) if not analyse(x["source"])["broken"]]
    parts = [part for source in sources for part in analyse(source)["definitions"]]
    roots = {full.partition(".")[0] for part in parts for full in part["mean"].values()}
    modules = [x for x in sorted(roots) if (folder / f"{x}.py").is_file() or (folder / x).is_dir()]
    named = {name for x in sources for name in _FILE.findall(plain(x))}
    files = [x for x in sorted(named - {ARMS, CHECKS}) if os.path.isfile(folder / x)]
    foreign = roots - _ANYWHERE - {*modules}
    return [
        f"{name} is a module of yours, and only the notebook is handed in; copy what you import "
        "from it into a cell, and delete the import"
        for name in modules
    ], [
        f"only the notebook is handed in, without {name}; an answer that reads it earns nothing"
        for name in files
    ] + [
        f"{name} does not come with labkit and may be missing where your notebook is marked; an "
        "answer that needs it then earns nothing, so do without it, or ask your instructor"
        for name in sorted(foreign and foreign - _comes_with_labkit())
    ]


def _comes_with_labkit() -> set[str]:
    """The modules of labkit and of all packages that it requires."""
    waiting, names = ["labkit"], set[str]()
    for one in waiting:  # the list grows
        with suppress(PackageNotFoundError):  # what only another system needs
            names.add(distribution(one).name)
            needs = [x for x in requires(one) or () if "extra ==" not in x]
            waiting += {re.split(r"[^\w.-]", x)[0] for x in needs} - {*waiting}
    return {x for x, owners in packages_distributions().items() if names.intersection(owners)}


def how_to_restore(name: str) -> str:
    """How to restore a cell of a notebook."""
    return (
        "To restore its cell, put a fresh copy of the notebook into a folder `fresh` beside this "
        f"file, and run in a new cell: !labkit merge {name}.ipynb fresh/{name}.ipynb --to "
        "again.ipynb (again.ipynb then has the cell and the rest of your work; call it "
        f"{name}.ipynb, and write what the cell lacks, or move it there)"
    )


def review_texts(
    cells: Sequence[dict[str, Any]], asked: Mapping[str, str], name: str
) -> tuple[dict[str, int], list[str], list[str]]:
    """The number of words in each text that a person marks, and problems and notes about them.

    Args:
        cells: The cells of the notebook.
        asked: The id of each text's cell, by its name; empty in an older release.
        name: The notebook's name.
    """
    texts, problems, notes = {}, [], []
    named = {grade_id(cell): "" for cell in cells if kind(cell) == "why" and grade_id(cell)}
    for text, home in (asked or named).items():
        found = cells_made_for(cells, text, home)
        words = texts[text] = len(words_of("\n\n".join(dict.fromkeys(x["source"] for x in found))))
        has = f"{text} has {words_in_all(words)}"
        if not found:
            problems.append(f"no cell holds the text {text}. {how_to_restore(name)}")
        elif words < WORDS[0] and (loose := _loose_text(cells, found[0])):
            problems.append(
                f"{has}, but the text that begins with `{_first_line(loose)}` is in a cell beside "
                f"it; only the cell of {text} is read, so cut the text out and paste it there"
            )
        elif words < WORDS[0]:
            notes.append(f"{has}; it needs at least {WORDS[0]}")
        else:
            most = re.search(r"(\d+) words", cells[cells.index(found[0]) - 1]["source"])
            if most and words > int(most[1]):
                notes.append(f"{has}; it may have at most {most[1]}")
        if any(cell["cell_type"] == "code" for cell in found):
            problems.append(
                f"the cell of {text} is code now, so Run All Cells stops there; click on it, press "
                "Esc and then M (its text counts all the same)"
            )
        if len(found) > 1:
            notes.append(f"there are {len(found)} cells of {text}; all of them count")
    return texts, problems, notes


def _loose_text(cells: Sequence[dict[str, Any]], home: dict[str, Any]) -> str:
    """A text as long as a why in a cell that belongs to no release, beside the cell made for it."""
    at = cells.index(home)
    for side in (reversed(cells[:at]), cells[at + 1 :]):
        for cell in itertools.takewhile(lambda x: not (grade_id(x) or released(x)), side):
            if cell["cell_type"] == "markdown" and len(words_of(cell["source"])) >= WORDS[0]:
                return str(cell["source"])
    return ""
