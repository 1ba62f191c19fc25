"""What answers while one looks: figures under sliders with typed numbers, and bars of progress.

Without a page to turn them in, the figure of the starting values is all there is, so a notebook
runs the same with nobody looking.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import ipywidgets as widgets
import matplotlib.pyplot as plt
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
    span = ", ".join(f"{name} from {a:g} to {b:g}" for name, (a, b, _) in ranges.items())
    display(_saying(widgets.VBox, f"Dials: {span}")([*rows, caption]))
    follow()
    for slider in sliders.values():
        slider.observe(follow, "value")
    return sliders


def progress(doing: str, total: float) -> Callable[[float], None]:
    """A bar for what takes more than a moment.

    Args:
        doing: What is being done, such as "following the tag".
        total: How much there is to do: runs, seconds, anything.

    Returns:
        To be told how much is done; cheap enough for every tick of a control loop.
    """
    bar = widgets.FloatProgress(0.0, max=total)
    words = widgets.Label(f"{doing} …")
    place = display(_saying(widgets.HBox, f"{doing} …")([bar, words]), display_id=True)
    shown = began = time.monotonic()

    def tell(done: float) -> None:
        nonlocal shown
        now = time.monotonic()
        if done < total and now - shown < 0.2:
            return
        shown, bar.value = now, done
        left = (now - began) * (total - done) / done if done else 0.0
        words.value = f"{doing}: about {left:.0f} s left"
        if done >= total and place is not None:  # a saved notebook keeps words, but no bar
            place.update({"text/plain": f"{doing}: done"}, raw=True)

    return tell


def _saying(box: type[Any], words: str) -> type[Any]:
    """A box whose text is readable where no widget can be shown."""
    return type(box.__name__, (box,), {"__repr__": lambda self: words})
