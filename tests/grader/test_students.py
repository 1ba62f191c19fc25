"""The roster: lists of every platform are read, nobody is taken for somebody else."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest
from downloaded import NAME, bare_course
from hypothesis import given, settings
from hypothesis import strategies as st

from labkit.__main__ import main
from labkit.errors import LabkitError
from labkit.grader.clean import LONGEST, safe_name
from labkit.grader.nbgrader.gradebook import open_gradebook
from labkit.grader.students.class_list import Entry, Student, read_list
from labkit.grader.students.enrol import enrol, import_list
from labkit.grader.students.identity import record_users
from labkit.grader.students.platforms import LmsUser
from labkit.grader.students.roster import FILE, Roster, read_roster, same_name, save_roster


def listed(tmp_path, text, encoding="utf-8"):
    path = tmp_path / "list.csv"
    path.write_bytes(text.encode(encoding))
    return read_list(path)


def people(tmp_path, text, encoding="utf-8"):
    return [entry.student for entry in listed(tmp_path, text, encoding)]


def enrolled(entries, roster=None, collected=None):
    return enrol(roster or Roster(), entries, collected or {}).roster


MOODLE = """First name,Last name,ID number,Email address,Groups
Ada,Lovelace,1001,ada@uni.org,A
Zoë,O'Brien,,zoe@uni.org,"A, B"
"""
CANVAS = """Student,ID,SIS User ID,SIS Login ID,Section,Paths (4711)
    Points Possible,,,,,20.00
"Lovelace, Ada",7,1001,alovelace,S1,18
"O'Brien, Zoë",8,,zobrien,S1 and S2,
"""
GERMAN = "Vorname;Nachname;E-Mail-Adresse\nAda;Lovelace;ada@uni.org\nZoë;O'Brien;zoe@uni.org\n"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
@pytest.mark.parametrize("text", [MOODLE, CANVAS, GERMAN, CANVAS.replace("\n", "\r\n")])
def test_lists_as_platforms_export_them(tmp_path, text, encoding):
    """Delimiter, encoding, byte order mark and order of the name are found out."""
    ada, zoe = people(tmp_path, text, encoding)
    assert (ada.first_name, ada.last_name) == ("Ada", "Lovelace")
    assert (zoe.first_name, zoe.last_name) == ("Zoë", "O'Brien")


def test_what_columns_hold(tmp_path):
    """Canvas's ID is its own number; a column "id" elsewhere is the login, or else a number."""
    ada, _ = people(tmp_path, CANVAS)
    assert (ada.lms_user_id, ada.id_number, ada.login) == ("7", "1001", "alovelace")
    ada, _ = people(tmp_path, MOODLE)
    assert (ada.lms_user_id, ada.id_number, ada.email) == ("", "1001", "ada@uni.org")
    (one,) = people(tmp_path, "id,first_name,last_name,email,lms_user_id\nada,A,L,a@x,7\n")
    assert (one.login, one.lms_user_id) == ("ada", "7")  # nbgrader's own list
    (one,) = people(tmp_path, "ID\tLogin\tName\n1001\tada\tAda de la Cruz\n")
    assert (one.id_number, one.login, one.name) == ("1001", "ada", "Ada de la Cruz")
    (one,) = listed(tmp_path, "Identifier,Full name,Status\nParticipant 77,Ada,-\n")
    assert (one.participant, one.student.name) == ("77", "Ada")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "list.csv is empty; download the list again"),
        ("\nname\nAda\n", "does not name its columns in the first line; download"),
        ("Group,Mark\nA,1\n", "its columns are 'Group', 'Mark'; call one of them 'name'"),
        ("a:b\nc:d:e,f\n", "its columns are 'a:b'"),
        ("name\n\x00", "is not a text; save the spreadsheet as CSV"),
        ("PK\x03\x04", "is not a text; save the spreadsheet as CSV"),
        ("name,login\nLovelace, Ada,ada\n", "line 2 has 3 cells and the first line has 2"),
        (f"name,{'x' * 200_000}\nAda,\n", "line 1: field larger than field limit"),
        ('name,login\n"Ada,ada\n', "unexpected end of data; correct the table"),
        ("name,email\n,a@x\n", "line 2 has neither a name nor a login"),
    ],
)
def test_a_list_that_cannot_be_read_is_a_sentence(tmp_path, text, words):
    """What is missing is named, with the line or with the columns that are there."""
    with pytest.raises(LabkitError) as error:
        listed(tmp_path, text)
    assert words in str(error.value)
    with pytest.raises(LabkitError, match="there is no file"):
        read_list(tmp_path / "none.csv")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("name,login\nAda,x\nBob,x\n", "lines 2 and 3 are one student by a login, an address or"),
        ("name,login\nAda,x\nBob,x\n", "and contradict each other: Ada and Bob; correct the"),
        ("name,login,email\nAda,a,x@u\nAda,b,X@u\n", "contradict each other: a and b; correct"),
        ("name,login,email\nAda,a,\nBob,b,x@u\n,a,x@u\n", "line 4 could be Ada (line 2) or Bob"),
        ("name\nLi Wei\nWei Li\n", "are both Wei Li, and nothing tells them apart"),
        ("name,login,email\nKim,a,\nKim,,x@u\n", "nothing tells them apart"),
        (
            "Identifier,name\nParticipant 7,A\nParticipant 7,B\n",
            "lines 2 and 3 are both participant 7;",
        ),
    ],
)
def test_rows_that_contradict_each_other_are_refused(tmp_path, text, words):
    """One address for two logins, or two of one name that nothing tells apart."""
    with pytest.raises(LabkitError) as error:
        enrolled(listed(tmp_path, text))
    assert words in str(error.value)


@pytest.mark.parametrize("test_student", ["", '"Student, Test",98,,0f98e,S1\n'])
def test_a_list_without_a_student_is_refused(tmp_path, test_student):
    """A download of nobody would only say that everybody of the roster is missing."""
    (tmp_path / "list.csv").write_text(CANVAS.partition("\n")[0] + "\n" + test_student)
    with pytest.raises(LabkitError, match="names its columns but no student; choose all students"):
        import_list(bare_course(tmp_path / "course"), tmp_path / "list.csv")


def test_a_list_that_is_cut_off_is_refused(tmp_path):
    """Half a character in UTF-16 would be in the last login."""
    (tmp_path / "cut.csv").write_bytes("login\nada\n".encode("utf-16")[:-1])
    with pytest.raises(LabkitError, match="is cut off; download"):
        read_list(tmp_path / "cut.csv")


def test_lines_of_an_old_mac_are_lines(tmp_path):
    """They end with a carriage return alone."""
    assert len(people(tmp_path, MOODLE.replace("\n", "\r"))) == 2


def test_a_number_that_is_not_a_participants_is_none(tmp_path):
    """Such as a word, wide digits, or more of them than any platform counts."""
    for number in ("Participant abc", "Participant \uff11", "9" * 5000):
        (one,) = listed(tmp_path, f"Identifier,Full name\n{number},Ada\n")
        assert one.participant == ""


def test_nothing_in_the_roster_becomes_a_formula(tmp_path):
    """A person may call themselves so, and a lecturer opens the file in a spreadsheet."""
    course = bare_course(tmp_path / "course")
    roster = enrolled(listed(tmp_path, "name,login\n=cmd|' /C calc'!A0,@SUM(A1)\n'=1,-ada\n"))
    save_roster(course, roster)
    cells = (course.root / FILE).read_text().replace("\n", ",").split(",")
    assert not [cell for cell in cells if cell[:1] in {"=", "@", "-", "+"}]
    assert read_roster(course) == roster


def test_a_row_that_is_there_twice_is_one_student(tmp_path):
    """Two sections of Canvas's, for instance."""
    text = "name,login,email\nAda,ada,\nAda,ada,a@x\n"
    assert enrolled(listed(tmp_path, text)).students == (
        Student("ada", "", "Ada", "a@x", login="ada"),
    )


def test_the_folder_is_the_login_or_else_the_name(tmp_path):
    """No two have the same, also where a file system knows no capitals."""
    text = "name,login,email\nAda Lovelace,ada,\nLi Wei,,li1@x\nLi Wei,,li2@x\nADA,,a@x\nO'Z,,\n"
    roster = enrolled(listed(tmp_path, text))
    assert [s.id for s in roster.students] == ["ada", "Li-Wei-li1", "Li-Wei-li2", "ADA-a", "OZ"]
    (group,) = roster.namesakes()
    assert [student.id for student in group] == ["Li-Wei-li1", "Li-Wei-li2"]


def test_nobody_gets_a_folder_in_which_others_work_lies(tmp_path):
    """Where an older labkit called it by a name: only who alone may be meant gets that folder."""
    entries = listed(tmp_path, "name,email\nAda Lovelace,al@x\nKim Li,kl@x\nBob,b@x\nzoe,z@x\n")
    collected = {
        "01_paths": {
            "Ada-Lovelace": LmsUser("moodle", "1", "Ada Lovelace"),
            "Kim-Li": LmsUser("moodle", "2", "Kim Li"),
            "Kim-Li-3": LmsUser("moodle", "3", "Kim Li"),
            "zoe": LmsUser("exchange", "zoe", "zoe"),
        },
        "02_model": {"BOB": LmsUser("moodle", "4", "Eve")},
    }
    roster = enrolled(entries, collected=collected)
    assert [student.id for student in roster.students] == [
        *("Ada-Lovelace", "Kim-Li-kl", "Bob-b", "zoe-z"),
    ]


def test_a_second_list_adds_and_changes_but_takes_nobody_away(tmp_path):
    """By any key, or by a name that only one has; the folder stays."""
    first = enrolled(listed(tmp_path, MOODLE + "Bob,,,bob@uni.org,\n"))
    done = enrol(first, listed(tmp_path, CANVAS), {})
    assert not done.new
    ada, zoe, bob = done.roster.students
    assert (ada.id, ada.lms_user_id, ada.login, ada.email) == (
        "Ada-Lovelace", "7", "alovelace", "ada@uni.org",
    )  # fmt: skip
    assert zoe.lms_user_id == "8" and bob.email == "bob@uni.org"


def test_a_guess_from_a_full_name_replaces_no_name(tmp_path):
    """Which words are the last name, one column does not say; two columns do."""
    roster = Roster((Student("ada", "Ada", "de la Cruz", "ada@x"), Student("b", email="b@x")))
    text = "Identifier,Full name,Email address\nParticipant 7,{},ada@x\nParticipant 8,Bo Li,b@x\n"
    ada, bo = enrolled(listed(tmp_path, text.format("Ada de la Cruz")), roster).students
    assert (ada.first_name, ada.last_name) == ("Ada", "de la Cruz")
    assert (bo.first_name, bo.last_name) == ("Bo", "Li"), "where there is none, it is taken"
    ada, _ = enrolled(listed(tmp_path, text.format('"Cruz, Ada de la"')), roster).students
    assert (ada.first_name, ada.last_name) == ("Ada", "de la Cruz")


SAMMY = {
    "participants": 'First name,Last name,Email address\nSammy,"Davis, Jr.",s@x\n',
    "worksheet": 'Identifier,Full name,Email address\nParticipant 7,"Sammy Davis, Jr.",s@x\n',
    "canvas": 'Student,ID,SIS Login ID,Section\n"Davis, Jr., Sammy",7,s,A\n',
}


@pytest.mark.parametrize("first", SAMMY)
def test_a_name_with_a_comma_stays_as_it_is(tmp_path, first):
    """Whichever list comes first, and whichever come after it."""
    course = bare_course(tmp_path / "course")
    for text in (SAMMY[first], *SAMMY.values()):
        (tmp_path / "list.csv").write_text(text)
        import_list(course, tmp_path / "list.csv")
        (sammy,) = read_roster(course).students
        assert (sammy.first_name, sammy.last_name) == ("Sammy", "Davis, Jr.")


def test_the_test_student_of_canvas_is_nobody(tmp_path):
    """It gets no folder and no mark, and the import says so once; a person may be called so."""
    course, file = bare_course(tmp_path / "course"), tmp_path / "list.csv"
    tests = "".join(f'"Student, Test",{n},,0f{n}e,S{n}\n' for n in (98, 99))
    file.write_text(CANVAS + tests)
    told, _ = import_list(course, file)
    assert [s.id for s in read_roster(course).students] == ["alovelace", "zobrien"]
    assert sum("Test Student" in sentence for sentence in told) == 1
    file.write_text("First name,Last name,Email address\nTest,Student,t@x\n")
    import_list(course, file)
    assert read_roster(course).students[-1].name == "Test Student"


def test_two_rows_of_one_student_of_the_roster_must_agree(tmp_path):
    """By the login of one row and the address of the other; another name is a contradiction."""
    roster = Roster((Student("ada", "Ada", email="a@x", login="a"),))
    text = "name,login,email\nAda,a,\n{},,a@x\n"
    with pytest.raises(
        LabkitError, match=r"lines 2 and 3 are one student .*: Ada and Bob; correct"
    ):
        enrolled(listed(tmp_path, text.format("Bob")), roster)


def test_a_row_between_two_students_is_refused():
    """The login of one and the address of another."""
    roster = Roster((Student("a", "A", email="a@x"), Student("b", "B", login="b")))
    with pytest.raises(LabkitError, match=r"line 2 could be A \(a\) or B \(b\); correct"):
        enrolled([Entry(2, Student("", "A", email="a@x", login="b"))], roster)


@settings(max_examples=50)
@given(st.text(max_size=60))
def test_names_of_folders_are_safe(name):
    """Of any text: one level, not hidden, no option, short, the same when made again."""
    folder = safe_name(name)
    assert folder == safe_name(folder) and folder
    assert not {"/", "\\", "\0", " ", "\n", "\x1b"} & set(folder)
    assert folder[0] not in ".-" and ".." not in folder
    assert len(folder.encode()) <= LONGEST
    assert folder.casefold().partition(".")[0] not in {"con", "nul", "prn", "aux", "com1"}


def test_spellings_of_a_name():
    """Order, case, commas, and what a file's name must not hold make no difference."""
    spellings = ("Ada O'Brien", "O'BRIEN, Ada", "OBrien Ada", "Ada_OBrien", "ada  o’brien")
    assert len({same_name(name) for name in spellings}) == 1
    assert same_name("Ada O'Brien") != same_name("Ada Brien")
    assert same_name("Zoe\u0308") == same_name("Zoë")


FIELDS = st.text(st.characters(exclude_categories=("Cs", "Cc")), max_size=8)


@settings(max_examples=20, deadline=None)
@given(st.lists(st.tuples(FIELDS, FIELDS, FIELDS), max_size=4))
def test_a_roster_is_read_as_it_was_written(rows):
    """Whatever people are called, quotation marks and commas included."""
    entries = [
        Entry(k, Student("", first, last, login=f"{k}{login}"))
        for k, (first, last, login) in enumerate(rows)
    ]
    with tempfile.TemporaryDirectory() as folder:
        course = bare_course(Path(folder, "course"))
        roster = enrolled(entries)
        save_roster(course, roster)
        again = read_roster(course)
        assert [s.id for s in again.students] == [s.id for s in roster.students]
        save_roster(course, again)
        assert read_roster(course) == again


def test_names_in_a_guessed_encoding_are_named(tmp_path):
    """A Mac's is read as Windows's; in UTF-8, and without such a name, nothing is said."""
    course, file = bare_course(tmp_path / "course"), tmp_path / "list.csv"
    for name, encoding in ("Ada Ay", "ascii"), ("Joséf Ay", "utf-8"), ("José Ay", "mac_roman"):
        file.write_text(f"name,email\n{name},{encoding}@x\n", encoding)
        said = [x for x in import_list(course, file)[1] if "Windows-1252" in x]
        assert len(said) == (encoding == "mac_roman")
    assert (
        "check these names: JosŽ Ay. If one is wrong, save the list in UTF-8, delete students"
        in said[0]
    )
    (course.root / FILE).unlink()
    file.write_text("name,email\nJosé Ay,mac_roman@x\n", "utf-8")
    import_list(course, file)
    assert [one.id for one in read_roster(course).students] == ["José-Ay"]


def test_the_import_says_what_groups_become(tmp_path):
    """Moodle's groups become teams, which share an arm; who is in none gets no team."""
    course, file = bare_course(tmp_path / "course"), tmp_path / "list.csv"
    head = "First name,Last name,Email address,Groups\n"
    rows = "Ada,Ay,a@x,Monday\nBob,Be,b@x,Monday\nEve,Ee,e@x,No groups\nZoe,Zet,z@x,No groups\n"
    file.write_text(head + rows)
    (_, teams), _ = import_list(course, file)
    assert teams.startswith("teams in this list: 1 ('Monday'), the largest of 2 students; a team")
    assert [s.team for s in read_roster(course).students] == ["Monday", "Monday", "", ""]
    file.write_text(head + rows.replace("Monday", '"Blue, Monday"'))
    (_, teams), (two, _) = import_list(course, file)
    assert "teams in this list: 1 ('Blue, Monday'), the" in teams
    assert two.startswith("teams with a comma: 'Blue, Monday'; Moodle writes this for a student")
    file.write_text("First name,Last name,Email address\nAda,Ay,a@x\n")
    assert not any("team" in sentence for sentence in import_list(course, file)[0])


def test_a_changed_team_is_named(tmp_path):
    """With what becomes of report and arm; of a first list, and of the same once more, nobody."""
    course, file = bare_course(tmp_path / "course"), tmp_path / "list.csv"
    said = []
    for ed, zoe in ("Blue", ""), ("Red", "Red"), ("Red", "Red"):
        file.write_text(f"name,team\nAda Ay,Blue\nEd Ee,{ed}\nZoe Zet,{zoe}\n")
        said.append(import_list(course, file)[1])
    first, (changed,), again = said
    names = "Ed Ee (Ed-Ee) from 'Blue' to 'Red', Zoe Zet (Zoe-Zet) from no team to 'Red'"
    assert changed.startswith(f"teams changed: {names}; their arm is now the new team's, and so")
    assert "import the list with that team, and change it after the report's marks" in changed
    assert "make the zip again (labkit student-bundle)" in changed
    assert (first, again) == ([], [])


def test_who_has_no_team_in_a_list_of_teams_is_named(tmp_path):
    """The old team stays, and the import says how to take somebody out of it, which helps."""
    course, file = bare_course(tmp_path / "course"), tmp_path / "list.csv"
    stays = "still in the team they had: Ed Ee (Ed-Ee) in 'Red'; to take somebody out of a team, "
    said = []
    for ed, ada in ("Red", "Red"), ("", ""), ("", "Red"), ("", "Red"):
        file.write_text(f"name,team\nAda Ay,{ada}\nEd Ee,{ed}\n")
        said.append(stays in "\n".join(import_list(course, file)[1]))
        if said[-1]:
            roster = course.root / FILE
            roster.write_text(roster.read_text().replace("Ed,Ee,,,,,,Red", "Ed,Ee,,,,,,"))
    assert said == [False, False, True, False]
    assert [one.team for one in read_roster(course).students] == ["Red", ""]


def test_one_student_with_another_address_is_not_taken_for_two(tmp_path, capsys):
    """The import asks for a look, exit code 1, and what it advises leaves one row and one folder.

    It does not ask if both are in the list, for then they are two students.
    """
    course, file = bare_course(tmp_path / "course"), tmp_path / "list.csv"
    words = ["students", "import", str(file), "--course", str(course.root)]
    file.write_text("name,email\nNia Novak,nia@x\nBo Li,bo@x\n")
    assert main(words) == 0
    assert "2 of them new\n" in capsys.readouterr().out, "of a first list nobody is named"
    changed = "name,email\nNia Novak,nia2@x\nBo Li,bo@x\n"
    file.write_text(changed)
    assert main(words) == 1
    out, err = capsys.readouterr()
    assert "3 students, 1 of them new: Nia Novak (Nia-Novak-nia2)\n" in out
    assert "not in this list: Nia Novak (Nia-Novak-nia2) and Nia-Novak; if the two are one" in err
    rows = (course.root / FILE).read_text().splitlines(keepends=True)
    assert rows.pop().startswith("Nia-Novak-nia2,")
    (course.root / FILE).write_text("".join(rows).replace("nia@x", "nia2@x"))
    assert main(words) == 0
    assert [one.id for one in read_roster(course).students] == ["Nia-Novak", "Bo-Li"]
    file.write_text(changed + "Bo Li,li@x\n")
    assert main(words) == 0
    assert "1 of them new: Bo Li (Bo-Li-li)\n" in capsys.readouterr().out


@pytest.mark.slow
def test_the_command_imports_a_list_and_formgrader_shows_names(tmp_path, capsys):
    """New ones are counted, namesakes named, and of a class list also those whom it lacks."""
    course = bare_course(tmp_path / "course")
    file = tmp_path / "list.csv"
    where = ["--course", str(course.root)]
    file.write_text(MOODLE + "Li,Wei,2,li@x,\nWei,Li,3,wei@x,\n")
    assert main(["students", "import", str(file), *where]) == 1, "a team is two groups"
    said = capsys.readouterr()
    assert f"{FILE}: 4 students, 4 of them new" in said.out
    assert (
        "2 students have the same name: Li Wei (Li-Wei-li), Wei Li (Wei-Li-wei); Moodle" in said.out
    )
    for name, system in ((NAME, "moodle"), ("05_impedance", "canvas")):
        record_users(course, name, {n: LmsUser(system, n, n) for n in ("Li-Wei-li", "Wei-Li-wei")})
    assert main(["students", "import", str(file), *where]) == 1, "a team is two groups"
    assert "with --assignment; this is done for 01_paths\n" in capsys.readouterr().out
    with open_gradebook(course) as book:
        ada = book.find_student("Ada-Lovelace")
        about = (ada.first_name, ada.last_name, ada.email, ada.lms_user_id)
    assert about == ("Ada", "Lovelace", "ada@uni.org", "1001")
    file.write_text("Identifier,Full name,Email address\nParticipant 7,Ada,ada@uni.org\n")
    assert main(["students", "import", str(file), "--assignment", NAME, *where]) == 0
    said = capsys.readouterr().out
    assert "0 of them new" in said and "01_paths: 1 participant; " in said
    assert "not in this list" not in said, "a worksheet may be that of a group"
    assert main(["students", "import", str(file), *where]) == 0
    said = capsys.readouterr().out
    assert "not in this list, and still in the roster: 3 (Zoë O'Brien (Zoë-OBrien), " in said
    assert "; keep their rows, even if they have left the class\n" in said
    file.write_text(CANVAS)
    assert main(["students", "import", str(file), "--assignment", NAME, *where]) == 2
    assert "has no column 'Identifier'" in capsys.readouterr().err
