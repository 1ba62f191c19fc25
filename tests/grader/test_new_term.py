"""A term begins, ends and is forgotten; a course is exported."""

import json
from pathlib import Path

import pytest
from courses import copied

from labkit import LabkitError
from labkit.__main__ import main
from labkit.course.bundle import Bundle
from labkit.course.layout import PUBLIC_SEED, Course
from labkit.errors import UnknownName
from labkit.grader import term
from labkit.grader.release import FORBIDDEN
from labkit.grader.student_bundle import export_course

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def course(tmp_path):
    """A course of its own, with nothing released yet."""
    return copied(tmp_path)


def test_a_term_has_a_seed_of_its_own_and_a_record(course):
    """A new term draws a seed that is not the public one, and keeps each bundle's hash."""
    record = term.new_term(course, None, ("01_paths",))
    bundle = json.loads((course.bundle / "01_paths.json").read_text())
    assert record["seed"] == bundle["seed"] == term.seed_of(course) != PUBLIC_SEED
    assert record["bundles"] == {"01_paths": bundle["hash"]}


def test_a_correction_keeps_the_seed(course):
    """Released again without a seed, an assignment has the hidden cases that it had."""
    arguments = ["release", "01_paths", "--course", str(course.root)]
    for more, seed in (([], PUBLIC_SEED), (["--seed", "41"], 41), ([], 41)):
        assert main([*arguments, *more]) == 0
        assert Bundle.of(course, "01_paths").data["seed"] == seed
    assert term.seed_for(course, "02_model") == PUBLIC_SEED
    term.new_term(course, 43, ("02_model",))
    assert term.seed_for(course, "01_paths") == 43, "not the last term's, which was seen"


def test_a_public_seed_is_said_to_be_public(course, capsys):
    """Released with the repository's seed, hidden cases are no secret, and the verb says so."""
    arguments = ["release", "00_warmup", "--course", str(course.root)]
    sentence = "public seed 2019 are public: anyone can compute them; begin a term with: labkit new"
    assert main(arguments) == 0
    assert capsys.readouterr().out.count(sentence) == 1
    assert main([*arguments, "--seed", "41"]) == 0
    assert "anyone can compute" not in capsys.readouterr().out


def test_the_next_term_archives_the_names_and_forgets_them(course):
    """What holds names moves into one folder, and one command deletes it."""
    (course.submitted / "ada" / "01_paths").mkdir(parents=True)
    folder = term.archive(course)
    assert not course.submitted.exists()
    assert (folder / "submitted" / "ada").is_dir()
    assert term.purge(course) == [folder]
    assert not folder.exists()


@pytest.mark.parametrize("seed", [PUBLIC_SEED])
def test_a_known_seed_is_refused(course, seed):
    """The public seed makes no secret, and the sentence says so."""
    with pytest.raises(LabkitError, match="may be known; take another"):
        term.new_term(course, seed)


def test_a_name_that_is_unknown_is_told_before_anything_is_archived(course):
    """The last term's submissions are where they were."""
    course.submitted.mkdir()
    with pytest.raises(UnknownName, match="99_dance"):
        term.new_term(course, None, ("01_paths", "99_dance"))
    assert course.submitted.exists() and not course.release.exists()


def test_a_release_that_fails_leaves_the_new_seed(course, monkeypatch):
    """What is mended and released again has the term's own seed, not the public one."""

    def fails(*args):
        raise LabkitError("nbgrader could not make it")

    monkeypatch.setattr(term, "release", fails)
    with pytest.raises(LabkitError, match="could not make it"):
        term.new_term(course, 41)
    assert term.seed_of(course) == 41


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"seed": "secret"}'])
def test_a_damaged_record_is_a_sentence(course, text):
    """Nothing is released with the public seed because the term's own cannot be read."""
    file = course.root / "course_private" / "term.json"
    file.parent.mkdir()
    file.write_text(text)
    with pytest.raises(LabkitError, match="holds no seed; restore it"):
        term.seed_of(course)


def test_the_students_repository_holds_no_answer(tmp_path):
    """The export for students has the notebooks and labkit, and nothing of the solutions."""
    student, private = export_course(Course(ROOT), tmp_path / "out")
    assert (student / "assignments/01_paths/01_paths.ipynb").exists()
    assert list(student.glob("labkit-*.whl"))
    assert not (student / "solutions").exists()
    assert (private / "solutions/paths/answers.py").exists()
    for path in student.rglob("*.ipynb"):
        assert not any(word in path.read_text() for word in FORBIDDEN)


def test_an_export_never_overwrites(tmp_path):
    """A folder that is there already is left alone."""
    with pytest.raises(LabkitError, match="there already"):
        export_course(Course(ROOT), tmp_path)
