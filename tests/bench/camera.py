"""The time for a picture and for a detection: `python -m tests.bench camera`."""

import time

import cv2
import numpy as np

import labkit as lk
from labkit import se3
from labkit.tags import Board
from labkit.tags.camera import BACKGROUND

EYE, AT = (1.5, 0.3, 0.7), (0.85, 0.3, -0.26)
"""The positions of the measured frame's camera and of the point that it looks at."""


def quickest(action, rounds=15):
    """The least time of an action on one core, in [ms], because other work only adds time."""
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    times = []
    for _ in range(rounds):
        start = time.process_time()
        action()
        times.append(time.process_time() - start)
    cv2.setNumThreads(threads)
    return 1e3 * min(times)


def measure():
    """Milliseconds for a full frame, for a fast one of the tag alone, and for a detection."""
    world = lk.World(things=[lk.Table()])
    with lk.Arm("left", world=world, q0=lk.robot("left").ready):
        T_wm = se3.pose(se3.rotation(np.array([0.0, 0.0, 0.3])), np.array([0.8, 0.25, -0.2]))
        Board(world, lk.Tag(), T_wm)
        camera = lk.Camera(world, lk.looking_at(EYE, AT))
        frame = camera.image()
        covered = float((frame != BACKGROUND).any(axis=2).mean())
        tint, wood = frame / np.maximum(frame.max(axis=2, keepdims=True), 1), lk.Table().colour[:3]
        table = np.abs(tint - np.divide(wood, max(wood))).max(axis=2) < 0.03
        figures = {
            "frame_ms": quickest(camera.image),
            "tag_frame_ms": quickest(camera.tag_image),
            "detection_ms": quickest(lambda: lk.detect_tags(frame, camera, {0: 0.1})),
        }
        if len(lk.detect_tags(frame, camera, 0.1)) != 1:
            raise RuntimeError("the measured frame does not show its tag")
    print(
        f"camera: {100 * covered:.0f} % of the pixels covered, table {100 * table.mean():.0f} %; "
        + ", ".join(f"{name} {value:.1f}" for name, value in figures.items())
    )
    return figures
