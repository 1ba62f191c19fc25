"""An arm of one's own: drawn again from the secret, sealed, unlike any other, and judged."""

import json

import pytest

from labkit.course import Found, Identification, Measured, Outcome, Telling, mark, my_arm
from labkit.course.bugs import CAUSES, MOVES, Bug, tells_apart
from labkit.course.differences import sentence
from labkit.course.identification import personal
from labkit.course.messages import tell
from labkit.course.own_arm import DEMO, FILE, Arms, draw
from labkit.course.reply import Here
from labkit.errors import LabkitError


def test_the_secret_draws_the_same_arm_again_and_others_otherwise():
    """One secret and one handle give one arm; another of either gives another arm."""
    assert draw(7, "kestrel") == draw(7, "kestrel")
    arms = {draw(secret, handle).payload for secret in range(5) for handle in "abcde"}
    assert len(arms) == 25


def test_what_students_get_names_no_number(tmp_path, monkeypatch):
    """The sealed file shows neither handle nor payload, and opens for its handle alone."""
    arm = draw(7, "kestrel")
    text = json.dumps(Arms(7, {"kestrel": "kestrel"}).sealed())
    assert "kestrel" not in text and str(arm.payload)[:6] not in text
    (tmp_path / FILE).write_text(text)
    monkeypatch.chdir(tmp_path)
    with my_arm("kestrel") as mine:
        assert mine.plant.payload == 0.0, "it does not say what it carries"
        assert mine._engine is not None
    with pytest.raises(LabkitError, match="has no arm for 'merlin'"):
        my_arm("merlin")


def test_a_number_is_judged_against_ones_own_arm():
    """The demonstration's number is right for the demonstration, and for nobody else."""
    demo, other = draw(2019, DEMO), draw(7, "kestrel")
    judge = Measured("payload", "kg", 0.0, 3.0, 0.01)
    asked = Identification("m", "?", judge, demo.payload, "one number", 1.0).question()
    assert mark(asked, Here(demo.payload, ())).outcome is Outcome.RIGHT
    assert mark(personal(asked, other), Here(other.payload, ())).outcome is Outcome.RIGHT
    assert mark(personal(asked, other), Here(demo.payload, ())).earned == 0.0
    assert mark(asked.public(), Here(other.payload, ())).outcome is Outcome.RIGHT


def test_a_bug_is_found_by_its_cause_and_its_time():
    """The wrong cause, or a time that is far off, is not found."""
    bugs = draw(7, "kestrel").bugs
    assert len({bug.cause for bug in bugs}) == 3 and len(CAUSES) * len(MOVES) >= 12
    judge = Found(0)
    cause, shows = judge.expected(bugs)
    assert judge((cause, shows + 0.1), (cause, shows)) is None
    assert judge((cause, shows + 0.3), (cause, shows)) is not None
    wrong = next(letter for letter in CAUSES if letter != cause)
    found = judge((wrong, shows), (cause, shows))
    assert sentence(found) == f"It should be ({cause!r}, {shows}), not ({wrong!r}, {shows})."


def test_a_mistake_shows_after_its_onset():
    """Until the mistake comes in the run is the right one."""
    assert 0.5 <= Bug("b", 0, 0.5, 1).shows() < 0.6


def test_an_experiment_must_tell_two_suspects_apart():
    """An arm at rest on its target cannot tell a lost feed-forward from a wrong damper."""
    still = [0.0] * 7
    assert tells_apart("f", "h", still, still) < 5.0
    assert Telling(0)(("fh", still, still), None) is not None
    assert Telling(0)(("bc", still, still), "b") is None
    assert sentence(Telling(0)(("bc", still, still), "c")) == "It should be c, not b."


def test_a_number_of_ones_own_arm_is_not_called_right_where_the_arm_is_not_known():
    """A check says when the number is judged; one of a wrong form is still wrong."""
    judge = Measured("payload", "kg", 0.0, 3.0, 0.01)
    asked = Identification("m", "?", judge, 0.3, "one number", 3.0).question().public()
    says = tell(asked, mark(asked, lambda: 1.0))
    assert says.startswith("m: a possible answer. When it is marked, it earns 3 points if it is")
    assert "right" not in says
    assert "not yet right" in tell(asked, mark(asked, lambda: 7.0))


def test_how_near_a_measured_number_has_to_be_is_said_above_its_cell():
    """A student knows when to stop measuring."""
    asked = Identification(
        "m", "?", Measured("payload", "kg", 0.0, 3.0, 0.01), 0.3, "a number", 3.0
    )
    assert "It counts if it is off by at most 0.01 kg." in asked.brief()
