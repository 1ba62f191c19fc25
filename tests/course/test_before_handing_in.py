"""Before handing in: what a look at the file tells."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from labkit import LabkitError
from labkit.course.before_handing_in import HandIn, examine
from labkit.course.brief import PLACEHOLDER, words_of
from labkit.course.forms import COMMITTED
from labkit.course.merge import merge
from labkit.course.messages import HEADS
from labkit.course.notebook import read_cells, verdict_in, verdict_metadata
from labkit.course.receipt import receipt
from labkit.course.verdict import Outcome, TestResult, Verdict

ASSIGNMENT = Path(__file__).resolve().parents[2] / "assignments" / "01_paths"


@pytest.fixture
def folder(tmp_path):
    return Path(shutil.copytree(ASSIGNMENT, tmp_path / "01_paths"))


def output(name, outcome, points=2.0, **more):
    """What a check leaves in its cell."""
    earned = points if outcome is Outcome.RIGHT else 0.0
    metadata = verdict_metadata(Verdict(name, outcome, earned, points, **more))
    return {"output_type": "display_data", "data": {}, "metadata": metadata}


def edited(path, change):
    """Change the notebook's cells and save it."""
    data = json.loads(path.read_text())
    data["cells"] = change(data["cells"])
    path.write_text(json.dumps(data))
    return path


def test_an_untouched_notebook_is_whole_and_not_run(folder):
    """The release itself needs no correction, and is said not to have been run."""
    found = examine(folder / "01_paths.ipynb")
    assert found.problems == ()
    assert set(found.verdicts.values()) == {None}
    assert "  bang_bang: not run" in str(found).splitlines()
    assert str(found).endswith(
        "can be handed in as it is; none of its checks has left a result. Without a text, "
        "why_twice_the_time will earn nothing."
    )


def test_only_what_there_is_is_counted():
    """A notebook without tasks hears nothing of tasks, and one with neither of no run."""
    verdict = Verdict("x", Outcome.RIGHT, 1.0, 1.0)
    some = HandIn("08_report", (), (), {"x": verdict}, ["x"])
    assert str(some).splitlines()[-1] == (
        "08_report: the notebook can be handed in as it is; in its last run, 1 of 1 predictions "
        "were committed."
    )
    assert str(HandIn("a", (), (), {})) == "a: the notebook can be handed in as it is."


@pytest.mark.parametrize("outcome", [Outcome.WRONG, Outcome.NOT_ATTEMPTED])
def test_what_is_not_yet_right_is_named(folder, outcome):
    """A wrong answer may be handed in, and is named beforehand; a stub is not wrong."""

    def change(cells):
        for cell in cells:
            if 'check("witness"' in "".join(cell["source"]):
                cell["outputs"] = [output("witness", outcome)]
        return cells

    found = examine(edited(folder / "01_paths.ipynb", change))
    wrong = outcome is Outcome.WRONG
    assert any(note.startswith("not yet right: witness;") for note in found.notes) == wrong
    assert f"  witness: {HEADS[outcome]}. 0 of 2 points." in str(found).splitlines()


def answered(folder, name, source, outputs=()):
    """The notebook with one answer, and what its check has left."""

    def change(cells):
        for cell in cells:
            if cell["metadata"].get("nbgrader", {}).get("grade_id") == name:
                cell["source"] = source
            if f'check("{name}"' in "".join(cell["source"]):
                cell["outputs"] = list(outputs)
        return cells

    return examine(edited(folder / "01_paths.ipynb", change))


CIRCLE = "def circle(s, start, centre):\n    return lk.Circle(start, centre)(s)"


@pytest.mark.parametrize("ran", [(), [output("circle", Outcome.RIGHT, 4.0, complete=False)]])
def test_a_withheld_tool_is_to_be_mended(folder, ran):
    """Whatever an older check said, and whether it ran or not, what is there uses the tool."""
    found = answered(folder, "circle", CIRCLE, ran)
    says = (
        "circle: not counted: uses lk.Circle, which this question asks you to write. 0 of 4 points."
    )
    assert found.problems == (f"{says} Write it yourself.",)
    assert f"  {says}" in str(found).splitlines()


def test_what_the_check_said_is_repeated(folder):
    """The same words, from the data in the output, not from its text."""
    ran = [output("circle", Outcome.RIGHT, 4.0, complete=False)]
    found = answered(folder, "circle", "def circle(*a): return 1", ran)
    says = "  circle: right on all cases here; 4 points if the instructor's cases agree."
    assert says in str(found).splitlines()
    assert "1 of 6 tasks were right, as far as can be tested here, and 0 of" in str(found)
    lies = [{"output_type": "stream", "name": "stdout", "text": "circle: right. 4 of 4 points.\n"}]
    assert answered(folder, "circle", "x = 1", lies).verdicts["circle"] is None


@pytest.mark.parametrize("magic", ["%%timeit", "%%bash"])
def test_a_magic_that_keeps_an_answer_to_itself_is_to_be_mended(folder, magic):
    """Where a notebook would define nothing, the sentence says which line to take away."""
    found = answered(folder, "circle", f"{magic}\ndef circle(s, start, centre):\n    return 1")
    assert found.problems == (
        f"the cell of circle begins with {magic}, so the notebook does not see what it "
        "defines; delete that line",
    )
    assert answered(folder, "circle", "%%time\ndef circle(*a): return 1").problems == ()


@pytest.mark.parametrize(
    "odd",
    [
        3, [3], [None], [{"metadata": 3}], [{"metadata": {"labkit": 3}}],
        [{"metadata": {"labkit": {"question": "circle", "outcome": "best", "earned": 1}}}],
        [{"metadata": {"labkit": {"question": "circle", "outcome": "right", "earned": "x",
                                  "points": [], "withheld": 0, "complete": 1}}}],
    ],
)  # fmt: skip
def test_odd_outputs_are_passed_over(folder, odd):
    """What no check has written counts as no verdict, and causes no traceback."""

    def change(cells):
        cells[-1]["outputs"] = odd
        return [*cells, {"cell_type": "code", "source": "1", "metadata": {"nbgrader": [1]}}]

    assert examine(edited(folder / "01_paths.ipynb", change)).verdicts["circle"] is None


@pytest.mark.parametrize("odd", ["lots", None, [1], {}])
def test_odd_points_in_a_cell_are_nobodys_concern(folder, odd):
    """What a file says of itself is not told again: it may be anything."""

    def change(cells):
        for cell in cells:
            cell["metadata"].setdefault("nbgrader", {})["points"] = odd
        return cells

    path = folder / "01_paths.ipynb"
    before = str(examine(path))
    assert str(examine(edited(path, change))) == before


def test_another_name_is_to_be_mended(folder):
    """For a notebook that a browser renamed, the problem names its right name."""
    path = (folder / "01_paths.ipynb").rename(folder / "01_paths(3).ipynb")
    assert examine(path).problems == (
        "the file is called 01_paths(3).ipynb; rename it to 01_paths.ipynb",
    )


def test_a_missing_cell_is_named_and_a_doubled_stub_is_not(folder):
    """A stub that is gone earns nothing; a second one takes nothing away."""

    def change(cells):
        stub = next(c for c in cells if "def circle" in "".join(c["source"]))
        kept = [c for c in cells if "def bang_bang" not in "".join(c["source"])]
        return [*kept, stub]

    problems = examine(edited(folder / "01_paths.ipynb", change)).problems
    assert any(text.startswith("no cell defines bang_bang") for text in problems)
    assert not any("circle" in text for text in problems), "an empty stub does not count"


@pytest.mark.parametrize("name", ["circle", "twice_the_time"])
def test_an_answer_that_is_gone_is_not_said_to_be_marked(folder, name):
    """An answer that no cell defines earns nothing, so no note says that it counts."""

    def change(cells):
        return [c for c in cells if c["metadata"].get("nbgrader", {}).get("grade_id") != name]

    found = examine(edited(folder / "01_paths.ipynb", change))
    assert found.problems[0].startswith(f"no cell defines {name}. To restore its cell")
    assert not any("marked all the same" in note for note in found.notes)


@pytest.mark.parametrize(
    ("source", "but"),
    [("def cirkle(*a): return 1", ", but cirkle"), ("cirkle = 1", ", but cirkle"), ("de f", "")],
)
def test_an_answer_under_another_name_is_told_the_name(folder, source, but):
    """A fresh copy does not help where the cell is there and only its name is wrong."""
    says = f"the cell of circle does not define circle{but}; write the name as in the task"
    assert answered(folder, "circle", source).problems[0] == says
    assert answered(folder, "circle", "").problems[0].startswith("no cell defines circle")


def test_a_given_cell_that_is_gone_and_an_error_are_named(folder):
    """Names that later cells need and no cell defines, and the first error, are to be corrected."""

    def change(cells):
        kept = [c for c in cells if "import labkit as lk" not in "".join(c["source"])]
        error = {"output_type": "error", "ename": "NameError", "evalue": "no lk"}
        [c for c in kept if c["cell_type"] == "code"][-2]["outputs"] = [error]
        return kept

    problems = examine(edited(folder / "01_paths.ipynb", change)).problems
    assert any(text.startswith("no cell defines") and "lk" in text for text in problems)
    assert any("ended with an error (NameError: no lk)" in text for text in problems)


def test_an_error_of_the_last_cell_is_not_to_be_corrected(folder):
    """The cell inspects the file, so its error is of an earlier run, such as under another name."""

    def change(cells):
        error = {"output_type": "error", "ename": "LabkitError", "evalue": "opened as mine.ipynb"}
        cells[-1]["outputs"] = [error]
        return cells

    assert not examine(edited(folder / "01_paths.ipynb", change)).problems


@pytest.mark.parametrize(
    ("uses", "todo"),
    [
        ("math.pi", "uses; to use math, begin the cell with `import math`"),
        ("sqrt(2)", "uses; if you mean NumPy's sqrt, write np.sqrt"),
        ("gone(2)", "uses; if you deleted a given cell, copy it from a fresh copy of the notebook, "
         "which is in the zip that you were given; if you deleted a cell of your own, write it "
         "again"),
    ],
)  # fmt: skip
def test_a_forgotten_import_is_no_deleted_cell(folder, uses, todo):
    """A name that a module or NumPy has is told with its import, any other with a fresh copy."""
    found = answered(folder, "circle", f"def circle(*a): return {uses}")
    (problem,) = found.problems
    assert problem.endswith(todo)


@pytest.mark.parametrize(
    ("begins", "edit", "todo"),
    [
        ("centre = ", "", "you were given this cell as it is, so correct what"),
        ("centre = ", "\n1 / 0", "correct or delete it"),
        ('check("circle"', "", "you were given this cell as it is, so correct what"),
        ("import matplotlib", "", "leave it as you were given it, restart the kernel"),
    ],
)
def test_a_given_cell_that_stopped_is_not_to_be_deleted(folder, begins, edit, todo):
    """A given cell stops because of what it uses, unless the student changed it."""

    def change(cells):
        (cell,) = (c for c in cells if "".join(c["source"]).startswith(begins))
        cell["source"] = "".join(cell["source"]) + edit
        cell["outputs"] = [{"output_type": "error", "ename": "TypeError", "evalue": "bad"}]
        return cells

    (problem,) = examine(edited(folder / "01_paths.ipynb", change)).problems
    assert f"error (TypeError: bad), and Run All Cells stops there; {todo}" in problem


def test_a_cell_that_python_cannot_read_is_to_be_mended(folder):
    """What was right when it ran earns nothing once a colon is lost, so the check's word is old."""
    ran = [output("circle", Outcome.RIGHT, 4.0, complete=False)]
    found = answered(folder, "circle", "def circle(s, start, centre)\n    return 1", ran)
    assert found.problems == (
        "Python cannot read the cell that begins with `def circle(s, start, centre)` (SyntaxError: "
        "expected ':', line 1), so what it defines earns nothing; correct it, run all cells from "
        "the top and save the file",
    )
    assert "01_paths: correct what is marked with [fix] first." in str(found)
    assert not answered(folder, "circle", "%%time\n!ls\ndef circle(*a): return 1").problems


def test_a_cell_that_python_cannot_read_is_named_once(folder):
    """The error that its run left is the same one."""

    def change(cells):
        error = {"output_type": "error", "ename": "SyntaxError", "evalue": "invalid syntax"}
        return [*cells, {**cells[-1], "source": "1 +", "outputs": [error]}]

    (problem,) = examine(edited(folder / "01_paths.ipynb", change)).problems
    assert problem.startswith("Python cannot read the cell that begins with `1 +`")


def test_an_answer_turned_into_text_is_told_how_to_turn_it_back(folder):
    """Where the cell is there and is not code, two keys bring it back."""

    def change(cells):
        for cell in cells:
            if "def witness" in "".join(cell["source"]):
                cell["cell_type"] = "markdown"
        return cells

    problems = examine(edited(folder / "01_paths.ipynb", change)).problems
    assert any("press Esc and then Y" in text for text in problems)


@pytest.mark.parametrize("text", ["Gravity pulls.", "gravity", "word " * 30])
def test_a_text_turned_into_code_is_told_how_to_turn_it_back(folder, text):
    """Nobody is asked to correct the syntax of prose, or to define its words."""

    def change(cells):
        (why,) = (cell for cell in cells if cell["metadata"].get("lab") == "why")
        error = {"output_type": "error", "ename": "NameError", "evalue": "no gravity"}
        why |= {"cell_type": "code", "source": text, "outputs": [error]}
        return cells

    (problem,) = examine(edited(folder / "01_paths.ipynb", change)).problems
    assert "the cell of why_twice_the_time is code now" in problem
    assert "press Esc and then M (its text counts" in problem


def with_texts_of(folder, words, word="word "):
    """The look at a notebook in which each text has so many words."""

    def change(cells):
        for cell in cells:
            if cell["metadata"].get("lab") == "why":
                cell["source"] = word * words
        return cells

    return examine(edited(folder / "01_paths.ipynb", change))


@pytest.mark.parametrize("name", ["01_paths", "08_report"])
def test_a_text_that_is_gone_is_to_be_mended(tmp_path, name):
    """Each text that a person marks is missed if it is deleted, and merging brings it back."""
    folder = Path(shutil.copytree(ASSIGNMENT.parent / name, tmp_path / name))
    path, fresh = folder / f"{name}.ipynb", ASSIGNMENT.parent / name / f"{name}.ipynb"
    asked = examine(path).texts.keys()
    edited(path, lambda cells: [cell for cell in cells if cell["metadata"].get("lab") != "why"])
    found = examine(path)
    assert [text.split(". ")[0] for text in found.problems] == [
        f"no cell holds the text {text}" for text in asked
    ]
    assert all("!labkit merge" in text for text in found.problems)
    assert all(f"  {text}: not written" in str(found) for text in asked)
    edited(path, lambda _: merge(read_cells(path), read_cells(fresh)))
    assert not examine(path).problems and examine(path).texts.keys() == asked


def test_a_text_beside_its_empty_cell_is_to_be_moved(folder):
    """Where a text lost its name and its id, merging keeps it beside the empty cell made for it."""
    path = folder / "01_paths.ipynb"

    def pasted(cells):
        (text,) = (cell for cell in cells if cell["metadata"].get("lab") == "why")
        text |= {"source": "word " * 30, "metadata": {}, "id": "0badcafe"}
        return cells

    (problem,) = examine(edited(path, pasted)).problems
    assert problem.startswith("no cell holds the text why_twice_the_time. To restore its cell")
    fresh = read_cells(ASSIGNMENT / "01_paths.ipynb")
    (problem,) = examine(edited(path, lambda _: merge(read_cells(path), fresh))).problems
    assert "why_twice_the_time has 0 words, but the text that begins with `word word" in problem

    def moved(cells):
        at = next(k for k, cell in enumerate(cells) if cell["metadata"].get("lab") == "why")
        return [*cells[: at - 1], {**cells[at], "source": "word " * 30}, *cells[at + 1 :]]

    found = examine(edited(path, moved))
    assert not found.problems and found.texts == {"why_twice_the_time": 30}


@pytest.mark.parametrize(
    ("metadata", "more", "words"),
    [({}, [PLACEHOLDER], 30), ({}, ["and more"], 32), ({"x": 1}, [], 30)],
)
def test_a_text_is_found_where_the_grader_finds_it(folder, metadata, more, words):
    """By its name, in all cells that have it, or by its id if it lost its name."""

    def change(cells):
        (text,) = (cell for cell in cells if cell["metadata"].get("lab") == "why")
        text["source"], text["metadata"] = "word " * 30, metadata or text["metadata"]
        return [*cells, *({**text, "source": source} for source in more)]

    found = examine(edited(folder / "01_paths.ipynb", change))
    assert not found.problems and found.texts == {"why_twice_the_time": words}
    twice = "there are 2 cells of why_twice_the_time; all of them count"
    assert (twice in found.notes) == bool(more)


def test_the_texts_of_an_older_release_are_counted(folder):
    """A file of questions without the names of the texts leaves those in the notebook."""
    file = folder / "checks.json"
    file.write_text(json.dumps({**json.loads(file.read_text()), "texts": {}}))
    assert examine(folder / "01_paths.ipynb").texts == {"why_twice_the_time": 0}


def test_an_emptied_prediction_is_named(folder):
    """What was committed to and then taken out of its cell would lose its point without a word."""

    def committed(said):
        def change(cells):
            for cell in cells:
                text = "".join(cell["source"])
                if text.startswith("twice_the_time ="):
                    cell["source"] = f'twice_the_time = predict("twice_the_time", {said})'
                if 'check("twice_the_time"' in text:
                    test = TestResult(COMMITTED, 1.0, Outcome.RIGHT)
                    cell["outputs"] = [output("twice_the_time", Outcome.RIGHT, tests=(test,))]
            return cells

        return change

    path = folder / "01_paths.ipynb"
    assert not examine(edited(path, committed("2.0"))).problems
    (problem,) = examine(edited(path, committed("None"))).problems
    assert problem.startswith("the cell of twice_the_time says None, although you had committed")


@pytest.mark.parametrize("comment", ["<!-- x -->", "<!-->", "<!--->", "<!--x\ny-->"])
def test_a_text_after_a_comment_counts(comment):
    """A comment in HTML ends where Jupyter ends it, also an empty one; the rest is read."""
    assert words_of(f"{comment} Gravity pulls.") == ["Gravity", "pulls."]


def test_words_of_a_text_are_counted_without_the_placeholder(folder):
    """A text that nobody has written has no words; a written one has a line."""
    assert PLACEHOLDER in (ASSIGNMENT.parents[1] / "nbgrader_config.py").read_text()
    found = examine(folder / "01_paths.ipynb")
    assert found.texts and set(found.texts.values()) == {0}
    assert any(f"{name} has 0 words; it needs" in str(found) for name in found.texts)
    assert all(f"  {name}: not written" in str(found) for name in found.texts)
    assert str(found).endswith(f" Without a text, {' and '.join(found.texts)} will earn nothing.")
    found = with_texts_of(folder, 30)
    assert "will earn nothing" not in str(found)
    assert all(
        f"  {name}: 30 words; your instructor may read it" in str(found) for name in found.texts
    )
    assert "at most" not in str(found)


@pytest.mark.parametrize(
    "text", ["<!-- a\nb -->", "<!-- a", "\u00a0\u200b", f"{PLACEHOLDER}\u2060"]
)
def test_a_text_that_nobody_can_see_is_not_written(folder, text):
    """A comment in HTML and characters without width are no words, and so earn nothing."""
    assert set(with_texts_of(folder, 1, text).texts.values()) == {0}
    assert set(with_texts_of(folder, 1, f"a {text}").texts.values()) == {1}


def test_a_text_that_is_too_long_is_named_with_its_limit(folder):
    """A why may have as many words as the cell above it says."""
    found = with_texts_of(folder, 81)
    assert [f"{name} has 81 words; it may have at most 80" for name in found.texts] == [
        note for note in found.notes if "at most" in note
    ]


def test_the_forum_block_holds_verdicts_and_no_answer(folder):
    """The block for the forum has a line for each question and none of the code."""
    block = examine(folder / "01_paths.ipynb").for_the_forum()
    assert "witness: not run" in block
    assert "def " not in block


@pytest.mark.parametrize("text", ["", "{", '{"cells": 3}', "\x00\x01"])
def test_a_damaged_file_is_a_sentence(folder, text):
    """A file that cannot be read as a notebook is refused as damaged or cut off."""
    path = folder / "01_paths.ipynb"
    path.write_text(text)
    with pytest.raises(LabkitError, match="not a notebook, or was cut off"):
        examine(path)


@pytest.mark.parametrize("cell", [1, {"source": "x"}, {"cell_type": "code", "metadata": {}}])
def test_a_notebook_with_a_cell_that_is_none_is_a_sentence(folder, cell):
    """A number, or a cell without type, metadata or source, makes the file one that was cut off."""
    path = folder / "01_paths.ipynb"
    path.write_text(json.dumps({"cells": [cell]}))
    with pytest.raises(LabkitError, match="not a notebook, or was cut off"):
        examine(path)


def test_a_cell_may_come_without_metadata(folder):
    """A cell that defines bang_bang and has no metadata counts as defining it."""
    path = folder / "01_paths.ipynb"
    path.write_text(json.dumps({"cells": [{"cell_type": "code", "source": ["def bang_bang(t):"]}]}))
    found = examine(path)
    assert not any("no cell defines bang_bang" in text for text in found.problems)


def test_a_notebook_without_its_questions_is_a_sentence(folder):
    """A missing or damaged checks.json is named, with the way out."""
    file = folder / "checks.json"
    for text, says in (("{", "only a damaged"), (None, "no")):
        file.unlink() if text is None else file.write_text(text)
        with pytest.raises(LabkitError, match=rf"there is {says} checks\.json in .*whole folder"):
            examine(folder / "01_paths.ipynb")


def test_an_empty_cell_leaves_the_receipt_as_it_is():
    """Shift+Enter in the last cell appends an empty cell, and the next autosave keeps it."""
    assert receipt(["a", "b"]) == receipt(["a", "b", "", " \n"]) != receipt(["a", "b", "c"])


def test_what_changed_after_its_check_is_not_called_ready(folder):
    """An old verdict is called old, beside it and in the last line, except for predictions."""
    right = output("circle", Outcome.RIGHT)
    right["metadata"] |= verdict_metadata(verdict_in(right), "another")
    answered(folder, "circle", "def circle(*a): return 1", [right])
    found = examine(folder / "01_paths.ipynb")
    assert found.old == ["circle"] and "before your last change" in "".join(found.lines)
    assert "01_paths: run the notebook from the top, save it, and look again." in str(found)
    ready = replace(found, old=[])
    assert "can be handed in as it is" in str(ready) and "last change" not in str(ready)
    by_mouse = output("twice_the_time", Outcome.RIGHT)
    by_mouse["metadata"] |= verdict_metadata(verdict_in(by_mouse), "another")
    said = 'twice_the_time = predict("twice_the_time", "a")'
    answered(folder, "twice_the_time", said, [by_mouse])
    assert examine(folder / "01_paths.ipynb").old == ["circle"]
