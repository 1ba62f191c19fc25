"""The size of the project, and the ceilings that hold it: `make count` prints both.

A line of Python counts if it has a token that is neither a comment nor a part of a docstring; of
all other files that are written by hand, each line that is not blank.
"""

import ast
import io
import re
import subprocess
import tokenize
from pathlib import Path

ROOT = Path(__file__).parents[1]
STOREYS = {
    "lab": (r"labkit/(?!course/|grader/|__main__).*\.py", 4400),
    "course": (r"labkit/(course/|__main__).*\.py", 3700),
    "grader": (r"labkit/grader/.*\.py", 4100),
    "solutions": (r"solutions/.*\.py", 11150),
    "book": (r"book/.*\.py", 5970),
    "tests": (r"tests/.*\.py", 15000),
    "JavaScript, styles": (r".*\.(js|mjs|css)", 4700),
    "templates, texts": (r".*\.(j2|html|toml|yml|yaml)|solutions/.*\.(md|txt)", 990),
    "commands": (r"Makefile|Dockerfile|nbgrader_config.py|.*\.sh|\.ci/(?!.*(toml|yml|md)$).*", 620),
}
"""The files of each storey, and its ceiling. After a deletion, lower it; nobody raises it."""
MADE = re.compile(r"assignments/|labkit/data/|.*/(constraints|(vendor|bundle)/(?!build))")
"""Files that are generated, or somebody else's."""
BLANK = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT,
         tokenize.ENDMARKER}  # fmt: skip


def lines(path):
    """How many lines of a file count."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return sum(bool(line.strip()) for line in text.splitlines())
    found = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in BLANK:
            found.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(text)):
        match node:
            case ast.Expr(ast.Constant(str())):
                found -= set(range(node.lineno, node.end_lineno + 1))
    return len(found)


def count():
    """Of each storey the number of files and of lines, and the ceiling."""
    asked = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    done = subprocess.run(asked, cwd=ROOT, capture_output=True, text=True, check=True)
    names = [x for x in done.stdout.split() if not MADE.match(x) and (ROOT / x).is_file()]
    for storey, (pattern, ceiling) in STOREYS.items():
        files = [ROOT / name for name in names if re.fullmatch(pattern, name)]
        yield storey, len(files), sum(map(lines, files)), ceiling


def test_no_storey_is_over_its_ceiling():
    """What grows by more than a path or a law is paid by a deletion in the same storey."""
    over = {name: f"delete {code - most} lines" for name, _, code, most in count() if code > most}
    assert not over


if __name__ == "__main__":
    print(f"{'':20}{'files':>7}{'lines':>8}{'ceiling':>9}")
    for storey, files, code, ceiling in count():
        print(f"{storey:20}{files:7}{code:8}{ceiling:9}")
