"""Text that somebody else wrote can be stored and shown anywhere."""

from datetime import UTC, datetime
from zoneinfo import ZoneInfo

import pytest
from hypothesis import given
from hypothesis import strategies as st

from labkit.grader.clean import clean_line, clean_text, how_many
from labkit.grader.submission import read_time

ANYTHING = st.text(alphabet=st.characters(exclude_categories=()))  # lone surrogates too


@given(ANYTHING)
def test_clean_text_can_be_written_as_utf8_and_moves_no_cursor(text):
    """Every file and terminal takes it, and cleaning twice changes nothing more."""
    clean = clean_text(text)
    clean.encode("utf-8")
    assert not set(clean) & {"\x1b", "\r", "\b", "\x00", "\u202e", "\x9b"}
    assert clean_text(clean) == clean


@given(ANYTHING)
def test_a_clean_line_is_one_short_line(text):
    """Nothing breaks it, and it is no longer than asked for."""
    line = clean_line(text, 40)
    assert len(line.splitlines()) <= 1 and len(line) <= 40
    assert clean_line(line, 40) == line


@pytest.mark.parametrize(
    ("text", "clean"),
    [
        ("plain\n\ttext", "plain\n\ttext"),
        ("\ud800", "\ufffd"),
        ("a\r\nb", "a\nb"),
        ("\x1b]0;owned\x07", "]0;owned"),
        ("ada \u202egpj.exe", "ada gpj.exe"),
        ("Zo\u00eb 🤖", "Zo\u00eb 🤖"),
    ],
)
def test_what_people_write_stays(text, clean):
    """Accents, emoji, tabs and lines stay; what commands a terminal goes."""
    assert clean_text(text) == clean


def test_one_thing_is_not_a_plural():
    """One is a student, while none and two are students."""
    assert [how_many(n, "student") for n in (0, 1, 2)] == ["0 students", "1 student", "2 students"]


@pytest.mark.parametrize(
    ("text", "hour"),
    [
        ("2026-11-06 10:00:00.123456 UTC", 10),
        ("2026-11-06 10:00 UTC", 10),
        ("2026-11-06T10:00:00Z", 10),
        ("2026-11-06 10:00:00+02:00", 8),
        ("2026-11-06 10:00", 9),
        ("2026-11-06 10:00:00 US", None),
        ("06.11.2026 10:00", None),
        ("10:00 am pm", None),
        ("1" * 5000, None),
        ("0001-01-01 00:00:00+14:00", None),
        ("", None),
    ],
)
def test_a_time_is_nbgraders_own_or_iso(text, hour):
    """Any other text, also with a zone that is a folder of the zone data, is no time."""
    when = read_time(text, ZoneInfo("Europe/Berlin"))
    assert when == (hour and datetime(2026, 11, 6, hour, 0, when.second, when.microsecond, UTC))
