"""Files that are written whole or not at all, and locks: one run at a time."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from ..errors import LabkitError


def write(path: Path, content: str | bytes) -> None:
    """Write a file whole or not at all, for its owner alone."""
    path.parent.mkdir(0o700, parents=True, exist_ok=True)
    new = path.with_name(f".{path.name}.new")
    try:
        with open(new, "wb", opener=partial(os.open, mode=0o600)) as file:
            file.write(content.encode() if isinstance(content, str) else content)
            file.flush()
            os.fsync(file.fileno())
        new.replace(path)
    finally:
        new.unlink(missing_ok=True)


@contextmanager
def locked(file: Path, busy: str) -> Iterator[None]:
    """Hold a lock for the length of a block; the lock ends with its process.

    Args:
        file: The lock file; it is made if needed, with its folder.
        busy: The message of the error if the lock is not free.

    Raises:
        LabkitError: Another process holds the lock.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    with open(file, "w") as mine:
        try:
            fcntl.flock(mine, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise LabkitError(busy) from None
        yield
