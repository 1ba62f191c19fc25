"""From nothing to an arm that can be used, each time in a process of its own."""

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
TIMES = 7


def measure():
    """Seconds to import labkit and to make an arm, the best of several."""
    rows = [
        subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True)
        for _ in range(TIMES)
    ]
    imports, arms = zip(*(map(float, row.stdout.split()) for row in rows), strict=True)
    return {"import_s": min(imports), "arm_ready_s": min(arms)}
