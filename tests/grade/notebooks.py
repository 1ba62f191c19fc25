"""Small changes to a notebook's JSON."""

from __future__ import annotations

import json


def cell_of(notebook, question):
    for cell in notebook["cells"]:
        if cell["metadata"].get("nbgrader", {}).get("grade_id") == question:
            return cell
    raise KeyError(question)


def put(notebook, question, source):
    cell_of(notebook, question)["source"] = source
    return notebook


def add(notebook, source, at=2):
    cell = {"cell_type": "code", "id": f"own-{len(notebook['cells'])}", "metadata": {},
            "source": source, "outputs": [], "execution_count": None}  # fmt: skip
    notebook["cells"].insert(at, cell)
    return notebook


def raw(notebook):
    return json.dumps(notebook).encode()
