"""The directive ``sketch``, which puts a drawing of `static/sketches` into a page as it stands.

Its argument is the drawing's name, the option `alt` says what is to be seen, and the text is the
caption.  A drawing inside the page takes the page's colours and letters, light or dark.
"""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

SKETCHES = Path(__file__).parents[1] / "static" / "sketches"


class Sketch(SphinxDirective):
    """The directive that draws a sketch."""

    required_arguments = 1
    has_content = True
    option_spec: ClassVar[dict[str, Any]] = {"alt": directives.unchanged_required}

    def run(self) -> list[nodes.Node]:
        """Return the drawing and, between its tags, the caption."""
        name, alt = self.arguments[0], escape(" ".join(self.options["alt"].split()))
        path = SKETCHES / f"{name}.svg"
        self.env.note_dependency(str(path))
        drawing = path.read_text(encoding="utf-8").replace(
            "<svg", f'<svg class="lab-svg" role="img" aria-label="{alt}"', 1
        )
        begin = f'<figure class="lab-figure" id="sketch-{name}">\n{drawing}<figcaption>'
        end = (
            f"<details><summary>Description in words</summary><p>{alt}</p></details>"
            "</figcaption></figure>"
        )
        caption = nodes.container()
        self.state.nested_parse(self.content, self.content_offset, caption)
        return [nodes.raw("", begin, format="html"), *caption.children,
                nodes.raw("", end, format="html")]  # fmt: skip


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directive with Sphinx."""
    app.add_directive("sketch", Sketch)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
