"""The file beside a notebook that holds its questions with their public cases."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from ..errors import LabkitError
from ..formats import check_stamp

FILE = "checks.json"


def read_checks(folder: Path) -> dict[str, Any]:
    """The data in a notebook's folder: its ``assignment``, its ``questions`` and its ``texts``.

    The texts, which a person marks, map the name of each to the id of its cell; the files of older
    releases have none.

    Raises:
        LabkitError: The file is missing or damaged.
    """
    file = folder / FILE
    remedy = "fetch the assignment's whole folder again"
    try:
        data: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        if not isinstance(data, dict):
            raise TypeError
        check_stamp(data, f"{FILE} in {folder.name!r}", remedy)
        if not isinstance(data["assignment"], str) or not isinstance(data["questions"], list):
            raise TypeError
        if not isinstance(data.setdefault("texts", {}), dict):
            raise TypeError
    except (FileNotFoundError, KeyError, TypeError, ValueError) as error:
        there = "no" if isinstance(error, FileNotFoundError) else "only a damaged"
        raise LabkitError(
            f"there is {there} {FILE} in {folder.name!r}; it came with the notebook and belongs "
            f"beside it, so {remedy}"
        ) from None
    return data
