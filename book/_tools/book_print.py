"""Printing the built book as one document: cover, contents with page numbers, every chapter.

The pages follow one another, a picture replaces what works only on screen, links lead to the
chapter in the same document, and Chromium prints the document.
"""

from __future__ import annotations

import logging
import re
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from datetime import date
from importlib.metadata import version
from pathlib import Path
from urllib.parse import unquote, urldefrag

from book_pages import BOOK, HTML, ROOT, in_order
from bs4 import BeautifulSoup, Tag
from chromium import program

PRINTING = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--allow-file-access-from-files", "--no-pdf-header-footer", "--virtual-time-budget=60000",
)  # fmt: skip
INNER = ("generated/notebooks/", "gallery/", "reference/")
"""Pages that are indented in the contents, because they belong to the page before them."""


def print_pdf(
    progress: Callable[[str], None],
    pages: Sequence[str] | None = None,
    target: Path = ROOT / "dist/book.pdf",
) -> Path:
    """Print the built book.

    Args:
        progress: Called with a few words about what is being done.
        pages: Names of the pages to print; None means all of them in order.
        target: The file to write.

    Returns:
        The file.

    Raises:
        SystemExit: There is no Chromium.
    """
    from pypdf import PdfReader, PdfWriter

    browser = program()
    logging.getLogger("pypdf").setLevel(logging.ERROR)  # Chromium's own table is one short
    target.parent.mkdir(exist_ok=True)
    pages = list(pages or in_order())
    progress("putting the pages together")
    whole = document(pages)
    with tempfile.TemporaryDirectory() as folder:
        source, printed = Path(folder) / "book.html", Path(folder) / "book.pdf"
        numbers = dict.fromkeys(pages, 0)
        for told in ("printing, to count the pages", "printing, with the contents"):
            progress(told)
            _number(whole, numbers)
            source.write_text(str(whole), encoding="utf-8")
            command = [browser, *PRINTING, f"--user-data-dir={folder}/profile"]
            command += [f"--print-to-pdf={printed}", source.as_uri()]
            subprocess.run(command, check=True, capture_output=True, timeout=600)
            found = PdfReader(printed)
            places = found.named_destinations
            numbers = {
                page: 1 + (found.get_destination_page_number(places[f"/{_place(page)}"]) or 0)
                for page in pages[1:]  # the first is not in the contents
            }
        file = PdfWriter(clone_from=printed)
        for chapter, page in zip(whole.select(".lab-chapter")[1:], pages[1:], strict=True):
            title = chapter.select_one("h1")
            assert title
            file.add_outline_item(title=_words(title), page_number=numbers[page] - 1)
        file.write(target)
    return target


def document(pages: Sequence[str]) -> BeautifulSoup:
    """One page made of the named pages of the built book."""
    index = BeautifulSoup((HTML / "index.html").read_text(encoding="utf-8"), "html.parser")
    whole = BeautifulSoup(
        '<!doctype html><html lang="en" data-theme="light" data-mode="light"><head>'
        '<meta charset="utf-8"></head><body><main class="bd-article"></main></body></html>',
        "html.parser",
    )
    assert whole.head and whole.main
    title = index.select_one("article h1")
    assert title
    whole.head.append(_made(f"<title>{_words(title)}</title>"))
    for link in index.select('head link[rel="stylesheet"]'):
        whole.head.append(_made(f'<link rel="stylesheet" href="{_file(HTML, link["href"])}">'))
    whole.head.append(
        _made(f'<link rel="stylesheet" href="{(ROOT / "book/_tools/print.css").as_uri()}">')
    )
    for script in ("mathjax-config.js", "tex-svg-full.js"):
        address = (HTML / "_static/vendor" / script).as_uri()
        whole.head.append(_made(f'<script src="{address}"></script>'))
    chapters = [(page, _chapter(page, set(pages))) for page in pages]
    whole.main.append(_cover(_words(title)))
    whole.main.append(_contents(chapters))
    for _, chapter in chapters:
        whole.main.append(chapter)
    return whole


def _chapter(page: str, pages: set[str]) -> Tag:
    """The text of one page, prepared for paper and for a document with the other pages."""
    path = HTML / f"{page}.html"
    text = BeautifulSoup(path.read_text(encoding="utf-8"), "html.parser")
    article = text.select_one("article.bd-article")
    assert article, page
    title = article.select_one("h1")
    assert title, page
    where = f"on screen in “{_words(title)}”"
    for gone in article.select(
        ".headerlink, script, button, .lk-alt, .lab-said, .toctree-wrapper, template"
    ):
        gone.decompose()
    for embed in article.select(".lk-embed"):
        note = _made(f'<p class="lab-live">Live {where}.</p>')
        picture = embed.select_one("img")
        if picture:
            picture.insert_after(note)
        else:
            embed.insert(0, note)
    for film in article.select("video"):
        alt = film.get("aria-label", "")
        picture = text.new_tag("img", src=film["poster"], alt=alt)
        film.replace_with(picture)
        picture.insert_after(_made(f'<p class="lab-live">A film {where}.</p>'))
    for choice in article.select(".lab-choice input"):
        choice.replace_with(_made('<span class="lab-box" aria-hidden="true"></span>'))
    for more in article.select("figcaption details"):
        told = more.select_one("p, ol")
        assert told, page
        told["class"] = "lab-words"
        more.replace_with(told.extract())
    for more in article.select("details"):
        more["open"] = ""
    for box in article.select("[tabindex]"):
        del box["tabindex"]
    for picture in article.select("img[src]"):
        if not picture["src"].startswith("data:"):
            picture["src"] = _file(path.parent, picture["src"])
    _join(article, page, path, pages)
    chapter: Tag = text.new_tag("div", attrs={"class": "lab-chapter", "id": _place(page)})
    chapter.append(article)
    return chapter


def _join(article: Tag, page: str, path: Path, pages: set[str]) -> None:
    """Make the ids of each page unique in the document, and let the links lead to them."""
    for element in article.select("[id]"):
        element["id"] = f"{_place(page)}--{element['id']}"
    for element in article.select("[aria-labelledby]"):
        element["aria-labelledby"] = f"{_place(page)}--{element['aria-labelledby']}"
    for link in article.find_all(["a", "use"]):
        name = next((n for n in ("href", "xlink:href") if link.has_attr(n)), None)
        if name is None or re.match(r"(https?|mailto):", link[name]):
            continue
        address, place = urldefrag(link[name])
        goal = (path.parent / unquote(address)).resolve() if address else path
        other = (
            goal.relative_to(HTML).with_suffix("").as_posix() if goal.is_relative_to(HTML) else ""
        )
        if goal.suffix == ".html" and other in pages:
            link[name] = f"#{_place(other)}" + (f"--{place}" if place else "")
        else:
            del link[name]
    for element in article.select("[clip-path]"):
        element["clip-path"] = element["clip-path"].replace("url(#", f"url(#{_place(page)}--")
    for element in article.select('[style*="url(#"]'):
        element["style"] = element["style"].replace("url(#", f"url(#{_place(page)}--")


def _cover(title: str) -> Tag:
    picture = (BOOK / "static/baxter.png").as_uri()
    return _made(
        f'<div class="lab-cover"><p class="lab-title">{title}</p>'
        "<p>Trajectory tracking with one arm of a simulated Baxter</p>"
        f'<img src="{picture}" alt="Baxter, a robot with two red arms">'
        f"<p>labkit {version('labkit')}, printed on {date.today():%-d %B %Y}</p>"
        "<p>Pictures here replace what moves on screen: replays, demos, the explorer of gains, "
        "films and quizzes are in the folder of the book, index.html.</p></div>"
    )


def _contents(chapters: list[tuple[str, Tag]]) -> Tag:
    """The contents, with a line for each page; `_number` adds the page numbers."""
    lines = []
    for page, chapter in chapters[1:]:
        title = chapter.select_one("h1")
        assert title
        inner = page.startswith(INNER) and not page.endswith("index")
        lines.append(
            f'<li class="{"lab-inner" if inner else "lab-outer"}"><a href="#{_place(page)}">'
            f'<span>{_words(title)}</span><span class="lab-leader"></span>'
            f'<span class="lab-number" data-page="{page}"></span></a></li>'
        )
    inside = f'<p class="lab-title">Contents</p><ol>{"".join(lines)}</ol>'
    return _made(f'<nav class="lab-contents">{inside}</nav>')


def _number(whole: BeautifulSoup, numbers: Mapping[str, int]) -> None:
    for place in whole.select(".lab-number"):
        place.string = str(numbers[str(place["data-page"])])


def _place(page: str) -> str:
    return page.replace("/", "--")


def _words(title: Tag) -> str:
    return " ".join(title.get_text().replace("#", "").split())


def _file(folder: Path, address: object) -> str:
    return (folder / unquote(str(address).split("?")[0])).resolve().as_uri()


def _made(html: str) -> Tag:
    found = BeautifulSoup(html, "html.parser").find()
    assert isinstance(found, Tag)
    return found.extract()
