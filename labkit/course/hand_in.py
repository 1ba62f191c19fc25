"""The last cell of a notebook: is the file ready to be handed in?  And a receipt for it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path

from .handin import look
from .messages import wrapped
from .notebook import read_cells


def hand_in(name: str) -> None:
    """Say what a look at the saved file finds, and print a receipt.

    With a receipt and the file students can prove which work was done by then.  The feedback page
    has the receipt of the file that was marked.

    Args:
        name: Of the notebook in the working directory, without ``.ipynb``.

    Raises:
        LabkitError: The file is missing or is not a notebook.
    """
    path = Path.cwd() / f"{name}.ipynb"
    found = look(path)
    saved = datetime.fromtimestamp(path.stat().st_mtime, UTC).astimezone()
    lines = [
        f"This is {path.name} as it was saved at {saved:%H:%M:%S}. What you did since then is not "
        "in it: save, and run this cell again.",
        *str(found).splitlines(),
        f"receipt: {receipt(cell['source'] for cell in read_cells(path))} of {path.name}, saved "
        f"{saved:%Y-%m-%d %H:%M %Z}",
    ]
    print("\n".join(map(wrapped, lines)))


def receipt(sources: Iterable[str]) -> str:
    """A short name for what is written in a notebook's cells, in order.

    Outputs do not count: to run the cell that prints the receipt changes the file.
    """
    text = "\0".join(sources).encode(errors="surrogatepass")
    return hashlib.sha256(text).hexdigest()[:16]
