"""Run a job on every cell of a grid, with any number of workers.

A *cell* is a set of named parameters (``{"controller": "joint velocity PD", "seed": 0, ...}``); a
*job* is a function of these parameters that returns numbers.  All randomness in a job comes from
its cell, so the rows are the same bit for bit, whichever worker computes them, in whatever order.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from itertools import product
from multiprocessing import get_context
from typing import Any

import numpy as np

from labkit.errors import LabkitError, OutOfRange, UnknownName
from labkit.shapes import as_number

Cell = Mapping[str, Any]
Row = dict[str, Any]
Job = Callable[..., Mapping[str, Any]]
"""A module's function, so that workers find it, with a cell's parameters as keyword arguments."""
Progress = Callable[[int, int], None]
"""Called with the number of cells that are done, and the number of all cells."""


def cells(**axes: Sequence[Any]) -> list[Row]:
    """One cell for each combination of values; the last axis changes fastest.

    Raises:
        OutOfRange: An axis is empty.
    """
    for name, values in axes.items():
        if not len(values):
            raise OutOfRange(f"the grid's axis {name!r} is empty, so there is nothing to run")
    return [dict(zip(axes, values, strict=True)) for values in product(*axes.values())]


def work_through(
    job: Job,
    grid: Iterable[Cell],
    *,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> list[Row]:
    """Run ``job`` on every cell.

    A run that labkit refuses or stops (it diverged, a pose is out of reach) is a result, too: its
    row has the message under ``"failed"``, and the campaign continues.

    Args:
        job: The function to call for each cell.
        grid: The cells.
        jobs: The number of processes; None means one for each core, 1 means this process.
        progress: Called after every cell; None reports nothing.

    Returns:
        For each cell, in the order of the grid, its parameters and the numbers of the job.

    Raises:
        OutOfRange: ``jobs`` is less than 1.
    """
    todo = [dict(cell) for cell in grid]
    jobs = os.cpu_count() or 1 if jobs is None else int(as_number(jobs, "jobs", least=1))
    tell = progress or (lambda done, total: None)
    if jobs == 1:
        rows = []
        for cell in todo:
            rows.append(row_of(job, cell))
            tell(len(rows), len(todo))
        return rows
    rows = [{} for _ in todo]
    with one_thread_each(), ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        number = {pool.submit(row_of, job, cell): i for i, cell in enumerate(todo)}
        for done, future in enumerate(as_completed(number), start=1):
            rows[number[future]] = future.result()
            tell(done, len(todo))
    return rows


def row_of(job: Job, cell: Cell) -> Row:
    """The row of one cell; the message of a `LabkitError` is under ``"failed"``."""
    try:
        return {**cell, **job(**cell), "failed": None}
    except LabkitError as error:
        return {**cell, "failed": str(error)}


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Make processes started in this block use one thread, because the cells run in parallel."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    before = {name: os.environ.get(name) for name in names}
    os.environ.update(dict.fromkeys(names, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


class Meter:
    """A progress report: cells done, cells in all, and an estimate of the time left."""

    def __init__(self, what: str) -> None:
        """Call the work ``what``."""
        self.what, self.began = what, time.monotonic()

    def __call__(self, done: int, total: int) -> None:
        """Show the progress: on one line of a terminal, or in a file a line for each tenth."""
        left = (time.monotonic() - self.began) * (total - done) / done
        text = f"{self.what}: {done} of {total}, about {left:.0f} s left"
        if sys.stderr.isatty():
            print(f"\r\033[K{text}", end="\n" if done == total else "", file=sys.stderr, flush=True)
        elif done == total or done * 10 // total > (done - 1) * 10 // total:
            print(text, file=sys.stderr, flush=True)


# Reading the rows


def pick(rows: Iterable[Row], **names: Any) -> list[Row]:
    """The rows whose cells have these parameters."""
    return [row for row in rows if all(row[key] == value for key, value in names.items())]


def spread(values: Iterable[float]) -> tuple[float, float, float]:
    """The mean, the smallest and the largest of the values."""
    x = np.array(list(values), dtype=float)
    return float(x.mean()), float(x.min()), float(x.max())


def table(rows: Sequence[Row], down: str, across: str, number: str) -> str:
    """A Markdown table with the mean over all other axes, and the spread in brackets.

    If runs failed, the entry says how many of how many.

    Args:
        rows: Rows of a campaign.
        down: The axis whose values head the rows.
        across: The axis whose values head the columns.
        number: The name of the number in the table.

    Raises:
        UnknownName: The rows have no such number or axis.
    """
    known = {key for row in rows for key in row}
    for name in (down, across, number):
        if name not in known:
            raise UnknownName("column", name, sorted(known))
    heads = list(dict.fromkeys(row[across] for row in rows))
    lines = [f"| {down} | " + " | ".join(map(str, heads)) + " |", "|---" * (len(heads) + 1) + "|"]
    for name in dict.fromkeys(row[down] for row in rows):
        here = [pick(rows, **{down: name, across: head}) for head in heads]
        lines.append(f"| {name} | " + " | ".join(_entry(r, number) for r in here) + " |")
    return "\n".join(lines)


def _entry(rows: list[Row], number: str) -> str:
    if not rows:
        return "–"
    failed = sum(row["failed"] is not None for row in rows)
    if failed:
        return f"failed {failed} of {len(rows)}"
    never = sum(row[number] is None or not np.isfinite(row[number]) for row in rows)
    if never:
        return "never" if never == len(rows) else f"never in {never} of {len(rows)}"
    mean, low, high = (float(f"{x:.3g}") for x in spread(row[number] for row in rows))
    return f"{mean:g}" if low == high else f"{mean:g} [{low:g}, {high:g}]"
