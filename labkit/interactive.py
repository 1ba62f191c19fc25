"""Interactive figures: sliders with a typed number beside each, and a figure that follows them.

Without a page to turn them in, the figure of the starting values is all there is, so a notebook
runs the same with nobody looking.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from IPython.display import display
from matplotlib.figure import Figure


def dials(
    draw: Callable[..., tuple[Figure, str]], **ranges: tuple[float, float, float]
) -> dict[str, Any]:
    """Show a figure under sliders that change it.

    Args:
        draw: Takes a number for each dial by name; gives a figure and its caption in words.
        ranges: For each dial its least value, its largest one, and where it starts.

    Returns:
        The sliders by name; setting a slider's `value` redraws.
    """
    import ipywidgets as widgets
    import matplotlib.pyplot as plt

    sliders: dict[str, Any] = {}
    rows = []
    caption = widgets.HTML()
    picture = None

    def follow(change: Any = None) -> None:
        nonlocal picture
        figure, words = draw(**{name: slider.value for name, slider in sliders.items()})
        caption.value = words
        alt = {"image/png": {"alt": words}}
        if picture is None:
            picture = display(figure, metadata=alt, display_id=True)
        else:
            picture.update(figure, metadata=alt)
        plt.close(figure)

    for name, (least, most, start) in ranges.items():
        step = (most - least) / 100.0
        slider = widgets.FloatSlider(
            start,
            min=least,
            max=most,
            step=step,
            description=name,
            readout=False,
            continuous_update=False,
        )
        typed = widgets.BoundedFloatText(
            start, min=least, max=most, step=step, layout={"width": "7em"}
        )
        widgets.link((slider, "value"), (typed, "value"))
        sliders[name] = slider
        rows.append(widgets.HBox([slider, typed]))
    display(widgets.VBox([*rows, caption]))
    follow()
    for slider in sliders.values():
        slider.observe(follow, "value")
    return sliders
