"""What a chapter of the book has, so that a reader can learn from it alone."""

import importlib
import inspect
import re

import pytest
from book_pages import BOOK

CHAPTERS = ("paths", "model", "velocity", "torque", "impedance", "tags", "comparison")
ELEMENTS = (
    "The question",
    "Derivation",
    "By hand",
    "Experiment",
    "What goes wrong",
    "What follows",
    "Exercises",
    "Summary",
    "Sources",
)
BLOCK = re.compile(r"^\$\$.+\$\$$|^(```+|:::+|\$\$)[^\n]*\n[\s\S]*?^\1[^\n]*$", re.M)
HEADING = re.compile(r"^##+ (.+)$", re.M)
CITED = re.compile(r"\{cite:\w+\}`([^`]+)`")

every_chapter = pytest.mark.parametrize("name", CHAPTERS)


def text_of(name):
    """A chapter without its front matter."""
    text = (BOOK / f"chapters/{name}.md").read_text(encoding="utf-8")
    return re.sub(r"\A---\n.*?\n---\n", "", text, flags=re.S)


def section(text, element):
    """The text under the headings with these words, each up to the next one of its level."""
    parts = []
    for found in HEADING.finditer(text):
        if element.lower() in found[1].lower():
            level, rest = found[0].index(" "), text[found.end() :]
            parts.append(re.split(rf"^#{{2,{level}}} ", rest, maxsplit=1, flags=re.M)[0])
    return "\n".join(parts)


def words(text):
    """How many words of prose: no code, formulas, directives, tables, headings, citations."""
    text = re.sub(r"^(#|\|).*$|^\(.+\)=$", "", BLOCK.sub("", text), flags=re.M)
    text = re.sub(r"\$[^$]+\$|\{cite[^}]*\}`[^`]+`|<[^>]+>|\]\([^)]*\)", " ", text)
    text = re.sub(r"\{[\w:]+\}`", " ", text)
    return len(re.findall(r"[A-Za-zÀ-ž][\w’'-]*", text))


def directives(text, kind):
    """The bodies of the directives of one kind, by their label or argument."""
    blocks = re.findall(rf"^(```+)\{{{kind}\}} ?([^\n]*)\n(.*?)^\1$", text, re.M | re.S)
    labels = ((re.search(r"^:label: (\S+)", body, re.M), at, body) for _, at, body in blocks)
    return {label[1] if label else at.strip(): body for label, at, body in labels}


def draws(text):
    """The functions of the book that the page's cells call and that return a drawing."""
    for module, function in re.findall(r"^(\w+)\.(\w+)\(", text, re.M):
        try:
            source = inspect.getsource(
                getattr(importlib.import_module(f"figures.{module}"), function)
            )
        except ModuleNotFoundError:
            continue
        if re.search(r"return (figure|framed)\(|HTML\(framed\(", source):
            yield f"{module}.{function}"


def cited(text):
    """The keys of the works that a text cites, one role naming one or several."""
    roles = (re.sub(r"\{.*?\}", "", role) for role in CITED.findall(text))
    return {key.strip() for role in roles for key in role.split(",")}


@every_chapter
@pytest.mark.parametrize("element", ELEMENTS)
def test_a_chapter_has_each_element(name, element):
    """Every chapter has a heading with the words of each element, and something below it."""
    assert section(text_of(name), element).strip()


@every_chapter
def test_the_elements_are_in_order(name):
    """A reader meets the question first, and the exercises, the summary and the sources last."""
    headings = [h.lower() for h in HEADING.findall(text_of(name))]
    first = [next(k for k, h in enumerate(headings) if x.lower() in h) for x in ELEMENTS]
    assert first[0] == 0
    assert first[-3:] == sorted(first[-3:])
    assert first[-3] > max(first[:-3])


@every_chapter
def test_a_chapter_has_a_drawing(name):
    """At least one cell of a chapter shows a drawing with a caption."""
    text = text_of(name)
    assert [*draws(text), *re.findall(r"^(?:```+|:::+)\{(?:figure|image)\}", text, re.M)]


@every_chapter
def test_a_chapter_derives_what_it_uses(name):
    """A derivation has displayed formulas, each step of it a line."""
    formulas = r"^\$\$|^```\{math\}|\\begin\{align"
    assert len(re.findall(formulas, section(text_of(name), "Derivation"), re.M)) >= 3


@every_chapter
def test_numbers_are_worked_by_hand(name):
    """What is worked by hand has numbers, and a program that the page runs repeats them."""
    text = text_of(name)
    assert len(re.findall(r"\d", section(text, "By hand"))) >= 20
    assert re.search(r"^```\{code-cell\}", text, re.M)


@every_chapter
def test_the_experiment_is_live(name):
    """The experiment has a panel that the reader moves."""
    assert re.search(
        r":::\{live-arm\}|^\w+\.\w*(demo|explorer)\(", section(text_of(name), "Experiment"), re.M
    )


@every_chapter
def test_three_exercises_have_folded_solutions(name):
    """Besides the notebook a chapter has three exercises, each with a solution that is folded."""
    text = text_of(name)
    exercises = {x for x in directives(text, "exercise") if not x.endswith("-notebook")}
    solutions = directives(text, "solution")
    assert len(exercises) >= 3
    assert exercises <= set(solutions)
    assert all(re.search(r"^:class: dropdown$", body, re.M) for body in solutions.values())


@every_chapter
def test_the_summary_has_five_lines(name):
    """The summary is a list of five."""
    items = re.findall(r"^(?:[-*]|\d+\.) ", section(text_of(name), "Summary"), re.M)
    assert len(items) == 5


@every_chapter
def test_a_chapter_is_long_enough_to_teach_and_short_enough_to_read(name):
    """A chapter has 2,000 to 4,500 words of prose."""
    assert 2000 <= words(text_of(name)) <= 4500


@every_chapter
def test_a_chapter_names_its_sources(name):
    """The sources cite at least two works, and every work cited is in the bibliography."""
    known = set(re.findall(r"^@\w+\{(\w+),", (BOOK / "references.bib").read_text(), re.M))
    text = text_of(name)
    assert cited(text) <= known
    assert len(cited(section(text, "Sources"))) >= 2


def test_words_are_those_of_the_prose():
    """Code, formulas, directives, tables and headings are not prose."""
    text = """# Title of it

Two words $x = 1$, and {term}`three more`.

```{code-cell}
not = "counted"
```

$$
a = b
$$

| a | table |

:::{tip}
Nor this.
:::
"""
    assert words(text) == 5


def test_a_heading_without_text_is_not_an_element():
    """A section goes to the next heading of its level, its own subsections included."""
    text = "## The question\n\n### A part\n\nWhy?\n\n## Summary\n\n## Sources\n\nOne.\n"
    assert "Why?" in section(text, "The question")
    assert "One." not in section(text, "The question")
    assert not section(text, "Summary").strip()


def test_a_role_may_cite_several_works():
    """Each key counts, and what is said of a place in a work does not."""
    text = "See {cite:p}`ott,khatib` and {cite:t}`mls{sections 2, 3}`."
    assert cited(text) == {"ott", "khatib", "mls"}


def test_a_chapter_gives_its_notebook_as_much_time_as_the_notebook_itself():
    """The first cells of the notebooks are the one place where their hours stand."""
    from figures.front import hours

    for name in CHAPTERS:
        ((told, number),) = re.findall(r"about (\d+) hours for notebook (\d\d)", text_of(name))
        (source,) = BOOK.parent.glob(f"solutions/*/{number}_*.py")
        assert float(told) == hours(source.stem)[1], name


def test_the_core_of_the_course_fits_into_28_hours():
    """Each notebook's core takes at most 4; the core is never longer than the whole."""
    from figures.planning import HOURS

    assert all(core <= min(4.0, whole) for core, whole in HOURS.values())
    assert sum(core for core, _ in HOURS.values()) <= 28.0
