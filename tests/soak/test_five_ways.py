"""One class, five ways to hand in: the same marks and identities in every table and page."""

from __future__ import annotations

import csv
import io
import json
import shutil
from dataclasses import dataclass

import pytest
from downloaded import canvas_writes, handed_in, moodle_writes, zipped
from handmade import ROOT
from made import NAME, result_of
from soak.attacks.place import full_marks

from labkit.__main__ import main
from labkit.course.authoring.layout import Course
from labkit.grader.grading.results import Results
from labkit.grader.nbgrader.gradebook import open_gradebook, record
from labkit.grader.terms.release import release

FIRST, SECOND = (2026, 3, 1, 12, 0, 0), (2026, 3, 3, 12, 0, 0)
WHEN = {FIRST: "2026-03-01 12:00", SECOND: "2026-03-03 12:00"}
DUE = "2026-03-02T12:00:00"
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)


@dataclass(frozen=True)
class Person:
    """A student: every third hands in again, late; the last two have one name."""

    k: int
    name: str

    @property
    def login(self):
        return f"s{self.k:03d}"

    @property
    def number(self):
        return str(5000 + self.k)

    @property
    def again(self):
        return self.k % 3 == 0

    def notebook(self, attempt):
        cells = {"cells": [], "nbformat": 4, "nbformat_minor": 5}
        return json.dumps(cells | {"metadata": {"of": self.k, "attempt": attempt}}).encode()


def people(count):
    names = [f"Ada{chr(97 + k % 26)} Love{chr(97 + k // 26)}" for k in range(count - 2)]
    return [Person(k, name) for k, name in enumerate([*names, "Mia Wong", "Mia Wong"])]


def moodle(folder, present, when):
    entries = [
        (moodle_writes(x.name, 100 + x.k, f"{NAME}.ipynb"), x.notebook(n)) for x, n in present
    ]
    return [str(zipped(folder / "m.zip", entries, when)), "--at", WHEN[when]]


def canvas(folder, present, when):
    entries = []
    for x, n in present:
        last_first = "".join(reversed(x.name.split()))
        late = n == 2
        named = canvas_writes(last_first, 5000 + x.k, 9000 + x.k, f"{NAME}.ipynb", late)
        entries.append((named, x.notebook(n)))
    return [str(zipped(folder / "c.zip", entries, when)), "--at", WHEN[when]]


def exchange(folder, present, when):
    for x, n in present:
        handed_in(folder / "in", x.login, x.notebook(n).decode(), f"{WHEN[when]}:00 UTC")
    return [str(folder / "in"), "--unverified"]


def github(folder, present, when):
    for x, n in present:
        (folder / f"clones/paths-gh-{x.login}").mkdir(parents=True)
        (folder / f"clones/paths-gh-{x.login}/{NAME}.ipynb").write_bytes(x.notebook(n))
        (folder / f"clones/paths-gh-{x.login}/02_model.ipynb").write_text("{}")
    return [str(folder / "clones"), "--named", "paths-{student}/*.ipynb", "--at", WHEN[when]]


def loose(folder, present, when):
    (folder / "files").mkdir(parents=True)
    for x, n in present:
        (folder / f"files/my work_{x.number}.ipynb").write_bytes(x.notebook(n))
    return [str(folder / "files"), "--named", "*_{student}.ipynb", "--at", WHEN[when]]


def typed(course, *words):
    return main([*words, "--course", str(course.root)])


def table(course, capsys, *more):
    capsys.readouterr()
    assert typed(course, "export", NAME, *more) == 0
    return list(csv.DictReader(io.StringIO(capsys.readouterr().out)))


def worksheet(course, folder, everybody, when):
    """Import Moodle's grading worksheet, with the time that each handed in."""
    sheet = ["Identifier,Full name,Email address,Last modified (submission)"]
    sheet += [f"Participant {100 + x.k},{x.name},{x.login}@uni.org,{when(x)}" for x in everybody]
    (folder / "sheet.csv").write_text("\n".join(sheet))
    words = ["students", "import", str(folder / "sheet.csv"), "--assignment", NAME]
    assert typed(course, *words) == 0


def term(course, way, folder, everybody):
    """Roster, rules, both downloads, the older one once more, grades, a mark by hand."""
    course.root.joinpath("course.toml").write_text(
        f"[late]\npercent_per_day = 10\n[assignments.{NAME}]\ndue = {DUE}\n"
        f'[[extensions]]\nstudent = "s003"\ndays = 2\n'
    )
    folder.mkdir()
    rows = ["username,id number,canvas id,github,email,first name,last name"]
    rows += [",".join([x.login, x.number, str(5000 + x.k), f"gh-{x.login}", f"{x.login}@uni.org",
                       *x.name.split()]) for x in everybody]  # fmt: skip
    (folder / "list.csv").write_text("\n".join(rows))
    assert typed(course, "students", "import", str(folder / "list.csv")) == 0
    if way is moodle:  # which alone says who of the namesakes is who
        worksheet(course, folder, everybody, lambda x: "")
    first = [(x, 1) for x in everybody]
    second = [(x, 2 if x.again else 1) for x in everybody]
    for k, (present, when) in enumerate(((first, FIRST), (second, SECOND), (first, FIRST))):
        (folder / str(k)).mkdir()
        if way is exchange and k == 1:  # nobody hands in there what they handed in before
            present = [(x, n) for x, n in present if n == 2]
        assert typed(course, "collect", NAME, *way(folder / str(k), present, when)) == 0
    if way is moodle:  # whose zips do not say when work was handed in
        worksheet(course, folder, everybody, lambda x: WHEN[SECOND if x.again else FIRST])
    for x in everybody:
        path = course.submitted / x.login / NAME / f"{NAME}.ipynb"
        about = json.loads(path.read_bytes())["metadata"]
        assert about["of"] == x.k, "work of somebody else"
        share = SHARES[(x.k + about["attempt"]) % 5]
        data = path.read_bytes()
        result = result_of(course, x.login, share=share, data=data, written={})  # nor a why
        Results(course, NAME).keep(result)
        record(course, NAME, [result])
    with open_gradebook(course) as book:
        book.find_grade("circle-check", NAME, NAME, "s001").manual_score = 1.5
        book.db.commit()
    assert typed(course, "feedback", NAME) == 0


@pytest.fixture(scope="module")
def released_once(tmp_path_factory):
    root = tmp_path_factory.mktemp("ways") / "course"
    root.mkdir()
    (root / "solutions").symlink_to(ROOT / "solutions")
    shutil.copy(ROOT / "nbgrader_config.py", root)
    release(Course(root), NAME, 7)
    return root


def expected(x, full):
    """Points by hand: the later attempt counts, and a day late costs a tenth."""
    share = SHARES[(x.k + (2 if x.again else 1)) % 5]
    points = full * share
    if x.k == 1:
        points += 1.5 - 4.0 * share
    late = x.again and x.k != 3
    return round(points * (0.9 if late else 1.0), 4)


@pytest.mark.slow
@pytest.mark.parametrize("count", [6, pytest.param(60, marks=pytest.mark.soak)])
@pytest.mark.parametrize(
    "way",
    [moodle, exchange, *(pytest.param(x, marks=pytest.mark.soak) for x in (canvas, github, loose))],
)
def test_one_class_has_one_set_of_marks(released_once, tmp_path, capsys, way, count):
    """Handed in twice, some late, an older download last, namesakes, an extension, a mark by hand.

    Every table has each student's identity and the same mark, and so has each page.
    """
    course = Course(shutil.copytree(released_once, tmp_path / "course", symlinks=True))
    everybody = people(count)
    term(course, way, tmp_path / "downloads", everybody)
    full, points = full_marks(course)
    marks = {x.login: expected(x, full) for x in everybody}
    rows = [r for r in table(course, capsys) if r["student"] in marks]
    assert {r["student"]: float(r["score"]) for r in rows} == marks
    rows = table(course, capsys, "--layout", "canvas")[1:]
    assert {(r["ID"], r["SIS User ID"], r["SIS Login ID"]): float(r[NAME]) for r in rows} == {
        (str(5000 + x.k), x.number, x.login): marks[x.login] for x in everybody
    }
    rows = table(course, capsys, "--layout", "moodle")
    assert {(r["Email address"], r["ID number"]): float(r[NAME]) for r in rows} == {
        (f"{x.login}@uni.org", x.number): marks[x.login] for x in everybody
    }
    if way is moodle:
        rows = table(course, capsys, "--layout", "moodle-worksheet")
        assert {r["Identifier"]: float(r["Grade"]) for r in rows} == {
            f"Participant {100 + x.k}": marks[x.login] for x in everybody
        }
    for x in everybody:
        page = (course.root / "feedback" / x.login / NAME / f"{NAME}.html").read_text()
        assert f"{marks[x.login]:g} of {points:g} points." in page
        title = page.partition("<title>")[2].partition("</title>")[0]
        assert "feedback for " in title and x.login in title
