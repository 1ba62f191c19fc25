"""What nbgrader says in a terminal: no name that a student chose gives it commands."""

from __future__ import annotations

from handmade import hand_in, nbgrader

NAME = "01_paths"
HOSTILE = "\x1b[2J\u202eeve"


def test_no_name_reaches_a_terminal_through_nbgraders_log(course):
    """Of a folder with such a name there are its letters, and the refusal in a sentence."""
    hand_in(course, NAME, HOSTILE, b"{}")
    code, said = nbgrader(course.root, "autograde", NAME, "--create", "--student", HOSTILE)
    assert code == 1 and r"not graded: '\x1b[2J\u202eeve'" in said
    assert [x for x in said if not (x.isprintable() or x == "\n")] == []
