"""The first line of every notebook: is everything here, and does the arm move?"""

from __future__ import annotations

import platform
import sys
from importlib.metadata import version

import numpy as np
import psutil

from . import __version__
from .arm import Arm
from .controllers import feedforward
from .errors import LabkitError
from .motion import Trajectory
from .paths import Line
from .run import run
from .scalings import Quintic


def ready() -> None:
    """Move the simulated arm once and print one line that says so.

    Raises:
        LabkitError: The arm did not move as it should.
    """
    moved = _nudge()
    free = psutil.virtual_memory().available / 2**30
    engines = ", ".join(f"{name} {version(name)}" for name in ("pybullet", "pin"))
    print(  # short enough for one line of a notebook beside its file browser
        f"labkit {__version__}: the arm moved {moved:.0f} mm; Python {platform.python_version()}, "
        f"{sys.platform} {platform.machine()}, {engines}, {free:.0f} GB free"
    )


def _nudge() -> float:
    """How far the tip goes, in [mm], when the shoulder turns by a tenth of a radian."""
    with Arm() as arm:
        q0 = arm.state().q
        turn = Trajectory(Line(q0, q0 + 0.1 * np.eye(7)[0]), Quintic(0.5))
        log = run(arm, turn, feedforward)
        a, b = (arm.model.pose(q)[:3, 3] for q in (log.q[0], log.q[-1]))
        off = np.abs(log.q[-1] - turn(0.5).position).max()
    if off > 0.01:
        raise LabkitError(f"the arm ended {off:.3f} rad from where it was sent; reinstall labkit")
    return float(1e3 * np.linalg.norm(b - a))
