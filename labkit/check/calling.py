"""Call somebody else's code without letting its prints and warnings through.

nbgrader takes anything on stderr for a failure, and PyBullet writes to the C streams, so both kinds
of stream are caught.
"""

from __future__ import annotations

import os
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from io import StringIO


class Heard:
    """What came out of the streams, and the warnings, once the call is over."""

    text: str = ""


@contextmanager
def heard() -> Iterator[Heard]:
    """Catch stdout, stderr and warnings, of Python and of C, while the block runs."""
    out, result = StringIO(), Heard()
    with _descriptors() as below, warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        with redirect_stdout(out), redirect_stderr(out):
            try:
                yield result
            finally:
                words = [out.getvalue(), *(f"{w.category.__name__}: {w.message}\n" for w in said)]
                result.text = "".join([*words, below()])


@contextmanager
def _descriptors() -> Iterator[Callable[[], str]]:
    """Point file descriptors 1 and 2 at a file, and give a function that reads it."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(Exception):
            stream.flush()
    with tempfile.TemporaryFile() as file:
        saved = [os.dup(1), os.dup(2)]
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)

        def read() -> str:
            file.seek(0)
            return file.read(100_000).decode(errors="replace")

        try:
            yield read
        finally:
            for target, copy in enumerate(saved, start=1):
                os.dup2(copy, target)
                os.close(copy)
