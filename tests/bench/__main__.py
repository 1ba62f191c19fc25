"""Measure, print and write build/bench.json: `python -m tests.bench`, or one alone.

A measurement is a file here with a function ``measure() -> {key: number}`` and an entry in
`MEASUREMENTS`.  The first line of the function's docstring says what the numbers are.
"""

import json
import sys
from pathlib import Path

from . import closed_loop, grading, names, notebooks

MEASUREMENTS = {
    "closed_loop": closed_loop,
    "notebooks": notebooks,
    "names": names,
    "grading": grading,
}
OUT = Path("build/bench.json")


def main(wanted):
    """Take the measurements in turn; without names take all, and write the file.

    Args:
        wanted: Names of measurements.
    """
    figures = {}
    for name in wanted or MEASUREMENTS:
        print(MEASUREMENTS[name].measure.__doc__.splitlines()[0])
        for key, value in MEASUREMENTS[name].measure().items():
            figures[key] = float(f"{value:.4g}")
            print(f"  {key:30s}{value:.4g}", flush=True)
    if not wanted:
        OUT.parent.mkdir(exist_ok=True)
        OUT.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
        print(f"written to {OUT}")


if __name__ == "__main__":
    main(sys.argv[1:])
