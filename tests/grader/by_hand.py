"""01_curves with two more cells that a person marks: an answer in words and a task."""

from __future__ import annotations

import nbformat

from labkit.course.notebook import source_notebook

WHY, REPORT = "why_reach", "report"
BLANK = "*Double-click here and write your text in place of this line.*"
SCHEME = "=== BEGIN MARK SCHEME ===\n2 points for the reason\n=== END MARK SCHEME ==="


def _cell(name, source, **flags):
    about = {"schema_version": 3, "grade_id": name, "grade": False, "locked": False,
             "solution": False, "task": False, **flags}  # fmt: skip
    cell = nbformat.v4.new_markdown_cell(source, id=f"paths-{name.replace('_', '-')}")
    return nbformat.from_dict({**cell, "metadata": {"lab": "written", "nbgrader": about}})


def with_hand_marked(path, questions, predictions):
    """The result of `source_notebook` with two cells by hand, of 2 and 4 points, and no why."""
    notebook = source_notebook(path, questions, predictions)
    (why,) = (k for k, cell in enumerate(notebook.cells) if cell.metadata["lab"] == "why")
    del notebook.cells[why - 1 : why + 1]
    first = notebook.cells[0]
    first.source = first.source.replace("24 points", "28 points")
    why = _cell(WHY, "Because the arm is short.", grade=True, solution=True, points=2)
    task = _cell(REPORT, f"Report below.\n\n{SCHEME}", task=True, locked=True, points=4)
    notebook.cells += [why, task]
    return notebook


def author(monkeypatch):
    """Let `labkit release` find these two cells in the source of the assignment."""
    monkeypatch.setattr("labkit.course.authoring.release.source_notebook", with_hand_marked)


def written_in(notebook, name, text):
    """Put an answer in words into a notebook's JSON."""
    for cell in notebook["cells"]:
        if cell["metadata"].get("nbgrader", {}).get("grade_id") == name:
            cell["source"] = text
    return notebook
