"""Whys: a person marks two of each student's, and nothing waits for the others."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import pytest
from handmade import hand_in
from made import NAME, WHY, notebook_of, result_of

from labkit import LabkitError
from labkit.__main__ import main
from labkit.course.notebook import grade_id
from labkit.grader.gradebook import apply_rules, open_gradebook, record, release_source
from labkit.grader.results import Results
from labkit.grader.whys import DRAWN, drawn

WHYS = [f"why_{k}" for k in range(8)]


def test_two_of_eight_are_drawn_evenly_and_for_good():
    """Each student's two are the same whenever they are drawn, and each why is drawn as often."""
    students = [f"student-{k}" for k in range(800)]
    found = [drawn("7", student, WHYS) for student in students]
    assert {len(one) for one in found} == {DRAWN}
    assert found == [drawn("7", student, reversed(WHYS)) for student in students]
    assert found != [drawn("8", student, WHYS) for student in students]
    counts = Counter(name for one in found for name in one)
    assert all(150 <= counts[name] <= 250 for name in WHYS)  # 200 are expected


def test_only_a_why_that_is_drawn_waits_for_a_person(course, capsys):
    """One that is written and not drawn has its points; one that is blank or as before has 0."""
    given = next(x for x in release_source(course, NAME).cells if grade_id(x) == WHY).source
    so = "Because it is so."
    texts = {"ada": so, "bob": None, "carl": " \n", "dan": so, "eve": f"{given}\n",
             "flo": "<!-- -->", "gus": "\u00a0\u200b"}  # fmt: skip
    for student, text in texts.items():
        data = notebook_of(student)
        hand_in(course, NAME, student, data)
        written = {} if text is None else {WHY: text}
        result = replace(result_of(course, student, data=data), written=written)
        Results(course, NAME).keep(result)
        record(course, NAME, [result])
    with open_gradebook(course) as book:
        grades = {s: book.find_grade(WHY, NAME, NAME, s) for s in texts}
        found = {s: (g.auto_score, g.needs_manual_grade) for s, g in grades.items()}
    zero, waits = (0.0, False), (None, True)
    right = {"ada": (2.0, False), "dan": waits}
    assert found == dict.fromkeys(texts, zero) | right
    assert main(["feedback", NAME, "--course", str(course.root)]) == 2
    said = capsys.readouterr().err
    assert f"dan ({WHY})" in said and "ada" not in said


def test_a_why_that_is_marked_is_one_of_the_two(course):
    """A list that is imported later gives a folder another name, and so other whys by lot."""
    data = notebook_of("dan")  # by lot one of Dan's two is WHY
    hand_in(course, NAME, "dan", data)
    result = result_of(course, "dan", data=data)
    Results(course, NAME).keep(result)
    with open_gradebook(course) as book:
        name, whys = "02_essays", ("why_slow", "why_time")
        book.update_or_create_assignment(name)
        book.update_or_create_notebook(name, name)
        for why in whys:
            about = {"cell_type": "markdown", "max_score": 2.0}
            book.update_or_create_task_cell(why, name, name, **about)
        book.update_or_create_student("dan")
        book.update_or_create_submission(name, "dan")
        for why in whys:
            grade = book.find_grade(why, name, name, "dan")
            grade.manual_score, grade.needs_manual_grade = 1.5, False
        book.db.commit()
    record(course, NAME, [result])
    with open_gradebook(course) as book:
        grade = book.find_grade(WHY, NAME, NAME, "dan")
        assert (grade.auto_score, grade.needs_manual_grade) == (2.0, False)


def a_person_marks(course, seed):
    """Whether WHY waits for a person, once Ada has handed it in in a term of this seed."""
    course.term.parent.mkdir(exist_ok=True)
    course.term.write_text(f'{{"secret": "{seed:032x}"}}')
    hand_in(course, NAME, "ada", notebook_of("ada"))
    result = result_of(course, "ada", written={WHY: "Because it is so."}, data=notebook_of("ada"))
    Results(course, NAME).keep(result)
    record(course, NAME, [result])
    with open_gradebook(course) as book:
        return book.find_grade(WHY, NAME, NAME, "ada").needs_manual_grade


def test_whys_of_notebooks_that_were_not_handed_out_are_not_drawn(course):
    """In a term with this notebook alone, a person marks the one why that there is."""
    assert a_person_marks(course, 7)


def test_whys_are_drawn_under_the_seed_of_the_term(course):
    """Also those of a notebook that was released with another seed: two of all, not of each."""
    for name in {*course.names()} - {NAME}:
        (course.bundle / f"{name}.json").write_text("{}")
    assert a_person_marks(course, 1)  # under 7 WHY is not drawn


def test_no_why_is_drawn_where_the_secret_is_lost(course):
    """Under another key a why that waits would have its points."""
    hand_in(course, NAME, "dan", notebook_of("dan"))  # by lot one of Dan's two is WHY
    result = result_of(course, "dan", written={WHY: "So."}, data=notebook_of("dan"))
    record(course, NAME, [result])
    course.term.parent.mkdir(exist_ok=True)
    course.term.write_text("{}")
    with open_gradebook(course) as book:
        with pytest.raises(LabkitError, match=r"term\.json is damaged"):
            apply_rules(course, book, NAME)
        assert book.find_grade(WHY, NAME, NAME, "dan").needs_manual_grade
