"""What a cell's text does: magics as a notebook understands them, and the names it defines."""

import ast
import json
import subprocess
import sys

import pytest

from labkit.course.source import analyse, dotted, plain

BODY = "def answer(x):\n    return 2 * x\n"
HEADS = [
    "", "%%time\n", "%%time \n", "\n\n%%time\n", "%%capture\n", "%%capture out --no-stderr\n",
    "%%prun -q\n", "%%time\n%%capture\n", "%%capture\n%%time\n", "%%timeit -n1 -r1\n",
    "%%bash\n", "%%html\n", "%%writefile x.py\n", "%%no_such_magic\n",
]  # fmt: skip
SHELL = """
import json, sys
from IPython.core.interactiveshell import InteractiveShell
shell, defined = InteractiveShell.instance(), []
for cell in json.load(sys.stdin):
    shell.user_ns.pop("answer", None)
    shell.run_cell(cell)
    defined.append("answer" in shell.user_ns)
print()
print(json.dumps(defined))
"""


def test_a_magic_defines_here_what_it_defines_in_a_notebook(tmp_path):
    """IPython itself is asked: an answer is found just where a notebook has it."""
    cells = [head + BODY for head in HEADS]
    done = subprocess.run(
        [sys.executable, "-c", SHELL],
        input=json.dumps(cells), capture_output=True, text=True, check=True, cwd=tmp_path,
    )  # fmt: skip
    defined = json.loads(done.stdout.splitlines()[-1])
    assert [("answer" in analyse(cell)["binds"]) for cell in cells] == defined
    assert [not analyse(cell)["magic"] for cell in cells] == defined
    assert len(set(defined)) == 2


def test_lines_keep_their_numbers():
    """An error below a magic has the number of the line that the student sees."""
    assert plain("%%time\n\n%%capture\nx = 1").split("\n")[3] == "x = 1"
    assert plain("x = 1\n%matplotlib inline\n!ls\ny = 2").split("\n")[3] == "y = 2"


def test_what_a_cell_needs_and_binds():
    """Names by def, class, import, loop and assignment, wherever they stand in a line."""
    found = analyse(
        "import a.b, c as d\nfor e in range(f): g = h; i = (\n 1)\nclass J(k): l = m\nn += 1"
    )
    assert found["binds"] == ["J", "a", "d", "e", "g", "i", "n"]
    assert set(found["uses"]) == {"f", "h", "k", "m", "range"}
    assert analyse("a = (1,\n 2); b = a; from x import *")["binds"] == ["*", "a", "b"]


@pytest.mark.parametrize(
    "source",
    [
        "(" * 500,
        "x = '\0'",
        "def f(:",
        "-" * 100_000 + "1",
        "a" + ".b" * 5000,
        "\ud800",
        "%%",
        "%%\n",
    ],
)
def test_no_text_is_too_odd(source):
    """The analysis of any cell's text has the same parts as that of x = 1."""
    assert set(analyse(source)) == set(analyse("x = 1"))


def test_dotted_names():
    """What a call gives is taken for what is called; a constant getattr is an attribute."""
    for text, name in [
        ("lk.Model('left').gravity(q)", "lk.Model.gravity"),
        ("getattr(lk, 'Circle')(s)", "lk.Circle"),
        ("getattr(lk, name)", "getattr"),
        ("[lk][0].Circle", ""),
    ]:
        assert dotted(ast.parse(text, mode="eval").body) == name
