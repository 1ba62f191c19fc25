"""Times belong to the bench: a slow machine fails no test."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
CLOCKS = {"time", "monotonic", "perf_counter", "process_time", "thread_time"}
SLOW = """
def test_runs():
    before = time.monotonic()
    run()
    took = time.monotonic() - before
    assert {}
"""


def limits_on_time(source: str) -> Iterator[int]:
    """Lines that assert that something took no longer than so many seconds.

    A loop may still end at a deadline, a clock's time compared with another; that is a guard.
    """
    for function in ast.walk(ast.parse(source)):
        if not isinstance(function, ast.FunctionDef):
            continue
        spans: set[str] = set()
        for one in ast.walk(function):
            if isinstance(one, ast.Assign) and _is_span(one.value, spans):
                spans |= {target.id for target in one.targets if isinstance(target, ast.Name)}
        for one in ast.walk(function):
            if isinstance(one, ast.Assert) and any(_limits(x, spans) for x in ast.walk(one.test)):
                yield one.lineno


def _limits(node: ast.AST, spans: set[str]) -> bool:
    if not isinstance(node, ast.Compare):
        return False
    sides = [node.left, *node.comparators]
    below = (ast.Lt, ast.LtE)
    return any(
        _is_span(left if isinstance(op, below) else right, spans)
        for left, op, right in zip(sides, node.ops, node.comparators, strict=False)
        if isinstance(op, (*below, ast.Gt, ast.GtE))
    )


def _is_span(node: ast.AST, spans: set[str]) -> bool:
    """Whether a difference of two of a clock's times takes part."""
    return any(
        (isinstance(x, ast.Name) and x.id in spans)
        or (isinstance(x, ast.BinOp) and isinstance(x.op, ast.Sub) and any(map(_asks, ast.walk(x))))
        for x in ast.walk(node)
    )


def _asks(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and getattr(node.func, "attr", "") in CLOCKS


def test_no_test_asserts_that_something_is_quick():
    """A gate that passes here passes on a machine three times slower."""
    found = {
        f"{path.relative_to(TESTS)}:{line}"
        for path in TESTS.rglob("*.py")
        for line in limits_on_time(path.read_text("utf-8"))
    }
    assert not found


@pytest.mark.parametrize(
    ("asserted", "found"),
    [
        ("took < 20.0", True),
        ("20.0 >= took", True),
        ("0.0 < time.perf_counter() - before < 5.0", True),
        ("took >= 1.0", False),
        ("time.monotonic() < until", False),
    ],
)
def test_a_limit_is_seen(asserted, found):
    """From either side, by name or in place; a least time and a deadline do not count."""
    assert bool([*limits_on_time(SLOW.format(asserted))]) == found
