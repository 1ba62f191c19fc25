"""Classes with a few honest students, in which all others hand in something hostile."""

from __future__ import annotations

import json
import os
import re
import shutil
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from labkit.course.authoring.layout import Course
from labkit.grader.students.roster import Roster, Student, save_roster

from . import hostile
from .attacks.place import handed_out, solved_code

NAME = "01_paths"
SECRET = 1000
"""Moodle's number of the first hostile participant."""
HONEST = ("ada", "kim", "zoe", "carl")
"""Honest students whose folders have their names; carl hands in through the exchange.

Mia Wong comes from Moodle as participant 101 and Ada Lovelace from Canvas as user 7.
"""
HEAD = """import numpy as np
import labkit as lk
from labkit.course.equivalence import Ratio
class Odd:
    def __init__(self, method, error=ZeroDivisionError):
        def fails(*args): raise error('odd')
        self.__class__ = type('Odd', (Odd,), {method: fails})
def tainted(answer, number):
    count = iter(range(10**9))
    def inner(x):
        if isinstance(x, np.ndarray):
            values = [number(v, next(count)) for v in x.ravel().tolist()]
            try: return np.array(values, dtype=float).reshape(x.shape)
            except Exception: return values
        if isinstance(x, tuple):
            return type(x)(*map(inner, x)) if hasattr(x, '_fields') else tuple(map(inner, x))
        if isinstance(x, list): return [inner(v) for v in x]
        if isinstance(x, dict): return {key: inner(v) for key, v in x.items()}
        if isinstance(x, (int, float, np.number)): return number(x, next(count))
        if hasattr(x, '__dict__') or hasattr(x, '__dataclass_fields__'):
            import dataclasses
            return type(x)(**{f.name: inner(getattr(x, f.name)) for f in dataclasses.fields(x)})
        return x
    return inner(answer)
def shout(data):
    import os, stat
    for end in range(3, 64):
        try:
            if not stat.S_ISSOCK(os.fstat(end).st_mode): continue
        except OSError: continue
        left = memoryview(data)
        while left: left = left[os.write(end, left):]
"""


@dataclass(frozen=True)
class Kind:
    """One hostile thing.

    Attributes:
        table: The table of `hostile` that contains the thing.
        name: The name of the thing in that table.
    """

    table: str
    name: str

    @property
    def thing(self) -> Any:
        """The value in the table."""
        return getattr(hostile, self.table)[self.name]

    @cached_property
    def folder(self) -> str:
        """The student whose folder in ``submitted/`` contains the thing."""
        if self.table == "PEOPLE":
            thing = self.thing
            return os.fsdecode(thing) if isinstance(thing, bytes) else thing
        return re.sub(r"\W+", "-", f"{self.table}-{self.name}").lower()

    def __str__(self) -> str:
        return f"{self.table.lower()}: {self.name}"


def kinds(*tables: str) -> list[Kind]:
    """All kinds in some tables."""
    return [Kind(table, name) for table in tables for name in getattr(hostile, table)]


def copied(course: Path, root: Path) -> Path:
    """A copy of a course to which a test may write."""
    shutil.copytree(course, root, symlinks=True)
    return root


def notebook(course: Path, which: str, name: str = NAME) -> hostile.Notebook:
    """A notebook, either "solved" in all its code or "blank" as students receive it."""
    work = {"solved": solved_code, "blank": handed_out}[which](Course(course), name)
    for cell in work["cells"]:
        cell["source"] = "".join(cell["source"])
    return work


def hand_in_honest(course: Path, name: str = NAME) -> None:
    """Hand in the work of three honest students: two solved it, one solved only a part."""
    solved, half = notebook(course, "solved", name), notebook(course, "blank", name)
    right = {who: cell["source"] for who, cell in _answers(solved).items()}
    for number, (question, cell) in enumerate(_answers(half).items()):
        if number < 1:
            cell["source"] = right[question]
        elif number < 3:
            cell["source"] = _wrapped(question, right[question], "2 * x + 1")
    half["cells"].insert(1, _code("head", HEAD))
    for who, work in (("ada", solved), ("kim", solved), ("zoe", half)):
        _put(course / "submitted" / who / name / f"{name}.ipynb", work)


def hand_in(course: Path, kind: Kind, name: str = NAME) -> None:
    """Put the submission of a kind where a person would have put it."""
    put(kind, course, course / "submitted" / kind.folder / name, name)


def put(kind: Kind, course: Path, folder: Path, name: str = NAME) -> Path:
    """Write the notebook of a kind into a folder and return its file."""
    work = notebook(course, "solved", name)
    path = folder / f"{name}.ipynb"
    if kind.table == "FILE_NAMES":
        thing = kind.thing
        path = path.with_name(os.fsdecode(thing) if isinstance(thing, bytes) else thing)
    if kind.table in _CHANGES:
        _CHANGES[kind.table](kind.thing, work)
    _put(path, work)
    if kind.table == "FILES":
        kind.thing(path)
    return path


def write_downloads(course: Path, hostiles: Sequence[Kind]) -> None:
    """Write a roster, downloads of Moodle and Canvas, and an exchange, an honest student in each.

    Students with odd names are in no roster, so their work is left; the entries of
    `hostile.ENTRIES` are worth 0, so that a mark shows if one has replaced an honest notebook.
    """
    solved = json.dumps(notebook(course, "solved"))
    folder = course / "downloads"
    folder.mkdir()
    listed = [Student(who, login=who) for who in HONEST]
    listed += [Student("Mia-Wong", "Mia", "Wong")]
    listed += [Student("Ada-Lovelace", "Ada", "Lovelace", lms_user_id="7")]
    save_roster(Course(course), Roster(tuple(listed)))
    entries = [k.thing for k in hostiles if k.table == "ENTRIES"]
    people = [_plain(k.thing) for k in hostiles if k.table == "PEOPLE"]
    with zipfile.ZipFile(folder / "moodle.zip", "w") as archive:
        archive.writestr(f"Mia Wong_101_assignsubmission_file_/{NAME}.ipynb", solved)
        for number, entry in enumerate(entries, start=SECRET):
            name = entry.replace("{n}", str(number)).replace("{m}", "_assignsubmission_file_")
            archive.writestr(name, "{}")
        for number, who in enumerate(people, start=2 * SECRET):
            archive.writestr(f"{who}_{number}_assignsubmission_file_/{NAME}.ipynb", solved)
    with zipfile.ZipFile(folder / "canvas.zip", "w") as archive:
        archive.writestr(f"lovelaceada_7_70_{NAME}.ipynb", solved)
        for number, who in enumerate(people, start=SECRET):
            archive.writestr(f"{who}_{number}_{number}_{NAME}.ipynb", solved)
        for number in range(5 * bool(entries)):
            archive.writestr(f"eve_{number}_80_lovelaceada_7_99_{NAME}.ipynb", "{}")
    when = "2026-03-01 10:00:00 UTC"
    names = ["carl", *(k.folder for k in hostiles if k.table == "PEOPLE" and "+" not in k.folder)]
    for who in names:
        if len(os.fsencode(who)) < 200:  # the whole name of a longer one is too long for a file
            path = folder / "inbound" / f"{who}+{NAME}+{when}" / f"{NAME}.ipynb"
            _put(path, json.loads(solved))


def _plain(name: str | bytes) -> str:
    """A name in a form that a zip can contain."""
    return name.decode("cp437") if isinstance(name, bytes) else name


def _put(path: Path, work: hostile.Notebook) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(work), "utf-8")


def _answers(work: hostile.Notebook) -> dict[str, dict[str, Any]]:
    """The cells of a notebook that answer questions, by the names of the questions."""
    return {
        cell["metadata"]["nbgrader"]["grade_id"]: cell
        for cell in work["cells"]
        if cell["metadata"].get("lab") == "answer"
    }


def _code(key: str, source: str) -> dict[str, Any]:
    cell = {"cell_type": "code", "id": key, "metadata": {}, "source": source}
    return {**cell, "outputs": [], "execution_count": None}


def _wrapped(question: str, source: str, number: str) -> str:
    """The source of a right answer with other numbers."""
    return (
        f"{source}\n\n_right_{question} = {question}\n\n\ndef {question}(*args, **kwargs):\n"
        f"    return tainted(_right_{question}(*args, **kwargs), lambda x, k: {number})"
    )


def _text(text: str, work: hostile.Notebook) -> None:
    comment = "\n".join(f"# {line}" for line in text.split("\n"))
    cell = next(iter(_answers(work).values()))
    cell["source"] += f"\n{comment}"
    raised = f"raise ValueError({text!a})"
    says = {"cell_type": "markdown", "id": text, "metadata": {text: text}, "source": text}
    work["cells"][1:1] = [says, _code("own-1", comment), _code("own-2", raised)]
    work["metadata"].update({"title": text, "authors": [{"name": text}]})
    told = {"output_type": "stream", "name": "stdout", "text": text}
    failed = {"output_type": "error", "ename": text, "evalue": text, "traceback": [text]}
    for one in work["cells"]:
        if one["cell_type"] == "code":
            one["metadata"]["tags"] = [text]
            one["outputs"] = [told, failed]


def _source(text: str, work: hostile.Notebook) -> None:
    for question, cell in _answers(work).items():
        right = cell["source"]
        wide = "".join(chr(ord(x) + 0xFEE0) if x.isalpha() else x for x in question)
        words = {"NAME": question, "{wide}": wide, "{answer}": right}
        words["{crlf}"] = right.replace("\n", "\r\n")
        cell["source"] = text
        for word, stands in words.items():
            cell["source"] = cell["source"].replace(word, stands)


def _each_answer(write: Callable[[str, str], str]) -> Callable[[Any, hostile.Notebook], None]:
    """Replace every answer by what ``write`` makes of the thing, question and right answer."""

    def change(thing: str, work: hostile.Notebook) -> None:
        for question, cell in _answers(work).items():
            cell["source"] = write(thing, question, cell["source"])
        work["cells"].insert(1, _code("head", HEAD))

    return change


def _load(thing: str, work: hostile.Notebook) -> None:
    question, cell = list(_answers(work).items())[-1]
    cell["source"] = _body(f"return {thing}", question)
    work["cells"].insert(1, _code("head", HEAD))


def _reply(data: str, work: hostile.Notebook) -> None:
    question, cell = list(_answers(work).items())[-1]
    cell["source"] += (
        f"\n\n_right = {question}\n\n\ndef {question}(*args, **kwargs):\n"
        f"    shout({data})\n    return _right(*args, **kwargs)"
    )
    work["cells"][1:1] = [_code("head", HEAD), _code("shouts", f"shout({data})")]


def _body(body: str, question: str) -> str:
    return f"def {question}(*args, **kwargs):\n    {body}"


_CHANGES: dict[str, Callable[[Any, hostile.Notebook], Any]] = {
    "TEXTS": _text,
    "MAGICS": _source,
    "SOURCES": _source,
    "NUMBERS": _each_answer(lambda thing, question, right: _wrapped(question, right, thing)),
    "OBJECTS": _each_answer(lambda thing, question, right: _body(f"return {thing}", question)),
    "LOADS": _load,
    "COEFFICIENTS": _each_answer(lambda thing, question, right: _body(f"return {thing}", question)),
    "RAISES": _each_answer(lambda thing, question, right: _body(thing, question)),
    "REPLIES": _reply,
    "NOTEBOOKS": lambda change, work: change(work),
}
