"""The numbers of the book: what the code confirms is what a page shows."""

import ast
import re
import sys

import numpy as np
import pytest
from book_pages import BOOK, computed
from figures.claims import ConclusionFails, holds, shows


def test_a_false_conclusion_or_number_stops_the_build():
    """Each error names its sentence; 7.4 passes for 7.41, and neither 7.9 nor -7.4 does."""
    holds(1 < 2, "one is less than two")
    shows("the error is 7.4 mm", 7.4, 7.41)
    with pytest.raises(ConclusionFails, match="two is less than one"):
        holds(2 < 1, "two is less than one")
    for wrong in (7.9, -7.4):
        with pytest.raises(ConclusionFails, match="the error is"):
            shows("the error is 7.4 mm", 7.4, wrong)


def numbers_in(text):
    """The numbers in words, whatever stands between them."""
    return set(re.findall(r"\d[\d.,]*\d|\d", text))


def test_the_numbers_that_the_code_confirms_stand_on_a_page():
    """Together, on one page; the words around them are free."""
    pages = [numbers_in(p.read_text()) for p in BOOK.rglob("*.md") if "_build" not in p.parts]
    confirmed = [
        numbers_in(node.args[0].value)
        for path in (BOOK / "figures").glob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call)
        and getattr(node.func, "id", "") == "shows"
        and isinstance(node.args[0], ast.Constant)
    ]
    assert len(confirmed) > 100
    assert [x for x in confirmed if not any(x <= page for page in pages)] == []


PAGES = computed()


@pytest.mark.soak
@pytest.mark.parametrize("shift", [11, 12])
@pytest.mark.parametrize("page", PAGES)
def test_the_claims_of_a_page_hold_with_other_seeds(page, shift, monkeypatch):
    """Whatever its arms, sensors and pictures draw."""
    for name in [x for x in sys.modules if x.split(".")[0] in ("figures", "solutions")]:
        monkeypatch.delitem(sys.modules, name)  # with the runs that they keep
    drawn = np.random.default_rng

    def other(seed=None):
        return drawn([shift, *np.ravel(seed)] if isinstance(seed, int | list) else seed)

    monkeypatch.setattr(np.random, "default_rng", other)
    names = {}
    for cell in PAGES[page].cells:
        exec(cell.source, names)
