"""A message as a card: the same words, folded, and never markup of a student's."""

import re
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser

import pytest
from questions import DOUBLE, double, square

from labkit.course.card import card
from labkit.course.marking import mark
from labkit.course.messages import message


def stub(x):
    raise NotImplementedError


def shown(function, printed="", picture=None):
    verdict = mark(DOUBLE, function)
    return card(message(DOUBLE, verdict, printed), verdict.outcome, picture)


def words(page):
    """What is to be read on a page."""
    return " ".join(unescape(re.sub(r"<style>.*</style>|<[^>]*>", " ", page, flags=re.S)).split())


@pytest.mark.parametrize("function", [double, square, stub, lambda x: 1 / 0, lambda x: None])
def test_the_card_holds_the_words_of_the_plain_text(function):
    """Nothing that is said in text is missing on the card, and the text is the text."""
    found = shown(function, printed="a print of mine")
    assert found["text/plain"] == str(message(DOUBLE, mark(DOUBLE, function), "a print of mine"))
    page = words(found["text/html"])
    for line in found["text/plain"].replace("`", " ").split("\n"):
        if line.strip() != "Where it fails:":
            assert " ".join(line.split()) in page, line


def test_tests_and_numbers_are_folded():
    """What helps stands open; tests and numbers open at a click or a key."""
    page = shown(square)["text/html"]
    folded = page[page.index("<details>") : page.index("</details>")]
    assert "That is the square." in page and "That is the square." not in folded
    assert "<summary>2 of 3 tests failed. Show" in folded and "double(3.0): expected 6" in folded
    assert "Show them, with the numbers</summary>" in page
    verdict = mark(DOUBLE, square)
    bare = replace(message(DOUBLE, verdict), numbers=())
    assert "Show them</summary>" in card(bare, verdict.outcome)["text/html"]
    assert "<details>" not in shown(double)["text/html"]


def test_hints_open_one_after_the_other():
    """Each is folded within the one before; the last one follows an attempt."""
    for function, count in ((stub, 2), (square, 3)):
        page = shown(function)["text/html"]
        first = page.index(f"Hint 1 of {count}<")
        parts = page[first:].split("<summary>")
        assert len(parts) == count
        for k, part in enumerate(parts):
            assert (
                DOUBLE.hints[k] in unescape(part)
                and part.count("</details>") == (0, count)[k == count - 1]
            )


def test_the_outcome_is_told_by_words_and_a_sign():
    """Right, wrong and error differ without any colour, and a screen reader hears the words."""
    heads = [words(shown(f)["text/html"]).split(". ")[0] for f in (double, square, lambda x: 1 / 0)]
    assert heads[1:] == ["\N{MULTIPLICATION SIGN} double: not yet right",
                         "! double: it stopped with an error"]  # fmt: skip
    assert heads[0].startswith("\N{CHECK MARK} double: right on all cases here")


def test_nothing_of_a_student_becomes_markup():
    """Prints, messages of exceptions and names are text on the card, whatever they hold."""
    attack = "<script>alert(1)</script><img src=x onerror='alert(2)'>`</code><b>`$x$\""

    def says(x):
        raise ValueError(attack)

    page = shown(says, printed=attack, picture=(b"", attack))["text/html"]
    tags = Tags()
    tags.feed(page)
    assert set(tags.found) == {
        ("div", "class style"), ("p", ""), ("b", "aria-hidden"), ("code", ""), ("details", ""),
        ("summary", ""), ("ul", ""), ("li", ""), ("pre", ""), ("img", "alt src"),
        ("style", ""),
    }  # fmt: skip
    assert page.count("alert(1)") == 3, "as text"


class Tags(HTMLParser):
    """The tags of a page, with the names of their attributes."""

    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, " ".join(name for name, _ in attrs)))
