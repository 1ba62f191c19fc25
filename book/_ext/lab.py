"""The book's own Sphinx extension: settings of the build tool, and pages that everyone can use.

What the theme and the extensions leave out (axe-core names each) is put right in the finished HTML.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import citations
import excerpts
from bs4 import BeautifulSoup, NavigableString
from docutils.nodes import Element
from sphinx.application import Sphinx
from sphinx.util.nodes import make_refnode


def settings(app: Sphinx, config: Any) -> None:
    """Where `book/_tools/build_book.py` keeps the pages that it ran."""
    if cache := os.environ.get("LAB_BOOK_CACHE"):
        config.nb_execution_cache_path = cache


def told_already(
    app: Sphinx, what: str, name: str, member: Any, skip: bool, options: Any
) -> bool | None:
    """Fields of a named tuple: the class describes them, Python's own words say nothing."""
    return True if str(member.__doc__).startswith("Alias for field number") else None


COLON = "\N{RATIO}"


def hide_colon(app: Sphinx, what: str, name: str, it: Any, options: Any, lines: list[str]) -> None:
    """A sentence with a colon is a sentence: napoleon would take what stands before for a type."""
    if what in ("attribute", "data", "property") and lines:
        lines[0] = lines[0].replace(": ", f"{COLON} ")


def show_colon(app: Sphinx, what: str, name: str, it: Any, options: Any, lines: list[str]) -> None:
    """The colon again, after napoleon."""
    lines[:] = [line.replace(f"{COLON} ", ": ") for line in lines]


def without_filler(
    app: Sphinx, what: str, name: str, it: Any, options: Any, signature: str, returned: str
) -> tuple[str, str] | None:
    """What a protocol takes stands in its `__call__`; Python's own signature says nothing."""
    return ("", returned) if signature == "(*args, **kwargs)" else None


CLASS = re.compile(r"([a-z]\w*\.)*[A-Z][A-Za-z]+(\.\w+)?$")


def entry_elsewhere(app: Sphinx, env: Any, node: Element, shown: Element) -> Element | None:
    """The one class of another module that has a name, or that describes it as its attribute.

    The name of a function may also be that of an argument, so it leads nowhere.
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


def without_unused(
    app: Sphinx, page: str, template: str, context: dict[str, Any], tree: Any
) -> None:
    """Jupyter Book loads Thebe's starter even where no kernel is offered; it fails without one.

    The theme's marks of what was searched for break formulas; `search.js` has its own.
    """
    context["script_files"] = [
        s
        for s in context["script_files"]
        if not re.search("thebe|sphinx_highlight", f"{getattr(s, 'filename', '')}")
        and "THEBE_JS_URL" not in str(getattr(s, "attributes", {}).get("body", ""))
    ]
    context["css_files"] = [
        s for s in context["css_files"] if "thebe" not in f"{getattr(s, 'filename', '')}"
    ]
    if body := context.get("body"):
        context["body"] = re.sub(
            r'\s*<script type="text/x-thebe-config">.*?</script>',
            "",
            re.sub(r"\s*<script>kernelName = '[^']*'</script>", "", body),
            flags=re.S,
        )


def repair(app: Sphinx, problem: Exception | None) -> None:
    """Mend every finished page that was written in this build."""
    if problem or app.builder.format != "html":
        return
    texts = {}
    notebooks = [p.stem for p in Path(app.outdir).glob("generated/notebooks/*.html")]
    for path in sorted(Path(app.outdir).rglob("*.html")):
        if "_static" in path.parts:
            continue
        text = path.read_text(encoding="utf-8")
        if "<!-- mended -->" in text:
            continue
        page = BeautifulSoup(text, "html.parser")
        name = path.relative_to(app.outdir).with_suffix("").as_posix()
        if name in app.env.found_docs:
            texts[name] = excerpts.parts_of(page)
        mend(page, notebooks)
        path.write_text(f"{page}\n<!-- mended -->\n", encoding="utf-8")
    excerpts.update(Path(app.outdir), texts)


def mend(page: BeautifulSoup, notebooks: Sequence[str] = ()) -> None:
    """Give one page the names, roles and landmarks that assistive technology needs."""
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
        _search_tools,
        _preview,
    ):
        rule(page)


def _exercises(page: BeautifulSoup, notebooks: Sequence[str]) -> None:
    """A link "05, impedance" to the list of notebooks goes on to that notebook, if it is there."""
    for link in page.select('a[href$="generated/notebooks.html"]'):
        number = link.get_text(strip=True)[:2]
        for name in notebooks:
            if number.isdigit() and name.startswith(number):
                link["href"] = link["href"].replace("notebooks.html", f"notebooks/{name}.html")


CLOSING = re.compile(r"[.,;:!?)\]\N{RIGHT DOUBLE QUOTATION MARK}]+")


def _punctuation(page: BeautifulSoup) -> None:
    """A line never begins with the comma that follows a formula: the two stay together."""
    for formula in page.select("span.math"):
        after = formula.next_sibling
        if type(after) is NavigableString and (found := CLOSING.match(after)):
            formula.wrap(page.new_tag("span", attrs={"class": "lab-keep"})).append(found[0])
            after.replace_with(after[found.end() :])


def _options(page: BeautifulSoup) -> None:
    """A line never breaks between the two dashes of an option."""
    for word in page.select("code .pre"):
        if re.fullmatch(r"--[\w-]{1,30}", word.get_text()):
            word["class"] = ["pre", "lab-keep"]


def _values(page: BeautifulSoup) -> None:
    """An object's address, or a path of the machine that built the book, tells a reader nothing."""
    for value in page.select("dt.sig > em.property"):
        if re.search(r"<class |Path\(|0x[0-9a-f]{6}|np\.float64", value.get_text()):
            value.decompose()
    for taken in page.select("dt.sig .sig-param"):
        name, is_function, _ = taken.get_text().partition("=<function")
        if is_function:
            taken.string = f"{name}=…"


def _names(page: BeautifulSoup) -> None:
    """Buttons and fields that show only an icon get a name; one with words, the same words."""
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
    """docutils uses roles that ARIA has withdrawn, and a list without items."""
    for element in page.select('[role="doc-biblioentry"], [role="doc-noteref"]'):
        del element["role"]
    for element in page.select('div[role="list"]'):
        del element["role"]


def _landmarks(page: BeautifulSoup) -> None:
    for query, name in {
        "#pst-primary-sidebar, .bd-sidebar-primary": "Chapters",
        "#pst-secondary-sidebar, .bd-sidebar-secondary": "Contents of this page",
    }.items():
        for element in page.select(query):
            if element.name in ("div", "dialog") and not element.get("role"):
                element["role"] = "complementary" if element.name == "div" else element.get("role")
            element["aria-label"] = name
            if element.get("role") is None:
                del element["role"]


def _tables(page: BeautifulSoup) -> None:
    """A wide table scrolls in a box of its own, which the keyboard must reach."""
    for box in page.select("div.pst-scrollable-table-container"):
        box["tabindex"] = "0"
        box["role"] = "group"
        box["aria-label"] = "Table"
    for head in page.select("th"):
        if not head.get_text(strip=True):
            head.name = "td"


def _scrollers(page: BeautifulSoup) -> None:
    """Code and formulas that are wider than a phone scroll too."""
    for box in page.select("div.highlight pre, div.math"):
        if not box.get("tabindex"):
            box["tabindex"] = "0"


def _hidden_inputs(page: BeautifulSoup) -> None:
    """The theme's sidebar switches are check boxes that are never shown."""
    for box in page.select("input.sidebar-toggle"):
        box["aria-hidden"] = "true"
        box["tabindex"] = "-1"


def _repeated_ids(page: BeautifulSoup) -> None:
    """Every exercise's box is given the same id, which nothing uses."""
    for box in page.select("#exercise-content, #solution-content, #proof-content"):
        del box["id"]


def _preview(page: BeautifulSoup) -> None:
    """What a chat or a forum shows of a link: the title, the first paragraph and the arm."""
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


def _search_tools(page: BeautifulSoup) -> None:
    """The theme loads the search's index on every page; only the one that searches needs it."""
    if not page.select_one("#search-results"):
        for script in page.select('script[src*="search"], script[src*="language_data"]'):
            if "search.js" not in script["src"]:
                script.decompose()


def setup(app: Sphinx) -> dict[str, Any]:
    """Register with Sphinx."""
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
