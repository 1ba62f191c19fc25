"""Make the README's picture of Baxter drawing a line, with labkit's own camera.

Run: python book/_tools/make_picture.py   (writes book/static/baxter.png)
"""

from __future__ import annotations

import argparse
from pathlib import Path

import cv2
import numpy as np
from PIL import Image

import labkit as lk
from labkit.trajectory import PosePath
from solutions.study.workspace_velocity import WorkspaceVelocityPD

OUT = Path(__file__).parents[2] / "book/static/baxter.png"
WIDTH, HEIGHT, FINE = 1000, 600, 2
EYE, AT = (2.45, 0.95, 1.05), (0.3, 0.0, 0.17)
PAPER, RED, GREY = (248, 247, 244), (178, 24, 43), (90, 90, 90)


def main() -> None:
    """Run along the line, take a picture of the arm near its end, and draw the tip's path."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    world = lk.World(things=[lk.Table(height=0.015, centre=(0.85, 0.25), size=(0.7, 1.1))])
    with lk.Arm("left", world=world) as arm:
        arm.reset(arm.robot.ready)
        T_wt = arm.model.pose(arm.robot.ready)
        start, goal = (T_wt[:3, 3] + np.array([0.05, y, 0.0]) for y in (0.15, -0.25))
        first = np.array(T_wt)
        first[:3, 3] = start
        arm.reset(arm.model.inverse_kinematics(first, arm.robot.ready))
        line = lk.Trajectory(PosePath(lk.Line(start, goal), T_wt[:3, :3]), lk.Quintic(3.0))
        log = lk.run(arm, line, WorkspaceVelocityPD(arm.model), duration=2.4)
        tip = lk.metrics.tip_poses(log)[:, :3, 3]
        lens = lk.Intrinsics(FINE * WIDTH, FINE * HEIGHT, FINE * 930.0, FINE * 930.0)
        camera = lk.Camera(world, lk.looking_at(EYE, AT), lens)
        picture = np.array(camera.image())
        T_cw = np.linalg.inv(camera.T_wc)
    picture[(picture == 255).all(axis=2)] = PAPER
    for points, colour, width in ((np.linspace(start, goal, 2), GREY, 4), (tip, RED, 9)):
        pixels = lens.project(points @ T_cw[:3, :3].T + T_cw[:3, 3])
        drawn = np.rint(8 * pixels).astype(np.int32).reshape(-1, 1, 2)
        cv2.polylines(picture, [drawn], False, colour, width, cv2.LINE_AA, shift=3)
    small = cv2.resize(picture, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)
    OUT.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(small).quantize(192).save(OUT, optimize=True)
    print(f"{OUT}: {OUT.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
