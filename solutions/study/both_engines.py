"""The campaign on every engine: ``python -m solutions.study.both_engines [--seeds 5] [--compare]``.

The campaign of each engine is written to ``build/ENGINE/campaign.json``, and each but the first is
compared with the first.  Two engines agree if every claim has the same verdict, over all tasks and
on each of them, and if the numbers in the comparison differ by at most 5 % or 0.1 mm (times by a
tick of the clock).  If they do not agree, the exit status is 1.  The outcome is written to
engines.json beside this file, for the book.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from labkit.errors import LabkitError
from labkit.sim import ENGINES, installed

from .claims import TICK

KEPT = Path(__file__).with_name("engines.json")
"""The outcome of the last comparison, for the book."""
SHARE, LEAST = 0.05, {"s": TICK}
"""How much a number may differ, relative to the larger one or in its unit (default 0.1)."""


def engines() -> list[str]:
    """The engines to compare: all that are installed.

    Raises:
        LabkitError: Only one engine is installed.
    """
    found = installed()
    if len(found) < 2:
        raise LabkitError(
            f"{len(found)} engine is installed here ({', '.join(found)}), and a comparison needs "
            f"two; type: pip install {' '.join(x for x in ENGINES if x not in found)}"
        )
    return found


def differences(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[str]:
    """A sentence for each number or verdict on which two campaigns do not agree.

    Args:
        a: The campaign of one engine, as `campaign` writes it.
        b: The campaign of the other engine.
    """
    for one, other in zip(a["verdicts"], b["verdicts"], strict=True):
        for x, y in zip((one["overall"], *one["tasks"]), (other["overall"], *other["tasks"]),
                        strict=True):  # fmt: skip
            what = f"{one['claim']}, {x['of']}"
            if x["outcome"] != y["outcome"]:
                yield f"{what}: {x['outcome']} and {y['outcome']}"
            if _apart(x["mean"], y["mean"], LEAST.get(one["unit"], 0.1)):
                yield f"{what}: {x['mean']:.4g} and {y['mean']:.4g} {one['unit']}"
    means = [_means(found["rows"]) for found in (a, b)]
    for cell in sorted(means[0].keys() | means[1].keys()):
        x, y = (mean.get(cell, np.nan) for mean in means)
        if _apart(x, y, 0.1):
            yield f"{', '.join(cell)}: {x:.4g} and {y:.4g} mm"


def agreement(a: Mapping[str, Any], b: Mapping[str, Any]) -> dict[str, float]:
    """The numbers of claims, of equal verdicts and of runs, and the two errors farthest apart."""
    pairs = list(zip(a["verdicts"], b["verdicts"], strict=True))
    means = [_means(found["rows"]) for found in (a, b)]
    alike = sum(x["overall"]["outcome"] == y["overall"]["outcome"] for x, y in pairs)
    farthest = max(abs(means[0][cell] - means[1][cell]) for cell in means[0])
    runs = len(a["rows"])
    return {"claims": len(pairs), "alike": alike, "runs": runs, "farthest_mm": farthest}


def _farthest(told: Mapping[str, float]) -> tuple[float, float]:
    """The key by which the worst pair of engines is chosen for the book."""
    return told["claims"] - told["alike"], told["farthest_mm"]


def _apart(x: float, y: float, least: float) -> bool:
    return not abs(x - y) <= max(SHARE * max(abs(x), abs(y)), least)


def _means(rows: list[dict[str, Any]]) -> dict[tuple[str, ...], float]:
    """The mean over the seeds of each number in the tables of the comparison."""
    cells: dict[tuple[str, ...], list[float]] = {}
    for row in rows:
        for name in ("late_rms_mm", "late_max_mm"):
            cell = (row["plant"], row["task"], row["controller"], name)
            cells.setdefault(cell, []).append(np.nan if row["failed"] else row[name])
    return {cell: float(np.mean(x)) for cell, x in cells.items()}


def main() -> int:
    """Run the campaigns, compare them, and print the differences."""
    parser = argparse.ArgumentParser(
        prog="python -m solutions.study.both_engines", description=__doc__
    )
    parser.add_argument("--seeds", type=int, default=5, help="how many seeds (5)")
    parser.add_argument("--compare", action="store_true", help="run nothing, compare what is there")
    options = parser.parse_args()
    first, *others = engines()
    for engine in () if options.compare else (first, *others):
        command = [sys.executable, "-m", "solutions.study", "--no-pictures"]
        command += ["--seeds", str(options.seeds), "--out", f"build/{engine}"]
        subprocess.run(command, env=os.environ | {"LABKIT_ENGINE": engine}, check=True)
    apart, told = [], []
    for engine in others:
        pair = [json.loads(Path(f"build/{x}/campaign.json").read_text()) for x in (first, engine)]
        found = [f"{first} and {engine}: {x}" for x in differences(*pair)]
        told.append(agreement(*pair))
        print(*found, sep="\n")
        print("{claims} claims and {runs} runs on each engine:".format(**told[-1]), end=" ")
        print(f"{len(found)} differences, errors to {told[-1]['farthest_mm']:.1g} mm")
        apart += found
    KEPT.write_text(json.dumps(max(told, key=_farthest)) + "\n")
    return bool(apart)


if __name__ == "__main__":
    sys.exit(main())
