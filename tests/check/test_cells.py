"""What a cell's text does: magics as a notebook understands them, and the names it defines."""

import pytest
from IPython.core.interactiveshell import InteractiveShell

from labkit.check.cells import dotted, look, plain

BODY = "def answer(x):\n    return 2 * x\n"


@pytest.fixture(scope="module")
def shell(tmp_path_factory):
    """A notebook's shell."""
    shell = InteractiveShell()
    yield shell
    shell.history_manager.end_session()


@pytest.mark.parametrize(
    "head",
    [
        "", "%%time\n", "%%time \n", "\n\n%%time\n", "%%capture\n", "%%capture out --no-stderr\n",
        "%%prun -q\n", "%%time\n%%capture\n", "%%capture\n%%time\n", "%%timeit -n1 -r1\n",
        "%%bash\n", "%%html\n", "%%writefile {folder}/x.py\n", "%%no_such_magic\n",
    ],
)  # fmt: skip
def test_a_magic_defines_here_what_it_defines_in_a_notebook(shell, tmp_path, head, capsys):
    """IPython itself is asked: an answer is found just where a notebook has it."""
    source = head.format(folder=tmp_path) + BODY
    shell.user_ns.pop("answer", None)
    shell.run_cell(source)
    capsys.readouterr()
    found = look(source)
    assert ("answer" in found["binds"]) == ("answer" in shell.user_ns)
    assert bool(found["magic"]) == ("answer" not in shell.user_ns)


def test_lines_keep_their_numbers():
    """An error below a magic is told with the line in which it stands."""
    assert plain("%%time\n\n%%capture\nx = 1").split("\n")[3] == "x = 1"
    assert plain("x = 1\n%matplotlib inline\n!ls\ny = 2").split("\n")[3] == "y = 2"


def test_what_a_cell_needs_and_binds():
    """Names by def, class, import, loop and assignment, wherever they stand in a line."""
    found = look(
        "import a.b, c as d\nfor e in range(f): g = h; i = (\n 1)\nclass J(k): l = m\nn += 1"
    )
    assert found["binds"] == ["J", "a", "d", "e", "g", "i", "n"]
    assert set(found["uses"]) == {"f", "h", "k", "m", "range"}
    assert look("a = (1,\n 2); b = a; from x import *")["binds"] == ["*", "a", "b"]


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
    """Whatever stands in a cell, a look at it comes back."""
    assert set(look(source)) == set(look("x = 1"))


def test_dotted_names():
    """What a call gives is taken for what is called; a constant getattr is an attribute."""
    import ast

    for text, name in [
        ("lk.Model('left').gravity(q)", "lk.Model.gravity"),
        ("getattr(lk, 'Circle')(s)", "lk.Circle"),
        ("getattr(lk, name)", "getattr"),
        ("[lk][0].Circle", ""),
    ]:
        assert dotted(ast.parse(text, mode="eval").body) == name
