"""Files that are written whole or not at all."""

from __future__ import annotations

import glob
import os
from functools import partial
from pathlib import Path


def write(path: Path, content: str | bytes) -> None:
    """Write a file whole or not at all, for its owner alone; delete what a killed run left."""
    path.parent.mkdir(0o700, parents=True, exist_ok=True)
    for left in path.parent.glob(f".{glob.escape(path.name)}.*.new"):
        if not Path("/proc", left.name.split(".")[-2]).exists():
            left.unlink(missing_ok=True)
    new = path.with_name(f".{path.name}.{os.getpid()}.new")
    try:
        with open(new, "wb", opener=partial(os.open, mode=0o600)) as file:
            file.write(content.encode() if isinstance(content, str) else content)
            file.flush()
            os.fsync(file.fileno())
        new.replace(path)
    finally:
        new.unlink(missing_ok=True)
