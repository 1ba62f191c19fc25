"""The whole course in miniature: make a release, grade a small class and build the book.

It works in ``build/demo``, which is a separate course, so it does not touch your files.  It fails
if the class could not be graded, or if a submission does not get the mark that it deserves.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import time
from pathlib import Path

from labkit.course.authoring.layout import Course

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
from tests.synthetic import differences  # noqa: E402

DEMO = ROOT / "build" / "demo"
ASSIGNMENT = "01_paths"
REPORT = DEMO / "class_report.md"
LABKIT = str(Path(sys.executable).with_name("labkit"))
SYNTHETIC = [sys.executable, "-m", "tests.synthetic"]
COURSE = ["--course", str(DEMO)]
GRADING = (
    (
        "Let a class hand in its notebooks",
        [*SYNTHETIC, ASSIGNMENT, "--seed", "1", "--count", "14", *COURSE],
    ),
    ("Grade the class, each submission in isolation", [LABKIT, "grade", ASSIGNMENT, *COURSE]),
    ("Compare the marks with those that are deserved", [sys.executable, __file__, "--compare"]),
    ("Write feedback", [LABKIT, "feedback", ASSIGNMENT, *COURSE]),
    (
        "Report what the class misunderstood",
        [LABKIT, "class-report", ASSIGNMENT, "--to", str(REPORT), *COURSE],
    ),
)


def main(arguments: list[str] | None = None) -> int:
    """Run the steps one after another; stop at the first one that fails."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--compare", action="store_true", help="only compare the marks")
    if parser.parse_args(arguments).compare:
        return compare()
    began = time.monotonic()
    set_up()
    doctor = subprocess.run([LABKIT, "doctor"], capture_output=True, text=True)
    steps = [
        ("Release the assignments", [LABKIT, "release", *COURSE]),
        *(GRADING if doctor.returncode == 0 else ()),
        ("Build the book", [sys.executable, str(ROOT / "book/_tools/build_book.py")]),
    ]
    for number, (title, command) in enumerate(steps, start=1):
        shown = " ".join(word.removeprefix(f"{ROOT}/") for word in command)
        print(f"\n[{number}/{len(steps)}] {title}\n$ {shown}", flush=True)
        if subprocess.run(command, cwd=ROOT).returncode:
            print(f"\nStopped: step {number} failed.", file=sys.stderr)
            return 1
    say_where_to_look(time.monotonic() - began)
    if doctor.returncode:
        print(f"\nNo class was graded: `labkit doctor` fails.\n{doctor.stdout}", file=sys.stderr)
        return 1
    return 0


def set_up() -> None:
    """Make the course of the demo again, from the sources of this course."""
    shutil.rmtree(DEMO, ignore_errors=True)
    DEMO.mkdir(parents=True)
    no_bytecode = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "solutions", DEMO / "solutions", ignore=no_bytecode)
    shutil.copy(ROOT / "nbgrader_config.py", DEMO)


def compare() -> int:
    """Print the students whose mark is not what their submission deserves."""
    wrong = list(differences(Course(DEMO), ASSIGNMENT))
    print("\n".join(wrong) or "Every mark is what its submission deserves.")
    return 1 if wrong else 0


def say_where_to_look(seconds: float) -> None:
    """Print where the files are that were made."""
    print(f"\nDone in {seconds:.0f} s. Where to look:")
    for what, where in (
        ("the book", ROOT / "book/_build/html/index.html"),
        ("the students' notebooks", DEMO / "assignments"),
        ("the solved notebooks, for after the deadline", DEMO / "build/course/solution"),
        ("the marks with their reasons, as data", DEMO / "results" / ASSIGNMENT),
        ("the feedback for each student", DEMO / "feedback"),
        ("what the class misunderstood", REPORT),
        ("the guide for instructors", ROOT / "book/_build/html/instructor_guide.html"),
    ):
        if where.exists():
            print(f"  {what}: {where.relative_to(ROOT)}")
    explain = ".venv/bin/labkit explain 01_paths student-001 trapezoid --course build/demo"
    print(f"Next: `{explain}` says why a mark is what it is,")
    print("`make lab` opens the notebooks, and `make help` lists the rest.")


if __name__ == "__main__":
    sys.exit(main())
