"""The book on paper: all its chapters, pictures where the screen has life, links that lead on."""

import re
from pathlib import Path
from urllib.parse import unquote, urlparse

import book_print
import pytest
from book_pages import in_order
from pypdf import PdfReader

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("print")]
ALIVE = "script:not([src]), button, input, select, canvas, video, details:not([open])"


@pytest.fixture(scope="module")
def paper(book):
    return book_print.document(in_order())


def test_every_page_is_there_with_its_title(paper):
    """There are as many chapters as pages in the contents, and each has a heading with words."""
    chapters = paper.select(".lab-chapter")
    assert len(chapters) == len(in_order())
    assert all(c.select_one("h1").get_text(strip=True) for c in chapters)


def test_nothing_waits_for_a_hand(paper):
    """No control is printed; what lives on screen has a picture or words, and says where."""
    assert paper.select(f".lab-chapter :is({ALIVE})") == []
    embeds = paper.select(".lk-embed")
    assert len(embeds) >= 10
    for embed in embeds:
        assert "Live on screen in" in embed.select_one(".lab-live").get_text()
        assert embed.select_one("figcaption").get_text(strip=True)
        assert embed.select_one("img"), embed.figcaption


def test_links_stay_in_the_document_and_pictures_are_files(paper):
    """Links go to an id or to an address outside; pictures exist and have an alt."""
    there = {element["id"] for element in paper.select("[id]")}
    for link in paper.select("a[href]"):
        assert re.match(r"#|https?:|mailto:", link["href"]), link
        assert not link["href"].startswith("#") or link["href"][1:] in there, link
    for picture in paper.select("img"):
        address = urlparse(picture["src"])
        assert address.scheme == "data" or Path(unquote(address.path)).exists(), picture["src"]
        assert picture.get("alt"), picture["src"][:80]


def test_what_is_printed_has_formulas_numbers_and_no_empty_page(book, tmp_path):
    """Two pages on paper: drawn formulas, contents with page numbers, no machine's path."""
    pages = ["index", "chapters/paths", "glossary"]
    made = book_print.print_pdf(lambda _: None, pages, tmp_path / "some.pdf")
    file = PdfReader(made)
    width, height = file.pages[0].mediabox[2:]
    assert (round(width), round(height)) == (595, 842)  # A4 in points
    texts = [page.extract_text() for page in file.pages]
    begins = {item.title: file.get_destination_page_number(item) for item in file.outline}
    assert [t.split(". ")[-1] for t in begins] == ["Paths and time scaling", "Glossary"]
    for title, number in begins.items():
        assert title in texts[number]
        assert re.search(rf"{re.escape(title)}\s+{number + 1}\b", texts[1])
    for text, page in zip(texts, file.pages, strict=True):
        assert len(text) > 30 or page.images
        assert not re.search(r"\\dot|\\lambda|\\frac|file:///", text)
    links = [a.get_object().get("/A", {}).get("/URI", "") for page in file.pages
             for a in page.get("/Annots", [])]  # fmt: skip
    assert not any(link.startswith("file:") for link in links)
