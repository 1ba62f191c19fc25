"""On which systems can pip install what a student needs, without a compiler?

`make wheels` asks uv for each system and Python, with the versions in constraints.txt, writes the
table to ``.ci/wheels.md`` and prints it. README and the guide for students show that table, the
guide without its last column; a test compares the three without a network.
"""

from __future__ import annotations

import hashlib
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TABLE = ROOT / ".ci" / "wheels.md"
PINS = ROOT / "constraints.txt"
PYTHONS = ("3.11", "3.12", "3.13")
SYSTEMS = {
    "Linux on x86-64": "x86_64-unknown-linux-gnu",
    "Linux on ARM (aarch64)": "aarch64-unknown-linux-gnu",
    "macOS on Apple silicon": "aarch64-apple-darwin",
    "macOS on Intel": "x86_64-apple-darwin",
    "Windows on x86-64": "windows",
}
"""The names of the systems, and uv's names for them."""
RUN_HERE = {("Linux on x86-64", python) for python in PYTHONS}
"""The systems on which notebooks were run from the zip; on others pip's choice was only found."""
HEAD = f"""\
| system | {" | ".join(f"Python {x}" for x in PYTHONS)} | engine | install with | grading |
|---|{"---|" * len(PYTHONS)}---|---|---|
"""


def resolved(platform: str, python: str) -> set[str] | None:
    """The packages that pip would install, all from wheels; None if one of them has no wheel."""
    words = ["--quiet", "--no-config", "--no-header", "--no-annotate", "--only-binary", ":all:"]
    words += ["--constraint", str(PINS), "--python-platform", platform, "--python-version", python]
    command = ["uv", "pip", "compile", *words, str(ROOT / "pyproject.toml")]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode == 0:
        return {line.partition("==")[0] for line in done.stdout.split()}
    if "No solution found" in done.stderr:
        return None
    raise SystemExit(f"uv failed for {platform}, Python {python}: {done.stderr.strip()}")


def row(system: str, platform: str) -> str:
    """The line of the table for one system."""
    found = {python: resolved(platform, python) for python in PYTHONS}
    cells = [
        "no wheels" if packages is None else "run" if (system, python) in RUN_HERE else "resolved"
        for python, packages in found.items()
    ]
    both = [python for python, packages in found.items() if packages and "pybullet" in packages]
    by_pip = any(found.values())
    engine = f"MuJoCo; with {', '.join(both)} PyBullet too" if both else "MuJoCo"
    install = "`start.py` or pip" if by_pip else "`environment.yml` (conda-forge; not run)"
    grading = "yes" if system.startswith("Linux") else "in the container"
    return f"| {' | '.join([system, *cells, engine, install, grading])} |\n"


def asked() -> str:
    """A hash of the question to uv, which is the students' packages and their versions."""
    needed = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    names = {re.split(r"[^\w-]", line)[0] for line in needed}
    pins = [pin for pin in PINS.read_text().split() if pin.partition("==")[0] in names]
    return hashlib.sha256("\n".join([*needed, *pins]).encode()).hexdigest()[:16]


def main() -> None:
    """Ask uv, then write the table and print it."""
    table = HEAD + "".join(row(*system) for system in SYSTEMS.items())
    TABLE.write_text(f"<!-- make wheels; asked: {asked()} -->\n{table}")
    print(table, end="")


if __name__ == "__main__":
    sys.exit(main())
