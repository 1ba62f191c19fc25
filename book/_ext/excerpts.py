"""The plain text of every page in one script, from which the search shows the text around a hit.

The theme would fetch each page that it found, but browsers forbid that to pages opened from disk.
"""

from __future__ import annotations

import json
import unicodedata
from collections.abc import Iterator, Mapping
from pathlib import Path

from bs4 import BeautifulSoup, NavigableString, Tag

NAME = "searchtexts.js"
OPENING = "window.labTexts = "
Part = tuple[str, str, str]
"""An id in the page, the heading or name that has this id, and the text up to the next id."""
HEADINGS = ["h1", "h2", "h3", "h4"]
UNREAD = ", ".join([
    "script, style, svg, button, details, video, .headerlink, .lab-quiz, .lk-embed, div.math",
    *HEADINGS,
])  # fmt: skip
BLOCKS = {"p", "li", "dt", "dd", "tr", "td", "th", "div", "pre", "section", "figcaption", "caption"}
ACCENTS = {"\u02d9": "\u0307", "\u00a8": "\u0308", "\u00af": "\u0304", "^": "\u0302"}
"""Accents that stand alone in MathML, and those that combine with the letter before them."""


def update(folder: Path, written: Mapping[str, list[Part]]) -> None:
    """Write the texts of all pages of the built book.

    Args:
        folder: The folder of the built book.
        written: The parts of each page written in this build; other pages keep their old ones.
    """
    texts = {n: parts for n, parts in kept(folder).items() if (folder / f"{n}.html").exists()}
    texts |= written
    told = json.dumps(dict(sorted(texts.items())), ensure_ascii=False, separators=(",", ":"))
    (folder / NAME).write_text(f"{OPENING}{told};\n", encoding="utf-8")


def kept(folder: Path) -> dict[str, list[Part]]:
    """The texts that the last build wrote; empty if there was no build."""
    path = folder / NAME
    if not path.exists():
        return {}
    told: dict[str, list[Part]] = json.loads(path.read_text("utf-8")[len(OPENING) : -2])
    return told


def parts_of(page: BeautifulSoup) -> list[Part]:
    """The parts of a page, which begin at its headings and at the names that it defines."""
    article = page.select_one("article.bd-article")
    if article is None:
        return []
    parts = [("", "", list[str]())]
    unread = {id(element) for element in article.select(UNREAD)}
    for piece in _pieces(article, unread):
        if isinstance(piece, Tag):
            parts.append((str(piece["id"]), _title(piece), []))
        else:
            parts[-1][-1].append(piece)
    found = ((place, title, " ".join("".join(words).split())) for place, title, words in parts)
    return [part for part in found if part[-1]]


def _pieces(element: Tag, unread: set[int]) -> Iterator[Tag | str]:
    """The pieces of text in their order, and each element at which a part begins."""
    if id(element) in unread:
        return
    if element.get("id") and (element.name == "dt" or _heading(element)):
        yield element
    if "math" in element.get_attribute_list("class"):
        yield spoken(element.get_text())
        return
    for child in element.children:
        if isinstance(child, Tag):
            yield from _pieces(child, unread)
        elif type(child) is NavigableString:
            yield str(child)
    if element.name in BLOCKS:
        yield " "


def _heading(element: Tag) -> Tag | None:
    """The heading at the beginning of a section; an exercise is a section without a heading."""
    found = element.find(HEADINGS, recursive=False) if element.name == "section" else None
    return found if isinstance(found, Tag) else None


def _title(element: Tag) -> str:
    named = _heading(element) or element.select_one(".descname") or element
    return named.get_text().rstrip("#").strip()


def spoken(formula: str) -> str:
    """The text of a formula, with each accent on its letter."""
    for alone, combined in ACCENTS.items():
        formula = formula.replace(alone, combined)
    return unicodedata.normalize("NFC", formula)
