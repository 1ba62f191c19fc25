"""What holds for every chapter of the book."""

import re

import pytest
from book_pages import BOOK
from figures.front import hours
from figures.planning import HOURS

CHAPTERS = ("paths", "model", "velocity", "torque", "impedance", "tags", "comparison")
CITED = re.compile(r"\{cite:\w+\}`([^`]+)`")

every_chapter = pytest.mark.parametrize("name", CHAPTERS)


def text_of(name):
    return (BOOK / f"chapters/{name}.md").read_text(encoding="utf-8")


def directives(text, kind):
    """The bodies of the directives of one kind, by their label or argument."""
    blocks = re.findall(rf"^(```+)\{{{kind}\}} ?([^\n]*)\n(.*?)^\1$", text, re.M | re.S)
    labels = ((re.search(r"^:label: (\S+)", body, re.M), at, body) for _, at, body in blocks)
    return {label[1] if label else at.strip(): body for label, at, body in labels}


@every_chapter
def test_exercises_have_folded_solutions(name):
    """Each but the one that leads to the notebook."""
    text = text_of(name)
    exercises = {x for x in directives(text, "exercise") if not x.endswith("-notebook")}
    solutions = directives(text, "solution")
    assert exercises
    assert exercises <= set(solutions)
    assert all(re.search(r"^:class: dropdown$", body, re.M) for body in solutions.values())


@every_chapter
def test_every_work_cited_is_in_the_bibliography(name):
    """One role names one work or several, some with a place in them."""
    known = set(re.findall(r"^@\w+\{(\w+),", (BOOK / "references.bib").read_text(), re.M))
    roles = (re.sub(r"\{.*?\}", "", role) for role in CITED.findall(text_of(name)))
    assert {key.strip() for role in roles for key in role.split(",")} <= known


@every_chapter
def test_a_chapter_gives_its_notebook_as_much_time_as_the_notebook_itself(name):
    """The first cells of the notebooks are the one place where their hours stand."""
    ((told, number),) = re.findall(r"about (\d+) hours for notebook (\d\d)", text_of(name))
    (source,) = BOOK.parent.glob(f"solutions/*/{number}_*.py")
    assert float(told) == hours(source.stem)[1]


def test_the_core_of_the_course_fits_into_28_hours():
    """Each notebook's core takes at most 4; the core is never longer than the whole."""
    assert all(core <= min(4.0, whole) for core, whole in HOURS.values())
    assert sum(core for core, _ in HOURS.values()) <= 28.0
