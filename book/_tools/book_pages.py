"""The book's pages: their order, and a hash of the code and the data that compute each page."""

from __future__ import annotations

import ast
import hashlib
import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import nbformat
import yaml

ROOT = Path(__file__).resolve().parents[2]
BOOK = ROOT / "book"
sys.path[:0] = [str(ROOT), str(BOOK)]  # this checkout, even if another is installed
HTML = BOOK / "_build/html"
CACHE = ROOT / "build/book"

OURS = ("labkit", "solutions", "figures")
DATA = {
    "labkit": ("labkit/data/*.json", "labkit/data/[mr]*/*"),
    "solutions/study": ("solutions/study/[!v]*.json", "solutions/study/baseline/*.json"),
    "labkit/course/authoring": ("assignments/*/*.ipynb", "solutions/*/*.py", "book/chapters/*.md"),
}
"""The files that modules of a folder read."""
ENGINES = re.compile(r"^(?:numpy|scipy|pin|pybullet|mujoco|matplotlib|opencv-\S+)==.*", re.M)
"""The locked versions that count; a reader with others sees what these have computed."""


def in_order() -> list[str]:
    """The names of the pages, in the order of the table of contents."""
    toc = yaml.safe_load((BOOK / "_toc.yml").read_text())

    def below(entries: list[dict]) -> Iterator[str]:
        for entry in entries:
            if "glob" in entry:
                found = sorted(BOOK.glob(f"{entry['glob']}.*"))
                yield from (str(p.relative_to(BOOK).with_suffix("")) for p in found)
            else:
                yield entry["file"]
            yield from below(entry.get("sections", []))

    return [toc["root"], *(name for part in toc["parts"] for name in below(part["chapters"]))]


def computed() -> dict[str, nbformat.NotebookNode]:
    """The code cells of each page that computes something, as a notebook."""
    from myst_nb.core.read import read_myst_markdown_notebook

    found = {}
    for name in in_order():
        path = BOOK / f"{name}.md"
        if path.exists() and "\n```{code-cell}" in path.read_text():
            page = read_myst_markdown_notebook(path.read_text())
            page.cells = [cell for cell in page.cells if cell.cell_type == "code"]
            found[name] = page
    return found


def key_of(page: nbformat.NotebookNode) -> str:
    """A hash of all that computes a page: its cells, the modules that it imports, their data.

    Comments and docstrings do not count, and of the engines only the versions in the lock file.
    """
    code = "\n".join(cell.source for cell in page.cells)
    files = imports(code)
    folders = {path.parent.relative_to(ROOT).as_posix() for path in files}
    files |= {path for key in DATA.keys() & folders for x in DATA[key] for path in ROOT.glob(x)}
    versions = ENGINES.findall((ROOT / "constraints.txt").read_text())
    return _hash("\n".join([code, *versions, *map(_hash_of, sorted(files))]).encode())


def _hash_of(path: Path) -> str:
    """A hash of a file's code, or of all of a file that is no code."""
    return _hash(read(path)[0].encode() if path.suffix == ".py" else path.read_bytes())


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]


def imports(code: str) -> set[Path]:
    """The files that code imports, directly or indirectly, found without importing anything."""
    seen: set[Path] = set()
    todo = [*_named(ast.parse(code), "")]
    while todo:
        name = todo.pop()
        if name.split(".")[0] not in OURS:
            continue
        stem = (BOOK if name.startswith("figures") else ROOT) / name.replace(".", "/")
        files = (stem.with_suffix(".py"), stem / "__init__.py")
        path = next((p for p in files if p.exists()), None)
        if path is None or path in seen:
            continue
        seen.add(path)
        todo += read(path)[1]
    return seen


@cache
def read(path: Path) -> tuple[str, list[str]]:
    """The code of a file without comments and docstrings, and the full names of its imports."""
    tree = ast.parse(path.read_text("utf-8"))
    package = path.parent.relative_to(BOOK if BOOK in path.parents else ROOT)
    return repr(_bare(tree)), [*_named(tree, ".".join(package.parts))]


def _bare(node: Any) -> Any:
    """A syntax tree without docstrings and empty fields, the same for each version of Python."""
    match node:
        case ast.Expr(ast.Constant()):
            return None
        case ast.AST():
            fields = (_bare(x) for _, x in ast.iter_fields(node) if x not in (None, []))
            return [type(node).__name__, *fields]
        case list():
            return [bare for x in node if (bare := _bare(x)) is not None]
    return node


def _named(tree: ast.AST, package: str) -> Iterator[str]:
    """The full names of the imports, without those for the type checker only."""
    nodes = [tree]
    for node in nodes:
        if isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING":
            continue
        nodes.extend(ast.iter_child_nodes(node))
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            up = package.rsplit(".", node.level - 1)[0] if node.level else ""
            base = ".".join(part for part in (up, node.module) if part)
            yield from (base, *(f"{base}.{alias.name}" for alias in node.names))
