"""Call somebody else's code without letting its prints and warnings through.

nbgrader takes anything on stderr for a failure, and PyBullet writes to the C streams, so both kinds
of stream are caught.
"""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from io import StringIO

from ..quiet import diverted


class Heard:
    """What came out of the streams, and the warnings, once the call is over."""

    text: str = ""


@contextmanager
def heard() -> Iterator[Heard]:
    """Catch stdout, stderr and warnings, of Python and of C, while the block runs."""
    out, result = StringIO(), Heard()
    with (
        tempfile.TemporaryFile() as file,
        diverted(file.fileno()),
        warnings.catch_warnings(record=True) as said,
    ):
        warnings.simplefilter("always")
        with redirect_stdout(out), redirect_stderr(out):
            try:
                yield result
            finally:
                words = [out.getvalue(), *(f"{w.category.__name__}: {w.message}\n" for w in said)]
                file.seek(0)
                below = file.read(100_000).decode(errors="replace")
                result.text = "".join([*words, below])
