"""The book's own Sphinx extension, which sets up the build and makes the pages accessible.

The theme and the extensions leave some faults, which axe-core finds; `repair` corrects the HTML.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import citations
import excerpts
from bs4 import BeautifulSoup, NavigableString
from docutils.nodes import Element
from sphinx.application import Sphinx
from sphinx.util.nodes import make_refnode


def settings(app: Sphinx, config: Any) -> None:
    """Set the folder in which `book/_tools/build_book.py` keeps the pages that were run."""
    if cache := os.environ.get("LAB_BOOK_CACHE"):
        config.nb_execution_cache_path = cache


def told_already(
    app: Sphinx, what: str, name: str, member: Any, skip: bool, options: Any
) -> bool | None:
    """Skip fields of a named tuple: the class describes them, and Python's text says nothing."""
    return True if str(member.__doc__).startswith("Alias for field number") else None


COLON = "\N{RATIO}"


def hide_colon(app: Sphinx, what: str, name: str, it: Any, options: Any, lines: list[str]) -> None:
    """Hide a colon in a first sentence, because napoleon takes the words before it for a type."""
    if what in ("attribute", "data", "property") and lines:
        lines[0] = lines[0].replace(": ", f"{COLON} ")


def show_colon(app: Sphinx, what: str, name: str, it: Any, options: Any, lines: list[str]) -> None:
    """Restore the hidden colon when napoleon has finished."""
    lines[:] = [line.replace(f"{COLON} ", ": ") for line in lines]


def without_filler(
    app: Sphinx, what: str, name: str, it: Any, options: Any, signature: str, returned: str
) -> tuple[str, str] | None:
    """Leave out a protocol's general signature; its `__call__` shows the arguments."""
    return ("", returned) if signature == "(*args, **kwargs)" else None


CLASS = re.compile(r"([a-z]\w*\.)*[A-Z][A-Za-z]+(\.\w+)?$")


def entry_elsewhere(app: Sphinx, env: Any, node: Element, shown: Element) -> Element | None:
    """Return a link to the only class or attribute of another module that has the name.

    The name of a function gets no link, because it may also be the name of an argument.
    """
    if node.get("reftype") != "obj" or not CLASS.match(node["reftarget"]):
        return None
    entries = env.get_domain("py").objects
    name = node["reftarget"].removeprefix("labkit.")
    before, _, last = name.rpartition(".")
    for wanted in filter(None, (name, last if last[0].isupper() else before)):
        found = [full for full in entries if full.endswith(f".{wanted}")]
        if len(found) == 1:
            it = entries[found[0]]
            return make_refnode(app.builder, node["refdoc"], it.docname, it.node_id, shown)
    return None


UNUSED = "thebe|sphinx_highlight|design|clipboard|copybutton"


def without_unused(
    app: Sphinx, page: str, template: str, context: dict[str, Any], tree: Any
) -> None:
    """Remove scripts and styles that the book cannot use.

    Jupyter Book loads Thebe even if the book has no kernel for it, and then Thebe fails.  The
    theme marks the words of a search, which breaks formulas; `search.js` marks them itself.
    """
    context["script_files"] = [
        s
        for s in context["script_files"]
        if not re.search(UNUSED, f"{getattr(s, 'filename', '')}")
        and "THEBE_JS_URL" not in str(getattr(s, "attributes", {}).get("body", ""))
    ]
    context["css_files"] = [
        s for s in context["css_files"] if not re.search(UNUSED, f"{getattr(s, 'filename', '')}")
    ]
    if body := context.get("body"):
        context["body"] = re.sub(
            r'\s*<script type="text/x-thebe-config">.*?</script>',
            "",
            re.sub(r"\s*<script>kernelName = '[^']*'</script>", "", body),
            flags=re.S,
        )


DRAWN = re.compile(r"<(svg|math)\b.*?</\1>", re.S)
EMPTIED = re.compile(r'<(svg|math) drawn="".*?</\1>', re.S)
"""Drawings and formulas, most of a page's elements, have no fault and are left as they are."""


def _emptied(found: re.Match[str]) -> str:
    """A drawing without its parts, or a formula of which the words are left."""
    words = re.sub("<[^>]*>", "", found[0]) if found[1] == "math" else ""
    return f'<{found[1]} drawn="">{words}</{found[1]}>'


def repair(app: Sphinx, problem: Exception | None) -> None:
    """Correct every finished page that was written in this build."""
    if problem or app.builder.format != "html":
        return
    texts = {}
    notebooks = [p.stem for p in Path(app.outdir).glob("generated/notebooks/*.html")]
    for path in sorted(Path(app.outdir).rglob("*.html")):
        if "_static" in path.parts:
            continue
        text = path.read_text(encoding="utf-8")
        if "<!-- corrected -->" in text:
            continue
        drawn = [found[0] for found in DRAWN.finditer(text)]
        text = DRAWN.sub(_emptied, text)
        page = BeautifulSoup(text, "html.parser")
        name = path.relative_to(app.outdir).with_suffix("").as_posix()
        if name in app.env.found_docs:
            texts[name] = excerpts.parts_of(page)
        correct_page(page, notebooks)
        whole = EMPTIED.sub("\0", str(page)).split("\0")
        text = "".join(chain(*zip(whole, [*drawn, "\n<!-- corrected -->\n"], strict=True)))
        path.write_text(text, encoding="utf-8")
    excerpts.update(Path(app.outdir), texts)


def correct_page(page: BeautifulSoup, notebooks: Sequence[str] = ()) -> None:
    """Give a page the names, roles and landmarks that assistive technology needs."""
    _exercises(page, notebooks)
    for rule in (
        _punctuation,
        _options,
        _values,
        _names,
        _citations,
        _landmarks,
        _tables,
        _scrollers,
        _hidden_inputs,
        _repeated_ids,
        _scripts,
        _preview,
    ):
        rule(page)


def _exercises(page: BeautifulSoup, notebooks: Sequence[str]) -> None:
    """Let a link such as "05, impedance" lead to that notebook, if the book contains it."""
    for link in page.select('a[href$="generated/notebooks.html"]'):
        number = link.get_text(strip=True)[:2]
        for name in notebooks:
            if number.isdigit() and name.startswith(number):
                link["href"] = link["href"].replace("notebooks.html", f"notebooks/{name}.html")


CLOSING = re.compile(r"[.,;:!?)\]\N{RIGHT DOUBLE QUOTATION MARK}]+")


def _punctuation(page: BeautifulSoup) -> None:
    """Keep a formula and the punctuation after it on one line."""
    for formula in page.select("span.math"):
        after = formula.next_sibling
        if type(after) is NavigableString and (found := CLOSING.match(after)):
            formula.wrap(page.new_tag("span", attrs={"class": "lab-keep"})).append(found[0])
            after.replace_with(after[found.end() :])


def _options(page: BeautifulSoup) -> None:
    """Prevent a line break between the two dashes of an option."""
    for word in page.select("code .pre"):
        if re.fullmatch(r"--[\w-]{1,30}", word.get_text()):
            word["class"] = ["pre", "lab-keep"]


def _values(page: BeautifulSoup) -> None:
    """Remove values that mean nothing to a reader, such as an object's address or a local path."""
    for value in page.select("dt.sig > em.property"):
        if re.search(r"<class |Path\(|0x[0-9a-f]{6}|np\.float64", value.get_text()):
            value.decompose()
    for taken in page.select("dt.sig .sig-param"):
        name, is_function, _ = taken.get_text().partition("=<function")
        if is_function:
            taken.string = f"{name}=…"


def _names(page: BeautifulSoup) -> None:
    """Name buttons and fields that show only an icon; name a button with words by its words."""
    for icon in page.select(".theme-switch-button i[title]"):
        del icon["title"]
    for button in page.select("button.search-button-field"):
        button["aria-label"] = " ".join(button.get_text(" ").split()).replace(" + ", "+")
    for fold in page.select("nav summary"):
        above = fold.find_parent("li")
        link = above.find("a") if above else None
        fold["aria-label"] = f"Pages under {link.get_text(strip=True) if link else 'this one'}"
    for query, name in {
        ".search-button, .search-button__button": "Search",
        ".theme-switch-button": "Colour theme: light, dark or as the system",
        ".primary-toggle, label.primary-toggle": "Chapters",
        ".secondary-toggle": "Contents of this page",
        "#pst-back-to-top": "Back to top",
        'input[type="search"]': "Search this book",
    }.items():
        for element in page.select(query):
            if not element.get("aria-label"):
                element["aria-label"] = name


def _citations(page: BeautifulSoup) -> None:
    """Remove docutils' roles that ARIA has withdrawn, and the role of lists without items."""
    for element in page.select('[role="doc-biblioentry"], [role="doc-noteref"]'):
        del element["role"]
    for element in page.select('div[role="list"]'):
        del element["role"]


def _landmarks(page: BeautifulSoup) -> None:
    """Name the two sidebars."""
    for query, name in {
        "#pst-primary-sidebar, .bd-sidebar-primary": "Chapters",
        "#pst-secondary-sidebar, .bd-sidebar-secondary": "Contents of this page",
    }.items():
        for element in page.select(query):
            if element.name == "div" and not element.get("role"):
                element["role"] = "complementary"
            element["aria-label"] = name


def _tables(page: BeautifulSoup) -> None:
    """Let the keyboard reach the boxes in which wide tables scroll."""
    for box in page.select("div.pst-scrollable-table-container"):
        box["tabindex"] = "0"
        box["role"] = "group"
        box["aria-label"] = "Table"
    for head in page.select("th"):
        if not head.get_text(strip=True):
            head.name = "td"
            head.attrs.pop("scope", None)


def _scrollers(page: BeautifulSoup) -> None:
    """Let the keyboard reach code and formulas, which scroll if they are wider than the screen."""
    for box in page.select("div.highlight pre, div.math"):
        if not box.get("tabindex"):
            box["tabindex"] = "0"


def _hidden_inputs(page: BeautifulSoup) -> None:
    """Hide the theme's sidebar switches, which are invisible check boxes, from screen readers."""
    for box in page.select("input.sidebar-toggle"):
        box["aria-hidden"] = "true"
        box["tabindex"] = "-1"


def _repeated_ids(page: BeautifulSoup) -> None:
    """Remove the id that all boxes of exercises share and that nothing uses."""
    for box in page.select("#exercise-content, #solution-content, #proof-content"):
        del box["id"]


def _preview(page: BeautifulSoup) -> None:
    """Add what a chat or a forum shows for a link: title, first paragraph and picture."""
    first = page.select_one("article.bd-article section > p")
    icon = page.select_one('link[rel*="icon"]')
    if not page.head or not first or not icon:
        return
    said = {
        "og:type": "article",
        "og:title": page.title.get_text(strip=True) if page.title else "",
        "og:description": " ".join(first.get_text(" ").split())[:200],
        "og:image": str(icon["href"]).replace("favicon.svg", "baxter.png"),
    }
    for name, text in said.items():
        page.head.append(page.new_tag("meta", attrs={"property": name, "content": text}))


USES = {"fontawesome": "nothing", "viewer": ".lk-embed, .lk-live", "togglebutton": ".dropdown",
        "searchtools": "#search-results", "searchindex": "#search-results",
        "language_data": "#search-results"}  # fmt: skip
"""Scripts, and what on a page uses each of them."""


def _scripts(page: BeautifulSoup) -> None:
    """Remove the scripts that nothing on a page uses."""
    for name, user in USES.items():
        if not page.select_one(user):
            for script in page.select(f'script[src*="{name}"]'):
                script.decompose()


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the extension with Sphinx."""
    citations.register()
    app.connect("config-inited", settings, priority=100)
    app.connect("autodoc-skip-member", told_already)
    app.connect("autodoc-process-docstring", hide_colon, priority=400)
    app.connect("autodoc-process-docstring", show_colon, priority=600)
    app.connect("autodoc-process-signature", without_filler)
    app.connect("missing-reference", entry_elsewhere)
    app.connect("html-page-context", without_unused, priority=900)
    app.connect("build-finished", repair, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
