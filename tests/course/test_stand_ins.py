"""A caption says which stand-ins its figure is drawn with, whichever cell asked for them."""

import json
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from questions import DOUBLE

import labkit as lk
from labkit.course import Number, Prediction, question_data, use
from labkit.course import student as notebook
from labkit.course.checks_file import FILE
from labkit.course.stand_ins import drawn_with
from labkit.formats import stamp
from solutions.paths import answers

KERNEL = """
import json, sys
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output
shell, said = InteractiveShell.instance(), []
for cell in json.load(sys.stdin):
    with capture_output() as out:
        shell.run_cell(cell, store_history=True)
    alts = [o.metadata.get("image/png", {}).get("alt") for o in out.outputs]
    result = repr(shell.user_ns["replay"]) if "replay =" in cell else None
    told = [x for x in (*alts, result) if x] or [out.stdout]
    said.append(told[-1])
print(json.dumps(said))
"""
HEAD = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parents[1] / "replay")!r})
import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import labkit as lk
from labkit.course import predict, use
def given(x): return x
def triple(x): raise NotImplementedError
"""
ANSWER = "def double(x): return {} * x"
USE = 'my_double = use("double", double, given)\nmy_triple = use("triple", triple, given)\n'
OTHER = 'plt.plot([given(2)])\nlk.plotting.show("Given.")'
DRAW = 'plt.plot([my_double(2)])\nlk.plotting.show("Drawn.")'
NAMED = "With a stand-in for double: "
BOTH = "With a stand-in for double and a stand-in for triple: "


@pytest.fixture
def said(tmp_path):
    """Runs cells after `HEAD` in a shell; the last alternative text of each, or what it printed."""
    asked = [replace(DOUBLE, name=name) for name in ("double", "triple")]
    guess = Prediction("guess", "How far?", Number("m", 0.0, 9.0), 2.0).question()
    questions = [question_data(question) for question in (*asked, guess)]
    data = {**stamp(), "assignment": "sample", "questions": questions}
    (tmp_path / FILE).write_text(json.dumps(data))

    def run(*cells):
        done = subprocess.run(
            [sys.executable, "-c", KERNEL],
            input=json.dumps([HEAD, *cells]),
            capture_output=True,
            text=True,
            check=True,
            cwd=tmp_path,
        )
        return [x.strip() for x in json.loads(done.stdout)[1:]]

    return run


def test_a_later_cell_that_draws_with_a_stand_in_says_so(said):
    """In a figure, under dials and in a replay; through functions and runs of other cells too."""
    cells = (
        "def at(x): return my_double(x)\nruns = {}\nfor x in (1, 2):\n    runs[x] = at(x)",
        'plt.plot([at(2)])\nlk.plotting.show("Called.")',
        'plt.plot(runs.values())\nlk.plotting.show("Kept.")',
        'def draw(k): return plt.figure(), f"{k * at(1):g}."\nlk.plotting.dials(draw, k=(0, 4, 2))',
        "from samples import swing\nshown = swing() if at(1) else None\n"
        "replay = lk.replay.show(shown)",
        'plt.plot([my_triple(my_double(1))])\nlk.plotting.show("Two.")',
    )
    _, _, drawn, _, called, kept, dialled, replayed, two = said(ANSWER.format(3), USE, DRAW, *cells)
    assert [drawn, called, kept] == [f"{NAMED}{x}" for x in ("Drawn.", "Called.", "Kept.")]
    assert dialled == f"{NAMED}2."
    assert replayed.startswith(f"{NAMED}Circle with") and replayed.count(NAMED) == 1
    assert two == f"{BOTH}Two."


def test_a_figure_without_a_stand_in_says_nothing(said):
    """Also in the cell that asks for one, and drawn with the very function that stands in."""
    cells = (USE + OTHER, OTHER, USE + DRAW, f"def later():\n    return my_double\n{OTHER}")
    _, *told = said(ANSWER.format(3), *cells)
    assert told == ["Given.", "Given.", f"{NAMED}Drawn.", "Given."]


def test_a_right_answer_is_not_called_a_stand_in(said):
    """Once `use` takes it; until then the stand-in still draws."""
    right, wrong = ANSWER.format(2), ANSWER.format(3)
    told = said(wrong, USE, DRAW, right, DRAW, USE, DRAW, wrong, USE, DRAW)
    assert [told[k] for k in (2, 4, 6, 9)] == [
        *[f"{NAMED}Drawn."] * 2, "Drawn.", f"{NAMED}Drawn."
    ]  # fmt: skip


@pytest.mark.parametrize(
    "keeps",
    [
        'double = use("double", double, given)\nkept = [double(1)]',
        'answer = double\nmine = use("double", answer, given)\nkept = [mine(1)]',
        'kept = []\nfor k in (1, 2):\n    kept.append(use("double", double, given)(k))',
        f"{USE}kept = []\nkept += [my_double(1)]\nkept += [2]",
        f"class Kept: pass\n{USE}a = Kept()\na.run = my_double(1)\nkept = [a.run]",
    ],
)
def test_what_a_stand_in_gave_is_named_however_it_was_kept(said, keeps):
    """Under the answer's own name, from another one, in a list that grew, in an attribute."""
    drawn = 'plt.plot(kept)\nlk.plotting.show("Kept.")'
    *_, kept, other = said(ANSWER.format(3), keeps, drawn, OTHER)
    assert (kept, other) == (f"{NAMED}Kept.", "Given.")


def test_a_wrong_answer_that_drives_anyway_is_named_and_tells_no_truth(said):
    """Each figure drawn with it says so; a prediction is laid over the truth of a right one."""
    anyway = USE.replace("double, given)", "double, given, anyway=True)")
    guess, truth = 'predict("guess", 3.0)', 'predict("guess", truth=my_double(1.0))'
    wrong, right = (ANSWER.format(k) for k in (3, 2))
    told = said(wrong, anyway, DRAW, guess, truth, right, USE, DRAW, truth)
    assert (told[2], told[7]) == ("With your wrong double: Drawn.", "Drawn.")
    assert "uses your wrong double" in told[4] and "arm says" not in told[4]
    assert "The arm says:  2" in told[8]


def test_before_a_cell_has_run_nothing_is_drawn():
    """A history without cells."""
    assert drawn_with([], {"double"}) == drawn_with([""], {"double"}) == []


@pytest.mark.parametrize(
    ("earlier", "draws"),
    [
        ("errors = np.append([], my_double(1))", "plt.plot(np.zeros(2))"),
        ('for k in (1, 2):\n    plt.rcParams["font.size"] = my_double(k)', "plt.plot([1])"),
        ("with at() as a:\n    logs = {}\n    logs[1] = my_double(1)",
         "with at() as a:\n    logs = {}\n    logs[1] = given(1)\nplt.plot(logs[1])"),
        ("for k in (1, 2):\n    total = 0\n    total += my_double(k)",
         "for k in (1, 2):\n    total = 0\n    total += given(k)\nplt.plot(total)"),
    ],
)  # fmt: skip
def test_what_an_earlier_cell_drew_is_not_said_of_the_next(earlier, draws):
    """Not through a module that both use, nor through a name that this cell made anew."""
    cells = ["import numpy as np\nimport matplotlib.pyplot as plt", HEAD, USE, earlier]
    assert drawn_with(cells, {"double"}) == ["double"]
    assert drawn_with([*cells, draws], {"double"}) == []


@pytest.mark.parametrize("form", [tuple, list, lambda parts: [x.tolist() for x in parts]])
def test_given_cells_get_the_type_of_the_right_answer(tmp_path, monkeypatch, capsys, form):
    """What the check accepts in place of a sample or an array drives the arm like one."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(Path(__file__).parents[2] / "assignments/01_paths/checks.json", tmp_path)
    start, centre = np.array([0.6, 0.1, 0.2]), np.array([0.5, 0.0, 0.3])
    my_circle = use("circle", lambda *args: form(answers.circle(*args)), None)
    path = lk.Trajectory(lambda s: my_circle(s, start, centre), lk.Quintic(2.0))
    right = lk.Trajectory(lk.Circle(start, centre), lk.Quintic(2.0))(0.7)
    assert np.allclose(path(0.7), right) and type(my_circle(0.3, start, centre)) is lk.Sample
    shutil.copy(Path(__file__).parents[2] / "assignments/00_warmup/checks.json", tmp_path)
    notebook._desks.clear()
    my_error = use("joint_error", lambda a, b: (a.position - b.q).tolist(), None)
    state, target = lk.State(0.0, np.zeros(7), np.zeros(7)), lk.Sample(*np.ones((3, 7)))
    assert type(my_error(target, state)) is np.ndarray and capsys.readouterr().out == ""
