"""The landing page's film: the scenes with their captions, and the film in the page.

`book/_tools/make_film.py` takes the pictures.
"""

from __future__ import annotations

from html import escape
from pathlib import Path

from IPython.display import HTML

FILM = Path(__file__).parents[1] / "static/film.mp4"
POSTER = FILM.with_suffix(".jpg")
SCENES: dict[str, tuple[int, str]] = {
    "pull": (
        12,
        "The live arm in a page of this book: a mouse pulls the hand from its circle, and the "
        "impedance controller lets it give way and brings it back.",
    ),
    "gain": (
        10,
        "A gain is changed. Each time the whole run is computed again, and the curve of the run "
        "before stays behind the new one.",
    ),
    "stub": (
        16,
        "A student has written the joint velocity controller without feed-forward. The check "
        "says which tests failed, and names the mistake.",
    ),
    "feedback": (
        9,
        "After the deadline one command grades the class, and each student receives a page.",
    ),
    "table": (
        6,
        "In the last notebook the five controllers are compared on four trajectories.",
    ),
    "notebooks": (7, "Eight notebooks, with their hours and points."),
}
"""The duration of each scene, in [s], and its caption."""


def captions() -> list[tuple[int, int, str]]:
    """The start and the end of each scene, in [s], and its caption."""
    found, t = [], 0
    for seconds, words in SCENES.values():
        found.append((t, t + seconds, words))
        t += seconds
    return found


def film() -> HTML:
    """The film, which loads when it is played, its captions, and the captions as a list."""
    lines = "".join(
        f'<li data-from="{start}" data-until="{end}">{escape(words)}</li>'
        for start, end, words in captions()
    )
    size = f"{captions()[-1][1]} seconds, {FILM.stat().st_size / 1e6:.1f} MB"
    return HTML(
        f'<figure class="lab-figure lab-film"><video class="lab-svg" controls playsinline '
        f'preload="none" poster="_static/{POSTER.name}" src="_static/{FILM.name}" '
        'width="800" height="608" aria-label="Film: the laboratory in a minute"></video>'
        f"<figcaption>The laboratory in a minute: {size}, without sound, loaded when you play it. "
        f"<details><summary>The film in words</summary><ol>{lines}</ol></details></figcaption>"
        "</figure>"
    )
