"""Which cell answers a question: the hand-in, merging and marking agree, and a student is told."""

import json
import shutil
from importlib import import_module
from pathlib import Path

import pytest

from labkit.course.before_handing_in import examine
from labkit.course.definitions import answer_hash, written_cells
from labkit.course.merge import merge
from labkit.course.notebook import kind, read_cells, verdict_metadata
from labkit.course.source import analyse
from labkit.course.verdict import Outcome, Verdict

ASSIGNMENT = Path(__file__).resolve().parents[2] / "assignments" / "01_paths"
CIRCLE = "def circle(s, start, centre):\n    return {}"
STUB = CIRCLE.replace("return {}", "raise NotImplementedError")


@pytest.fixture
def path(tmp_path):
    return Path(shutil.copytree(ASSIGNMENT, tmp_path / "01_paths")) / "01_paths.ipynb"


def code(source, **more):
    return {"cell_type": "code", "metadata": {}, "source": source, "outputs": [], **more}


def handed_in(path, answer, *below, above=(), judged=()):
    """The look at a notebook with this answer to `circle`, and cells above it and below its check.

    Args:
        path: The notebook.
        answer: The text of the answer's cell.
        below: Cells to insert below the check.
        above: Cells to insert at the top.
        judged: The cells that had run when the answer was checked last, and was right.
    """
    data, cells = json.loads((ASSIGNMENT / path.name).read_text()), []
    verdict = Verdict("circle", Outcome.RIGHT, 4.0, 4.0)
    for cell in data["cells"]:
        cells.append(cell)
        if cell["metadata"].get("nbgrader", {}).get("grade_id") == "circle":
            cell["source"] = answer
        if 'check("circle"' in "".join(cell["source"]):
            if judged:
                metadata = verdict_metadata(verdict, answer_hash(judged, "circle"))
                shown = {"output_type": "display_data", "data": {}, "metadata": metadata}
                cell["outputs"] = [shown]
            cells += below
    data["cells"] = [*cells[:2], *above, *cells[2:]]
    path.write_text(json.dumps(data))
    return examine(path)


def test_an_answer_that_is_defined_again_below_its_check_is_named(path):
    """The check judged another function than the one that is marked."""
    again = code(CIRCLE.format("0"))
    (problem,) = handed_in(path, CIRCLE.format("1"), again).problems
    assert problem == (
        "the cell that begins with `def circle(s, start, centre):` defines circle again below its "
        "check, and that later one is marked; delete it, or check again below it"
    )
    assert not handed_in(path, CIRCLE.format("1"), code(STUB)).problems
    check = code('check("circle", circle)')
    assert not handed_in(path, CIRCLE.format("1"), again, check).problems


def test_a_copy_of_a_check_takes_nothing_away(path):
    """A cell that is there twice with its name does no harm unless another answer counts."""
    cells = read_cells(path)
    check = next(cell for cell in cells if 'check("circle"' in cell["source"])
    assert not handed_in(path, CIRCLE.format("1"), check).problems


@pytest.mark.parametrize(
    ("above", "below"),
    [
        ("def half(x): return x / 2", "def half(a, t): return a * t"),
        ("half = 4.0", "for half in range(3): print(half)"),
        ("if True:\n    def half(): pass", "if True:\n    def half(): return 1"),
    ],
)
def test_a_helper_that_is_defined_again_below_the_check_is_named(path, above, below):
    """Answers are marked after all cells have run, with the last definition of what they use."""
    answer = "def deep(s): return half\n" + CIRCLE.format("deep(s)")
    (problem,) = handed_in(path, answer, code(below), above=[code(above)]).problems
    assert problem.startswith("circle uses half, which the cell that begins with `")
    assert "defines again below the check, and circle is marked with that half" in problem


@pytest.mark.parametrize(
    "below",
    [
        "half[0] = 5.0",
        "half[:] = [1.0]",
        "half[0][1] += 1",
        "del half[0]",
        "half.size = 3",
        "half[0].size = 3",
        "half.append(3.0)",
        "last = half.pop()",
        "for k in range(3):\n    half.sort()",
        "half = [4.0]\nhalf.clear()",
        "import numpy as np\nnp.pi = 3",
    ],
)
def test_what_the_answer_uses_and_a_cell_below_the_check_changes_is_named(path, below):
    """An object that is changed keeps its name, and marking uses what it holds at the end."""
    name, above = "np.pi" if "np" in below else "half", "import numpy as np\nhalf = [4.0]"
    answer = "def deep(s): return half[0] * np.pi\n" + CIRCLE.format("deep(s)")
    (problem,) = handed_in(path, answer, code(below), above=[code(above)]).problems
    first, other = below.partition("\n")[0], "give the changed value another name"
    assert problem == (
        f"circle uses {name}, which the cell that begins with `{first}` changes below the check, "
        f"and circle is marked with that {name}; {'do not change it' if '.' in name else other}, "
        "or check circle again below it"
    )


@pytest.mark.parametrize(
    ("above", "below"),
    [
        ("half = [4.0]\nhalf[0] = 5.0", ""),
        ("half = [4.0]", "half[0] = 5.0\nhalf = [4.0]"),
        ("half = [4.0]", "def later(): half[0] = 5.0"),
        ("half = [4.0]", "runs = []\nruns.append(half[0])"),
        ("half = [4.0]", "calls.clear()"),
        ("def half(): return [4.0]", "half().sort()\nhalf()[0] = 5.0\nhalf().size = 3"),
        ("half = [4.0]", "plt.rcParams['font.size'] = 9\nlonger = np.append(half, 1)"),
    ],
)
def test_a_change_that_the_answer_does_not_meet_is_not_named(path, above, below):
    """Above the check, undone, in a function, of another object, or of an answer's own record."""
    answer = (
        "calls = []\ndef circle(s, start, centre):\n    calls.append(s)\n"
        "    plt.plot(np.array(half))\n    return 0"
    )
    imports = "import numpy as np\nimport matplotlib.pyplot as plt\n"
    assert not handed_in(path, answer, code(below), above=[code(imports + above)]).problems


def test_what_is_hidden_below_the_check_is_named(path):
    """A value takes Python's function, or another answer, from an answer that ran before."""
    above = [code("def bang_bang(*a): return 1")]
    for name in "sum", "bang_bang":
        answer = f"class Turn:\n    def by(self): return {name}([1])\n" + CIRCLE.format(
            "Turn().by()"
        )
        (problem,) = handed_in(path, answer, code(f"{name} = 0"), above=above).problems
        assert problem == (
            f"circle uses {name}, which the cell that begins with `{name} = 0` defines again below "
            f"the check, and circle is marked with that {name}; change one of the two names, or "
            "check circle again below it"
        )


def test_the_check_of_another_function_is_named(path):
    """What is marked has the question's name, and where there is a function, it is the function."""
    cells = code("def ring(*a): return 2"), code("check('circle', ring)")
    (problem,) = handed_in(path, CIRCLE.format("1"), *cells).problems
    assert problem == (
        "the check of circle tried ring, but circle is marked; check circle itself, or rename "
        "ring to circle and check it again"
    )
    cells = code("circle = abs"), code("check('circle', circle)")
    (problem,) = handed_in(path, CIRCLE.format("1"), *cells).problems
    assert problem == (
        "the check of circle tried what the cell that begins with `circle = abs` defines, but the "
        "cell that begins with `def circle(s, start, centre):` is marked; write your answer there"
    )


@pytest.mark.parametrize("tried", ["lambda s, start, centre: 2", "(\n    ring\n)", "rings[0]"])
def test_the_check_of_what_has_no_name_is_named(path, tried):
    """An expression is not the answer, on however many lines it is written."""
    cells = code("def ring(*a): return 2\nrings = [ring]"), code(f"check('circle', {tried})")
    (problem,) = handed_in(path, CIRCLE.format("1"), *cells).problems
    plain = " ".join(tried.split()).strip("( )")
    assert problem.startswith(f"the check of circle tried {plain}, but circle is marked; check")
    assert ("rename ring" in problem) == (plain == "ring")


@pytest.mark.parametrize(
    "last",
    [
        "check(\n    'circle',\n    circle,\n)",
        "%time check('circle', circle)",
        "check('circle', function=circle)",
        "check('circle', abs); check('circle', circle)",
    ],
)
def test_the_last_check_counts_however_it_is_written(path, last):
    """It tries what is marked, so nothing above it has to be corrected."""
    again = code(CIRCLE.format("2")), code("check('circle', abs)"), code(last)
    assert not handed_in(path, CIRCLE.format("1"), *again).problems


def test_a_timed_statement_defines_its_name(path):
    """IPython's %time runs one statement as it is."""
    timed = [code("%time half = 4.0"), code("%time import math")]
    assert not handed_in(path, CIRCLE.format("half * math.pi"), above=timed).problems
    # With an option, its name is not seen, but the cell is read.
    assert not analyse("%time --no-raise-error two = 2")["broken"]


def test_a_module_that_an_import_of_everything_brings_is_the_same(path):
    """Matplotlib's pyplot has a name np, too, and means NumPy by it."""
    import_module("matplotlib.pyplot")  # in a notebook labkit has loaded it
    answer, every = CIRCLE.format("np.pi"), code("from matplotlib.pyplot import *")
    found = handed_in(path, answer, every, above=[code("import numpy as np")])
    assert not any("np" in problem for problem in found.problems)


@pytest.mark.parametrize("above", ["", "from math import *", "from numpy import pi"])
def test_an_import_of_everything_below_the_check_is_named(path, above):
    """It hides Python's own functions, and what was imported before from elsewhere."""
    every, answer = "from numpy import *", CIRCLE.format("min(s, 1) + max(s, 0)")
    (problem,) = handed_in(path, answer, code(every), above=[code(above)]).problems
    assert problem == (
        f"circle uses max and min, which the cell that begins with `{every}` defines again below "
        "the check, and circle is marked with those; import only the names that you need, or "
        "check circle again below it"
    )
    again = code("check('circle', circle)")
    assert not handed_in(path, answer, code(every), again, above=[code(above)]).problems
    for one in ("from numpy import pi", every):
        pi = handed_in(path, CIRCLE.format("pi"), code(every), above=[code(one)])
        assert not pi.problems


def test_an_import_of_everything_hides_what_a_module_without_a_list_has(path):
    """Where a module has no list of its public names, those without an underscore are public."""
    answer, every = CIRCLE.format("pow(s, 1), __name__"), code("from math import *")
    (problem,) = handed_in(path, answer, every).problems
    assert problem.startswith("circle uses pow, which")


def test_an_answer_may_stand_above_a_value_that_it_needs_at_once(path):
    """A cell that lacks a name runs once more after all others, so this costs nothing."""
    answer = CIRCLE.format("1").replace("centre)", "centre, four=FOUR)")
    assert not handed_in(path, answer, code("FOUR = 4.0")).problems


def test_a_comment_tries_nothing_and_an_empty_stub_replaces_nothing(path):
    """A check that is a comment is not run, and marking ignores a stub below the answer."""
    said = code('check("circle", circle)\n# check("circle", ring)')
    assert not handed_in(path, CIRCLE.format("1"), said).problems
    assert not handed_in(path, STUB, above=[code(CIRCLE.format("1"))]).problems
    above = [code("def compose(*a): return 1")]
    assert not handed_in(path, CIRCLE.format("compose(s)"), above=above).problems


def test_a_given_cell_that_no_answer_needs_does_not_count(path):
    """A name of the answer's cell has its value from there, unless the given cell was edited."""
    given = next(x for x in read_cells(path) if "lk.Circle(" in x["source"] and kind(x) == "walk")
    name = min(analyse(given["source"])["binds"])
    answer, edited = f"{name} = 1\n" + CIRCLE.format(name), {"lab": "walk", "released": "0"}
    assert not handed_in(path, answer).problems
    (problem,) = handed_in(path, answer, code(f"{name} = 2", metadata=edited)).problems
    assert problem.startswith(f"circle uses {name}, which")


@pytest.mark.parametrize(
    ("above", "below"),
    [
        ("import math, os", "import math"),
        ("", "half = 4.0"),
        ("half = 4.0", "def other():\n    half = 3\n    return half"),
        ("half = 4.0", "bang_bang = 3"),
        ("half = 4.0\nall = [half for half in 'ab']", "half = 4.0"),
        ("two = 2\nhalf = [two for _ in 'ab']", "two = 3"),
    ],
)
def test_what_the_answer_does_not_meet_is_not_named(path, above, below):
    """The same import or value, a local name, another question and a value used up do no harm."""
    answer = CIRCLE.format("math.pi" if "math" in above else "half")
    found = handed_in(path, answer, code(below), above=[code(above)])
    assert not any("circle" in problem for problem in found.problems)


LOOP = "def circle(s, start, centre):\n    for k in s:\n        k\n    return 0"
COUNT = "def circle(s, start, centre):\n    circle.calls += 1\n    return {}"
RIGHT, OTHER, HALF, PI = map(CIRCLE.format, ("1", "2", "half", "math.pi"))


@pytest.mark.parametrize(
    ("judged", "above", "answer", "below"),
    [
        ([RIGHT], [], OTHER, []),
        ([LOOP], [], LOOP.replace("    return", "        return"), []),
        (["half = 2", HALF], ["half = 3"], HALF, []),
        ([STUB, RIGHT], [], STUB, [OTHER]),
        (["half = [2]\nhalf[0] = 3", HALF], ["half = [2]\nhalf[0] = 4"], HALF, []),
        (["half = [2]\nhalf[0] = 3", HALF], ["half = [2]"], HALF, []),
        (["half = [0]; half[0] = 3", HALF], ["half = [0]; half[0] = 4"], HALF, []),
        ([f"{RIGHT}\ncircle.last = 1"], [], f"{OTHER}\ncircle.last = 1", []),
        (["half = 2\nhalf *= 2", HALF], ["half = 3\nhalf *= 2"], HALF, []),
        (["half = [2]\nhalf.append(a)", "a = 1", HALF], ["half = [2]\nhalf.append(a)"], HALF, []),
    ],
)
def test_an_answer_that_was_edited_after_its_check_is_not_called_right(
    path, judged, above, answer, below
):
    """The verdict belongs to what was judged, wherever the answer and what it uses are."""
    notes = handed_in(path, answer, *map(code, below), above=map(code, above), judged=judged).notes
    assert any("changed since the last check: circle;" in note for note in notes)


@pytest.mark.parametrize(
    ("judged", "above", "answer", "below"),
    [
        ([RIGHT], [], RIGHT.replace("\n", " \n\n") + "\n\n", []),
        (["half = 2", HALF], ["half = 2"], HALF, []),
        (["half = 2", HALF], [], HALF, ["half = 2"]),
        (["import math", PI], ["import math, os"], PI, []),
        (["two = 2", "half = two", HALF], ["two = 2", "half = two"], HALF, ["two = 3"]),
        (["two = 2", "half = two", "two = 3", HALF], ["two = 2", "half = two"], HALF, ["two = 3"]),
        ([STUB, RIGHT], [], STUB, [RIGHT]),
        ([HALF], [], HALF, ["half = 2"]),
        ([COUNT.format(1), COUNT.format(2)], [], COUNT.format(2), []),
        (
            ["half = [0]; half[0] = 2", "half = [0]; half[0] = 3", HALF],
            ["half = [0]; half[0] = 3"],
            HALF,
            [],
        ),
        (["half = [2]\nhalf[0] = 3"] * 2 + [HALF], ["half = [2]\nhalf[0] = 3"], HALF, []),
        (
            ["import os\na = os.sort(1)", HALF + " + os.x"],
            ["import os\na = os.sort(2)"],
            HALF + " + os.x",
            [],
        ),
        (["half = [2]", "half[0] = 3", "half = [2]", HALF], ["half = [2]"], HALF, []),
    ],
)
def test_an_answer_that_means_the_same_is_not_called_changed(path, judged, above, answer, below):
    """Empty lines, other imports and what the answer does not meet change nothing."""
    notes = handed_in(path, answer, *map(code, below), above=map(code, above), judged=judged).notes
    assert not any("changed since the last check" in note for note in notes)


def test_what_only_a_cell_below_the_check_defines_is_named(path):
    """From the top the check finds no answer or a NameError, although the answer is marked."""
    note = (
        "only the cell that begins with `{}` defines {}, and it is below the check of circle; move "
        "it above the check, so that the check can try the answer (it is marked all the same)"
    )
    helper, ring = note.format("half = 2", "half, which circle uses"), code(CIRCLE.format("half"))
    found = handed_in(path, f"def deep(s): return half\n{CIRCLE.format('deep')}", code("half = 2"))
    assert not found.problems and helper in found.notes
    for home in STUB, "# below":
        alone = handed_in(path, home, ring, judged=[STUB])
        assert note.format("def circle(s, start, centre):", "circle") in alone.notes
        assert not any("uses circle" in problem for problem in alone.problems)
    check, every = code('check("circle", circle)'), code("from halves import *")
    for above, below in (([code("half = 3")], []), ([], [check]), ([every], [])):
        notes = handed_in(path, HALF, code("half = 2"), *below, above=above).notes
        assert not any("below the check" in note for note in notes)
    # A module that is loaded and has no such name does not define it.
    misspelt = handed_in(path, CIRCLE.format("haif"), code("from math import *"))
    assert not any("haif" in note for note in misspelt.notes)
    both = handed_in(path, HALF, every, code("half = 2")).notes  # the first need not define it
    assert note.format("half = 2", "half, which circle uses") in both


@pytest.mark.parametrize("early", ["half = 2 * four", "half = [four for _ in 'ab']"])
def test_a_value_above_the_cell_that_it_needs_is_named(path, early):
    """Cells that ran in another order fail from the top; a function may be above what it uses."""
    (problem,) = handed_in(path, HALF, code("four = 4"), above=[code(early)]).problems
    assert problem == (
        f"the cell that begins with `{early}` uses four, which only a cell below it defines; move "
        "it below that cell, because cells run from the top when the notebook is marked"
    )
    assert not handed_in(path, HALF, code("half = 2")).problems
    every = "from math import *\n" + early
    assert not handed_in(path, HALF, code("four = 4"), above=[code(every)]).problems


def test_what_is_beside_the_notebook_is_not_handed_in(path):
    """A module or a file of the student's own is missing where the notebook is marked."""
    (path.parent / "mypaths.py").write_text("def circle(*a): return 1")
    (path.parent / "four.txt").write_text("4")
    (path.parent / "more.py").touch()
    found = handed_in(path, "%run more.py\nfrom mypaths import circle\nfour = open('four.txt')")
    assert found.problems == (
        "mypaths is a module of yours, and only the notebook is handed in; copy what you import "
        "from it into a cell, and delete the import",
    )
    assert {f"only the notebook is handed in, without {x}" for x in ("four.txt", "more.py")} <= {
        note.partition(";")[0] for note in found.notes
    }


def test_a_library_that_does_not_come_with_labkit_is_named(path):
    """What Python, labkit or a package that it requires brings can be imported everywhere."""
    foreign = "import pandas as pd\nfrom pytest.x import y\nimport collections.abc, numpy.linalg\n"
    comes = "from PIL import Image\nimport dateutil, mujoco, pinocchio, labkit.se3\n"
    notes = [x for x in handed_in(path, foreign + comes + CIRCLE.format(1)).notes if "come" in x]
    assert [note.split()[0] for note in notes] == ["pandas", "pytest"]
    assert notes[0] == (
        "pandas does not come with labkit and may be missing where your notebook is marked; an "
        "answer that needs it then earns nothing, so do without it, or ask your instructor"
    )


def test_a_long_text_of_numbers_is_not_taken_for_a_file(path):
    """No file has a name of 800 characters, so nothing is said about it."""
    numbers = "0.1 " * 200 + "0.1"
    assert not handed_in(path, CIRCLE.format(f"'{numbers}'")).problems


@pytest.mark.parametrize("source", ['predict("twice_the_time", 2.0)', "", "# later"])
def test_a_prediction_without_its_name_is_told_its_line(path, source):
    """A fresh copy of the cell would not help."""
    data = json.loads(path.read_text())
    for cell in data["cells"]:
        if "".join(cell["source"]).startswith("twice_the_time ="):
            cell["source"] = source
    path.write_text(json.dumps(data))
    (problem,) = examine(path).problems
    assert problem == (
        "the cell of twice_the_time does not define it; write `twice_the_time = "
        'predict("twice_the_time", ...)` there, with your prediction in place of the dots'
    )


def test_merging_takes_the_value_that_would_be_marked():
    """A value counts in the cell made for it, even if the student's own cell below has the name."""
    new = read_cells(ASSIGNMENT / "01_paths.ipynb")
    mine = read_cells(ASSIGNMENT / "01_paths.ipynb")
    said = 'twice_the_time = predict("twice_the_time", 4.0)'
    at = next(k for k, x in enumerate(mine) if x["source"].startswith("twice_the_time ="))
    mine[at]["source"] = said
    own = code("twice_the_time = 2 * 3.0", id="0badcafe")
    merged = merge([*mine, own], new)
    (answer,) = [x for x in merged if kind(x) == "answer" and "twice_the_time" in x["source"]]
    assert answer["source"] == said
    assert [x["source"] for x in merged if "2 * 3.0" in x["source"]] == [own["source"]]


def test_which_cells_count():
    """Functions anywhere before values, values at home before others, and never an empty stub."""
    stub = "def f():\n    raise NotImplementedError"
    cells = {k: analyse(x) for k, x in enumerate(["f = 1", "def f(): pass", stub, "f = 2"])}
    assert written_cells(cells, {0}, "f") == [1]
    values = {k: x for k, x in cells.items() if k != 1}
    assert written_cells(values, {0}, "f") == [0]
    assert written_cells(values, set(), "f") == [0, 3]
    assert written_cells({2: cells[2]}, {2}, "f") == []
