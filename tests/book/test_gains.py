"""The gain explorer shows what Python runs, at every point that is tried."""

import json
import random

import pytest
from figures import gains

pytestmark = pytest.mark.slow


def test_forty_random_points_are_run_again_bit_for_bit(book):
    """Their files and facts in the book are the ones that a new run writes."""
    runs = book / "_static/runs"
    facts = json.loads((runs / "facts.json").read_text())
    for point in random.Random(9).sample(gains.points(), 40):
        name, text, fact = gains.make(point)
        assert (runs / name).read_text() == text, point
        assert facts["-".join(map(str, point))] == fact


def test_every_point_of_the_grid_is_recorded_and_small(book):
    """There is one file for each point, and none has more than 40 kB."""
    files = sorted((book / "_static/runs").glob("gains-*.js"))
    assert len(files) == len(gains.points())
    assert max(f.stat().st_size for f in files) <= 40_000


def test_the_dials_are_moved_by_keyboard_and_say_recorded(visit):
    """A key shows another run; a typed Kp of 12 shows the nearest, 8; the line names the task."""
    page = visit("chapters/velocity.html")
    host = page.locator(".lk-embed:has(.lk-explorer)")
    page.evaluate("""() => [...document.querySelectorAll('.lk-embed')].forEach(e =>
        JSON.parse(e.querySelector('script').textContent).kind === 'explorer'
        && e.scrollIntoView())""")
    host.locator("[data-run]").or_(page.locator("[data-run]")).first.wait_for()
    shown = page.locator("[data-run]").first
    before = shown.get_attribute("data-run")
    page.get_by_role("slider", name="Kp").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_function(
        "b => document.querySelector('[data-run]').dataset.run !== b", arg=before
    )
    assert "recorded" in page.inner_text(".lk-recorded")
    typed = page.get_by_label("Kp, typed")
    typed.fill("12")
    typed.press("Enter")
    page.wait_for_function(
        "text => document.querySelector('.lk-recorded').textContent.includes(text)",
        arg="at Kp 12; the nearest, 8, is shown",
    )
    page.get_by_label("Task", exact=True).select_option("circle")
    page.wait_for_function("document.querySelector('.lk-recorded').textContent.includes('circle')")
