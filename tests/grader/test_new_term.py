"""A term begins, ends and is forgotten; a course is exported."""

import json
import shutil
from pathlib import Path

import pytest
from courses import copied

from labkit import LabkitError
from labkit.__main__ import main
from labkit.course.authoring.bundle import Bundle
from labkit.course.authoring.layout import Course
from labkit.course.own_arm import Arms
from labkit.course.seed import PUBLIC_SEED
from labkit.errors import UnknownName
from labkit.grader import seeds
from labkit.grader.nbgrader.gradebook import open_gradebook
from labkit.grader.nbgrader_api import nbgrader_api
from labkit.grader.students.class_list import Student
from labkit.grader.students.identity import all_lms_users, record_users
from labkit.grader.students.platforms import LmsUser
from labkit.grader.students.roster import Roster, read_roster, save_roster, tell_gradebook
from labkit.grader.terms import term
from labkit.grader.terms.release import FORBIDDEN
from labkit.grader.terms.student_bundle import export_course

PURPOSES = ("hidden cases", "arms", "the whys", "defence")
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def course(tmp_path):
    """A course of its own, with nothing released yet."""
    return copied(tmp_path)


def test_a_term_has_a_secret_of_its_own_and_a_record(course):
    """It has 128 random bits; the release has a key of its own, and the record its hash."""
    record = term.new_term(course, ("01_paths",))
    bundle = json.loads((course.bundle / "01_paths.json").read_text())
    assert bundle["seed"] == seeds.seed_of(course) != PUBLIC_SEED
    assert len(bytes.fromhex(record["secret"])) == 16
    assert record["bundles"] == {"01_paths": bundle["hash"]}
    other = term.new_term(course, ("00_warmup",))
    assert other["secret"] != record["secret"]
    assert main(["release", "01_paths", "--course", str(course.root)]) == 0
    again = Bundle.of(course, "01_paths").data["seed"]
    assert again == seeds.seed_of(course) != bundle["seed"], "not the last term's, which was seen"


def test_each_purpose_has_a_key_of_its_own(course):
    """None is another's, and none is the secret, so that a leak of one gives nothing else away."""
    public = {seeds.key_of(course, purpose) for purpose in PURPOSES}
    term.new_term(course, ("00_warmup",))
    keys = {seeds.key_of(course, purpose) for purpose in PURPOSES}
    assert len(keys) == len(PURPOSES) and not keys & public
    secret = json.loads(course.term.read_text())["secret"]
    assert not any(secret in key for key in keys)
    assert all(len(bytes.fromhex(key)) == 32 for key in keys)


def test_a_public_seed_is_said_to_be_public(course, capsys):
    """Released without a term, hidden cases are no secret, and the verb says so."""
    arguments = ["release", "00_warmup", "--course", str(course.root)]
    assert main(arguments) == 0
    assert capsys.readouterr().out.count("public seed 2019 are public") == 1
    term.new_term(course, ("00_warmup",))
    capsys.readouterr()
    assert main(arguments) == 0
    assert "anyone can compute" not in capsys.readouterr().out


def test_the_next_term_archives_the_names_and_forgets_them(course, capsys):
    """What holds names moves into one folder, and one command deletes it."""
    (course.submitted / "ada" / "01_paths").mkdir(parents=True)
    page, arms = course.build / "explain/ada/bang_bang.html", course.release / "03/arms.json"
    for file in (page, arms):
        file.parent.mkdir(parents=True)
        file.write_text("{}")
    folder = term.archive(course)
    assert not course.submitted.exists() and not page.exists() and not arms.exists()
    assert (Course(folder).build / "explain/ada" / page.name).exists()
    settings = nbgrader_api(Course(folder)).config  # of the course: an archive has none of its own
    assert settings.CourseDirectory.root == str(folder) and "ClearSolutions" in settings
    assert term.archives(course)[0].people == 0, "a folder without a file is nobody's work"
    (folder / "submitted/ada/01_paths/01_paths.ipynb").touch()
    assert term.archives(course)[0].people == 1
    assert (folder / "submitted" / "ada").is_dir()
    words = ["term", "forget", "--course", str(course.root)]
    assert main(words) == 2
    assert "--older YEARS, or --student NAME" in capsys.readouterr().err
    assert main([*words, "--older", "1", "--yes"]) == 0 and folder.exists()
    assert main([*words, "--older", "0"]) == 0 and folder.exists()
    assert "nothing is deleted yet; add --yes" in capsys.readouterr().out
    assert main([*words, "--older", "0", "--yes"]) == 0
    assert not folder.exists()


def test_rules_of_the_last_term_are_named(course):
    """Due dates that are over and extensions stay in force, so the command says so."""
    assert term.old_rules(course) == ""
    rules = course.root / "course.toml"
    rules.write_text("[assignments.01_paths]\ndue = 2099-11-02T23:59:00\n")
    assert term.old_rules(course) == ""
    more = '[assignments.02_model]\ndue = 2020-11-02\n[[extensions]]\nstudent = "ada"\ndays = 3\n'
    rules.write_text(rules.read_text() + more.replace("11-02", "11-02T23:59:00"))
    said = term.old_rules(course)
    assert "over: 02_model; extensions: 1" in said and "Edit it" in said
    course.submitted.mkdir()
    assert (term.archive(course) / rules.name).read_text() == rules.read_text()


def test_a_new_term_has_nothing_of_the_last_one(course):
    """Its hidden cases go with it, and no advice names its secret."""
    term.new_term(course, ("00_warmup", "01_paths"))
    assert term.new_term(course, ("00_warmup",))["bundles"].keys() == {"00_warmup"}
    with pytest.raises(LabkitError, match="was not released here"):
        Bundle.of(course, "01_paths")


def test_one_student_is_forgotten_everywhere(course, capsys):
    """Files, results, gradebook, roster and numbers, of this term and of earlier ones."""
    for kind in ("submitted", "attempts", "feedback", "autograded"):
        for student in ("ada", "ada-2"):
            (course.root / kind / student / "01_paths").mkdir(parents=True)
    results = course.results / "01_paths"
    old = "-".join(["0123abcd"] * 3) + ".json"
    for student in ("ada", "ada-2"):
        page = course.build / f"explain/{student}/bang_bang.html"
        aside = (f"aside/{student}.json", f"aside/old/{student}/{old}")
        names = (f"{student}.json", f"old/{student}/{old}", *aside)
        for file in (page, *(results / name for name in names)):
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text("{}")
    save_roster(course, Roster((Student("ada", "Ada"), Student("ada-2", "Ada"))))
    tell_gradebook(course, read_roster(course))
    record_users(course, "01_paths", {"ada": LmsUser("moodle", "7", "Ada")})
    archived = term.archive(course)
    shutil.copytree(archived, course.root, dirs_exist_ok=True)
    words = ["term", "forget", "--student", "ada", "--course", str(course.root)]
    assert main(words) == 0
    before = capsys.readouterr().out
    assert before.count("would go: ") == 18 and "nothing is deleted yet" in before
    assert main([*words, "--yes"]) == 0
    said = capsys.readouterr().out
    listed = before.replace("would go: ", "deleted: ").replace("would go from", "no more in")
    assert listed.replace("nothing is deleted yet; add --yes\n", "") == said
    assert said.count("no more in") == 6 and "backups" in said
    left = {str(x.relative_to(course.root)) for x in course.root.rglob("ada*")}
    assert not [x for x in left if "ada-2" not in x and "solutions" not in x]
    assert any("ada-2" in x for x in left)
    assert [x.id for x in read_roster(course).students] == ["ada-2"]
    with open_gradebook(course) as book:
        assert [x.id for x in book.students] == ["ada-2"]


def test_who_is_unknown_is_not_forgotten(course, capsys):
    """A name that nobody has is refused, with those who are meant perhaps."""
    bob = Student("Bob-Hope", "Bob", "Hope", "b@x.test", login="bh17", id_number="700001")
    save_roster(course, Roster((bob, Student("eve", "Eve", "Li"))))
    meant = dict.fromkeys(
        ("Bob", "BH17", "b@x.test", "700001"), "did you mean Bob Hope (Bob-Hope)?"
    )
    for name, near in (meant | {"zz": "there are Bob Hope (Bob-Hope), "}).items():
        for more in ([], ["--yes"]):
            words = ["term", "forget", "--student", name, "--course", str(course.root)]
            assert main([*words, *more]) == 2
            said = capsys.readouterr()
            assert f"no student '{name}' in this term or an earlier one; {near}" in said.err
            assert not said.out
    assert "Bob-Hope" in read_roster(course)


@pytest.mark.parametrize("form", ["name;id\nAda;ada\nEve;eve\n", "name,id\nAda,ada\nEve,eve\n"])
def test_a_roster_that_a_person_saved_loses_the_student_too(course, form):
    """With semicolons, and with its columns in another order."""
    roster = course.root / "course_private/roster.csv"
    roster.parent.mkdir()
    roster.write_text(form.replace("name", "first_name"))
    words = ["term", "forget", "--student", "ada", "--yes", "--course", str(course.root)]
    assert main(words) == 0
    assert [x.id for x in read_roster(course).students] == ["eve"]
    assert "ada" not in roster.read_text().lower()


def test_rules_with_a_byte_order_mark_are_read(course, capsys):
    """By `term forget`, which names an extension, and by nbgrader, which takes the name."""
    text = 'id = "robots"\n[[extensions]]\nstudent = "ada"\ndays = 3\n'
    (course.root / "course.toml").write_text(text, encoding="utf-8-sig")
    save_roster(course, Roster((Student("ada", "Ada"),)))
    assert main(["term", "forget", "--student", "ada", "--course", str(course.root)]) == 0
    assert "course.toml names an extension of theirs" in capsys.readouterr().out
    assert nbgrader_api(course).config.CourseDirectory.course_id == "robots"


def test_rules_that_nobody_can_read_do_not_stop_it(course, capsys):
    """Those of an archive are named with what is wrong, for a person to look."""
    save_roster(course, Roster((Student("ada", "Ada"),)))
    rules = term.archive(course) / "course.toml"
    rules.write_text("late = 3 =")
    assert main(["term", "forget", "--student", "ada", "--yes", "--course", str(course.root)]) == 0
    said = capsys.readouterr().out
    assert f"{rules}: " in said and "and see whether it names an extension of theirs" in said
    assert "ada" not in (rules.parent / "course_private/roster.csv").read_text()


def test_an_archive_without_a_date_is_listed_and_searched(course, capsys):
    """It is not deleted by age, which nobody knows, and that is said."""
    (course.submitted / "ada/01_paths").mkdir(parents=True)
    folder = term.archive(course)
    old = folder.rename(folder.with_name("archive-old"))
    words = ["--course", str(course.root)]
    assert main(["term", "list", *words]) == 0
    assert "archive-old: its name has no date" in capsys.readouterr().out
    assert main(["term", "forget", "--older", "0", "--yes", *words]) == 0
    said = capsys.readouterr().out
    assert "rename it archive-YYYY-MM-DD" in said and "there is nothing to forget" in said
    folder.with_suffix(".zip").write_text("a copy, which nobody can look into")
    assert main(["term", "forget", "--student", "ada", "--yes", *words]) == 0
    assert old.exists() and not (old / "submitted/ada").exists()


def test_what_an_older_labkit_archived_is_forgotten(course):
    """Its archives had all files side by side; results and pages had the student in their name."""
    folder = course.root / "course_private/archive-2025-02-03-101112"
    key = "-".join(["0123abcd"] * 3)
    for name in (
        *("explain/{}-bang_bang.html", "defence/{}.html", "submitted/{}/01_paths/01_paths.ipynb"),
        *(f"results/01_paths/old/{{}}-{key}.json", "results/01_paths/old/{}---.json"),
    ):
        for student in ("ada", "ada-2"):
            file = folder / name.format(student)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text("{}")
    (folder / "roster.csv").write_text("id,first_name\nada,Ada\nada-2,Ada\n")
    (folder / "lms.json").write_text(
        '{"01_paths": {"ada": {"system": "moodle", "number": "7", "name": "Ada"}}}'
    )
    (folder / "handles.json").write_text('{"key": "3", "handles": {"ada": "a", "ada-2": "b"}}')
    assert [str(x.ended) for x in term.archives(course)] == ["2025-02-03"]
    words = ["term", "forget", "--student", "ada", "--yes", "--course", str(course.root)]
    assert main(words) == 0
    archived = Course(folder)
    assert [x.id for x in read_roster(archived).students] == ["ada-2"]
    assert Arms.of(folder).handles == {"ada-2": "b"} and all_lms_users(archived) == {"01_paths": {}}
    left = [x.relative_to(folder).as_posix() for x in folder.rglob("*") if "ada" in x.as_posix()]
    assert not [x for x in left if "ada-2" not in x]
    files = {x.relative_to(folder).as_posix() for x in folder.rglob("*") if x.is_file()}
    old = "results/01_paths/old/ada-2"
    assert {"build/course/explain/ada-2/bang_bang.html", f"{old}/{key}.json"} <= files


def test_a_term_with_students_does_not_end_by_mistake(course, capsys):
    """What is there is said; --yes archives it, and the command that is told returns to it."""
    words = ["term", "new", "00_warmup", "--course", str(course.root)]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert "archived" not in said
    guide = " ".join((ROOT / "book/instructor_guide.md").read_text().split())
    first, quoted = said.splitlines()
    assert first == "a new term begins, released: 00_warmup"
    assert f"names the notebooks that were released, and says *{quoted}*." in guide
    record = course.term.read_text()
    seed = seeds.seed_of(course)
    save_roster(course, Roster((Student("ada", "Ada"), Student("bob", "Bob"))))
    hand_in = course.submitted / "ada/00_warmup/00_warmup.ipynb"
    result = course.results / "00_warmup/ada.json"
    for file in (hand_in, result):
        file.parent.mkdir(parents=True)
        file.write_text("{}")
    rules = course.root / "course.toml"
    rules.write_text("# of the last term\n")
    assert main(words) == 2
    said = capsys.readouterr().err
    assert "has 2 students, 1 submission, 1 graded mark; to hand out" in said
    assert "labkit release NAME" in said and "--yes" in said
    assert hand_in.exists() and course.term.read_text() == record
    assert main([*words, "--yes"]) == 0
    said = capsys.readouterr().out
    (old,) = term.archives(course)
    assert "archived: 2 students, 1 submission, 1 graded mark" in said
    command = f"labkit term return {old.folder.name}"
    assert f"to return to it, type: {command}\n" in said
    secret = json.loads(course.term.read_text())["secret"]
    assert secret not in said, "the terminal may be projected"
    rules.write_text("# of the new term\n")
    save_roster(course, Roster((Student("zoe", "Zoe"),)))
    newer = course.submitted / "zoe/00_warmup/00_warmup.ipynb"
    newer.parent.mkdir(parents=True)
    newer.write_text("{}")
    assert main(["term", "return", "archive-nope", "--course", str(course.root)]) == 2
    assert f"name one archive: {old.folder.name}" in capsys.readouterr().err
    (Course(old.folder).build / ".gradebook").touch()  # as after a look at the marks there
    assert main([*command.split()[1:], "--course", str(course.root)]) == 0
    assert not newer.exists() and rules.read_text() == "# of the last term\n"
    (undone,) = term.archives(course)
    assert (undone.folder / newer.relative_to(course.root)).exists()
    assert (undone.folder / rules.name).read_text() == "# of the new term\n", "all is kept"
    assert "1 handed in" in str(undone) and (undone.folder / "build/course/bundle").is_dir()
    assert main(["term", "forget", "--student", "zoe", "--yes", "--course", str(course.root)]) == 0
    assert "zoe" not in read_roster(Course(undone.folder))
    again = json.loads((course.bundle / "00_warmup.json").read_text())["hash"]
    assert again == json.loads(record)["bundles"]["00_warmup"], "results stay valid"
    assert hand_in.exists() and result.exists() and seeds.seed_of(course) == seed
    assert len(read_roster(course).students) == 2


def test_a_release_that_nobody_used_is_said_to_be_one(course, capsys):
    """The first term archives the hidden cases released before, and says that nobody is there."""
    words = ["00_warmup", "--course", str(course.root)]
    assert main(["release", *words]) == 0
    assert main(["term", "new", *words]) == 0
    said = capsys.readouterr().out
    assert "archived: the last release, in which there were no students and no marks\n" in said


def test_who_handed_in_is_not_called_a_student_of_the_roster(course, capsys):
    """Work that was kept apart is archived too, and makes no other number of students."""
    save_roster(course, Roster((Student("ada", "Ada"), Student("bob", "Bob"))))
    for name in ("ada", "bob", "Bob-2"):
        (course.submitted / name / "00_warmup").mkdir(parents=True)
        (course.submitted / name / "00_warmup/00_warmup.ipynb").write_text("{}")
    assert main(["term", "new", "00_warmup", "--yes", "--course", str(course.root)]) == 0
    assert "archived: 2 students, 3 submissions\n" in capsys.readouterr().out
    assert main(["term", "list", "--course", str(course.root)]) == 0
    said = capsys.readouterr().out
    assert ", 3 handed in\n" in said and "student" not in said


def test_a_name_that_is_unknown_is_told_before_anything_is_archived(course):
    """The last term's submissions are where they were."""
    course.submitted.mkdir()
    with pytest.raises(UnknownName, match="99_dance"):
        term.new_term(course, ("01_paths", "99_dance"))
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
    with pytest.raises(LabkitError, match="exists already"):
        export_course(Course(ROOT), tmp_path)
