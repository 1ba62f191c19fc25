"""The build tool: what it keeps, what it makes again, and what it refuses."""

import json
import re
import zipfile

import book_pages
import book_runs
import lab
import pytest
from book_pages import ROOT
from bs4 import BeautifulSoup
from figures.page import shown
from nbclient.exceptions import CellExecutionError
from nbformat.v4 import new_code_cell, new_notebook


def test_a_page_depends_on_what_it_imports_and_on_nothing_else():
    """The chapter on paths depends on its figures, lk.run and its law, not on the grader."""
    found = book_pages.imports("from figures import facts, paths")
    names = {p.relative_to(ROOT).as_posix() for p in found}
    assert {
        "book/figures/facts.py",
        "book/figures/paths.py",
        "labkit/run.py",
        "solutions/study/joint_velocity.py",
    } <= names
    assert not any(
        n.startswith(("labkit/grader", "labkit/course", "solutions/paths/01")) for n in names
    )


@pytest.fixture
def small_book(tmp_path, monkeypatch):
    """A book of one page, which imports one module."""
    monkeypatch.setattr(book_pages, "ROOT", tmp_path)
    monkeypatch.setattr(book_pages, "BOOK", tmp_path)
    for name, folder in (("KEPT", "runs"), ("NEW", "build")):
        monkeypatch.setattr(book_runs, name, tmp_path / folder)
    head = "---\nkernelspec: {name: python3, display_name: Python 3}\n---\n"
    cell = "```{code-cell}\nfrom figures import a\na.f()\n```\n"
    for name, text in {
        "_toc.yml": "{root: page, parts: []}",
        "page.md": f"{head}# Page\n\n{cell}",
        "constraints.txt": "numpy==2.4.6\nattrs==1\n",
        "figures/a.py": "def f():\n    return 1\n",
    }.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


@pytest.mark.parametrize(
    ("name", "old", "new", "runs"),
    [
        ("page.md", "# Page", "# A page", 1),
        ("constraints.txt", "attrs==1", "attrs==2", 1),
        ("figures/a.py", "1", '1  # one\n\n"""Why."""', 1),
        ("page.md", "a.f()", "a.f();", 2),
        ("constraints.txt", "2.4.6", "2.4.7", 2),
        ("figures/a.py", "1", "2", 2),
    ],
)
def test_a_page_is_run_again_if_what_computes_it_has_changed(
    small_book, monkeypatch, name, old, new, runs
):
    """Its code, a line of an imported module, an engine: not a word, a comment, another package."""
    ran = []

    def execute(pages, progress, done):
        for name, page in pages.items():
            page.cells[0].outputs = [{"output_type": "stream", "name": "stdout", "text": "1"}]
            ran.append(name)
            done(name)

    monkeypatch.setattr(book_runs, "execute", execute)
    book_runs.fill(book_pages.computed(), print, keep=True)
    path = small_book / name
    path.write_text(path.read_text().replace(old, new))
    book_pages.read.cache_clear()
    pages = book_pages.computed()
    book_runs.fill(pages, print)
    assert ran == ["page"] * runs
    assert pages["page"].cells[0].outputs[0]["text"] == "1"


def test_a_page_of_the_book_has_a_hash_of_all_that_computes_it():
    """Another one for each page."""
    keys = [book_pages.key_of(page) for page in book_pages.computed().values()]
    assert len({*keys}) == len(keys) > 10


@pytest.mark.slow
def test_pages_of_the_contents_exist(book):
    """Each page of the table of contents has a source in Markdown or as a notebook."""
    for name in book_pages.in_order():
        assert any((ROOT / f"book/{name}{end}").exists() for end in (".md", ".ipynb"))


@pytest.mark.slow
def test_an_exception_in_a_cell_ends_the_build():
    """The pages before it are kept; what one page has defined, the next one does not see."""
    cells = ("x = 1\nx", "assert 'x' not in globals()", "assert False")
    pages = {str(k): new_notebook(cells=[new_code_cell(x)]) for k, x in enumerate(cells)}
    done = []
    with pytest.raises(CellExecutionError, match="AssertionError"):
        book_runs.execute(pages, print, done.append)
    assert done == ["0", "1"]
    assert pages["0"].cells[0].outputs[0].data["text/plain"] == "1"


@pytest.mark.slow
def test_the_zip_is_small_and_holds_the_book(book):
    """It is at most 40 MB, and the first page and the viewer are in it."""
    from book_outputs import pack

    made = pack()
    assert made.stat().st_size <= 40e6
    names = zipfile.ZipFile(made).namelist()
    assert {"book/index.html", "book/_static/viewer/viewer.js"} <= set(names)


@pytest.mark.slow
def test_static_files_are_as_they_stand_in_the_sources(book):
    """A changed style reaches the book though no page has changed."""
    for name in ("book.css", "favicon.svg"):
        assert (book / "_static" / name).read_bytes() == (ROOT / "book/static" / name).read_bytes()


def test_a_line_never_begins_with_the_sign_after_a_formula():
    """The page says the same as before; a formula without such a sign is left alone."""
    text = '<p>At <span class="math">x</span>, and <span class="math">y</span> on.</p>'
    page = BeautifulSoup(text, "html.parser")
    lab.correct_page(page)
    assert page.get_text() == "At x, and y on."
    assert [kept.get_text() for kept in page.select(".lab-keep")] == ["x,"]


def test_the_reference_shows_no_object_of_the_machine_that_built_it(book):
    """Neither an address nor a path, and no function by its inner name."""
    page = BeautifulSoup((book / "reference.html").read_text(), "html.parser")
    shown = " ".join(x.get_text() for x in page.select("dt.sig"))
    assert not re.findall(r"PosixPath|0x[0-9a-f]{6,}|<function[^)]*|<class[^)]*", shown)


def test_a_line_never_breaks_within_an_option():
    """The word --lower in code receives the class that keeps it whole."""
    page = BeautifulSoup('<code><span class="pre">--lower</span></code>', "html.parser")
    lab.correct_page(page)
    assert page.select_one("code .pre")["class"] == ["pre", "lab-keep"]


def test_a_number_is_shown_as_prose_writes_it():
    """Two digits of 2381, -0.644 and 12.4 are 2,400, -0.64 with a true minus sign, and 12."""
    assert [shown(x, ".2g") for x in (2381.0, -0.644, 12.4)] == ["2,400", "\u22120.64", "12"]


@pytest.mark.slow
def test_the_reference_says_what_the_docstrings_say(book):
    """Nothing of Python's own filler, and no sentence taken for a type."""
    told = (book / "reference.html").read_text()
    assert "Alias for field number" not in told
    assert ">Type<" not in told
    assert "Return type" not in told
    assert "(*args, **kwargs)" not in BeautifulSoup(told, "html.parser").get_text()


@pytest.mark.slow
def test_the_reference_says_what_a_class_is_made_with(book):
    """The arguments that only `__init__` describes, and the methods of a class's base."""
    page = BeautifulSoup((book / "reference.html").read_text(), "html.parser")
    assert "seed – The seed of the measurement noise" in page.get_text()
    assert page.find(id="labkit.paths.Quintic.within")


@pytest.mark.slow
def test_a_name_of_another_module_leads_to_its_entry(book):
    """`Push`, in the words of the arm, and `Robot.neutral`, which its class describes."""
    page = BeautifulSoup((book / "reference.html").read_text(), "html.parser")
    links = {a.get_text(): a["href"] for a in page.select("a:has(code.py-obj)")}
    assert links["Push"] == "#labkit.scene.Push"
    assert links["Robot.neutral"] == "#labkit.robot.Robot"
    page = BeautifulSoup((book / "own_robot.html").read_text(), "html.parser")
    links = {a.get_text(): a["href"] for a in page.select("a:has(code.py-obj)")}
    assert links["Robot"] == "reference.html#labkit.robot.Robot"


@pytest.mark.slow
def test_downloads_are_the_released_notebooks(book):
    """Word for word, and a page shows the stubs of the notebooks that have some."""
    for path in (ROOT / "assignments").glob("*/*.ipynb"):
        handed_out = book / "_static/notebooks" / path.name
        assert json.loads(handed_out.read_text()) == json.loads(path.read_text())
        page = (book / f"generated/notebooks/{path.stem}.html").read_text()
        stub = "NotImplementedError"  # the report has none
        assert (stub in page) == (stub in path.read_text())
