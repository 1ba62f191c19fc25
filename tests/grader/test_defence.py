"""The defence: questions from a student's own accepted code, and one mark in the gradebook."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from handmade import cell_of, hand_in, raw
from made import NAME, result_of

import labkit as lk
from labkit.__main__ import main
from labkit.course.authoring.layout import DEFENCE
from labkit.course.marking import try_public
from labkit.course.question import Loop
from labkit.grader.defence import ASKED, Asked, draw, give_mark, write_page
from labkit.grader.gradebook import record
from labkit.grader.marks import marks_of
from labkit.grader.results import Results
from labkit.grader.roster import Student, save_roster


def accepted(course, student, notebook):
    """Hand in, with a result that accepts all of it."""
    hand_in(course, NAME, student, notebook)
    result = result_of(course, student, data=raw(notebook))
    answers = tuple(replace(a, source="".join(cell_of(notebook, a.verdict.name)["source"]))
                    for a in result.questions)  # fmt: skip
    result = replace(result, questions=answers)
    Results(course, NAME).keep(result)
    record(course, NAME, [result])


def says(course, *words):
    return main([*words, "--course", str(course.root)])


@pytest.mark.slow
def test_a_defence_from_the_draw_to_the_term_s_table(course, solved, capsys):
    """Another student is asked something else; a second print is the same and keeps the mark."""
    for student in ("ada", "bob"):
        accepted(course, student, solved)
    asked = draw(course, "ada")
    assert len({one.of.question.name for one in asked}) == ASKED
    for one in asked:
        names = {"lk": lk, "np": np}
        own = "".join(cell_of(solved, one.of.question.name)["source"])
        exec(one.edit.cell, names)
        assert try_public(one.of.question, names[one.of.question.name]).outcome != "right"
        exec(own, names)
        assert try_public(one.of.question, names[one.of.question.name]).outcome == "right"
        assert one.edit.now != one.edit.was and '"""' not in "".join(one.edit.lines)
    other = [(one.of.question.name, one.edit) for one in draw(course, "bob")]
    assert other != [(one.of.question.name, one.edit) for one in asked]

    page = write_page(course, "ada", asked)
    before = page.read_text()
    students, _, examiners = before.partition("For the examiner only")
    assert "handed in</th>" not in students and examiners.count("handed in</th>") == ASKED
    assert says(course, "defence", "ada", "--mark", "2", "3", "1") == 0
    assert says(course, "defence", "ada") == 0
    assert page.read_text() == before
    (mark,) = marks_of(course, DEFENCE)
    assert (mark.score, mark.points, mark.open, mark.remark) == (6.0, 9.0, (), "")

    (course.root / "course.toml").write_text(f"[assignments.{DEFENCE}]\nweight = 3\n")
    capsys.readouterr()
    assert says(course, "export", DEFENCE) == 0
    assert "ada,2.0,3.0,1.0,0.0,6.0" in capsys.readouterr().out
    says(course, "export")
    table = capsys.readouterr().out
    assert DEFENCE in table.splitlines()[0] and ",3" in table.splitlines()[2]


def test_the_front_says_what_the_law_is_given():
    """The gains of the run, and whether the arm carries itself: without them nobody can answer."""
    loop = Loop(None, {"kp": 40.0, "arm_compensates": False})
    question = SimpleNamespace(tests=[SimpleNamespace(name="circle", cases=[loop])])
    asked = Asked(SimpleNamespace(question=question), None, {"test": "circle"}, None)
    assert asked.given == "(kp=40.0, arm_compensates=False)"


def test_what_cannot_be_asked_or_marked_is_a_sentence(course, solved, capsys):
    """An unknown student, no result; a mark that is none or too early."""
    hand_in(course, NAME, "eve", solved)
    hand_in(course, NAME, "bob", solved)
    Results(course, NAME).keep(result_of(course, "bob", share=0.5, data=raw(solved)))
    save_roster(course, [Student("Ada-Lovelace", "Ada", "Lovelace")])
    for words, sentence in [
        (["Ada-Lovelace"], "handed in nothing, so there is nothing to ask about"),
        (["zoe"], "there is no student 'zoe'"),
        (["eve"], "01_curves: handed in but not graded"),
        (["bob", "--mark", "2", "x", "3"], "not a valid integer"),
        (["bob", "--mark", "2", "3", "4"], "4 is not in the range"),
        (["zoe", "--mark", "2", "3", "1"], "there is no student 'zoe'"),
    ]:
        assert says(course, "defence", *words) == 2
        assert sentence in capsys.readouterr().err


def test_who_has_too_few_accepted_answers_gets_a_page_and_a_mark(course, solved):
    """The page and the command say for how many questions the examiner chooses the work."""
    hand_in(course, NAME, "bob", solved)
    Results(course, NAME).keep(result_of(course, "bob", share=0.5, data=raw(solved)))
    assert says(course, "defence", "bob") == 0
    students, _, examiners = (
        (course.build / "defence/bob.html").read_text().partition("For the examiner only")
    )
    assert students.count("work of yours that the examiner chooses") == ASKED
    assert "Three functions" not in students
    assert examiners.count("no other accepted function") == ASKED
    assert says(course, "defence", "bob", "--mark", "0", "0", "1") == 0
    assert says(course, "defence", "bob", "--mark", "2", "0", "1") == 0
    assert [mark.score for mark in marks_of(course, DEFENCE)] == [3.0]


def test_a_mark_can_be_given_again(course):
    """To a student of the roster, for whom there is nothing to hand in."""
    save_roster(course, [Student("ada"), Student("bob")])
    for points in ((2, 3, 1), (3, 3, 3)):
        give_mark(course, "ada", points)
        ada, bob = marks_of(course, DEFENCE)
        assert (ada.score, bob.remark) == (sum(points), "no defence yet")
