"""What the pages computed when they were last run: kept with the sources, made anew where stale."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path

from book_pages import BOOK, CACHE, ROOT, key_of
from nbclient import NotebookClient
from nbformat import NotebookNode, from_dict
from nbformat.v4 import new_code_cell, new_notebook

KEPT, NEW = BOOK / "runs", CACHE / "runs"
PATHS = os.pathsep.join([str(ROOT), str(BOOK), os.environ.get("PYTHONPATH", "")])


def fill(
    pages: Mapping[str, NotebookNode], progress: Callable[[str], None], *, keep: bool = False
) -> dict[str, str]:
    """Give each page its outputs, from a kept run of the same code, or else from a run now.

    Args:
        pages: The code cells of each page; they receive the outputs.
        progress: Called with a few words about what is being done.
        keep: Whether book/runs receives the runs of all pages; new ones otherwise stay in build/.

    Returns:
        The hash of what computes each page.

    Raises:
        CellExecutionError: A cell raised an exception.
    """
    keys = {name: key_of(page) for name, page in pages.items()}
    stale = {name: page for name, page in pages.items() if not _filled(name, page, keys[name])}
    if stale:
        execute(stale, progress, lambda name: _write(name, stale[name], keys[name], NEW))
    if keep:
        for name, page in pages.items():
            _write(name, page, keys[name], KEPT)
        for path in {*KEPT.rglob("*.json")} - {KEPT / f"{name}.json" for name in pages}:
            path.unlink()
    return keys


def _filled(name: str, page: NotebookNode, key: str) -> bool:
    """Give a page the outputs of a run with this key; False if there is none."""
    for folder in (KEPT, NEW):
        path = folder / f"{name}.json"
        told = json.loads(path.read_text("utf-8")) if path.exists() else {}
        if told.get("key") == key:
            for cell, outputs in zip(page.cells, told["cells"], strict=True):
                cell.outputs = from_dict(outputs)
            return True
    return False


def _write(name: str, page: NotebookNode, key: str, folder: Path) -> None:
    path = folder / f"{name}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    cells = ",\n".join(json.dumps(cell.outputs, ensure_ascii=False) for cell in page.cells)
    path.write_text(f'{{"key": "{key}", "cells": [\n{cells}\n]}}\n', "utf-8")


def execute(
    pages: Mapping[str, NotebookNode],
    progress: Callable[[str], None],
    done: Callable[[str], None],
) -> None:
    """Run pages in one kernel, which imports the lab once; each begins without names.

    Args:
        pages: The code cells of each page; they receive the outputs.
        progress: Called with a few words before each page.
        done: Called with the name of each page that was run.

    Raises:
        CellExecutionError: A cell raised an exception.
    """
    quiet = ["--log-level=ERROR"]
    client = NotebookClient(new_notebook(), timeout=300, record_timing=False, extra_arguments=quiet)
    with client.setup_kernel(cwd=str(BOOK), env=os.environ | {"PYTHONPATH": PATHS}):
        for name, page in pages.items():
            progress(f"running the page {name}")
            client.nb = new_notebook(cells=[new_code_cell("%reset -f"), *page.cells])
            for k, cell in enumerate(client.nb.cells):
                client.execute_cell(cell, k)
                for part in (cell, *cell.outputs):
                    if "execution_count" in part:
                        part.execution_count = None
            done(name)
