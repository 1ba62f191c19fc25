"""A term begins, ends and is forgotten."""

import json
import shutil

import pytest
from courses import synthetic

from labkit import LabkitError
from labkit.__main__ import main
from labkit.course.authoring.bundle import Bundle
from labkit.course.authoring.layout import PUBLIC_SEED
from labkit.errors import UnknownName
from labkit.grader import seeds, term
from labkit.grader.gradebook import open_gradebook
from labkit.grader.release import prepared, release
from labkit.grader.roster import Student, save_roster

PURPOSES = ("hidden cases", "arms", "defence")
CURVES, ESSAYS = "01_curves", "02_essays"


@pytest.fixture
def course(tmp_path):
    """A course of its own, with nothing released yet."""
    return synthetic(tmp_path / "course")


def test_a_term_has_a_secret_of_its_own(course, capsys):
    """It has 128 random bits; the release has a key of its own; nothing of the last is left."""
    assert main(["term", "new", CURVES, "--course", str(course.root)]) == 0
    record, bundle = json.loads(course.term.read_text()), Bundle.of(course, CURVES)
    assert bundle.data["seed"] == seeds.seed_of(course) != PUBLIC_SEED
    assert len(bytes.fromhex(record["secret"])) == 16
    said = capsys.readouterr().out
    assert f"{bundle.points + bundle.by_hand:g} points" in said
    assert str(seeds.seed_of(course)) not in said, "the terminal may be projected"
    term.new_term(course, (ESSAYS,))
    other = json.loads(course.term.read_text())
    assert other["secret"] != record["secret"]
    with pytest.raises(LabkitError, match="was not released here"):
        Bundle.of(course, CURVES)


def test_each_purpose_has_a_key_of_its_own(course):
    """None is another's, and none is the secret, so that a leak of one gives nothing else away."""
    public = {seeds.key_of(course, purpose) for purpose in PURPOSES}
    term.new_term(course, (ESSAYS,))
    keys = {seeds.key_of(course, purpose) for purpose in PURPOSES}
    assert len(keys) == len(PURPOSES) and not keys & public
    secret = json.loads(course.term.read_text())["secret"]
    assert not any(secret in key for key in keys)
    assert all(len(bytes.fromhex(key)) == 32 for key in keys)


def test_a_public_seed_is_said_to_be_public(course, capsys):
    """Released without a term, hidden cases are no secret, and the verb says so."""
    words = ["release", ESSAYS, "--course", str(course.root)]
    for public in (True, False):
        assert main(words) == 0
        assert ("without a term" in capsys.readouterr().out) == public
        term.new_term(course, (ESSAYS,))


def test_one_student_is_forgotten_in_every_folder(course, capsys):
    """In all terms, what is named after the student goes; what else names them is listed."""
    names = ("submitted/{}/01_curves/01_curves.ipynb", "attempts/{}/01_curves/x.ipynb",
             "autograded/{}/01_curves/x.ipynb", "feedback/{}/01_curves/01_curves.html",
             "results/01_curves/{}.json",
             "build/course/explain/{}/bang_bang.html",
             "build/course/defence/{}.html")  # fmt: skip
    for name, student in ((n, s) for n in names for s in ("ada", "bob")):
        path = course.root / name.format(student)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("{}")
    (course.root / "course.toml").write_text('[[extensions]]\nstudent = "ada"\ndays = 3\n')
    save_roster(course, [Student("ada", "Ada"), Student("bob", "Bob")])
    shutil.copytree(term.archive(course), course.root, dirs_exist_ok=True)
    words = ["term", "forget", "--course", str(course.root)]
    assert main([*words, "ada"]) == 0
    first = capsys.readouterr().out
    assert first.count("would go: ") == 2 * len(names)
    assert main([*words, "ada", "--yes"]) == 0
    said = capsys.readouterr().out
    named = {x.rpartition(": ")[2] for x in said.splitlines() if "also has it" in x}
    here = {"course.toml", "course_private/roster.csv"}
    assert here < named and len(named) == 2 * len(here)
    assert not [*course.root.rglob("ada*")]
    assert len([*course.root.rglob("bob*")]) > len(names)
    for wrong in ("..", "a/b", "."):
        assert main([*words, wrong, "--yes"]) == 2


def test_a_term_with_students_does_not_end_by_mistake(course, capsys):
    """What is there is said, and only --yes archives it."""
    words = ["term", "new", ESSAYS, "--course", str(course.root)]
    assert main(words) == 0
    record = course.term.read_text()
    save_roster(course, [Student("ada", "Ada"), Student("bob", "Bob")])
    hand_in = course.submitted / f"ada/{ESSAYS}/{ESSAYS}.ipynb"
    result = course.results / f"{ESSAYS}/ada.json"
    for file in (hand_in, result):
        file.parent.mkdir(parents=True)
        file.write_text("{}")
    assert main(words) == 2
    assert "submitted, results, course_private/roster.csv" in capsys.readouterr().err
    assert hand_in.exists() and course.term.read_text() == record
    assert main([*words, "--yes"]) == 0
    (old,) = (course.root / "course_private").glob("archive-*")
    assert (old / hand_in.relative_to(course.root)).exists()


def test_a_release_with_other_questions_waits_for_the_next_term(course, monkeypatch):
    """Once students have handed in; a correction of a test is released as ever."""
    assert not release(course, CURVES, 1).handed_in
    before = (course.bundle / f"{CURVES}.json").read_bytes()
    with open_gradebook(course) as book:
        book.add_student("ada")
        book.add_submission(CURVES, "ada")
    assert release(course, CURVES, 1).handed_in
    made = prepared(course, CURVES, 1)
    made.source.cells = [x for x in made.source.cells if "bang_bang" not in str(x.metadata)]
    monkeypatch.setattr("labkit.grader.release.prepared", lambda *_: made)
    with pytest.raises(LabkitError, match="takes no other questions now"):
        release(course, CURVES, 1)
    assert (course.bundle / f"{CURVES}.json").read_bytes() == before


def test_a_name_that_is_unknown_is_told_before_anything_is_archived(course):
    """The last term's submissions are where they were."""
    course.submitted.mkdir()
    with pytest.raises(UnknownName, match="99_dance"):
        term.new_term(course, (CURVES, "99_dance"))
    assert course.submitted.exists() and not course.release.exists()


def test_a_release_that_fails_leaves_the_new_secret(course, monkeypatch):
    """What is corrected and released again has the term's own seed, not the public one."""

    def fails(*args):
        raise LabkitError("nbgrader could not make it")

    monkeypatch.setattr(term, "release", fails)
    with pytest.raises(LabkitError, match="could not make it"):
        term.new_term(course)
    assert seeds.seed_of(course) != PUBLIC_SEED


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"secret": "12"}', '{"secret": 12}'])
def test_a_damaged_record_is_a_sentence(course, text):
    """Nothing is released with the public seed because the term's own cannot be read."""
    course.term.parent.mkdir()
    course.term.write_text(text)
    with pytest.raises(LabkitError, match=r"term\.json is damaged"):
        seeds.seed_of(course)
