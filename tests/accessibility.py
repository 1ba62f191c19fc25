"""What axe-core finds on a page, no rule disabled and nothing excluded."""

from pathlib import Path

AXE = (Path(__file__).parent / "vendor/axe.min.js").read_text()
TAGS = ("wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice")
COLOURS = ("color-contrast", "link-in-text-block")
"""The rules that look at colours: all that a page in the other theme can break anew."""


def violations(page, where="html", only=TAGS):
    """What is wrong on a page, as rule and element; empty where nothing is.

    Only this list leaves the page: axe's whole answer is ten thousand elements long, and to
    carry them over takes longer than to find them.

    Args:
        page: Playwright's.
        where: A selector of the part to look at.
        only: Tags of rules, or the names of some.
    """
    page.evaluate(AXE)
    asked = {"runOnly": list(only), "resultTypes": ["violations"], "preload": False}
    return page.evaluate(
        """async ([where, asked]) => (await axe.run(where, asked)).violations.flatMap(
            (v) => v.nodes.map((n) => `${v.id}: ${n.html.slice(0, 150)}`))""",
        [where, asked],
    )
