"""Nobody can stop a class: whatever is in a student's hand costs that student alone.

Hostile times, names of folders and files, predictions and texts are given to every verb.
"""

from __future__ import annotations

import copy
import os
import pwd
import random
import shutil

import pytest
from downloaded import CLASS, canvas_writes, handed_in, moodle_writes, zipped
from handmade import NAME, QUICK, add, put, raw

from labkit.__main__ import main
from labkit.grader import batch
from labkit.grader.gradebook import open_gradebook
from labkit.grader.roster import Student, save_roster

TIMES = (
    *("US", "9" * 100_000, "0001-01-01 00:00:00 UTC", "9999-12-31T23:59:59-23:59", "٢٠٢٦-١١-٠٦"),
    *("2026-11-06 10:00:00 US", "10:00 am pm", "", "\x00", "1e999", "2026-W01", "nan"),
)
NUMBERS = (
    *("10**5000", "-(10**400)", f"0x{'f' * 4000}", "1e999", "float('nan')", "True", "None"),
    *("[[[[[[]]]]]]", "{1: 2}", "'a' * 10**6", "'\\ud800'", "lambda: 0", "range(10**9)", "1j"),
)
TEXTS = (
    *("`" * 200_000, "<!--" * 100_000, "\n" * 300_000, "![" * 80_000, "<script>alert(1)</script>"),
    *("\x1b[2J\u202e", "$" * 100_000, "a" * 500_000, "[" * 100_000, "=cmd()", "\ud800"),
)
NAMES = (
    *("ada", "../ada", "ada\x1b[2J", "<script>", "=1+1", "CON", ".", "a" * 200, "\u202eada", "९"),
    *("ada_42_900_x", "Ada Lovelace_101_assignsubmission_file_x", "[31m", "x\ny", "--yes"),
)
CODE = "import os; os._exit(0)"
HOSTILE = tuple(f"eve{k}" for k in range(4))


def _people(dice):
    """Ada, and others whose names are hostile; they chose them on the platform."""
    odd = [Student(x, dice.choice(NAMES), dice.choice(NAMES), f"{x}@x.test", f"7{x[3:]}", x)
           for x in HOSTILE]  # fmt: skip
    me = Student("me", "M", "E", login=pwd.getpwuid(os.getuid()).pw_name)
    return [CLASS[0], me, *odd]


def _notebook(dice, solved):
    """A right notebook in which a prediction, a text, a name and a cell are hostile."""
    work = copy.deepcopy(solved)
    said = dice.choice(NUMBERS)
    put(work, "twice_the_time", f'twice_the_time = predict("twice_the_time", {said})')
    put(work, "why_slower", dice.choice(TEXTS))
    add(work, f"# {dice.choice(TEXTS)[:1000]!r}\nprint({dice.choice(TEXTS)!r})")
    add(work, dice.choice([CODE, "raise ValueError('x' * 10**6)", "x = 1"]))
    work["metadata"] = {"kernelspec": dice.choice(TEXTS)[:100]}
    return raw(work)


def _hand_in(course, dice, solved, place):
    """Everybody hands in, on each platform; hostile times lie beside the files."""
    file = f"{dice.choice(NAMES)}.ipynb".replace("/", "_")
    moodle = [(moodle_writes("Ada Lovelace", 101, f"{NAME}.ipynb"), raw(solved))]
    moodle += [(moodle_writes(dice.choice(NAMES), 200, file), b"{}") for _ in range(3)]
    canvas = [(canvas_writes("x", f"7{x[3:]}", 900 + k, file, dice.random() < 0.5),
               _notebook(dice, solved)) for k, x in enumerate(HOSTILE)]  # fmt: skip
    inbound = place / "inbound"
    for when in TIMES:
        handed_in(inbound, "ada", "{}", when.replace("/", "").replace("\x00", "")[:150])
    handed_in(inbound, pwd.getpwuid(os.getuid()).pw_name, "{}")
    dates = [(2026, 3, 1, 12, 0, 0), (1980, 1, 1, 0, 0, 0), (2107, 12, 31, 23, 59, 58)]
    run(course, "collect", NAME, zipped(place / "m.zip", moodle), inbound)
    run(course, "collect", NAME, zipped(place / "c.zip", canvas, dice.choice(dates)))
    for student in HOSTILE:
        folder = course.submitted / student / NAME
        if folder.exists():
            (folder / "timestamp.txt").write_text(dice.choice(TIMES), errors="replace")
    for name in dice.sample([x for x in NAMES if x not in (".", "ada") and "/" not in x], 3):
        shutil.copytree(course.submitted / "ada", course.submitted / name)


def run(course, *words):
    """Type it: a traceback would end the test, and every other outcome is a sentence."""
    code = main([words[0], "--course", str(course.root), *map(str, words[1:])])
    assert code in (0, 1, 2)
    return code


def handed_in_files(course):
    """The bytes of everything that was handed in or collected."""
    tops = (course.submitted, course.root / "attempts")
    return {path: path.read_bytes() for top in tops for path in top.rglob("*.*") if path.is_file()}


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, *(pytest.param(k, marks=pytest.mark.soak) for k in (2, 3))])
def test_nothing_in_a_students_hand_reaches_another(course, solved, tmp_path, monkeypatch, capsys,
                                                    seed):  # fmt: skip
    """Every verb ends without a traceback, and Ada's mark is what she deserves."""
    monkeypatch.setattr(batch, "Limits", lambda: QUICK)
    dice = random.Random(seed)
    save_roster(course, _people(dice))
    shutil.copy(course.root / "course_private/roster.csv", tmp_path / "list.csv")
    run(course, "roster", tmp_path / "list.csv")
    (course.root / "course.toml").write_text(
        "late.percent_per_day = 50\n[assignments.01_curves]\ndue = 2025-01-01T00:00:00\n"
    )
    _hand_in(course, dice, solved, tmp_path)
    before = handed_in_files(course)
    run(course, "grade", NAME, "--jobs", "2")
    run(course, "grade", NAME, "--diff", "--student", "eve0", "--student", "eve1")
    with open_gradebook(course) as book:  # as somebody does in formgrader
        why = book.find_grade("why_slower", NAME, NAME, "ada")
        why.manual_score, why.needs_manual_grade = 2.0, False
        book.db.commit()
    capsys.readouterr()
    for layout in ("canvas", "moodle", "questions"):
        assert run(course, "export", NAME, "--layout", layout) < 2
        out = capsys.readouterr().out
    (row,) = (line.split(",") for line in out.splitlines() if line.startswith("ada,"))
    assert row[-2] == "24.0", "neither late nor wrong"
    assert run(course, "export") < 2
    assert run(course, "feedback", NAME, "--unmarked", "--moodle", tmp_path / "back.zip") < 2
    assert (course.root / f"feedback/ada/{NAME}/{NAME}.html").exists()
    assert run(course, "class-report", NAME) < 2
    for student in ("ada", *HOSTILE):
        run(course, "explain", NAME, student, "bang_bang")
        run(course, "defence", student)
        run(course, "defence", student, "--mark", 1, 1, 1)
    assert handed_in_files(course) == before
    for name in {*HOSTILE, *NAMES} - {"ada"}:
        run(course, "term", "forget", "--yes", "--", name)
    assert (course.submitted / f"ada/{NAME}/{NAME}.ipynb").exists()
    said = capsys.readouterr()
    assert all(x.isprintable() or x in "\n\t" for x in said.err)
