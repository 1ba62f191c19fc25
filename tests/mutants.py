"""Fifty mutants of what decides a mark or moves an arm: `python tests/mutants.py [COUNT]`.

They are drawn from the commit's hash.  Each is one changed operator, number or condition; it is
killed if the tests of its module fail.  A comparison is negated, since of two floats < and <= are
alike.  The survivors are printed, and more than a tenth is an error.
"""

import ast
import os
import random
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue

ROOT = Path(__file__).parents[1]
MODULES = {
    "labkit/course/judges.py": (
        "course/test_judges.py course/test_marking.py course/test_predictions.py"
    ),
    "labkit/course/marking.py": (
        "course/test_marking.py course/test_judges.py course/test_causes.py"
    ),
    "labkit/trajectory.py": "test_trajectory.py test_paths.py test_refusals.py",
    "labkit/model.py": "test_model.py test_kinematics.py test_impedance.py test_refusals.py",
    "labkit/joints.py": "test_joints.py test_plant_effects.py test_plant.py test_scene.py",
    "labkit/grader/grade.py": "grader/test_grade.py",
    "labkit/grader/roster.py": "grader/test_roster.py grader/test_collect.py",
}
"""Each module, and its tests in the gate."""
SWAPS = {
    ast.Lt: ast.GtE, ast.LtE: ast.Gt, ast.Gt: ast.LtE, ast.GtE: ast.Lt, ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult,
    ast.MatMult: ast.Add, ast.And: ast.Or, ast.Or: ast.And,
}  # fmt: skip


def places(tree):
    """The nodes that can be changed; no message, annotation or text of a class."""
    todo = [tree]
    while todo:
        node = todo.pop()
        if isinstance(node, ast.Raise | ast.JoinedStr | ast.Import | ast.ImportFrom):
            continue
        for field, value in ast.iter_fields(node):
            if field not in ("annotation", "returns", "decorator_list"):
                values = value if isinstance(value, list) else [value]
                todo += [x for x in values if isinstance(x, ast.AST)]
        ops = getattr(node, "ops", None) or [getattr(node, "op", None)]
        number = isinstance(node, ast.Constant) and isinstance(node.value, int | float)
        if number or type(ops[0]) in SWAPS or isinstance(node, ast.If | ast.IfExp):
            yield node


def change(node):
    """Change a node, and say how."""
    before = ast.unparse(node.test if isinstance(node, ast.If) else node)
    match node:
        case ast.Compare():
            node.ops[0] = SWAPS[type(node.ops[0])]()
        case ast.Constant(bool()):
            node.value = not node.value
        case ast.Constant():
            node.value = node.value + 1
        case ast.If() | ast.IfExp():
            node.test = ast.UnaryOp(ast.Not(), node.test)
        case _:
            node.op = SWAPS[type(node.op)]()
    after = ast.unparse(node.test if isinstance(node, ast.If) else node)
    return f"{before[:60]} -> {after[:60]}"


def drawn(count):
    """Modules, each with the number of one of its places."""
    head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, check=True)
    chance = random.Random(head.stdout)
    for k in range(count):
        name = list(MODULES)[k % len(MODULES)]
        found = list(places(ast.parse((ROOT / name).read_text())))
        yield name, chance.randrange(len(found))


def lives(checkout, name, place):
    """What was changed, where, if the tests of the module do not find it; else None."""
    path = checkout / name
    text = path.read_text()
    tree = ast.parse(text)
    node = list(places(tree))[place]
    said = f"{name}:{node.lineno}: {change(node)}"
    path.write_text(ast.unparse(ast.fix_missing_locations(tree)))
    words = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "-m", "not slow"]
    files = [f"tests/{file}" for file in MODULES[name].split()]
    environment = os.environ | {"PYTHONPATH": str(checkout)}
    try:
        done = subprocess.run(
            words + files, cwd=checkout, env=environment, capture_output=True, timeout=600
        )
    except subprocess.TimeoutExpired:
        return None
    finally:
        path.write_text(text)
    return None if done.returncode else said


def main(count):
    """Draw, try and count."""
    checkouts = SimpleQueue()
    with tempfile.TemporaryDirectory() as folder:
        for k in range(2):
            made = Path(folder) / str(k)
            subprocess.run(["git", "clone", "-q", "--shared", ROOT, made], check=True)
            checkouts.put(made)

        def tried(mutant):
            checkout = checkouts.get()
            try:
                return lives(checkout, *mutant)
            finally:
                checkouts.put(checkout)

        with ThreadPoolExecutor(2) as pool:
            survivors = [said for said in pool.map(tried, drawn(count)) if said]
    print(*survivors, f"{count - len(survivors)} of {count} mutants killed", sep="\n")
    return len(survivors) > count / 10


if __name__ == "__main__":
    sys.exit(main(int([*sys.argv[1:], "50"][0])))
