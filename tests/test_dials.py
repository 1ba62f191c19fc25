"""Sliders redraw, and need nobody to look."""

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
