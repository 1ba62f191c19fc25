"""Hostile files given to the commands that take one: submit-check, merge and report-card."""

from __future__ import annotations

import json
import shutil

import pytest
from soak import laws
from soak.classes import HEAD, NAME, copied, kinds, put
from soak.commands import typed
from soak.examined import guilty
from soak.test_fuzz import cases, chosen

pytestmark = pytest.mark.slow

QUESTION = "joint_error"
FEW = {"texts: lone surrogate", "files: pipe"}
"""The gate's sample of what the student's commands are given."""
STOP = "KeyboardInterrupt"
"""Cannot be told from Ctrl-C in a file that the instructor runs; see the test of its own."""


@pytest.fixture(scope="module")
def course(released, tmp_path_factory):
    """A course with an assignment released."""
    return copied(released.root, tmp_path_factory.mktemp("files") / "course")


@pytest.mark.xdist_group("fuzz: files")
@pytest.mark.parametrize(
    "kind", cases("TEXTS", "MAGICS", "SOURCES", "FILE_NAMES", "FILES", "NOTEBOOKS", sample=FEW)
)
def test_student(course, tmp_path, kind):
    """Submit-check and merge say what is wrong in a sentence; what merge writes is a notebook."""
    mine = tmp_path / "mine"
    shutil.copytree(course / "assignments" / NAME, mine)
    (mine / f"{NAME}.ipynb").unlink()
    path = f"./{put(kind, course, mine).name}"
    solved = str(course / "build/course/solution" / NAME / f"{NAME}.ipynb")
    wrong = []
    for words in (
        ("submit-check", path),
        ("submit-check", path, "--forum"),
        ("merge", path, solved, "--to", "a.ipynb"),
        ("merge", solved, path, "--to", "b.ipynb"),
    ):
        wrong += laws.said(typed(mine, "labkit", *words), (0, 1, 2))
    for made in (mine / "a.ipynb", mine / "b.ipynb"):
        if made.exists():
            wrong += laws.look_at(made)
    assert not wrong, "\n".join(wrong)


@pytest.fixture(scope="module")
def card(request, course, tmp_path_factory):
    """What answers break that the report card is given from outside, the others' rows included."""
    asked = [x["kind"] for x in chosen(request, test_report_card)]
    folder = tmp_path_factory.mktemp("card")

    def breaks(part):
        lines = [HEAD]
        for number, kind in enumerate(part):
            body = f"return {kind.thing}" if kind.table == "OBJECTS" else kind.thing
            lines.append(f"def _{number}(*args, **kwargs):\n    {body}\n")
        functions = ", ".join(f"_{number}" for number in range(len(part)))
        for table in ("MISTAKES", "VARIANTS"):
            lines.append(f"{table} = {{{QUESTION!r}: [{functions}]}}")
        (folder / "answers.py").write_text("\n".join(lines), "utf-8")
        answers = str(folder / "answers.py")
        words = ["report-card", "00_warmup", "--mistakes", answers, "--variants", answers]
        ended = typed(course, "labkit", *words)
        return [*laws.said(ended, (0, 1)), *laws.changed(clean, _rows(course))]

    typed(course, "labkit", "report-card", "00_warmup")
    clean = _rows(course)
    faults = breaks(asked)
    return guilty([*asked, asked[0]], breaks) if faults else {}


def _rows(course):
    """The rows of the card, but for that of the question that is answered from outside."""
    data = json.loads((course / "build" / "report_card.json").read_text("utf-8"))
    return {f"row of {x['question']}": x for x in data["questions"] if x["question"] != QUESTION}


@pytest.mark.soak
@pytest.mark.xdist_group("fuzz: files")
@pytest.mark.parametrize("kind", [k for k in kinds("OBJECTS", "RAISES") if k.name != STOP], ids=str)
def test_report_card(card, kind):
    """Answers from outside are tried like any others, whatever they give back or raise."""
    assert kind not in card, "\n".join(card[kind])


@pytest.mark.soak
@pytest.mark.xdist_group("fuzz: files")
def test_an_answer_stops_the_report_card_as_its_author_would(course, tmp_path):
    """A KeyboardInterrupt is the author's own, by Ctrl-C or in their file: 130, and a word."""
    path = tmp_path / "answers.py"
    path.write_text(f"def stops(*args):\n    raise {STOP}\nMISTAKES = {{{QUESTION!r}: [stops]}}")
    ended = typed(course, "labkit", "report-card", "00_warmup", "--mistakes", str(path))
    assert not [*laws.said(ended, (130,))]


@pytest.mark.xdist_group("fuzz: files")
@pytest.mark.parametrize("kind", cases("ANSWERS"))
def test_file_of_answers(course, tmp_path, kind):
    """A file of answers that cannot be used is refused in a sentence."""
    path = tmp_path / "answers.py"
    path.write_text("MISTAKES = {}", "utf-8")
    kind.thing(path)
    words = ("labkit", "report-card", "00_warmup", "--mistakes", str(path))
    wrong = [*laws.said(typed(course, *words), (2,))]
    assert not wrong, "\n".join(wrong)
