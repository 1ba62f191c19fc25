"""The last cell of a notebook, which prints a receipt for the saved file."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path

from ..errors import LabkitError
from .checks_file import read_checks
from .messages import wrapped
from .notebook import last_verdict, read_cells
from .student import last_run

SILENT = "LABKIT_SUBMIT_CHECK"
"""The environment variable that is set while `labkit submit-check` runs a notebook."""


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
        return (
            f"This notebook is called {opened.name}; rename it to {path.name}, and open it again."
        )
    cells = read_cells(path)
    saved = path.stat().st_mtime
    if saved < last_run():
        return "Save this notebook (Ctrl+S), then run this cell again."
    if data["questions"] and not any(last_verdict(cells, x["name"]) for x in data["questions"]):
        return f"{path.name} holds no result of a check; run all cells, save, run this one again."
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
