"""The search for barriers finds them."""

import pytest
from accessibility import COLOURS, violations

PAGE = """<!doctype html><html lang="en"><title>A page</title><main><h1>A page</h1>
<p style="background: #fff; color: #ccc">pale</p><img src="data:,"></main></html>"""


@pytest.mark.parametrize("only", [{}, {"only": COLOURS}], ids=["all", "colours"])
def test_pale_words_and_a_picture_without_words_are_found(chromium, only):
    """Both, with their elements; of the colours alone, the first."""
    page = chromium.new_page()
    page.set_content(PAGE)
    found = " ".join(violations(page, **only))
    assert 'color-contrast: <p style="background' in found
    assert ('image-alt: <img src="data:,">' in found) == (not only)
    page.close()
