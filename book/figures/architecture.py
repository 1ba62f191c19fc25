"""Page "How it is made": labkit's modules and their imports, read from the source code."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from html import escape
from pathlib import Path

from IPython.display import HTML

import labkit

from .page import framed, holds

HOME = Path(labkit.__file__).parent
LAYERS = (
    ("Sentences and numbers", ("errors", "quiet", "formats", "shapes", "se3")),
    ("What is wanted", ("trajectory", "paths")),
    ("What is known", ("plant", "urdf", "robot", "baxter", "kinematics", "model")),
    ("The world and its commands", ("control", "joints", "sim", "world", "scene")),
    ("The arm", ("sensors", "springs", "motors", "arm")),
    (
        "The loop, and what it did",
        ("log", "arm_adapters", "run", "metrics", "recordings", "stability"),
    ),
    ("What sees, draws and shows", ("tags", "plotting", "replay")),
    ("What judges", ("course",)),
    ("For instructors", ("grader",)),
)
"""From the ground up: a module imports from its own row and the rows below, never above."""

WIDE, HIGH, LEFT = 112, 30, 8


def imported(name: str) -> set[str]:
    """The modules of labkit that a module imports when it is loaded or later."""
    files = [HOME / f"{name}.py"] if (HOME / f"{name}.py").exists() else (HOME / name).rglob("*.py")
    return {found for path in files for found in _named(path)} - {name}


def _named(path: Path) -> Iterator[str]:
    depth = len(path.relative_to(HOME).parts)
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level == depth:
            stem = node.module.split(".")[0] if node.module else None
            yield from [stem] if stem else [alias.name for alias in node.names]


def picture() -> HTML:
    """Draw the rows of modules, each above the rows from which it imports."""
    row_of = {name: k for k, (_, names) in enumerate(LAYERS) for name in names}
    drawn = set(row_of)
    arrows = {(a, b) for a in drawn for b in imported(a) & drawn}
    modules, folders = HOME.glob("[a-z]*.py"), HOME.glob("*/__init__.py")
    there = {path.stem for path in modules} | {path.parent.name for path in folders}
    strays = ", ".join(sorted(there ^ drawn))
    holds(
        not strays,
        "LAYERS of book/figures/architecture.py has each module and folder of labkit, and no "
        f"other; enter there, or take out: {strays}",
    )
    holds(all(row_of[b] <= row_of[a] for a, b in arrows), "imports point down, never up")
    parts = []
    height = len(LAYERS) * 62 + 6
    for k, (title, names) in enumerate(LAYERS):
        y = height - 62 * (k + 1)
        parts.append(f'<text x="{LEFT}" y="{y + 12}" font-size="13">{title}</text>')
        for i, name in enumerate(names):
            x = LEFT + i * (WIDE + 10)
            parts.append(
                f'<rect x="{x}" y="{y + 19}" width="{WIDE}" height="{HIGH}" rx="5" fill="none" '
                f'stroke="var(--line-{k % 7})" stroke-width="2"/>'
                f'<text x="{x + WIDE / 2}" y="{y + 38}" text-anchor="middle" font-size="14" '
                f'fill="currentColor">{name}</text>'
            )
    alt = (
        f"{len(LAYERS)} rows of modules, from the ground up: "
        + "; ".join(f"{title.lower()}: {', '.join(names)}" for title, names in LAYERS)
        + f". All {len(arrows)} imports among them point to the same row or a lower one."
    )
    width = LEFT + max(len(names) for _, names in LAYERS) * (WIDE + 10)
    svg = (
        f'<svg class="lab-svg" role="img" aria-label="{escape(alt)}" '
        f'viewBox="0 0 {width} {height}" fill="currentColor" xmlns="http://www.w3.org/2000/svg">{"".join(parts)}</svg>'
    )
    caption = f"labkit from the ground up. All {len(arrows)} imports point sideways or down."
    return HTML(framed(svg, caption, alt))
