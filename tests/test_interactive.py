"""Sliders redraw, bars come to their end, and neither needs anybody to look."""

import matplotlib.pyplot as plt
import pytest

import labkit as lk


@pytest.fixture
def shown(monkeypatch):
    """What was displayed, in order."""
    things = []

    class Picture:
        def update(self, thing, **about):
            things.append(about if "metadata" in about else thing)

    def display(thing, **about):
        things.append(about if "metadata" in about else thing)
        return Picture()

    monkeypatch.setattr("labkit.interactive.display", display)
    return things


def test_a_slider_redraws_with_the_caption_as_alt_text(shown):
    """Each figure carries its own numbers in words, and none is left open."""

    def draw(kp):
        return plt.figure(), f"kp is {kp:g}"

    others = plt.get_fignums()
    sliders = lk.dials(draw, kp=(0.0, 10.0, 4.0))
    sliders["kp"].value = 7.0
    captions = [x["metadata"]["image/png"]["alt"] for x in shown if isinstance(x, dict)]
    assert captions == ["kp is 4", "kp is 7"]
    assert plt.get_fignums() == others


def test_a_typed_number_moves_the_slider(shown):
    """The box beside a slider holds the same value, both ways."""
    sliders = lk.dials(lambda kd: (plt.figure(), ""), kd=(0.0, 2.0, 1.0))
    rows = shown[0].children
    typed = rows[0].children[1]
    typed.value = 1.5
    assert sliders["kd"].value == 1.5


def test_a_bar_says_how_long_it_takes_and_when_it_is_done(shown, monkeypatch):
    """Told every tick, it is drawn five times a second at most, and its end never fails to show."""
    clock = iter([0.0, 0.1, 0.25, 0.3, 1.0])
    monkeypatch.setattr("labkit.interactive.time.monotonic", lambda: next(clock))
    tell = lk.progress("pushing", 10.0)
    bar, words = shown[0].children
    tell(1.0)
    assert bar.value == 0.0
    tell(2.5)
    assert bar.value == 2.5 and words.value == "pushing: about 1 s left"
    tell(3.0)
    assert bar.value == 2.5
    tell(10.0)
    assert bar.value == 10.0 and shown[1:] == [{"text/plain": "pushing: done"}]


def test_boxes_are_words_where_no_widget_can_be_shown(shown):
    """A page that shows the saved notebook as text is told what was there."""
    lk.dials(lambda kd: (plt.figure(), ""), kd=(0.0, 2.0, 1.0))
    lk.progress("pushing", 10.0)
    assert repr(shown[0]) == "Dials: kd from 0 to 2"
    assert repr(shown[2]) == "pushing …"
