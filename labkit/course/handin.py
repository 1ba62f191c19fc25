"""Handing in: the receipt in the last cell, and `labkit submit-check`, which runs the notebook.

A copy runs from top to bottom in a fresh kernel, in a folder with nothing else, and its answers are
tried once more after the last cell, as the grader tries them.  So what is said of them is observed.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import tempfile
import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from ..errors import LabkitError
from .messages import head, wrapped
from .notebook import (
    FILE,
    WORDS,
    cells_made_for,
    last_verdict,
    read_cells,
    read_checks,
    verdict_metadata,
    words_in_all,
    words_of,
)
from .source import analyse
from .student import desk, last_run, shell
from .verdict import Outcome, Verdict

SILENT = "LABKIT_SUBMIT_CHECK"
"""The environment variable that is set while `submit_check` runs a notebook."""
LARGEST = 10.0
"""Size in megabytes above which a learning platform may reject a notebook."""
_END = f'__import__("{__name__}", fromlist=["_"])._end()'
"""The cell below those of the notebook, which binds no name in it."""


def hand_in(name: str) -> None:
    """Print a receipt for the saved file, or in one sentence why it cannot be handed in yet.

    With the receipt and the file, students can prove what they had done by then.  The feedback
    page shows the receipt of the file that was marked.

    Args:
        name: Name of the notebook in the working directory, without ``.ipynb``.
    """
    if SILENT not in os.environ:
        try:
            print(wrapped(_told(name, Path.cwd())))
        except LabkitError as error:
            print(wrapped(f"{error}."))


def _told(name: str, folder: Path) -> str:
    data = read_checks(folder)
    path = folder / f"{data['assignment']}.ipynb"
    if name != path.stem:
        return f"This notebook is {path.stem}; write lk.hand_in({path.stem!r})."
    opened = Path(os.environ.get("JPY_SESSION_NAME", ""))  # its name when the kernel started
    if opened.name != path.name and (folder / opened.name).is_file():
        return f"This notebook is called {opened.name}; rename it {path.name} and open it again."
    cells = read_cells(path)
    saved = path.stat().st_mtime
    if saved < last_run():
        return "Save this notebook (Ctrl+S), then run this cell again."
    code = [cell["source"] for cell in cells if cell["cell_type"] == "code"]
    bound = {name for source in code for name in analyse(source)["binds"]}
    gone = [x["name"] for x in data["questions"] if x["name"] not in bound]
    if gone and not any("exec(" in source for source in code):
        return f"No cell defines {gone[0]}; lk.restore({gone[0]!r}) brings its cell back."
    if problem := _too_large(path):
        return f"Do not hand in yet: {problem}."
    when = datetime.fromtimestamp(saved, UTC).astimezone()
    text = receipt(cell["source"] for cell in cells)
    return f"receipt: {text} of {path.name}, saved {when:%Y-%m-%d %H:%M %Z}. Hand in this file."


def receipt(sources: Iterable[str]) -> str:
    """A short hash of the text in a notebook's cells, in order.

    Outputs and empty cells do not count, because running the cell that prints the receipt changes
    the outputs, and Shift+Enter in the last cell appends an empty one.
    """
    text = "\0".join(filter(str.strip, sources)).encode(errors="surrogatepass")
    return hashlib.sha256(text).hexdigest()[:16]


def progress(folder: Path | None = None) -> None:
    """Print the points and the time left of each notebook, as the saved files say.

    Args:
        folder: The folder that holds a folder for each notebook; by default the working directory,
            or the one above that of a notebook.
    """
    here = Path.cwd().parent if Path("checks.json").exists() else Path.cwd()
    for checks in sorted((folder or here).glob("*/checks.json")):
        data = read_checks(checks.parent)
        name = data["assignment"]
        cells = read_cells(checks.parent / f"{name}.ipynb")
        found = [last_verdict(cells, question["name"]) for question in data["questions"]]
        earned, of = sum(v.earned for v in found if v), sum(x["points"] for x in data["questions"])
        hours = re.search(r"\*\*Time\*\* \|\D*([\d.]+) hour", cells[0]["source"])
        left = 60.0 * float(hours[1]) * (1.0 - earned / of) if hours else 0.0
        print(f"{name:20} {earned:5.1f} of {of:g} points as tested here, {left:3.0f} minutes left")


@dataclass(frozen=True)
class Tried:
    """What was found when a copy of a notebook ran.

    Attributes:
        assignment: Its assignment.
        problems: Sentences about what to correct before handing in.
        notes: Sentences about what is worth knowing.
        verdicts: The verdict on each question after all cells; None if nothing defines its answer.
    """

    assignment: str
    problems: tuple[str, ...]
    notes: tuple[str, ...]
    verdicts: Mapping[str, Verdict | None]

    def __str__(self) -> str:
        lines = [f"[fix] {text}" for text in self.problems]
        lines += [f"[note] {text}" for text in self.notes]
        for name, verdict in self.verdicts.items():
            lines.append(f"  {head(verdict) if verdict else f'{name}: no answer'}")
        right = sum(v is not None and v.right for v in self.verdicts.values())
        end = "correct what is marked with [fix] first" if self.problems else "it can be handed in"
        of = f"{right} of {len(self.verdicts)} answers are right as far as can be tested here"
        return "\n".join([*lines, f"{self.assignment}: {of}; {end}."])


def submit_check(path: Path, seconds: float = 600.0) -> Tried:
    """Run a copy of a notebook that is about to be handed in, and read what its checks say.

    Args:
        path: The notebook; ``checks.json`` must be in the same folder.
        seconds: Time limit of a cell.

    Raises:
        LabkitError: The file is missing, is not a notebook, or is another person's.
    """
    cells, folder = read_cells(path), path.resolve().parent
    mine = not hasattr(os, "getuid") or path.stat().st_uid == os.getuid()
    if "submitted" in folder.parts or not mine:
        raise LabkitError(f"{path} is not yours, and its code would run as you; use labkit grade")
    data = read_checks(folder)
    name, asked = data["assignment"], [x["name"] for x in data["questions"]]
    code = [cell["source"] for cell in cells if cell["cell_type"] == "code"]
    ran, stopped = _run(code, folder / FILE, seconds)
    errors = _errors(ran)
    at_check = {question: last_verdict(ran[:-1], question) for question in asked}
    verdicts = {question: last_verdict(ran[-1:], question) for question in asked}
    problems, notes = [], []
    if path.name != f"{name}.ipynb":
        problems.append(f"the file is called {path.name}; rename it {name}.ipynb")
    problems += filter(None, [_too_large(path)])
    problems += [stopped] if stopped else errors
    for question, verdict in verdicts.items() if not stopped else ():
        problems += _gaps(question, at_check[question], verdict)
    none = [q for q, v in verdicts.items() if v and v.outcome is Outcome.NOT_ATTEMPTED]
    notes += [f"not answered: {', '.join(none)}"] if none else []
    lost, told = _texts(cells, data["texts"])
    return Tried(name, (*problems, *lost), (*notes, *told), verdicts)


def _too_large(path: Path) -> str:
    size = path.stat().st_size / 1e6
    says = f"the file has {size:.0f} MB, over {LARGEST:g}; clear the largest outputs"
    return says if size > LARGEST else ""


def _gaps(question: str, at_check: Verdict | None, at_end: Verdict | None) -> Iterator[str]:
    """What must be corrected about an answer, by the verdicts at its check and at the end."""
    if at_end is None:
        yield f"no cell defines {question}; lk.restore({question!r}) brings its cell back"
    elif at_end.withheld:
        yield head(at_end)
    elif at_check and at_check.right and not at_end.right:
        yield (
            f"{question} is right at its check but not after the last cell, which is what counts; "
            "a cell below the check changes it or what it uses"
        )


def _run(code: Sequence[str], checks: Path, seconds: float) -> tuple[list[dict[str, Any]], str]:
    """The cells after a run in a fresh kernel, one of ours the last, and why it stopped, if so."""
    from nbclient import NotebookClient
    from nbclient.exceptions import CellTimeoutError, DeadKernelError
    from nbformat import v4

    made = v4.new_notebook(cells=[v4.new_code_cell(x) for x in (*code, _END)])
    stopped = ""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(checks, folder)
        client = NotebookClient(
            made,
            timeout=seconds,
            allow_errors=True,
            store_widget_state=False,
            extra_arguments=["--log-level=ERROR"],
            resources={"metadata": {"path": folder}},
        )
        try:
            client.execute(env={**os.environ, SILENT: "1"})
        except CellTimeoutError:
            stopped = f"a cell ran for more than {seconds:g} s; does every loop in it end?"
        except DeadKernelError:
            stopped = "the kernel died while the notebook ran; is there enough memory?"
    return made.cells, stopped


def _errors(cells: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """A sentence for each cell that raised."""
    for cell in cells:
        for output in cell["outputs"]:
            if output["output_type"] != "error":
                continue
            kind, text = str(output["ename"]), str(output["evalue"])
            beside = "; only the notebook is handed in, without the files beside it"
            why = beside if kind in ("ModuleNotFoundError", "FileNotFoundError") else ""
            yield (
                f"the cell that begins with `{_first_line(cell['source'])}` ends with an error "
                f"({textwrap.shorten(f'{kind}: {text}', 120, placeholder=' ...')}){why}"
            )


def _first_line(source: str) -> str:
    """The first line of a cell that is not a comment, shortened."""
    lines = (line.strip() for line in source.splitlines())
    line = next((line for line in lines if line and line[0] != "#"), "")
    return textwrap.shorten("".join(x for x in line if x.isprintable()), 60, placeholder=" ...")


def _texts(
    cells: Sequence[dict[str, Any]], asked: Mapping[str, str]
) -> tuple[list[str], list[str]]:
    """Problems and notes about the texts that a person marks, by their names and their cells."""
    problems, notes = [], []
    for name, home in asked.items():
        found = cells_made_for(cells, name, home)
        count = sum(len(words_of(cell["source"])) for cell in found)
        if not found:
            problems.append(f"no cell holds the text {name}; copy its cell from a fresh notebook")
        elif any(cell["cell_type"] == "code" for cell in found):
            problems.append(f"the cell of {name} is code; click on it, press Esc and then M")
        elif count < WORDS[0]:
            notes.append(f"{name} has {words_in_all(count)}; it needs at least {WORDS[0]}")
    return problems, notes


def _end() -> None:
    """After the last cell: try each answer as it is now.

    A name that has been given to something else than a function still means the function that was
    checked, as in marking.
    """
    from IPython.display import display

    names, place = shell().user_ns, desk()
    for name in place.questions:
        known = name in place.checked
        if name in names and (callable(names[name]) or not known):
            now = names[name]
        elif known:
            now = place.checked[name][0]
        else:
            continue
        verdict, *_ = place.verdict(name, now)
        display({"text/plain": name}, metadata=verdict_metadata(verdict), raw=True)
