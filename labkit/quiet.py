"""Keep C libraries from talking: PyBullet writes to the process's streams, past Python's own."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress


@contextmanager
def quiet() -> Iterator[None]:
    """Send file descriptors 1 and 2 to nowhere while the block runs."""
    with open(os.devnull, "wb") as nowhere, diverted(nowhere.fileno()):
        yield


@contextmanager
def diverted(file: int) -> Iterator[None]:
    """Send file descriptors 1 and 2 to an open file, by its own, while the block runs."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(Exception):  # whatever somebody put in their place
            stream.flush()
    saved = os.dup(1), os.dup(2)
    try:
        os.dup2(file, 1)
        os.dup2(file, 2)
        yield
    finally:
        for target, copy in enumerate(saved, start=1):
            os.dup2(copy, target)
            os.close(copy)
