"""The words of `book/style.md`: what nobody wants to read stands in no text of the project."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
STYLE = ROOT / "book/style.md"
TEXTS = (
    "*.md",
    "book/*.md",
    "book/chapters/*.md",
    "book/deeper/*.md",
    "book/gallery/*.md",
    "book/reference/*.md",
    "book/figures/*.py",
    "labkit/**/*.py",
    "labkit/**/*.md",
    "labkit/**/*.j2",
    "solutions/**/*.py",
    "solutions/*.md",
)


def rows():
    """Each line of the table: an example, what to write instead, and the expression."""
    found = re.findall(r"^\| (.+) \| (.+) \| `(.+)` \|$", STYLE.read_text(), re.MULTILINE)
    assert len(found) > 10
    return [(example, instead, pattern.replace("\\|", "|")) for example, instead, pattern in found]


def words():
    """Each expression of the table, with what to write instead."""
    return {pattern: instead for _, instead, pattern in rows()}


def texts():
    """Every text that people read, by its path."""
    found = {path for pattern in TEXTS for path in ROOT.glob(pattern)} - {STYLE}
    return sorted(path.relative_to(ROOT) for path in found)


def hits(text):
    """Each place where a text has one of the expressions."""
    for pattern, instead in words().items():
        for found in re.finditer(pattern, text):
            line = text.count("\n", 0, found.start()) + 1
            yield f"line {line}: {found[0]!r}; write: {instead}"


@pytest.mark.parametrize("path", texts(), ids=str)
def test_a_text_is_plain_english(path):
    """No expression of the list is in the text."""
    assert list(hits((ROOT / path).read_text(encoding="utf-8"))) == []


@pytest.mark.parametrize(("example", "instead", "pattern"), rows())
def test_the_example_of_an_expression_has_it(example, instead, pattern):
    """What the style page shows is what the test looks for."""
    assert re.search(pattern, example)


@pytest.mark.parametrize("text", ["That is no error.", "Whoever asks", "mend it", "five ways"])
def test_the_list_finds_what_it_is_for(text):
    """Each of these is found, and the same idea in plain English is not."""
    assert list(hits(text))
    assert not list(hits("There is no error; anyone may ask, repair it, and use five methods."))
