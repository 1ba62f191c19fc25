"""Silence C libraries such as PyBullet, which write past Python's own output streams."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress


@contextmanager
def quiet() -> Iterator[None]:
    """Discard what is written to file descriptors 1 and 2 while the block runs."""
    with open(os.devnull, "wb") as nowhere, diverted(nowhere.fileno()):
        yield


@contextmanager
def diverted(file: int) -> Iterator[None]:
    """Redirect file descriptors 1 and 2 to the file descriptor ``file`` while the block runs."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(Exception):  # a user may have replaced the stream by anything
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
