"""HTML for the static book: a motion or a live demo as a figure in a page.

The figure contains its data; `boot.js` loads the shared viewer and robot when it comes into sight.
Put `shared_files()` into one folder of the book and let every page load boot.js from there.
"""

from __future__ import annotations

from pathlib import Path

from labkit.errors import OutOfRange, UnknownName
from labkit.replay import Motion
from labkit.replay.motion import compact
from labkit.replay.player import VIEWER, figure_html

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
    data = motion.data(rate)
    size = len(compact(data).encode())
    if size > LIMIT:
        raise OutOfRange(
            f"the motion {motion.title!r} is {size / 1000:.0f} kB, more than"
            f" {LIMIT / 1000:.0f} kB: give fewer ghosts, a shorter run or a lower rate"
        )
    return figure_html(data, motion.alt, caption or motion.title, poster, root)


DEMOS = {
    "jacobian": "Live: Baxter's arm with a slider for each joint; the tip's pose, the Jacobian as a"
    " table and its chosen column as arrows, and the manipulability.",
    "rotation": "Live: two orientations by roll, pitch and yaw; the error between them by the"
    " logarithm and by subtracting Euler angles, side by side.",
}


def demo_html(
    name: str, *, caption: str = "", poster: str | None = None, root: str | None = None
) -> str:
    """One of the live demos: "jacobian" or "rotation".

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
    return figure_html({"kind": name, "alt": words}, words, caption or words, poster, root)
