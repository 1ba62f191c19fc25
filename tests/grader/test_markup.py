"""What a student wrote is shown on nbgrader's pages, and nothing in it runs there."""

from __future__ import annotations

from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import nbformat
import pytest
from made import NAME, changed, graded, result_of, saying
from nbconvert import HTMLExporter
from nbgrader.server_extensions.formgrader.handlers import template_path
from traitlets.config import Config
from traitlets.config.loader import PyFileConfigLoader

from labkit.__main__ import main
from labkit.course.verdict import Outcome
from labkit.grader.feedback import page
from labkit.grader.gradebook import record
from labkit.grader.marks import MarkLine, mark_of
from labkit.grader.results import Results
from labkit.grader.roster import Student

MARKDOWN = [
    "<script>alert(1)</script>",
    "x <img src=x onerror=alert(1)> y",
    "<svg onload=alert(1)><a xlink:href='javascript:alert(1)'>x</a></svg>",
    "[a](javascript:alert(1)) [b](JaVa&#115;cript:alert(1)) [c](vbscript:x)",
    "[d](data:text/html,<script>alert(1)</script>) ![e](data:image/svg+xml;base64,PHN2Zz4=)",
    "[f](page.html) <a href='&#1;javascript:alert(1)'>g</a>",
    "<iframe srcdoc='<script>alert(1)</script>'></iframe><base href=//evil><form action=//evil>",
    "<details open ontoggle=alert(1)>h</details> <p style='position:fixed' class='grade'>i</p>",
    '```mermaid\nclick A href "javascript:alert(1)"\n```',
    "```\n</pre><script>alert(1)</script>\n```",
    "~~~~\n`````\n<script>alert(1)</script>",
    "![j](attachment:none.png)",
    "$a<script>alert(1)</script>$ \\begin{x}<script>alert(1)</script>\\end{x}",
    "> " * 3000 + "k",
    "<!-- --><!doctype x><style>*{display:none}</style><meta http-equiv=refresh content='0;//x'>",
]
OUTPUTS = [
    {"text/html": MARKDOWN[0] + MARKDOWN[1]},
    {"application/javascript": "alert(1)"},
    {"image/svg+xml": "<svg onload=alert(1)><script>alert(1)</script></svg>"},
    {"text/markdown": MARKDOWN[0] + MARKDOWN[3]},
    {"text/latex": "<script>alert(1)</script>"},
    {"application/vnd.jupyter.widget-view+json": {"model_id": "<script>"}, "text/plain": "x"},
    {"image/png": '"><script>alert(1)</script>'},
    {"text/plain": "\x1b[31m<script>alert(1)</script>"},
]
RUNS = {"iframe", "svg", "object", "embed", "form", "base", "style", "meta", "math", "img"}


class Page(HTMLParser):
    """Elements below the notebook, and the text there."""

    def __init__(self, text):
        super().__init__()
        self.found, self.words = [], []
        self.feed(text.partition('id="notebook-container"')[2])

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.words.append(data)

    @property
    def alive(self):
        """What could run, load, cover or lead away."""
        return [
            (tag, attrs)
            for tag, attrs in self.found
            if (tag in RUNS and not attrs.get("src", "").startswith("data:image/"))
            or tag == "script"
            or any(name.startswith("on") for name in attrs)
            or not attrs.get("href", "#").lower().startswith(("#", "http", "mailto:"))
        ]


@pytest.fixture(scope="module")
def show(released):
    """Show a notebook as formgrader does, or ``nbgrader generate_feedback``."""

    def show(notebook, template, *, configured=True):
        config = Config()
        if configured:
            loader = PyFileConfigLoader("nbgrader_config.py", path=str(released.root))
            config = Config(loader.load_config())
        config.HTMLExporter.template_name = template
        config.HTMLExporter.extra_template_basedirs = [template_path]
        styles = Path(template_path).parent / "static/node_modules/bootstrap/dist/css"
        config.HTMLExporter.extra_template_paths = [str(styles)]
        about = {"score": 1, "max_score": 1, "late_penalty": 0, "notebook": NAME}
        resources = {"nbgrader": about, "base_url": "", "index": 0, "total": 1, "student": "ada"}
        return Page(HTMLExporter(config=config).from_notebook_node(notebook, resources)[0])

    return show


@pytest.mark.parametrize("template", ["formgrade", "feedback"])
def test_markdown_of_a_student_does_not_run(show, template):
    """A text cell as the student typed it, task or not: text, with no element that acts."""
    cells = [nbformat.v4.new_markdown_cell(source) for source in (*MARKDOWN, *MARKDOWN)]
    manual = {"grade": True, "solution": True, "grade_id": "essay", "points": 1, "score": 1}
    for cell in cells[len(MARKDOWN) :]:
        cell.metadata.nbgrader = manual
    assert show(nbformat.v4.new_notebook(cells=cells), template).alive == []


@pytest.mark.parametrize("template", ["formgrade", "feedback"])
def test_outputs_of_a_student_do_not_run(show, template):
    """HTML, JavaScript, SVG, widgets and false pictures are shown as text, or left out."""
    outputs = [nbformat.v4.new_output("display_data", data) for data in OUTPUTS]
    outputs.append(nbformat.v4.new_output("stream", text="<script>alert(1)</script>"))
    outputs.append(nbformat.v4.new_output("error", traceback=["<script>alert(1)</script>"]))
    cell = nbformat.v4.new_code_cell("'<script>alert(1)</script>'", outputs=outputs)
    cell.metadata.tags = ['"><script>alert(1)</script>']
    assert show(nbformat.v4.new_notebook(cells=[cell]), template).alive == []


@pytest.mark.parametrize("configured", [True, False])
def test_what_grading_writes_down_does_not_run(course, show, configured):
    """Own cells in autograded/ are blocks of text, even where formgrader has another config."""
    cells = ("text", "code")
    own = [{"after": "", "type": kind, "source": x} for x in MARKDOWN for kind in cells]
    one = result_of(course, "ada", own=tuple(own), notes=(MARKDOWN[0],))
    tests = saying(one.questions[0].verdict, MARKDOWN[6]).tests
    wrong = {"outcome": Outcome.WRONG, "tests": tests}
    one = changed(one, verdict=wrong, source=MARKDOWN[0], notes=(MARKDOWN[1],))
    assert graded(course, one) == []
    path = course.root / "autograded" / "ada" / NAME / f"{NAME}.ipynb"
    page = show(nbformat.read(path, 4), "formgrade", configured=configured)
    assert page.alive == []
    assert "".join(page.words).count("alert(1)") >= 2 * len(MARKDOWN)


def test_what_everybody_writes_is_shown(show):
    """Headings, lists, tables, formulas, code and links are rendered as ever."""
    source = (
        "# T\n\n1. *a* **b** `c<d`\n\n| x | y |\n|---|---|\n| 1 | $a<b$ |\n\n[l](https://x.org)"
    )
    page = show(
        nbformat.v4.new_notebook(cells=[nbformat.v4.new_markdown_cell(source)]), "formgrade"
    )
    tags = {tag for tag, _ in page.found}
    assert {"h1", "ol", "li", "em", "strong", "code", "table", "td", "a"} <= tags
    text = "".join(page.words)
    assert "$a<b$" in text and "c<d" in text and "<p>" not in text
    assert ("a", {"href": "https://x.org"}) in page.found


def test_a_report_on_its_authors_page_does_not_run(released):
    """What a person marks is rendered on the student's own page, too, and nothing in it acts."""
    for source in MARKDOWN:
        mark = mark_of(result := result_of(released, "ada", written={"essay": source}))
        mark = replace(mark, lines=(*mark.lines, MarkLine("essay", 3.0, 2.0)))
        body = page(result, mark).partition("<body>")[2]
        assert Page(f'id="notebook-container"{body}').alive == [], source


def test_a_report_on_its_authors_page_is_rendered(released):
    """Headings, lists and tables are what they are; the page has the name and the folder."""
    text = "# Claim\n\n- **14 mm** of sag\n\n| a | b |\n|---|---|\n| 1 | 2 |"
    result = result_of(released, "ada", written={"essay": text})
    mark = mark_of(result)
    who = Student("ada", "Ada", "Hope")
    lines = (*mark.lines, MarkLine("essay", 3.0, 2.0))
    shown = page(result, replace(mark, lines=lines, person=who))
    assert "feedback for Ada Hope (ada)</h1>" in shown
    assert "<h1>Claim</h1>" in shown and "<strong>14 mm</strong>" in shown and "<td>1</td>" in shown
    assert "# Claim" not in shown


def test_a_prediction_in_the_class_report_has_its_text_and_its_truth(course, capsys):
    """A lecturer reads what was asked, what is true, and how many chose it."""
    results = [result_of(course, f"s{number}") for number in range(11)]
    for result, value in zip(results, [4.0] * 6 + [0.25] * 5, strict=True):
        source = f"twice_the_time = predict('twice_the_time', {value!r})"
        graded(course, changed(result, 3, source=source), recorded=False)
    record(course, NAME, list(Results(course, NAME)))
    assert main(["class-report", NAME, "--course", str(course.root)]) == 0
    lines = capsys.readouterr().out.splitlines()
    asked = next(k for k, line in enumerate(lines) if line.startswith("**`twice_the_time`**"))
    said = "\n".join(lines[asked : asked + 9])
    assert "takes twice as long?" in lines[asked] and "0.25 times" in said and "6 x" in said
    row = next(line for line in lines if line.startswith("| bang_bang |"))
    assert "| Return `(s, ds, dds)` at time `t`" in row
