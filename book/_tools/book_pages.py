"""The book's pages: their order, and the code and data from which each page is computed."""

from __future__ import annotations

import ast
import hashlib
import importlib.metadata
import json
import re
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
BOOK = ROOT / "book"
sys.path[:0] = [str(ROOT), str(BOOK)]  # this checkout, even if another is installed
HTML = BOOK / "_build/html"
CACHE = ROOT / "build/book"
CAMPAIGN = CACHE / "campaign.json"

OURS = ("labkit", "solutions", "figures")
DATA = (
    "labkit/data/baxter.json",
    "solutions/study/baseline/baxter_collision.json",
    "labkit/data/campaign.json",
    "solutions/study/assumptions.json",
)
ENGINES = (
    *filter(find_spec, ("pybullet", "mujoco")),
    *("numpy", "scipy", "pin", "matplotlib", "opencv-python-headless"),
)
FIGURES = re.compile(r"^from (figures(?:\.\w+)?) import ([\w, ]+)", re.M)


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


def page_keys() -> dict[str, str]:
    """A hash of all the code that a page uses, for each page that computes something."""
    keys = {}
    for name in in_order():
        page = BOOK / f"{name}.md"
        used = FIGURES.findall(page.read_text()) if page.exists() else []
        if not used:
            continue
        modules = dict.fromkeys(
            f"{package}.{name}" if package == "figures" else package
            for package, names in used
            for name in names.split(", ")
        )
        parts = [key_of(module) for module in modules]
        if {"figures.comparison", "figures.gallery"} & modules.keys():
            parts.append(hashlib.sha256(CAMPAIGN.read_bytes()).hexdigest()[:16])
        keys[name] = " ".join(parts)
    return keys


def forget_stale(folder: Path, keys: dict[str, str]) -> None:
    """Delete the kept outputs of pages whose code has changed since they were run."""
    from jupyter_cache import get_cache

    known = folder / "keys.json"
    before = json.loads(known.read_text()) if known.exists() else {}
    cache = get_cache(str(folder))
    for record in cache.list_cache_records():
        name = str(Path(record.uri).relative_to(BOOK).with_suffix(""))
        if name not in keys or keys[name] != before.get(name):
            cache.remove_cache(record.pk)
    folder.mkdir(parents=True, exist_ok=True)
    known.write_text(json.dumps(keys))


def key_of(module: str) -> str:
    """A hash of a module and of all our modules that it imports, directly or indirectly."""
    digest = hashlib.sha256()
    for path in [*(ROOT / name for name in DATA), *sorted(imports(module))]:
        digest.update(path.read_bytes())
    for name in ENGINES:
        digest.update(f"{name} {importlib.metadata.version(name)}\n".encode())
    return digest.hexdigest()[:16]


def imports(module: str) -> set[Path]:
    """The files of a module and of its imports, found without importing anything."""
    seen: set[Path] = set()
    todo = [module]
    while todo:
        name = todo.pop()
        stem = (BOOK if name.startswith("figures") else ROOT) / name.replace(".", "/")
        files = (stem.with_suffix(".py"), stem / "__init__.py")
        path = next((p for p in files if p.exists()), None)
        if path is None or path in seen:
            continue
        seen.add(path)
        package = name if path.name == "__init__.py" else name.rpartition(".")[0]
        todo += [n for n in _named(path, package) if n.split(".")[0] in OURS]
    return seen


def _named(path: Path, package: str) -> Iterator[str]:
    """The full names of a file's imports, without those for the type checker only."""
    nodes: list[ast.AST] = [ast.parse(path.read_text())]
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
