"""The faults that axe-core finds on a page, with every rule and without exclusions."""

from pathlib import Path

AXE = (Path(__file__).parent / "vendor/axe.min.js").read_text()
TAGS = ("wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice")
COLOURS = ("color-contrast", "link-in-text-block")
"""The rules about colours, which are the only ones that the other theme can break."""


def violations(page, where="html", only=TAGS):
    """The faults on a page, each as its rule and element; an empty list if there are none.

    Only this list leaves the page: axe's whole answer has ten thousand elements, and passing
    them on takes longer than finding them.

    Args:
        page: A page of Playwright.
        where: A selector of the part to check.
        only: Tags of rules, or names of rules.
    """
    page.evaluate(AXE)
    asked = {"runOnly": list(only), "resultTypes": ["violations"], "preload": False}
    return page.evaluate(
        """async ([where, asked]) => (await axe.run(where, asked)).violations.flatMap(
            (v) => v.nodes.map((n) => `${v.id}: ${n.html.slice(0, 150)}`))""",
        [where, asked],
    )
