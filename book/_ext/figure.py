"""The figures of the book: each has a number and a caption, and the text can cite it.

Drawings, replays, sketches and live arms are HTML, which Sphinx neither counts nor cites, so each
becomes a `Figure`.  A cell or a directive with the option ``:name: fig-speeds`` is cited by
``{numref}`fig-speeds```.

The directive ``sketch`` puts a drawing of `static/sketches` into a page as it stands.  Its argument
is the drawing's name, the option `alt` says what is to be seen, and the text is the caption.  A
drawing inside the page takes the page's colours and letters, light or dark.
"""

from __future__ import annotations

import re
from html import escape, unescape
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.transforms import SphinxTransform
from sphinx.util.docutils import SphinxDirective

SKETCHES = Path(__file__).parents[1] / "static" / "sketches"
CAPTION = "<figcaption>"


class Figure(nodes.General, nodes.Element):
    """HTML with a caption, which begins with the number: attributes `before` and `after` it."""


def visit(self: Any, node: Figure) -> None:
    """Write the figure up to its number; the children are the rest of the caption."""
    self.body.append(node["before"].replace("<figure", f'<figure id="{node["ids"][0]}"', 1))
    self.add_fignumber(node)


def depart(self: Any, node: Figure) -> None:
    """Write what follows the caption."""
    self.body.append(node["after"])


class DrawnFigures(SphinxTransform):
    """Replace the HTML of each cell that draws a figure by a `Figure` with the cell's name."""

    default_priority = 400  # before Sphinx collects the names

    def apply(self, **_: Any) -> None:
        """Find them."""
        for html in list(self.document.findall(nodes.raw)):
            before, caption, after = html.astext().partition(CAPTION)
            if not caption or not before.startswith("<figure"):
                continue
            cell = html.parent
            while cell and "cell_metadata" not in cell:
                cell = cell.parent
            figure = Figure(before=before + caption, after=after)
            named(figure, self.document, cell["cell_metadata"].get("name") if cell else None)
            html.replace_self(figure)


def named(figure: Figure, document: nodes.document, name: str | None) -> Figure:
    """Give a figure the id by which it is counted, and the name by which it is cited."""
    if name:
        figure["names"].append(name)
        document.note_explicit_target(figure, figure)
    else:
        document.set_id(figure)
    return figure


def title(figure: Figure) -> str:
    """The first words of the caption, for Sphinx, which cites only what has a title."""
    words = figure.astext() or unescape(re.sub("<[^>]+>", " ", figure["after"]))
    return words.partition(".")[0].strip()


class Sketch(SphinxDirective):
    """The directive that draws a sketch."""

    required_arguments = 1
    has_content = True
    option_spec: ClassVar[dict[str, Any]] = {"alt": directives.unchanged_required}

    def run(self) -> list[nodes.Node]:
        """Return the drawing with its caption; its name is `fig-` and the drawing's name."""
        name, alt = self.arguments[0], escape(" ".join(self.options["alt"].split()))
        path = SKETCHES / f"{name}.svg"
        self.env.note_dependency(str(path))
        drawing = path.read_text(encoding="utf-8").replace(
            "<svg", f'<svg class="lab-svg" role="img" aria-label="{alt}"', 1
        )
        figure = Figure(
            before=f'<figure class="lab-figure">\n{drawing}{CAPTION}',
            after=f"<details><summary>Description in words</summary><p>{alt}</p></details>"
            "</figcaption></figure>",
        )
        self.state.nested_parse(self.content, self.content_offset, figure)
        label = f"fig-{name.replace('_', '-')}"
        return [named(figure, self.state.document, label)]


def setup(app: Sphinx) -> dict[str, Any]:
    """Register node, transform and directive with Sphinx."""
    app.add_enumerable_node(Figure, "figure", title, html=(visit, depart))
    app.add_transform(DrawnFigures)
    app.add_directive("sketch", Sketch)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
