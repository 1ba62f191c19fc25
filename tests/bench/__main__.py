"""Measure, print and write build/bench.json: `python -m tests.bench`, or one alone.

A measurement is a file here with a function ``measure() -> {key: number or None}`` and an entry in
`MEASUREMENTS`.  The first line of the function's docstring says what the numbers are.
"""

import argparse
import json
import sys
from pathlib import Path

from . import (
    closed_loop,
    costs,
    grading,
    names,
    notebooks,
    start,
    viewer,
)

ROOT = Path(__file__).parents[2]
sys.path += [str(ROOT / "book"), str(ROOT / "book/_tools")]  # the viewer is measured in pages

MEASUREMENTS = (
    start,
    closed_loop,
    viewer,
    notebooks,
    names,
    grading,
    costs,
)
OUT = Path("build/bench.json")


def main(arguments=()):
    """Take the measurements in turn; if one fails, say so and leave its keys out.

    Args:
        arguments: Names of measurements, which are then only printed; by default all are taken.
    """
    known = {module.__name__.rpartition(".")[2]: module for module in MEASUREMENTS}
    parser = argparse.ArgumentParser(prog="python -m tests.bench", description="Measure speeds.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"by default {', '.join(known)}")
    names = parser.parse_args(arguments).names
    for name in set(names) - set(known):
        parser.error(f"no measurement {name}; there is {', '.join(known)}")
    figures, failed = {}, []
    for module in [known[name] for name in names] or MEASUREMENTS:
        print(module.measure.__doc__.splitlines()[0])
        try:
            measured = module.measure()
        except Exception as error:  # the other measurements are still wanted
            failed.append(module.__name__)
            print(f"  failed: {type(error).__name__}: {error}", file=sys.stderr, flush=True)
            continue
        for key, value in measured.items():
            figures[key] = None if value is None else float(f"{value:.4g}")
            print(f"  {key:30s}{'not here' if value is None else f'{value:.4g}'}", flush=True)
    if not names:
        OUT.parent.mkdir(exist_ok=True)
        OUT.write_text(json.dumps(figures, indent=1) + "\n")
        print(f"written to {OUT}")
    if failed:
        sys.exit(f"without {', '.join(failed)}, which failed")


if __name__ == "__main__":
    main(sys.argv[1:])
