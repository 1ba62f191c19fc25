"""A lock on the results of an assignment: one run at a time, or the shards of one run."""

from __future__ import annotations

import fcntl
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from ..errors import LabkitError

PATIENCE = 2.0
"""Seconds to wait for another run, such as one that was stopped and is about to end."""
WHOLE = (1, 1)
"""The shard of a run on the whole class."""


@contextmanager
def exclusive_run(results: Path, shard: tuple[int, int] = WHOLE) -> Iterator[None]:
    """Keep other runs on an assignment away, except other shards of the same split.

    Args:
        results: The folder with the results of the assignment; made if need be.
        shard: (i, n): which of n parts of the class this run works on.

    Raises:
        LabkitError: Another run is under way.
    """
    results.mkdir(parents=True, exist_ok=True)
    part, parts = shard
    with (
        open(results / ".running", "a+") as run,
        open(results / f".running-{part}-of-{parts}", "w") as mine,
    ):
        until = time.monotonic() + PATIENCE
        while not (_joined(run, parts) and _locked(mine, fcntl.LOCK_EX)):
            fcntl.flock(run, fcntl.LOCK_UN)
            if time.monotonic() > until:
                raise LabkitError(f"another run is grading {results.name}; wait for it to end")
            time.sleep(0.1)
        yield


def _joined(run: IO[str], parts: int) -> bool:
    """Whether this run may go on: alone, or beside others that split the class into as many."""
    if _locked(run, fcntl.LOCK_EX):
        run.truncate(0)
        run.write(str(parts))
        run.flush()
        return parts == 1 or _locked(run, fcntl.LOCK_SH)
    if parts == 1 or not _locked(run, fcntl.LOCK_SH):
        return False
    run.seek(0)
    return run.read() == str(parts)


def _locked(file: IO[str], how: int) -> bool:
    try:
        fcntl.flock(file, how | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
