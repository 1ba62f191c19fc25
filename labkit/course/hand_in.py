"""The last cell of a notebook: is the file ready to be handed in?  And a receipt for it."""

from __future__ import annotations

import hashlib
from datetime import UTC, datetime
from pathlib import Path

from .handin import look


def hand_in(name: str) -> None:
    """Say what a look at the saved file finds, and print a receipt.

    With a receipt and the file students can prove which work was done by then: the hash is that of
    the file, and the time is that of the last save.

    Args:
        name: Of the notebook in the working directory, without ``.ipynb``.

    Raises:
        LabkitError: The file is missing or is not a notebook.
    """
    path = Path.cwd() / f"{name}.ipynb"
    found = look(path)
    data = path.read_bytes()
    saved = datetime.fromtimestamp(path.stat().st_mtime, UTC)
    right = [question for question, v in found.verdicts.items() if v is not None and v.right]
    print(found)
    print(
        f"receipt: {hashlib.sha256(data).hexdigest()[:16]} of {path.name}, saved "
        f"{saved:%Y-%m-%d %H:%M} UTC; right or committed when last run: {', '.join(right) or '-'}"
    )
    print("If you changed anything since you saved, save and run this cell again.")
