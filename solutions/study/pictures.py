"""The report's tracking figures, 4 to 23, with the axes that belong there; a video of each task."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib

from labkit import plotting

from .campaign import FIVE, TASKS, joints, perform
from .film import film
from .grid import cells
from .tag_task import staged


def grid(folder: Path) -> list[dict[str, Any]]:
    """Cells of the figures: five controllers on every task."""
    return cells(way=FIVE, task=TASKS, folder=(str(folder),))


def draw(way: str, task: str, folder: str) -> Mapping[str, Any]:
    """The job: run once on Baxter's plant, draw everything, say in words what is to be seen.

    Returns:
        "figure", the report's number of it; "file", its name; "alt", the figure in words.
    """
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    number = 4 + 4 * FIVE.index(way) + TASKS.index(task)
    log = perform(way, task, "baxter", 0)
    figure = plotting.overview(log, joints=joints(way, task, 0), title=f"{way}, {task}, baxter arm")
    name = f"figure_{number:02d}_{way.replace(' ', '_')}_{task}.png"
    figure.savefig(Path(folder) / name, dpi=90)
    plt.close(figure)
    return {"figure": number, "file": name, "alt": f"{task}: {plotting.describe(log)}"}


def film_grid(folder: Path) -> list[dict[str, Any]]:
    """Cells of the videos: one for each task."""
    return cells(task=TASKS, folder=(str(folder),))


def shoot(task: str, folder: str) -> Mapping[str, Any]:
    """The job: film joint velocity control of a task on Baxter's plant.

    Returns:
        "file" and "poster", their names; "alt", the film in words.
    """
    log = perform("joint velocity", task, "baxter", 0)
    stage = (lambda world: staged(world, 0)) if task == "tag" else None
    path = Path(folder) / f"{task}.mp4"
    poster = film(log, path, stage=stage)
    return {"file": path.name, "poster": poster.name, "alt": f"{task}: {plotting.describe(log)}"}
