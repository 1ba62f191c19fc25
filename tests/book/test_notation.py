"""The table of symbols is what the docstrings say."""

import ast
import importlib
import inspect
import pkgutil
import re
from itertools import pairwise
from pathlib import Path

import pytest
from figures.notation import ERRORS, SYMBOLS

import labkit

TABLE = {s.code: s for s in SYMBOLS if s.shape}
MODULES = [m.name for m in pkgutil.iter_modules(labkit.__path__) if not m.ispkg]


def public_docstrings():
    """Every public function and method of labkit, with its docstring."""
    for name in MODULES:
        module = importlib.import_module(f"labkit.{name}")
        for thing in vars(module).values():
            if getattr(thing, "__module__", None) != module.__name__:
                continue
            if inspect.isfunction(thing):
                yield thing.__qualname__, thing.__doc__ or ""
            elif inspect.isclass(thing):
                yield thing.__qualname__, thing.__doc__ or ""
                for member in vars(thing).values():
                    if inspect.isfunction(member) and not member.__name__.startswith("_"):
                        yield member.__qualname__, member.__doc__ or ""


DOCSTRINGS = dict(public_docstrings())


def entries(doc):
    """Pairs of an argument's name and its description."""
    for found in re.finditer(r"^ {4,12}(\w+): (.*(?:\n {8,16}(?! *\w+:).*)*)", doc, re.M):
        yield found[1], " ".join(found[2].split())


@pytest.mark.parametrize("name", sorted(TABLE))
def test_docstrings_give_this_symbol_the_tables_shape_and_unit(name):
    """Each argument of this name in labkit has the shape and unit of the table."""
    symbol, seen = TABLE[name], 0
    for where, doc in DOCSTRINGS.items():
        for argument, text in entries(doc):
            if argument != name or "shape" not in text:
                continue
            seen += 1
            stacked = r"\((?:\w+, )?" + re.escape(symbol.shape[1:].rstrip(",)")) + r",?\)"
            assert re.search(stacked, text), f"{where}: {argument}: {text}"
            if symbol.unit:
                assert f"[{symbol.unit}]" in text, f"{where}: {argument}: {text}"
    assert seen or name not in {"q", "dq", "T_wt", "T_ab"}, f"no docstring speaks of {name}"


def test_no_symbol_stands_twice():
    """Symbols and errors together have no name in code twice."""
    names = [s.code for s in (*SYMBOLS, *ERRORS)]
    assert len(names) == len(set(names))


def test_the_words_under_a_constant_have_no_colon_in_their_first_line():
    """The reference would print what stands before it as the constant's type."""
    for path in Path(labkit.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Module | ast.ClassDef):
                for constant, words in pairwise(node.body):
                    match constant, words:
                        case ast.Assign() | ast.AnnAssign(), ast.Expr(ast.Constant(str(text))):
                            assert ": " not in text.splitlines()[0], f"{path}: {text}"
