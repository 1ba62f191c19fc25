"""The table of labkit's files, made from the first line of each one's docstring.

``python tests/modules.py`` writes it to ``labkit/README.md``.
"""

import ast
from collections.abc import Iterator
from pathlib import Path

HOME = Path(__file__).parents[1] / "labkit"
PAGE = HOME / "README.md"
FOLDERS = {
    ".": "The lab: an arm, a trajectory, a controller, and `run`",
    "sim": "Physics engines",
    "tags": "AR tags and cameras",
    "replay": "Replays and live arms",
    "course": "The course: questions, checks and handing in",
    "course/authoring": "What makes a release; students do not get this folder",
}
"""The folders of the table, with their titles; the grader has a page of its own."""


def table() -> str:
    """The page: for each folder a title, and a line for each of its files."""
    return "\n".join(_lines()) + "\n"


def _lines() -> Iterator[str]:
    yield "# labkit, file by file"
    yield ""
    yield "`python tests/modules.py` makes this page from the docstrings. The grader's files have"
    yield "[their own page](grader/README.md), and a picture of what may import what is in"
    yield "[How it is made](../book/architecture.md)."
    for folder, title in FOLDERS.items():
        name = "labkit" if folder == "." else f"labkit/{folder}"
        yield f"\n## {title}\n\n| `{name}/` | |\n|---|---|"
        for path in sorted((HOME / folder).glob("[a-z]*.py")):
            text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
            says = text.splitlines()[0].replace("``", "`")
            yield f"| [`{path.stem}`]({path.relative_to(HOME)}) | {says} |"


if __name__ == "__main__":
    PAGE.write_text(table(), encoding="utf-8")
