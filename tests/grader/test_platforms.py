"""Whose a file is: what a student calls it never changes that."""

from __future__ import annotations

import pytest
from downloaded import canvas_writes, moodle_writes
from hypothesis import example, given
from hypothesis import strategies as st

from labkit.grader.students.platforms import readings

PIECES = st.sampled_from(
    [
        "_42_assignsubmission_file",
        "_",
        "_7_99_",
        "LATE_",
        "_1",
        "9_",
        "42_",
        " ",
        "/",
        "anon",
        "Ada",
    ]
    + ["assignsubmission_onlinetext", "-", ".", "é", "०१", "\x1b[2J", "(3)", "01_paths"]
)
TEXTS = st.lists(PIECES | st.text(max_size=3), max_size=8).map("".join)
FILES = TEXTS.map(lambda text: text.replace("/", "") + ".ipynb")
NUMBERS = st.integers(1, 10**15)


@given(TEXTS, NUMBERS, FILES, st.booleans())
@example("Eve Mallory", 77, "x_42_assignsubmission_file_01_paths(9).ipynb", False)
@example("Eve_42_assignsubmission_file", 77, "01_paths.ipynb", True)
def test_a_file_from_moodle_is_the_participants(name, number, file, in_folders):
    """Whatever people and files are called, the first number is the participant's."""
    (one,) = readings(moodle_writes(name, number, file, in_folders))
    assert one.who.key == ("moodle", str(number))
    assert one.kind == "file"


@given(TEXTS, NUMBERS, st.integers(10**6, 10**9), FILES, st.booleans())
@example("a_1", 77, 10**6, "x.ipynb", False)
@example("a", 1, 77, "99_x.ipynb", False)
def test_a_file_from_canvas_is_nobody_elses(name, user, attachment, file, late):
    """One reading is the right one; where two are possible the right one is among them."""
    found = readings(canvas_writes(name, user, attachment, file, late))
    right = ("canvas", str(user))
    assert not found or right in [one.who.key for one in found]
    assert all(one.late == late for one in found)


@pytest.mark.parametrize(
    ("entry", "users"),
    [
        ("hoppergrace_7_99_01_paths-1.ipynb", ["7"]),
        ("hoppergrace_LATE_7_99_10_x.ipynb", ["7"]),
        ("hoppergrace_7_99_10_cup.ipynb", ["7"]),
        ("hoppergrace_7_99_2_x.ipynb", ["7"]),  # no attachment has such a number
        ("eve_7_8_100_x.ipynb", ["7", "8"]),  # eve_7 who is user 8, or eve who is 7 with 100_x
        ("anon_12345_3_x.ipynb", []),
        ("anon_aB3x5_3_x.ipynb", []),
        ("../x_7_99_x.ipynb", []),
        ("eve_0_80_lovelaceada_7_99_x.ipynb", []),  # the first numbers, or none
        ("a_01_77_990_x.ipynb", ["77"]),
        ("Ada_Lovelace_7_assignsubmission_file_x.ipynb", []),  # no underscore is Moodle's here
        ("Team_assignsubmission_file_x_42_assignsubmission_file_y.ipynb", []),
        ("Team_assignsubmission_file_5_6_x.ipynb", []),
        ("Ada Lovelace_7_assignsubmission_file_/sub/x.ipynb", ["7"]),
        ("essay.ipynb", []),
        ("Eve_000101_assignsubmission_file/x.ipynb", []),  # 101 is another's
        ("Eve_１０１_assignsubmission_file/x.ipynb", []),
        ("Eve_" + "9" * 20 + "_assignsubmission_file/x.ipynb", []),
        ("Eve_0_assignsubmission_file/x.ipynb", ["0"]),
    ],
)
def test_names_as_platforms_write_them(entry, users):
    """What can be read in two ways is read in two; what no platform wrote is nobody's."""
    assert [one.who.number for one in readings(entry)] == users


def test_what_moodle_calls_another_way_of_handing_in_is_told():
    """A name that holds both kinds is read as the text that was typed, by the first person."""
    (one,) = readings("Eve_77_assignsubmission_onlinetext_Ada_42_assignsubmission_file_x.ipynb")
    assert (one.who.number, one.kind) == ("77", "onlinetext")
