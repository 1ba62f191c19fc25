"""Packing the built book into one file to hand out."""

from __future__ import annotations

import shutil
from pathlib import Path

from book_pages import CACHE, HTML, ROOT


def pack() -> Path:
    """Pack the built book into one zip; its readers double-click on index.html."""
    target = ROOT / "dist/book"
    target.parent.mkdir(exist_ok=True)
    stage = CACHE / "stage"
    shutil.rmtree(stage, ignore_errors=True)
    skipped = shutil.ignore_patterns(".buildinfo", "objects.inv", "_sources")
    shutil.copytree(HTML, stage / "book", ignore=skipped)
    made = Path(shutil.make_archive(str(target), "zip", stage, "book"))
    shutil.rmtree(stage)
    return made
