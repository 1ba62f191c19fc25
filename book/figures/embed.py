"""HTML for the static book: a motion, a gain explorer or a live demo as a figure in a page.

The figure contains its data; `boot.js` loads the shared viewer and robot when it comes into sight.
Put `shared_files()` into one folder of the book and let every page load boot.js from there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from labkit.errors import OutOfRange, UnknownName
from labkit.replay import Motion
from labkit.replay.figure import VIEWER, compact, figure_html

LIMIT = 40_000  # bytes of a page for one motion


def shared_files() -> dict[str, Path]:
    """The files to put into one folder of the book, by name."""
    names = ("boot.js", "viewer.js", "robot.js", "LICENSE-three")
    return {name: VIEWER / name for name in names} | {
        "LICENSE-baxter": VIEWER.parent / "LICENSE-baxter"
    }


def motion_html(
    motion: Motion,
    *,
    caption: str = "",
    poster: str | None = None,
    root: str | None = None,
    rate: float = 25.0,
) -> str:
    """A replay as a figure.

    Args:
        motion: The motion to show.
        caption: Text under it; the motion's title if empty.
        poster: Address of a picture for print, for phones before the tap and for browsers without
            WebGL.
        root: Address of the folder with the shared files, ending in "/"; None if every page of the
            book loads boot.js already.
        rate: Samples per second.

    Returns:
        HTML without inline code.

    Raises:
        OutOfRange: The motion is too large for a page.
    """
    text = motion.to_json(rate)
    size = len(text.encode())
    if size > LIMIT:
        raise OutOfRange(
            f"the motion {motion.title!r} is {size / 1000:.0f} kB, more than"
            f" {LIMIT / 1000:.0f} kB: give fewer ghosts, a shorter run or a lower rate"
        )
    return figure_html(text, motion.description, caption or motion.title, motion.alt, poster, root)


@dataclass(frozen=True)
class Dial:
    """A choice in the explorer: numbers become a slider that stops at each, words a list.

    Attributes:
        label: The text beside the dial, such as "Kp".
        values: The values on the grid.
        unit: The unit after the number.
        value: The first value to show; None means the first of the grid.
    """

    label: str
    values: Sequence[float] | Sequence[str]
    unit: str = ""
    value: float | str | None = None


@dataclass(frozen=True)
class Explorer:
    """A grid of recorded runs.

    Attributes:
        name: Stem of the runs' file names; letters, digits and hyphens.
        title: The title of the explorer.
        dials: The axes of the grid.
        runs: Recorded motions by their indices on the axes; points may be missing.
        facts: A sentence about the results of each run, by the same indices.
    """

    name: str
    title: str
    dials: Sequence[Dial]
    runs: Mapping[tuple[int, ...], Motion]
    facts: Mapping[tuple[int, ...], str] = field(default_factory=dict)


def run_files(explorer: Explorer, rate: float = 20.0) -> dict[str, str]:
    """A small script for each recorded run, by file name; a page from disk can load a script."""
    return {
        f"{_stem(explorer, key)}.js": "(globalThis.labkitRuns??={})"
        f'["{_stem(explorer, key)}"]={motion.to_json(rate)};\n'
        for key, motion in explorer.runs.items()
    }


def explorer_html(
    explorer: Explorer,
    folder: str,
    *,
    caption: str = "",
    poster: str | None = None,
    root: str | None = None,
) -> str:
    """The explorer as a figure; its runs are loaded one by one from `folder`.

    Args:
        explorer: The grid.
        folder: Address, from the page, of the folder with `run_files`, ending in "/".
        caption: Text under it; the title if empty.
        poster: See `motion_html`.
        root: See `motion_html`.

    Returns:
        HTML without inline code.
    """
    dials = [
        {"label": d.label, "unit": d.unit, "values": list(d.values), "value": d.value}
        for d in explorer.dials
    ]
    data = {
        "kind": "explorer",
        "title": explorer.title,
        "dials": dials,
        "runs": {_key(k): f"{folder}{_stem(explorer, k)}.js" for k in explorer.runs},
        "facts": {_key(k): text for k, text in explorer.facts.items()},
    }
    names = ", ".join(d.label for d in explorer.dials)
    alt = f"{explorer.title}: {len(explorer.runs)} recorded runs to choose from by {names}."
    words = f"{alt} {_described(explorer)}"
    return figure_html(compact(data), words, caption or explorer.title, alt, poster, root)


def _described(explorer: Explorer) -> str:
    """The facts of the first point, and of the points at the other end of each dial."""
    opening = [0 if d.value is None else list(d.values).index(d.value) for d in explorer.dials]
    points = {f"It opens with {_said(explorer.dials, opening)}": tuple(opening)}
    for k, d in enumerate(explorer.dials):
        far = [*opening[:k], len(d.values) - 1, *opening[k + 1 :]]
        if far != opening:
            points[f"With {_said([d], far[k:])} instead"] = tuple(far)
    return " ".join(f"{w}: {explorer.facts[p]}" for w, p in points.items() if p in explorer.facts)


def _said(dials: Sequence[Dial], at: Sequence[int]) -> str:
    """A description of the values of dials."""
    pairs = ((d, d.values[k]) for d, k in zip(dials, at, strict=False))
    return ", ".join(
        x if isinstance(x, str) else f"{d.label} {x:g}{' ' * bool(d.unit)}{d.unit}"
        for d, x in pairs
    )


DEMOS = {
    "scaling": "Live: four time scalings of the same distance in the same time, with position,"
    " speed and acceleration plotted against time and their numbers in a table.",
    "jacobian": "Live: Baxter's arm with a slider for each joint; the tip's pose, the Jacobian as a"
    " table and its chosen column as arrows, and the manipulability.",
    "rotation": "Live: two orientations by roll, pitch and yaw; the error between them by the"
    " logarithm and by subtracting Euler angles, side by side.",
}


def demo_html(
    name: str, *, caption: str = "", poster: str | None = None, root: str | None = None
) -> str:
    """One of the live demos: "scaling", "jacobian" or "rotation".

    Args:
        name: Which.
        caption: Text under it; a description if empty.
        poster: See `motion_html`.
        root: See `motion_html`.

    Returns:
        HTML without inline code.

    Raises:
        UnknownName: There is no such demo.
    """
    if name not in DEMOS:
        raise UnknownName("demo", name, DEMOS)
    words = DEMOS[name]
    data = compact({"kind": name, "alt": words})
    return figure_html(data, words, caption or words, words, poster, root)


def _key(indices: tuple[int, ...]) -> str:
    return "-".join(map(str, indices))


def _stem(explorer: Explorer, indices: tuple[int, ...]) -> str:
    return f"{explorer.name}-{_key(indices)}"
