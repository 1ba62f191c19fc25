"""A reader's hands on the book: keyboard, quiz, theme, reduced motion, no WebGL."""

import json
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.slow


def test_the_first_stop_of_the_keyboard_skips_to_the_text(visit):
    """After one Tab the focus is on "Skip to main content"."""
    page = visit("chapters/paths.html")
    page.keyboard.press("Tab")
    assert "Skip to main content" in page.evaluate("document.activeElement.textContent")


def test_every_viewer_is_moved_by_keyboard(visit):
    """On the page on paths the right arrow moves the first slider of each viewer."""
    page = visit("chapters/paths.html")
    for k in range(page.locator(".lk-embed").count()):
        host = page.locator(".lk-embed").nth(k)
        host.scroll_into_view_if_needed()
        host.locator("[data-ready]").first.wait_for()
        slider = host.locator("input[type=range]:not([disabled])").first
        slider.focus()
        before = slider.input_value()
        page.keyboard.press("ArrowRight")
        page.keyboard.press("ArrowRight")
        assert slider.input_value() != before


def test_formulas_are_drawn(visit):
    """They are MathML, in the book's font, and leave no source of TeX in the text."""
    page = visit("chapters/paths.html")
    assert page.locator("math").count() > 100
    source = r"/\\dot|\\lambda|\\\(/"
    assert not page.evaluate(f"{source}.test(document.querySelector('main').innerText)")
    loaded = "document.fonts.load('16px \"STIX Two Math\"', 'Σ').then((f) => f.length)"
    assert page.evaluate(loaded) == 1


def test_the_quiz_answers(visit):
    """Each choice, taken by keyboard, says whether it is right, and why."""
    page = visit("chapters/paths.html")
    question = page.locator(".lab-question").first
    right = int(question.get_attribute("data-right"))
    said = json.loads(question.get_attribute("data-said"))
    for k, choice in enumerate(question.locator("input").all()):
        choice.focus()
        page.keyboard.press("Space")
        told = question.locator(".lab-said").inner_text()
        assert told.startswith("✓ Right." if k == right else "✗ Not yet.")
        if "\\(" not in said[k]:
            assert said[k] in told


def test_answers_to_exercises_are_folded(visit):
    """Each is closed until the reader opens it."""
    page = visit("chapters/paths.html")
    folded = page.query_selector_all(".solution details, details.solution, .solution.dropdown")
    assert len(folded) >= 3
    assert not page.query_selector_all(".solution details[open], details.solution[open]")


def test_reduced_motion_stops_the_themes_transitions(visit):
    """No element of the first page has a transition or an animation that takes time."""
    page = visit("index.html", reduced_motion="reduce")
    moving = page.evaluate("""() => [...document.querySelectorAll('*')].filter((e) => {
        const s = getComputedStyle(e);
        return parseFloat(s.transitionDuration) > 0 || parseFloat(s.animationDuration) > 0;
    }).length""")
    assert moving == 0


def test_without_webgl_words_and_plots_remain(visit, blind_chromium):
    """The still picture with its description and at least one curve are there."""
    page = visit("chapters/torque.html", browser=blind_chromium)
    page.locator(".lk-embed").first.scroll_into_view_if_needed()
    page.wait_for_selector("[data-ready]")
    assert page.is_visible(".lk-embed img.lk-poster")
    assert "left arm" in page.get_attribute(".lk-embed img.lk-poster", "alt")
    page.wait_for_selector(".lk-line", state="attached")  # drawn when the page is laid out


def test_every_notebook_is_saved_from_the_disk(visit):
    """The link brings the file: a browser would show a neighbouring one instead of saving it."""
    page = visit("generated/notebooks.html")
    links = page.get_by_role("link", name="download", exact=True).all()
    released = sorted((ROOT / "assignments").glob("*/*.ipynb"))
    assert len(links) == len(released)
    for link, notebook in zip(links, released, strict=True):
        with page.expect_download() as saving:
            link.click()
        assert saving.value.suggested_filename == notebook.name
        assert Path(saving.value.path()).read_bytes() == notebook.read_bytes()


def test_an_exercise_leads_to_its_notebook(visit):
    """Its link opens the notebook's page, which offers the download."""
    page = visit("chapters/impedance.html")
    page.get_by_role("link", name="05, impedance").click()
    page.wait_for_url("**/generated/notebooks/05_impedance.html")
    assert page.get_by_role("link", name="Download this notebook").is_visible()


def test_words_and_numbers_in_tables_stay_whole_on_a_phone(visit):
    """Each symbol in the table of notation is on one line."""
    page = visit("notation.html", phone=True)
    heights = page.evaluate("""() => [...document.querySelectorAll('td:first-child code')]
        .map((e) => e.getClientRects().length)""")
    assert set(heights) == {1}


def test_a_wide_formula_is_moved_by_keyboard(visit):
    """It begins at the left, and fades at the right until its end has been brought in."""
    page = visit("chapters/torque.html", phone=True)
    page.set_viewport_size({"width": 260, "height": 844})  # on a phone of 390 all of them fit
    fade = "d => getComputedStyle(d).getPropertyValue('--more')"
    box = "d.querySelector('math').getBoundingClientRect()"
    begins = f"d => {box}.left - d.getBoundingClientRect().left"
    ends = f"d => {box}.right - innerWidth"
    wide = [box for box in page.locator("div.math").all() if box.evaluate(ends) > 0]
    assert len(wide) > 2
    for box in wide:
        assert box.evaluate(begins) >= 0
        assert box.evaluate(fade) == "40px"
        box.focus()
        page.keyboard.press("ArrowRight")
        page.wait_for_function("document.activeElement.scrollLeft > 0")
        box.evaluate("d => { d.blur(); d.scrollLeft = d.scrollWidth; }")
        page.wait_for_function(f"d => ({fade})(d) === '0px'", arg=box.element_handle())
        assert box.evaluate(ends) <= 0


def test_a_phone_loads_the_arm_on_tap(visit):
    """There is no canvas until the reader taps, and then the viewer becomes ready."""
    page = visit("chapters/comparison.html", phone=True)
    page.wait_for_timeout(300)
    assert page.locator("canvas").count() == 0
    page.get_by_role("button", name="Tap to load").first.click()
    page.wait_for_selector("[data-ready]")
