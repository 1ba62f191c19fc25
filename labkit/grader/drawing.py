"""Draw the figures of the feedback page as SVG in the colours of the page, light or dark.

All numbers can be drawn.  Numbers that are not finite are left out; very large and very small ones
are divided by a power of ten, which the label of the axis names.
"""

from __future__ import annotations

import io
import re
from math import floor, log10
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
from markupsafe import Markup
from matplotlib import rc_context, rc_params_from_file
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike, NDArray

from .pages import TEMPLATES

SIZE = (6.4, 2.8)
"""The size in inches; the page scales a figure to its own width."""
PLAIN = (1e-3, 1e6)
"""Numbers are drawn without a power of ten if the largest is in this range."""
LEAST = 1e-300
"""Smaller numbers are drawn as 0."""
TEXT, GRID, NO, TIP = "#000001", "#000002", "#000003", "#000004"
"""Placeholder colours that become variables of ``feedback.css``."""
_VARIABLES = {TEXT: "var(--text)", GRID: "var(--grid)", NO: "var(--no)", TIP: "var(--tip)"}
_STYLE = rc_params_from_file(TEMPLATES / "figure.mplstyle", use_default_template=False)
_SVG = "http://www.w3.org/2000/svg"
_GROUP = f"{{{_SVG}}}g"
_LEFT_OUT = {f"{{{_SVG}}}{name}" for name in ("metadata", "style", "clipPath")}
_PLACES = {"d", "x", "y", "transform"}
_DECIMALS = re.compile(r"(?<=\.\d)\d+")
ET.register_namespace("", _SVG)
ET.register_namespace("xlink", "http://www.w3.org/1999/xlink")


def curve(
    t: ArrayLike, y: ArrayLike, labels: tuple[str, str], alt: str, limit: float | None
) -> Markup:
    """Draw a curve over time.

    Args:
        t: (n,) Times.
        y: (n,) Values.
        labels: The labels of the two axes.
        alt: A description of the figure in words.
        limit: A value for a dashed line; None for no line.
    """
    with rc_context(_STYLE):
        figure, axes = _axes()
        values, unit = _scaled(y, limit)
        axes.plot(np.asarray(t, dtype=float), values[:-1], color=NO, linewidth=2.0)
        if np.isfinite(values[-1]):
            axes.axhline(values[-1], color=TEXT, linestyle=(0, (6, 4)), linewidth=1.2)
        axes.set_ylim(bottom=float(np.nanmin(values, initial=0.0)))
        axes.set_title(labels[1] + unit, loc="left")
        axes.set_xlabel(labels[0], loc="right")
        return _svg(figure, alt)


def side_by_side(expected: ArrayLike, given: ArrayLike, alt: str) -> Markup:
    """Draw the numbers of an answer (n,) as crosses, and those expected (n,) as rings."""
    with rc_context(_STYLE):
        figure, axes = _axes()
        values, unit = _scaled(np.stack([np.asarray(expected), np.asarray(given)]), None)
        wanted, came = values[:-1].reshape(2, -1)
        number = np.arange(1, len(wanted) + 1)
        axes.vlines(number, wanted, came, colors=GRID, linewidth=1.0)
        ring: Any = {"markerfacecolor": "none", "markeredgecolor": TIP}
        axes.plot(number, wanted, "o", markersize=9.0, markeredgewidth=1.5, **ring)
        axes.plot(number, came, "x", markersize=7.0, markeredgewidth=2.0, color=NO)
        axes.xaxis.set_major_locator(MaxNLocator(6, integer=True, min_n_ticks=1))
        axes.set_xlim(0.5, max(len(number), 1) + 0.5)
        axes.set_title(unit.strip(), loc="left")
        axes.set_xlabel("number in the answer", loc="right")
        return _svg(figure, alt)


def _axes() -> tuple[Figure, Axes]:
    figure = Figure(figsize=SIZE)
    figure.set_layout_engine("none")  # the axes are placed here
    axes = figure.add_axes((0.1, 0.2, 0.87, 0.68))
    axes.yaxis.set_major_locator(MaxNLocator(4))
    return figure, axes


def _scaled(numbers: ArrayLike, limit: float | None) -> tuple[NDArray[np.float64], str]:
    """The numbers, flat and followed by the limit, scaled for drawing, and their unit."""
    flat = np.append(np.ravel(np.asarray(numbers, dtype=float)), np.nan if limit is None else limit)
    flat[~np.isfinite(flat)] = np.nan
    size = float(np.nanmax(np.abs(flat), initial=0.0))
    if size < LEAST or PLAIN[0] <= size < PLAIN[1]:
        return np.where(np.abs(flat) < LEAST, 0.0, flat), ""
    power = floor(log10(size))
    return flat / 10.0**power, f" \u00d7 1e{power}"


def _svg(figure: Figure, alt: str) -> Markup:
    """A figure as an element for a page whose content policy forbids inline styles."""
    text = io.StringIO()
    with rc_context({"svg.hashsalt": alt}):
        figure.savefig(text, format="svg", transparent=True, metadata={"Date": None})
    root = ET.fromstring(text.getvalue())
    for parent in list(root.iter()):
        for child in parent.findall("*"):
            if child.tag in _LEFT_OUT:
                parent.remove(child)
    for element in root.iter():
        about = element.attrib
        for rule in filter(None, about.pop("style", "").split(";")):
            name, _, value = map(str.strip, rule.partition(":"))
            if not name.startswith("font"):
                about[name] = _VARIABLES.get(value, value)
        for name in ("clip-path", "id") if element.tag == _GROUP else ("clip-path",):
            about.pop(name, None)
        about |= {name: _DECIMALS.sub("", about[name]) for name in _PLACES & about.keys()}
    root.attrib = {"viewBox": root.attrib["viewBox"], "role": "img", "aria-label": alt}
    return Markup(ET.tostring(root, encoding="unicode"))
