"""The whole course in miniature: release, a small class graded, the book, and where to look.

It works in ``build/demo``, a course of its own, so nothing of yours is touched.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DEMO = ROOT / "build" / "demo"
ASSIGNMENT = "01_paths"
LABKIT = str(Path(sys.executable).with_name("labkit"))


def main() -> int:
    """Run the steps one after another; stop at the first that fails."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    began = time.monotonic()
    shutil.rmtree(DEMO, ignore_errors=True)
    DEMO.mkdir(parents=True)
    shutil.copytree(
        ROOT / "solutions", DEMO / "solutions", ignore=shutil.ignore_patterns("__pycache__")
    )
    shutil.copy(ROOT / "nbgrader_config.py", DEMO)
    isolated = subprocess.run([LABKIT, "doctor"], capture_output=True).returncode == 0
    steps = [("Release the assignments", [LABKIT, "release", "--course", str(DEMO)])]
    if isolated:
        course = ["--course", str(DEMO)]
        steps += [
            (
                "A class hands in",
                [LABKIT, "make-class", ASSIGNMENT, "--seed", "1", "--count", "14", *course],
            ),
            ("Grade it, each submission in isolation", [LABKIT, "grade", ASSIGNMENT, *course]),
            ("Write feedback", [LABKIT, "feedback", ASSIGNMENT, *course]),
            ("What the class misunderstood", [LABKIT, "class-report", ASSIGNMENT, *course]),
        ]
    else:
        print("This machine cannot isolate submissions, so nothing is graded: see `make doctor`.")
    steps.append(("Build the book", [sys.executable, str(ROOT / "book/_tools/build_book.py")]))
    for number, (title, command) in enumerate(steps, start=1):
        shown = " ".join(Path(word).name if "/" in word else word for word in command)
        print(f"\n[{number}/{len(steps)}] {title}\n$ {shown}", flush=True)
        if subprocess.run(command, cwd=DEMO).returncode:
            print(f"\nStopped: step {number} failed.", file=sys.stderr)
            return 1
    print(f"\nDone in {time.monotonic() - began:.0f} s. Where to look:")
    for what, where in (
        ("the book", ROOT / "book/_build/html/index.html"),
        ("the students' notebooks", DEMO / "assignments"),
        ("solved ones, for after the deadline", DEMO / "build/course/solution"),
        ("marks with reasons", DEMO / "results" / ASSIGNMENT),
        ("feedback for each student", DEMO / "feedback"),
    ):
        if where.exists():
            print(f"  {what}: {where.relative_to(ROOT)}")
    print("Next: `make lab` opens the notebooks, `make help` lists the rest.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
