"""What is shown between a prediction and its reveal waits for the commitment."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SHOWS = ("print", "show", "dials", "slider", "display")
SOURCES = sorted(ROOT.glob("solutions/*/0[0-7]_*.py"))


def before_the_reveals():
    """Each prediction, and the code from its place to its reveal."""
    for path in SOURCES:
        for after in path.read_text().split('# %% predict="')[1:]:
            name, _, rest = after.partition('"')
            code, reveal, _ = rest.partition(f'predict("{name}", truth=')
            assert reveal, f"{path.name}: {name} has no reveal"
            yield pytest.param(name, code.rsplit("\n", 1)[0], id=name)


def shown_at_once(name, code):
    """Calls that show something although nobody has committed, outside of functions."""
    code = re.sub(r"^ *(if|else).*:\s*\Z", "", code, flags=re.M)  # an open branch before a reveal
    todo = list(ast.parse(code).body)
    while todo:
        node = todo.pop()
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            continue
        if isinstance(node, ast.If | ast.IfExp):
            test = ast.unparse(node.test)
            if test == f"{name} is not None":
                todo += node.orelse if isinstance(node.orelse, list) else [node.orelse]
                continue
            if test == f"{name} is None":
                todo += node.body
                continue
        if isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[-1] in SHOWS:
            yield ast.unparse(node)
        todo += ast.iter_child_nodes(node)


@pytest.mark.parametrize(("name", "code"), list(before_the_reveals()))
def test_nothing_is_shown_before_the_commitment(name, code):
    """No print, figure, replay or dial stands between a prediction and its reveal unguarded."""
    assert not list(shown_at_once(name, code))
