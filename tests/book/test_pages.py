"""Every page of the built book, opened from the disk: quiet, offline, accessible, small or dark."""

import re
from urllib.parse import unquote, urldefrag

import pytest
from accessibility import COLOURS, violations
from book_pages import ROOT, in_order
from bs4 import BeautifulSoup
from build_book import SAMPLE
from weigh import LIMITS, loaded

PAGES = [*in_order(), "search"]
each = pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n in SAMPLE else pytest.mark.soak) for n in PAGES]
)
"""The gate opens a page of each kind, `make soak` the others."""

pytestmark = pytest.mark.slow


def wake(page):
    """Bring every viewer into sight, wait until it stands."""
    page.evaluate("""async () => {
        const soon = () => new Promise((r) => setTimeout(r, 30));
        for (const e of document.querySelectorAll('.lk-embed')) {
            e.scrollIntoView();
            e.querySelector('.lk-load')?.click();
            while (!e.querySelector('[data-ready]')) await soon();
        }
    }""")


def too_wide(page, width):
    """Whether the page has to be moved sideways at a width."""
    page.set_viewport_size({"width": width, "height": 844})
    page.evaluate("() => new Promise((r) => requestAnimationFrame(() => setTimeout(r, 0)))")
    return page.evaluate("document.documentElement.scrollWidth") > width


@each
def test_a_page_is_light_quiet_accessible_and_fits(visit, open_chromium, name):
    """On a desk, and narrower down to a phone's width; no request, no complaint."""
    page = visit(f"{name}.html", browser=open_chromium, reduced_motion="reduce")
    page.wait_for_load_state("networkidle")
    assert [key for key, x in loaded(page.asked).items() if x > LIMITS[key]] == []
    wake(page)
    assert violations(page) == []
    assert not too_wide(page, 640), "what 200 % leaves of 1280"
    assert not too_wide(page, 390)


@each
def test_a_page_is_accessible_in_every_mode(visit, open_chromium, name):
    """Opened on a phone, and in dark colours."""
    page = visit(f"{name}.html", browser=open_chromium, phone=True, reduced_motion="reduce")
    assert not too_wide(page, 390)
    assert violations(page) == [], "phone"
    wake(page)
    page.evaluate("document.documentElement.dataset.theme = 'dark'")
    assert violations(page, only=COLOURS) == [], "dark"


@pytest.mark.soak
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_drawing_is_enlarged_on_a_phone(visit, open_chromium, scheme):
    """To letters of reading size, in a box that the keyboard moves; closing puts it back."""
    page = visit("chapters/torque.html", browser=open_chromium, phone=True, color_scheme=scheme)
    figure = page.locator(".lab-figure").first
    before = figure.bounding_box()["height"]
    figure.get_by_role("button", name="Enlarge").click()
    dialog = page.get_by_role("dialog")
    assert abs(figure.bounding_box()["height"] - before) < 1, "the text behind does not move"
    size = """svg => svg.getBoundingClientRect().width / svg.viewBox.baseVal.width
        * parseFloat(getComputedStyle(svg.querySelector('text')).fontSize)"""
    assert dialog.locator("svg").evaluate(size) >= 14
    assert violations(page) == []
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    page.keyboard.press("Tab")
    page.keyboard.press("ArrowRight")
    page.wait_for_function("document.querySelector('.lab-sheet').scrollLeft > 0")
    page.keyboard.press("Escape")
    assert dialog.count() == 0
    assert figure.locator("> svg").count() == 1
    assert page.evaluate("document.activeElement.textContent") == "Enlarge"


def html_files(book):
    return [p for p in book.rglob("*.html") if "_static" not in p.parts]


@pytest.fixture(scope="module")
def pages(book):
    """Each page of the book, read once for all tests."""
    return {p: BeautifulSoup(p.read_text(), "html.parser") for p in html_files(book)}


@pytest.mark.soak
@pytest.mark.xdist_group("read pages")
def test_internal_links_and_downloads_lead_somewhere(pages):
    """Each address within the book is a file, and the part after # is an id or a name in it."""
    places = {
        path: {tag.get(key) for key in ("id", "name") for tag in page.find_all(attrs={key: True})}
        for path, page in pages.items()
    }
    broken = []
    for path, page in pages.items():
        for link in page.select("[href], [src]"):
            address, place = urldefrag(link.get("href") or link.get("src"))
            if re.match(r"(https?|mailto|data|javascript):", address):
                continue
            target = (path.parent / unquote(address.split("?")[0])).resolve() if address else path
            if target.is_dir() or not target.exists():
                broken.append(f"{path.name}: {address}")
            elif place and unquote(place) not in places.get(target, {unquote(place)}):
                broken.append(f"{path.name}: {address}#{place}")
    assert broken == []


@pytest.mark.soak
@pytest.mark.xdist_group("read pages")
def test_every_picture_has_words(pages):
    """Figures have a caption and a description, drawings a label, and images an alt."""
    for path, page in pages.items():
        for figure in page.select(".lab-figure, .lk-embed"):
            assert figure.select_one("figcaption").get_text(strip=True), path.name
            assert figure.select_one("details :is(p, ol)").get_text(strip=True), path.name
        for drawing in page.select(".lab-figure svg"):
            assert len(drawing["aria-label"]) > 40, path.name
        for image in page.select("img"):
            assert image.get("alt") is not None, f"{path.name}: {image}"


@pytest.mark.soak
@pytest.mark.xdist_group("read pages")
def test_every_figure_has_a_number_and_is_cited(pages):
    """Somewhere the text leads to each figure by its number."""
    names, cited = set(), set()
    for path, page in pages.items():
        here = {figure["id"] for figure in page.select("article figure")}
        told = page.select(":is(figcaption, .lk-caption) .caption-number")
        assert len(told) == len(here), path.name
        names |= here
        cited |= {link["href"].partition("#")[2] for link in page.select("a:has(.std-numref)")}
    assert names == cited


@pytest.mark.soak
@pytest.mark.xdist_group("read pages")
def test_ids_are_unique(pages):
    """On no page of the book do two elements have one id."""
    for path, page in pages.items():
        ids = [e["id"] for e in page.select("[id]")]
        assert len(ids) == len(set(ids)), (path.name, [i for i in ids if ids.count(i) > 1][:5])


def test_the_readme_has_the_books_numbers(pages, book):
    """README's table of errors is the landing page's."""
    tables = pages[book / "index.html"].select("table")
    (table,) = (x for x in tables if x.caption and "RMS error" in x.caption.text)
    readme = (ROOT / "README.md").read_text().splitlines()
    for row in table.select("tbody tr"):
        name, *numbers = (cell.text for cell in row.select("th, td"))
        (line,) = (x for x in readme if x.startswith(f"| {name}"))
        assert line.endswith(f"| {' | '.join(numbers)} |")
