"""Measure, print and write build/bench.json: `python -m bench`, or `make bench`.

A measurement is a file here with a function ``measure() -> {key: number or None}``, whose first
line of documentation says what the numbers are.
"""

import json
import sys
from pathlib import Path

from . import camera, campaign, closed_loop, drake, grading, notebooks, realistic, start, viewer

MEASUREMENTS = (
    start,
    closed_loop,
    realistic,
    drake,
    campaign,
    camera,
    viewer,
    notebooks,
    grading,
)
OUT = Path("build/bench.json")


def main():
    """Take every measurement in turn; one that fails says so and leaves its keys out."""
    figures, failed = {}, []
    for module in MEASUREMENTS:
        print(module.measure.__doc__.splitlines()[0])
        try:
            measured = module.measure()
        except Exception as error:  # whatever it is, the others are still wanted
            failed.append(module.__name__)
            print(f"  failed: {type(error).__name__}: {error}", file=sys.stderr, flush=True)
            continue
        for key, value in measured.items():
            figures[key] = None if value is None else float(f"{value:.4g}")
            print(f"  {key:30s}{'not here' if value is None else f'{value:.4g}'}", flush=True)
    OUT.parent.mkdir(exist_ok=True)
    OUT.write_text(json.dumps(figures, indent=1) + "\n")
    print(f"written to {OUT}")
    if failed:
        sys.exit(f"without {', '.join(failed)}, which failed")


if __name__ == "__main__":
    main()
