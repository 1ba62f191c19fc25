"""The special kinds of submissions in a synthetic class, with typical faults and attacks."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from labkit.course.notebook import kind

if TYPE_CHECKING:
    from . import Draft

Kind = Callable[[Any], None]


def _perfect(draft: Draft) -> None:
    draft.solve()


def _variant(draft: Draft) -> None:
    for name, problem in draft.problems.items():
        draft.answer_with(name, [*problem.variants, problem.answer][0])
    draft.commit()


def _blank(draft: Draft) -> None:
    """The notebook as students receive it."""


def _emptied(draft: Draft) -> None:
    for name in draft.problems:
        draft.answer(name, "", 0.0)


def _mistaken(number: int) -> Kind:
    """Everything wrong, each question with its n-th mistake."""

    def make(draft: Draft) -> None:
        for name, problem in draft.problems.items():
            choices = [wrong.function for wrong in problem.wrong] or [problem.answer]
            draft.answer_with(name, choices[number % len(choices)])

    return make


def _warns(draft: Draft) -> None:
    """All right, with output on every channel."""
    draft.solve()
    for name in draft.problems:
        cell = draft.cells[draft.place(name)]
        cell["source"] = cell["source"].replace(
            "(*args, **kwargs):\n    return",
            "(*args, **kwargs):\n    import os, sys, warnings\n    warnings.warn('careful')\n"
            "    print('here'); print('there', file=sys.stderr); os.write(2, b'below')\n    return",
        )


def _reordered(draft: Draft) -> None:
    """All right, with the cells in reverse order."""
    draft.solve()
    draft.cells.reverse()


def _duplicated(draft: Draft) -> None:
    """All right, with every answer twice under the same name."""
    draft.solve()
    for name in draft.problems:
        place = draft.place(name)
        draft.cells.insert(place, draft.cells[place])


def _copied_stub(draft: Draft) -> None:
    """All right, with the empty stub pasted below one answer."""
    name = next(iter(draft.problems))
    stub = dict(draft.cells[draft.place(name)])
    draft.solve()
    draft.cells.insert(draft.place(name) + 1, stub)


def _deleted(draft: Draft) -> None:
    """All right, but without the first answer and without the checks."""
    draft.solve()
    name = next(iter(draft.problems))
    del draft.cells[draft.place(name)]
    draft.expected[name] = 0.0
    draft.cells = [cell for cell in draft.cells if kind(cell) != "check"]


def _renamed(draft: Draft) -> None:
    """All right, under a file name made by a browser."""
    draft.solve()
    draft.name = f"{draft.assignment}(3).ipynb"


def _no_metadata(draft: Draft) -> None:
    """All right, but a converter removed the metadata and the ids."""
    draft.solve()
    for cell in draft.cells:
        cell["metadata"] = {}
        cell.pop("id", None)


def _relabelled(draft: Draft) -> None:
    """All right, with roles and points changed by hand."""
    draft.solve()
    for cell in draft.cells:
        if "nbgrader" in cell["metadata"]:
            cell["metadata"]["nbgrader"] |= {
                "points": 100, "grade": True, "solution": False, "schema_version": 99,
            }  # fmt: skip


def _truncated(draft: Draft) -> None:
    draft.solve()
    draft.data, draft.rejected = draft.bytes()[:-2000], True


def _first_becomes(source: str) -> Kind:
    """All right except for the first question, whose function is given."""

    def make(draft: Draft) -> None:
        draft.solve()
        name = next(iter(draft.problems))
        draft.answer(name, source.replace("NAME", name), 0.0)

    return make


def _right_and(source: str) -> Kind:
    """All right, with a given cell at the start."""

    def make(draft: Draft) -> None:
        draft.solve()
        draft.add(source)

    return make


def _wrong_and(source: str) -> Kind:
    """Nothing answered, with a cell at the start that tries an attack."""

    def make(draft: Draft) -> None:
        draft.add(source)

    return make


_FORGE = """
import json, socket, os, stat
for end in range(3, 64):
    try:
        if stat.S_ISSOCK(os.fstat(end).st_mode):
            os.write(end, b'{"is": 1.0, "earned": 100, "outcome": "right", "over": 0}\\n' * 50)
    except OSError:
        pass
"""

KINDS: dict[str, Kind] = {
    "perfect": _perfect,
    "perfect, in other words": _variant,
    "blank": _blank,
    "emptied": _emptied,
    "mistakes, the first of each": _mistaken(0),
    "mistakes, the second of each": _mistaken(1),
    "mistakes, the third of each": _mistaken(2),
    "warns and prints": _warns,
    "reordered": _reordered,
    "duplicated": _duplicated,
    "stub pasted below an answer": _copied_stub,
    "a cell deleted": _deleted,
    "renamed": _renamed,
    "no metadata": _no_metadata,
    "relabelled": _relabelled,
    "truncated": _truncated,
    "an answer that never ends": _first_becomes(
        "def NAME(*args, **kwargs):\n    while True:\n        pass"
    ),
    "an answer that ends the process": _first_becomes(
        "import os\ndef NAME(*args, **kwargs):\n    os._exit(0)"
    ),
    "an answer that crashes": _first_becomes(
        "import ctypes\ndef NAME(*args, **kwargs):\n    ctypes.string_at(0)"
    ),
    "an answer that takes all memory": _first_becomes(
        "def NAME(*args, **kwargs):\n    return bytearray(6 * 10**9)"
    ),
    "a cell that never ends": _right_and("while True:\n    pass"),
    "a cell that ends the process": _right_and("import os\nos._exit(3)"),
    "a cell with magics and a shell": _right_and("%matplotlib inline\n!ls\n%time 1 + 1"),
    "cheats: patched comparison": _wrong_and(
        "import numpy as np, builtins, labkit.course\n"
        "np.testing.assert_allclose = lambda *a: None\nnp.allclose = lambda *a, **k: True\n"
        "labkit.course.check = lambda *a: 20.0\n"
        "builtins.float = lambda *a: 20.0"
    ),
    "cheats: forged answers": _wrong_and(_FORGE),
    "cheats: a withheld name": _first_becomes(
        "import labkit as lk\ndef NAME(t, T=2.0, *rest):\n    return lk.BangBang(T)(t)"
    ),
    "speaks HTML": _first_becomes(
        "def NAME(*args, **kwargs):\n    raise ValueError('<script>alert(1)</script>')"
    ),
}
"""The kinds by name, as functions that change a fresh copy of the assignment."""
