"""An attack as data: the submission, the points that it deserves, and what it is after.

In its sources {root} is the course's folder; {loot} is a folder, {port} the port of a server and
{marker} an open, locked file, all made by the test.  An attack that obtains something forbidden says
GOT.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from textwrap import indent
from typing import Any

Notebook = dict[str, Any]
QUESTION = "bang_bang"
CANARY = "canary-5816534691"
"""A word that is in every file of a course that no student may read."""

RIGHT = """
def right(t, T):
    if t < 0.0: return 0.0, 0.0, 0.0
    if t >= T: return 1.0, 0.0, 0.0
    a, left = 4.0 / T**2, T - t
    return (a * t**2 / 2.0, a * t, a) if t < T / 2.0 else (1.0 - a * left**2 / 2.0, a * left, -a)
"""
WORTH = 3.0
"""The points for a right answer to the question."""


@dataclass(frozen=True)
class Attack:
    """One attack.

    Attributes:
        wins: What it is after.
        cells: Cells above the answers.
        answer: The source that replaces the first question's function; "" keeps the stub.
        earns: The points that the notebook deserves.
        then: The cell of an accomplice who is graded next.
        shape: A function that makes other changes to the notebook.
    """

    wins: str
    cells: tuple[str, ...] = ()
    answer: str = ""
    earns: float = 0.0
    then: str = ""
    shape: Callable[[Notebook], Notebook] | None = None

    def filled(self, **words: object) -> Attack:
        """The attack with values of the test in place of the words in braces."""

        def fill(source: str) -> str:
            for word, value in words.items():
                source = source.replace("{" + word + "}", str(value))
            return source

        cells, answer, then = tuple(map(fill, self.cells)), fill(self.answer), fill(self.then)
        return replace(self, cells=cells, answer=answer, then=then)

    def planted(self, notebook: Notebook) -> Notebook:
        """A notebook with the attack in it."""
        for cell in notebook["cells"]:
            about = cell["metadata"].get("nbgrader", {})
            if self.answer and about.get("grade_id") == QUESTION and about.get("solution"):
                cell["source"] = disguised(self.answer)
        own = [code_cell(disguised(source), f"own-{k}") for k, source in enumerate(self.cells)]
        notebook["cells"][:0] = own
        return notebook if self.shape is None else self.shape(notebook)

    def accomplice(self, notebook: Notebook) -> Notebook:
        """The notebook of the accomplice who is graded next."""
        notebook["cells"].insert(0, code_cell(disguised(self.then), "own-0"))
        return notebook


def disguised(source: str) -> str:
    """Spell GOT as an expression, because a traceback shows the line that failed."""
    return source.replace("GOT", r"G\x4fT")


def code_cell(source: str, name: str) -> Notebook:
    return {"cell_type": "code", "id": name, "metadata": {}, "source": source,
            "outputs": [], "execution_count": None}  # fmt: skip


def cells(wins: str, **sources: str) -> dict[str, Attack]:
    """Attacks with one cell each."""
    return {spelt(name): Attack(wins, (source,)) for name, source in sources.items()}


def answers(wins: str, **bodies: str) -> dict[str, Attack]:
    """Attacks from within the function, each given as the body of the function."""
    return {spelt(name): Attack(wins, answer=function(body)) for name, body in bodies.items()}


def function(body: str, before: str = "") -> str:
    return f"{before}def {QUESTION}(t, duration):\n{indent(body.strip(), '    ')}\n"


def spelt(name: str) -> str:
    return name.replace("_", " ")
