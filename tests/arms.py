"""Two arms that are not Baxter's, from example-robot-data: a UR5 and a Panda."""

import sysconfig
from pathlib import Path

import labkit as lk

DATA = Path(sysconfig.get_path("purelib")) / "cmeel.prefix/share/example-robot-data/robots"
FILES = {
    "ur5": DATA / "ur_description/urdf/ur5_robot.urdf",
    "panda": DATA / "panda_description/urdf/panda.urdf",
}
READY = {
    "ur5": [0.0, -1.2, 1.8, -2.2, -1.57, 0.0],
    "panda": [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785],
}
TIPS = {"ur5": "tool0", "panda": "panda_hand_tcp"}


def arm(name):
    """The robot of one of the two arms."""
    return lk.Robot.from_urdf(FILES[name], tip=TIPS[name], ready=READY[name])
