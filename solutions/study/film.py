"""Make a film of a log, as a camera beside the table would have seen it (needs imageio-ffmpeg).

A `labkit.Camera` draws the robot from its meshes, frame by frame.  A dot with a trace shows the
target of the tip.  A poster is the picture in the middle of the run.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from labkit import Arm, Camera, Intrinsics, Log, Table, World, looking_at, metrics
from labkit.errors import OutOfRange
from labkit.shapes import Array, as_number
from labkit.tags.tag import Picture

EYE, AT = (1.7, 1.15, 0.7), (0.45, 0.2, 0.2)
"""Where the camera is and what it looks at, world axes, in [m]."""
LENS = Intrinsics(width=640, height=480, fx=540.0, fy=540.0)


def frames(
    log: Log,
    rate: float = 15.0,
    *,
    stage: Callable[[World], Any] | None = None,
    lens: Intrinsics = LENS,
) -> Sequence[Picture]:
    """Pictures of a run.

    Args:
        log: The run.
        rate: Pictures per second.
        stage: Adds other objects to the world, such as a tag that moves with its clock.
        lens: The lens of the camera.

    Returns:
        Colours in RGB order, (height, width, 3) each.
    """
    as_number(rate, "rate", above=0.0)
    if len(log) < 2:
        raise OutOfRange("this log has no duration; a film needs a run of at least two ticks")
    times = np.arange(0.0, log.t[-1], 1.0 / rate)
    wanted = metrics.target_poses(log)[:, :3, 3]
    pictures = []
    with World(things=(Table(),)) as world:
        arm = Arm(log.robot, log.plant, world=world)
        if stage is not None:
            stage(world)
        camera = Camera(world, looking_at(EYE, AT), lens, samples=1)
        for t in times:
            world.step(max(0, round((t - world.t) / world.dt)))
            arm.reset(_at(t, log.t, log.q))
            picture = np.array(camera.image())
            _trace(picture, camera, wanted[log.t <= t])
            pictures.append(picture)
    return pictures


def film(log: Log, path: Path, rate: float = 15.0, **options: Any) -> Path:
    """Write a run as an mp4, and its poster beside it as a png.

    Args:
        log: The run.
        path: The file to write, with the ending ``.mp4``.
        rate: Pictures per second.
        **options: Options of `frames`.

    Returns:
        The poster's path.
    """
    try:
        import imageio.v3 as imageio
        import imageio_ffmpeg  # noqa: F401 - imageio finds it by itself
    except ModuleNotFoundError as missing:
        raise ModuleNotFoundError(
            f'a film needs {missing.name}, which is not installed: pip install "labkit[book]"',
            name=missing.name,
        ) from missing
    pictures = frames(log, rate, **options)
    imageio.imwrite(path, np.array(pictures), fps=rate, codec="libx264", macro_block_size=16)
    poster = path.with_suffix(".png")
    imageio.imwrite(poster, pictures[len(pictures) // 2])
    return poster


def _at(t: float, times: Array, rows: Array) -> Array:
    return np.array([np.interp(t, times, column) for column in rows.T])


def _trace(picture: Picture, camera: Camera, places: Array) -> None:
    """Draw the trace of the target, and its present place as a larger dot."""
    lens, T_wc = camera.intrinsics, camera.T_wc
    ends = np.linspace(0, len(places) - 1, 4 * lens.width)
    close = np.array([np.interp(ends, np.arange(len(places)), x) for x in places.T]).T
    pixels = np.round(lens.project((close - T_wc[:3, 3]) @ T_wc[:3, :3])).astype(int)
    _stamp(picture, np.unique(pixels, axis=0), 1)
    _stamp(picture, pixels[-1:], 4)


def _stamp(picture: Picture, pixels: Any, radius: int) -> None:
    """Colour the parts in the picture of discs around pixels (column, row)."""
    x, y = np.mgrid[-radius : radius + 1, -radius : radius + 1]
    disc = np.column_stack([x.ravel(), y.ravel()])
    disc = disc[(disc**2).sum(axis=1) <= radius * (radius + 0.5)]
    column, row = (pixels[:, None] + disc).reshape(-1, 2).T
    seen = (column >= 0) & (row >= 0) & (column < picture.shape[1]) & (row < picture.shape[0])
    picture[row[seen], column[seen]] = _BLUE


_BLUE = (30, 90, 220)
