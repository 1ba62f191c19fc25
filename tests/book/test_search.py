"""Search as a reader of the folder has it: hits with their surroundings, marks behind the link."""

import excerpts
import pytest
from book_pages import in_order
from bs4 import BeautifulSoup
from figures.formulas import mathml

TAGGED = """<article class="bd-article"><section id="top"><h1>Top<a class="headerlink">#</a></h1>
<p>A speed <span class="math"><math><mover><mi>q</mi><mo>\u02d9</mo></mover></math></span>
is <b>com</b>manded.</p>
<script>not this</script>
<section id="exercise-content"><p>Do it.</p></section>
<section id="low"><h2>Low</h2><dl><dt id="name"><span class="descname">run</span>()</dt>
<dd>Runs.</dd></dl></section></section></article>"""


def test_a_page_is_cut_at_headings_and_names_and_words_stay_whole():
    """A tagged page has a part for its heading and one for a function, formulas as letters."""
    assert excerpts.parts_of(BeautifulSoup(TAGGED, "html.parser")) == [
        ("top", "Top", "A speed q̇ is commanded. Do it."),
        ("name", "run", "run() Runs."),
    ]


def test_a_formula_of_a_sentence_is_read_as_letters():
    """An accent is on its letter, as one searches for it."""
    page = BeautifulSoup(mathml(r"\dot q = \ddot x + \lVert e\rVert"), "html.parser")
    assert excerpts.spoken(page.get_text()) == "q̇=ẍ+‖e‖"


def test_a_page_that_was_not_written_again_keeps_its_text(tmp_path):
    """A new text is added to the old one, and that of a page that has gone is dropped."""
    for name in ("old", "new"):
        (tmp_path / f"{name}.html").touch()
    excerpts.update(tmp_path, {"old": [("a", "A", "as it was")], "gone": [("g", "G", "away")]})
    excerpts.update(tmp_path, {"new": [("b", "B", "as it is")]})
    assert excerpts.kept(tmp_path) == {
        "new": [["b", "B", "as it is"]],
        "old": [["a", "A", "as it was"]],
    }


@pytest.mark.slow
def test_every_page_has_its_text_and_all_of_it_is_small(book):
    """Each page of the contents has a text, and the file has less than 900 kB."""
    assert set(excerpts.kept(book)) == set(in_order())
    assert (book / excerpts.NAME).stat().st_size < 900_000


@pytest.mark.slow
def test_only_the_page_that_searches_loads_what_searching_needs(book):
    """No page of the contents loads the index or the tools of the search."""
    for name in in_order():
        page = BeautifulSoup((book / f"{name}.html").read_text(), "html.parser")
        loaded = " ".join(script["src"] for script in page.select("script[src]"))
        assert "searchindex" not in loaded, name
        assert "searchtools" not in loaded, name


def results(visit, words):
    page = visit("search.html")
    page.goto(page.url.split("?")[0] + f"?q={words}")
    page.wait_for_selector("#search-results li[data-complete] .context")
    return page


@pytest.mark.slow
def test_a_hit_shows_what_stands_around_it(visit):
    """The word trapezoid finds its chapter first, marked in over 100 characters of context."""
    page = results(visit, "trapezoid")
    first = page.locator("#search-results li").first
    assert "Paths and time scaling" in first.inner_text()
    assert first.locator("mark").first.inner_text().lower().startswith("trapezoid")
    assert len(first.locator(".context").inner_text()) > 100
    for item in page.locator("#search-results li").all():
        assert item.locator(".context").count() == 1


@pytest.mark.slow
def test_the_page_behind_a_hit_is_marked_until_escape(visit):
    """Also where the word has another form; formulas are drawn and nothing is stored."""
    page = results(visit, "gravitational dot")
    assert page.evaluate("localStorage.getItem('sphinx_highlight_terms')") is None
    page = results(visit, "gravity")
    page.locator("#search-results").get_by_role("link", name="2. The model").click()
    page.wait_for_selector(".lab-unmark")
    marked = page.evaluate("[...CSS.highlights.get('lab-found')].map(r => String(r).toLowerCase())")
    assert len(marked) >= 3
    assert set(marked) == {"gravity"}
    page.wait_for_selector("math")
    assert page.locator("merror").count() == 0
    page.keyboard.press("Escape")
    assert page.evaluate("CSS.highlights.size") == 0
    assert page.locator(".lab-unmark").count() == 0


@pytest.mark.slow
def test_a_link_into_a_page_brings_the_mark_into_sight(visit):
    """After a click on a hit's section a marked word is within the window."""
    page = results(visit, "compensation")
    page.locator(".context a", has_text="Who carries the weight").click()
    page.wait_for_selector(".lab-unmark")
    page.wait_for_function("""() => {
        const boxes = [...CSS.highlights.get('lab-found')].map((r) => r.getBoundingClientRect());
        return boxes.some((b) => b.top > 0 && b.bottom < innerHeight);
    }""")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("typed", "offered"),
    [("singularty", "singularity"), ("pasivity", "passivity"), ("joint toruqe", "joint torque")],
)
def test_a_slip_of_the_fingers_is_forgiven(visit, typed, offered):
    """A word that the book does not have leads to the nearest one that it has."""
    page = visit("search.html")
    page.goto(page.url.split("?")[0] + f"?q={typed}")
    page.locator("#search-results").get_by_role("link", name=offered, exact=True).click()
    page.wait_for_selector("#search-results li[data-complete] .context")


@pytest.mark.slow
def test_a_word_that_the_book_has_offers_no_other(visit):
    """A search for singularity does not ask "Did you mean"."""
    assert results(visit, "singularity").get_by_text("Did you mean").count() == 0
