"""Read a stranger's notebook: its sources, and the names that each cell defines and uses.

Outputs are ignored, so a notebook may be full of pictures.  Sources are cleaned here, before they
run, and not only with the whole result, so an instructor reads exactly what ran.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from ...course.notebook import grade_id
from ...course.source import analyse
from ...errors import LabkitError
from .protocol import clean_text

MOST_CELLS = 1000
MOST_SOURCE = 2_000_000  # characters, in all cells together


def read(data: bytes) -> dict[str, Any]:
    """Read the cells of a notebook, or say why it is rejected.

    Args:
        data: The contents of the file.

    Returns:
        ``{"cells": [...]}``, or ``{"rejected": sentence}``.  Each cell has ``id``, ``grade_id``,
        ``type`` and ``source``; a code cell also has what
        `labkit.course.source.analyse` finds.
    """
    try:
        return {"cells": list(_cells(_notebook(data)))}
    except LabkitError as why:
        return {"rejected": str(why)}


def _notebook(data: bytes) -> dict[str, Any]:
    try:
        notebook = json.loads(data)
    except (ValueError, RecursionError, MemoryError) as error:
        why = f"the file is not a notebook; its JSON is broken: {error}"
        raise LabkitError(why[:200]) from None
    if not isinstance(notebook, dict) or notebook.get("nbformat") != 4:
        raise LabkitError("the file is not a notebook of format 4")
    if not isinstance(notebook.get("cells"), list):
        raise LabkitError("the notebook has no cells")
    about = notebook.get("metadata")
    kernel = about.get("kernelspec") if isinstance(about, dict) else None
    language = kernel.get("language") if isinstance(kernel, dict) else None
    if language not in (None, "python", "sage"):
        raise LabkitError(f"the notebook's kernel runs {str(language)[:20]}, not Python")
    if len(notebook["cells"]) > MOST_CELLS:
        raise LabkitError(f"it has {len(notebook['cells'])} cells; the limit is {MOST_CELLS}")
    return notebook


def _cells(notebook: dict[str, Any]) -> Iterator[dict[str, Any]]:
    total = 0
    for cell in notebook["cells"]:
        if not isinstance(cell, dict):
            continue
        source = cell.get("source", "")
        if isinstance(source, list):
            source = "".join(x for x in source if isinstance(x, str))
        if not isinstance(source, str):
            source = ""
        total += len(source)
        if total > MOST_SOURCE:
            raise LabkitError("its cells have over 2 MB of text; delete some of it")
        source = clean_text(source.replace("\r\n", "\n").replace("\r", "\n"))
        kind = "code" if cell.get("cell_type") == "code" else "text"
        yield {
            "id": _name(cell.get("id")),
            "grade_id": _name(grade_id(cell)),
            "type": kind,
            "source": source,
            **(analyse(source) if kind == "code" else {}),
        }


def _name(x: Any) -> str:
    """The name of a cell, which is compared with those of the release and never shown."""
    return x[:100] if isinstance(x, str) else ""
