"""The last cell of a notebook, which inspects the saved file and prints a receipt for it."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

from ..errors import LabkitError
from .before_handing_in import HandIn, examine
from .messages import wrapped
from .notebook import read_cells
from .student import desk, shell
from .unfinished import defined_in

JUST_NOW = timedelta(minutes=1)
"""Age up to which a saved file is assumed to match the open notebook."""


def hand_in(name: str) -> None:
    """Inspect the saved file, and print the findings and a receipt.

    With the receipt and the file, students can prove what they had done by then.  The feedback
    page shows the receipt of the file that was marked.

    Args:
        name: Name of the notebook in the working directory, without ``.ipynb``.

    Raises:
        LabkitError: The file is missing, is not a notebook, or is not the one that is open.
    """
    path = Path.cwd() / f"{name}.ipynb"
    if other := _open_as(path):
        todo = f"save this notebook, rename it to {path.name}, and run this cell again"
        if path.is_file():
            todo = (
                f"if you have saved it as {path.name} since then, shut down its kernel, open "
                f"{path.name} and run all cells; if not, move the file called {path.name} out of "
                f"this folder first, then {todo}"
            )
        raise LabkitError(
            f"this notebook was opened as {other}, but what you hand in must be called "
            f"{path.name}; {todo}"
        )
    found = examine(path)
    sources = [cell["source"] for cell in read_cells(path)]
    unsaved = _unsaved(found, sources)
    found = replace(found, problems=(*found.problems, *_no_longer_right(found, unsaved)))
    saved = datetime.fromtimestamp(path.stat().st_mtime, UTC).astimezone()
    age = max(datetime.now(UTC) - saved, timedelta())
    lines = [
        *_findings(found, unsaved),
        f"receipt: {receipt(sources)} of {path.name}, saved {saved:%Y-%m-%d %H:%M %Z}",
        _advice(path.name, found, age, unsaved),
    ]
    print("\n".join(map(wrapped, lines)))


def _open_as(path: Path) -> str:
    """The name of the open notebook's file, if another one is about to be inspected, else "".

    Jupyter gives its kernels the name that the file had when they started.  If no file has that
    name any more, the file was renamed meanwhile.
    """
    opened = Path(os.environ.get("JPY_SESSION_NAME", ""))
    return opened.name if opened.name != path.name and (Path.cwd() / opened.name).is_file() else ""


def _no_longer_right(found: HandIn, unsaved: Collection[str]) -> Iterator[str]:
    """A sentence for each answer that its check found right, and that is not right any more.

    After Run All, all cells have run, as when the notebook is marked, so this finds every change
    that a cell below a check makes, also those that the text of the cells does not show.  An
    answer that is not in the file yet is another one than its verdict there is about.
    """
    notebook = shell()
    for name, verdict in found.verdicts.items() if notebook is not None else ():
        known = any(re.search(rf"\b{name}\b", text) for text in found.problems)
        if not verdict or not verdict.right or known or name in unsaved:
            continue
        if name not in notebook.user_ns:
            continue
        now, *_ = desk().verdict(name, notebook.user_ns[name])
        if not now.right:
            yield (
                f"{name} was right when it was checked and is not right now; restart the kernel "
                f"and run all cells. If you see this line again, something that runs after the "
                f"check of {name} changes what {name} uses, or {name} remembers its earlier calls: "
                f"check {name} once more in a new cell at the end to see what is different"
            )


def _findings(found: HandIn, unsaved: Collection[str]) -> list[str]:
    """The findings in the saved file; without any saved result, only what must be corrected.

    Of a file that lacks what ran last, it is not said that it can be handed in.
    """
    if found.verdicts and not any(found.verdicts.values()):
        return [f"[fix] {text}" for text in found.problems]
    lines = str(found).splitlines()
    return lines[:-1] if unsaved else lines


def _unsaved(found: HandIn, sources: Iterable[str]) -> list[str]:
    """Answers that ran in this notebook with a text that is not in the saved file.

    Predictions are left out, because one chosen with the mouse is written only after its cell ran.
    """
    notebook = shell()
    ran = notebook.history_manager.input_hist_raw if notebook is not None else ()
    last = {name: source for source in ran for name in defined_in(source)}
    saved = set(map(str.strip, sources))
    tasks = found.verdicts.keys() - set(found.predictions)
    return sorted(name for name in tasks if last.get(name, "").strip() not in {"", *saved})


def _advice(file: str, found: HandIn, age: timedelta, unsaved: Collection[str]) -> str:
    """Whether to hand in the file now, and if not, what to do first."""
    recent = age < JUST_NOW
    ago = f"{age.total_seconds():.0f} s" if recent else f"{age.total_seconds() / 60:.0f} min"
    says = f"{file} was saved {ago} ago"
    again = "save it and run this cell again"
    if unsaved:
        lacks = f"but does not hold the {', '.join(unsaved)} that you ran last"
        return f"{says}, {lacks}: run all cells, {again}."
    if found.problems:
        return f"{says}: correct what is marked with [fix], run all cells, then {again}."
    if found.verdicts and not any(found.verdicts.values()):
        return f"{says}, before any check had run: {again}."
    if found.old:
        return f"{says}: run all cells from the top, {again}."
    says += ": first look at what is marked with [note]" if found.notes else " and is complete"
    return f"{says}. Hand it in if you have changed nothing since then; if you have, {again}."


def receipt(sources: Iterable[str]) -> str:
    """A short hash of the text in a notebook's cells, in order.

    Outputs and empty cells do not count, because running the cell that prints the receipt changes
    the outputs, and Shift+Enter in the last cell appends an empty one.
    """
    text = "\0".join(filter(str.strip, sources)).encode(errors="surrogatepass")
    return hashlib.sha256(text).hexdigest()[:16]
