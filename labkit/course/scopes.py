"""Scopes of statements: the names that they bind, and those that they take from outside."""

from __future__ import annotations

import ast
import copy
import symtable
import sys
from collections.abc import Iterator
from contextlib import suppress


class _Generators(ast.NodeTransformer):
    """Makes a generator of each comprehension."""

    def visit(self, node: ast.AST) -> ast.AST:
        """The node, or a generator of the same elements."""
        self.generic_visit(node)
        if isinstance(node, ast.DictComp):
            pair = ast.Tuple([node.key, node.value], ast.Load())
            return ast.GeneratorExp(pair, node.generators)
        if isinstance(node, ast.ListComp | ast.SetComp):
            return ast.GeneratorExp(node.elt, node.generators)
        return node


def scope_of(part: list[ast.stmt], text: str) -> symtable.SymbolTable:
    """The names of statements, written as ``text``, and of the scopes in them."""
    if sys.version_info >= (3, 12):
        # There the variables of a comprehension are among the names of the scope around it.
        with suppress(RecursionError):  # a sum of hundreds of terms
            text = ast.unparse(_Generators().visit(ast.Module(copy.deepcopy(part), [])))
    return symtable.symtable(text, "", "exec")


def own_names(scope: symtable.SymbolTable) -> set[str]:
    """Names that a scope binds itself."""
    return {x.get_name() for x in scope.get_symbols() if x.is_assigned() or x.is_imported()}


def functions_in(scope: symtable.SymbolTable) -> Iterator[symtable.SymbolTable]:
    """The functions in a scope, those in classes included; comprehensions run at once."""
    for inner in scope.get_children():
        if inner.get_type() == "function" and ".0" not in inner.get_identifiers():
            yield inner
        else:
            yield from functions_in(inner)


def outside_names(scope: symtable.SymbolTable) -> Iterator[str]:
    """Names that a scope takes from outside."""
    top = scope.get_type() == "module"
    own = own_names(scope) if top else set()
    for symbol in scope.get_symbols():
        outside = symbol.is_referenced() and (top or symbol.is_global())
        if outside and symbol.get_name() not in own:
            yield symbol.get_name()
    for inner in scope.get_children():
        yield from (name for name in outside_names(inner) if name not in own)
