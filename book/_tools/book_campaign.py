"""The data of the chapter "Comparison": a campaign of this code, either kept or run now."""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Callable, Iterator
from typing import Any

from book_pages import CACHE, CAMPAIGN, ROOT, key_of

from labkit import recordings
from solutions.study.grid import pick, work_through

JOBS = 2  # the rows do not depend on the number of jobs


def compare(progress: Callable[[str], None]) -> None:
    """Put the campaign where the pages read it.

    If this code reproduces the result of `make campaign` in build/, that result is copied.
    Otherwise each task is looked at separately: if this code reproduces a sample of the task's rows
    in labkit's data, those rows are used; if not, the task is run here with two seeds.

    Args:
        progress: Called with a few words about what is being done.
    """
    key, stamp = key_of("solutions.study.campaign"), CACHE / "campaign.key"
    if CAMPAIGN.exists() and stamp.exists() and stamp.read_text() == key:
        return
    CACHE.mkdir(parents=True, exist_ok=True)
    theirs = ROOT / "build/campaign.json"
    if theirs.exists() and not _differ(json.loads(theirs.read_text())["rows"][-1:]):
        shutil.copyfile(theirs, CAMPAIGN)
    else:
        found = _kept_or_made(progress)
        CAMPAIGN.write_text(json.dumps(found, indent=1, allow_nan=False) + "\n")
    stamp.write_text(key)


def _kept_or_made(progress: Callable[[str], None]) -> dict[str, Any]:
    from solutions.study import campaign, claims

    kept, gains, noise = (
        [row | {"failed": None} for row in recordings.campaign(name)]
        for name in ("rows", "gains", "noise")
    )
    progress("comparing the kept runs with new ones")
    changed = {row["task"] for row in _differ(list(_sample(kept)))}
    changed |= set(campaign.TASKS) - {row["task"] for row in kept}
    rows = [row for row in kept if row["task"] not in changed]
    if changed:
        progress(f"running two seeds of the campaign: {', '.join(sorted(changed))}")
        todo = [cell for cell in campaign.grid(2) if cell["task"] in changed]
        rows += work_through(campaign.numbers, todo, jobs=JOBS)
    if "line" in changed:  # which both follow
        gains = work_through(campaign.converge, campaign.gain_grid(2), jobs=JOBS)
        noise = work_through(campaign.derivative, campaign.noise_grid(2), jobs=JOBS)
    return {"rows": rows, "verdicts": [v.as_data() for v in claims.verdicts(rows, gains, noise)]}


def _sample(rows: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """One run of each controller on a path, and one run on the tag, on Baxter's arm."""
    from solutions.study.campaign import CONTROLLERS, TASKS

    paths = [task for task in TASKS if task != "tag"]
    seeds = len({row["seed"] for row in rows})
    for k, controller in enumerate(CONTROLLERS):
        yield from pick(
            rows, controller=controller, task=paths[k % len(paths)], plant="baxter", seed=k % seeds
        )
    yield from pick(rows, controller=CONTROLLERS[0], task="tag", plant="baxter", seed=0)


def _differ(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The rows that this code does not reproduce."""
    from solutions.study.campaign import numbers

    names = ("controller", "task", "plant", "seed")
    if not all(row.keys() >= set(names) for row in rows):  # an older campaign has other names
        return rows
    again = work_through(numbers, [{x: row[x] for x in names} for row in rows], jobs=JOBS)
    return [row for row, new in zip(rows, again, strict=True) if not _same(row, new)]


def _same(row: dict[str, Any], new: dict[str, Any]) -> bool:
    if "digest" in row:
        return bool(row["digest"] == new["digest"])
    told = ("late_rms_mm", "late_max_mm")  # kept to four digits
    return all(math.isclose(row[x], new[x], rel_tol=1e-3) for x in told)
