"""Measure, print and write build/bench.json: `python -m bench`, or `make bench`.

A measurement is a file here with a function ``measure() -> {key: number or None}``, whose first
line of documentation says what the numbers are.
"""

import json
from pathlib import Path

from . import campaign, closed_loop, drake, grading, realistic, start

MEASUREMENTS = (start, closed_loop, realistic, drake, campaign, grading)
OUT = Path("build/bench.json")


def main():
    """Take every measurement in turn."""
    figures = {}
    for module in MEASUREMENTS:
        print(module.measure.__doc__.splitlines()[0])
        for key, value in module.measure().items():
            figures[key] = None if value is None else float(f"{value:.4g}")
            print(f"  {key:30s}{'not installed' if value is None else f'{value:.4g}'}", flush=True)
    OUT.parent.mkdir(exist_ok=True)
    OUT.write_text(json.dumps(figures, indent=1) + "\n")
    print(f"written to {OUT}")


if __name__ == "__main__":
    main()
