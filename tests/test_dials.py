"""Sliders redraw, bars come to their end, and neither needs anybody to look."""

import matplotlib.pyplot as plt
import pytest

import labkit as lk


@pytest.fixture
def shown(monkeypatch):
    """What was displayed, in order."""
    things = []

    class Picture:
        def update(self, obj, **about):
            things.append(about if "metadata" in about else obj)

    def display(obj, /, **about):  # as IPython's, which shows nothing given by name
        things.append(about if "metadata" in about else obj)
        return Picture()

    monkeypatch.setattr("labkit.plotting.display", display)
    return things


@pytest.fixture
def widgets(monkeypatch):
    """The boxes that were made, in order."""
    import ipywidgets

    made = []
    for name in ("VBox", "HBox"):
        box = getattr(ipywidgets, name)
        monkeypatch.setattr(ipywidgets, name, lambda *a, box=box: made.append(box(*a)) or made[-1])
    return made


def test_a_slider_redraws_with_the_caption_as_alt_text(shown):
    """Each figure carries its own numbers in words, and none is left open."""

    def draw(kp):
        return plt.figure(), f"kp is {kp:g}"

    others = plt.get_fignums()
    sliders = lk.plotting.dials(draw, kp=(0.0, 10.0, 4.0))
    sliders["kp"].value = 7.0
    captions = [x["metadata"]["image/png"]["alt"] for x in shown if "metadata" in x]
    assert captions == ["kp is 4", "kp is 7"]
    below = [x["text/plain"] for x in shown if "text/plain" in x]
    assert below[-2:] == ["kp is 4", "kp is 7"], "which stay in the notebook without its kernel"
    assert plt.get_fignums() == others


def test_a_bar_says_how_long_it_takes_and_when_it_is_done(shown, widgets, monkeypatch):
    """Told every tick, it is drawn five times a second at most, and its end never fails to show."""
    clock = iter([0.0, 0.1, 0.25, 0.3, 1.0])
    monkeypatch.setattr("labkit.plotting.time.monotonic", lambda: next(clock))
    tell = lk.plotting.progress("pushing", 10.0)
    bar, words = widgets[0].children
    tell(1.0)
    assert bar.value == 0.0
    tell(2.5)
    assert bar.value == 2.5 and words.value == "pushing: about 1 s left"
    tell(3.0)
    assert bar.value == 2.5
    tell(10.0)
    assert bar.value == 10.0 and shown[1:] == [{"text/plain": "pushing: done"}]
