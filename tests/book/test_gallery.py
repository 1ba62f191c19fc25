"""The galleries: runs to compare, at the same place on every page, on the same scales."""

from pathlib import Path

import pytest
from bs4 import BeautifulSoup
from figures import gallery

from solutions.study.campaign import TASKS

ROOT = Path(__file__).parents[2]


def test_the_scales_of_a_page_hold_every_method():
    """On the line each method's values are strictly between the ends of their panel's scale."""
    for controller in gallery.SHOWN:
        for (_, values, _), (low, high) in zip(
            gallery._panels(controller, "line"), gallery._limits("line"), strict=True
        ):
            assert low < values.min()
            assert values.max() < high


@pytest.mark.slow
def test_every_run_leads_to_the_same_method_on_the_other_tasks_and_to_all(book):
    """Each has these links and no other, and the last table links each method."""
    for task in TASKS:
        page = BeautifulSoup((book / f"gallery/{task}.html").read_text(), "html.parser")
        for controller in gallery.SHOWN:
            place = controller.replace(" ", "-")
            links = {a["href"] for a in page.select_one(f"section#{place}").select("p a")}
            others = {f"{other}.html#{place}" for other in TASKS if other != task}
            assert links == others | {"#all-methods"}
        names = [a["href"] for a in page.select("section#all-methods table a")]
        assert names == [f"#{controller.replace(' ', '-')}" for controller in gallery.SHOWN]


@pytest.mark.slow
def test_the_readme_has_the_books_numbers(book):
    """README's table of errors is the landing page's."""
    page = BeautifulSoup((book / "index.html").read_text(), "html.parser")
    table = next(x for x in page.select("table") if x.caption and "RMS error" in x.caption.text)
    rows = [[cell.text for cell in row.select("th, td")] for row in table.select("tbody tr")]
    assert len(rows) == len(gallery.SHOWN)
    lines = (ROOT / "README.md").read_text().splitlines()
    for controller, *numbers in rows:
        assert any(
            x.startswith(f"| {controller}") and x.endswith(f"| {' | '.join(numbers)} |")
            for x in lines
        ), controller
