"""The time until an arm can be used, each time in a new process."""

import subprocess
import sys

PROGRAM = """
from time import perf_counter
start = perf_counter()
import labkit
imported = perf_counter()
labkit.Arm()
print(imported - start, perf_counter() - imported)
"""
ENGINES = """
from time import perf_counter
start = perf_counter()
import numpy, pybullet, pinocchio
print(perf_counter() - start)
"""
TIMES = 7


def measure():
    """Best seconds to import labkit and to make an arm; the import relative to the engines'."""
    imports, arms, engines = [], [], []
    for _ in range(TIMES):
        imported, arm = _printed(PROGRAM)
        imports.append(imported)
        arms.append(arm)
        engines += _printed(ENGINES)
    return {
        "import_s": min(imports),
        "arm_ready_s": min(arms),
        "import_vs_engines": min(imports) / min(engines),
    }


def _printed(program):
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    return [float(word) for word in done.stdout.split()]
