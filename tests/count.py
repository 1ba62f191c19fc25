"""The size of labkit, in lines of code and statements of each layer: `make count`.

A line of code has a token that is neither a comment nor a part of a docstring.
"""

import ast
import io
import tokenize
from collections import Counter
from pathlib import Path

LABKIT = Path(__file__).parents[1] / "labkit"
LAYERS = {"course": "course", "grader": "grader", "__main__.py": "course"}
"""The layers of the folders and of the command line; all other files belong to the lab."""
LARGE = 200
BLANK = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT,
         tokenize.ENDMARKER}  # fmt: skip


def lines(text):
    """The lines of code in a module's text."""
    found = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in BLANK:
            found.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(text)):
        if is_text(node):
            found -= set(range(node.lineno, node.end_lineno + 1))
    return len(found)


def statements(text):
    """The number of statements in a module's text, without docstrings."""
    return sum(isinstance(n, ast.stmt) and not is_text(n) for n in ast.walk(ast.parse(text)))


def is_text(node):
    """Whether a statement is a docstring or the description below a constant."""
    match node:
        case ast.Expr(ast.Constant(str())):
            return True
    return False


def main():
    """Print the table, the large files and how many names ``lk.`` offers."""
    code, stated, files, large = Counter(), Counter(), Counter(), []
    for path in sorted(LABKIT.rglob("*.py")):
        layer = LAYERS.get(path.relative_to(LABKIT).parts[0], "lab")
        text = path.read_text(encoding="utf-8")
        count = lines(text)
        code[layer] += count
        stated[layer] += statements(text)
        files[layer] += 1
        if count > LARGE:
            large.append(f"{path.relative_to(LABKIT.parent)} ({count})")
    print("layer    files   lines   statements")
    for layer in ("lab", "course", "grader"):
        print(f"{layer:8}{files[layer]:6}{code[layer]:8}{stated[layer]:13}")
    print(f"together{files.total():6}{code.total():8}{stated.total():13}")
    print(f"files over {LARGE} lines of code: {', '.join(large) or 'none'}")
    tree = ast.parse((LABKIT / "__init__.py").read_text(encoding="utf-8"))
    (names,) = (
        n.value for n in tree.body
        if isinstance(n, ast.Assign) and getattr(n.targets[0], "id", "") == "__all__"
    )  # fmt: skip
    print(f"names exported by labkit: {len(names.elts)}")


if __name__ == "__main__":
    main()
