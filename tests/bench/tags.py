"""A tag's pose, and OpenCV's: `python -m tests.bench.tags [SEED]` writes build/tags.json.

Nothing here is fitted: the poses come from the seed and the true values from the simulation.
"""

import json
import sys
from pathlib import Path

import cv2
import numpy as np

from labkit.tags.detection import tag_pose
from labkit.tags.tag import PATTERNS
from solutions.study.sensing import Setup, pictures, random_poses, read

TILT = (0.26, 1.05)
NOISE = 3.0
OUT = Path("build/tags.json")
CONDITIONS = {
    "sharp": {"optics": {"noise": 0.0}},
    "noise 3": {},
    "noise 10": {"optics": {"noise": 10.0}},
    "light falls 20 %": {"optics": {"shade": 0.2}},
    "light falls 60 %": {"optics": {"shade": 0.6}},
    "vignetting 50 %": {"optics": {"vignette": 0.5}},
    "gamma 0.7": {"optics": {"gamma": 0.7}},
    "gamma 1.4": {"optics": {"gamma": 1.4}},
    "blur 1 px": {"optics": {"blur": 1.0}},
    "blur 2 px": {"optics": {"blur": 2.0}},
    "smear 3 px": {"smear": 3.0},
    "smear 6 px": {"smear": 6.0},
    "JPEG 60": {"optics": {"jpeg": 60}},
    "12 px a side": {"distance": 4.3},
}


def setup(name):
    """The experiment of a condition, with a noise of 3 grey levels if it does not say another."""
    dials = CONDITIONS[name]
    return Setup(tilt=TILT, **(dials | {"optics": {"noise": NOISE} | dials.get("optics", {})}))


def found_by_opencv(picture, refinement=cv2.aruco.CORNER_REFINE_NONE):
    """OpenCV's own corners of each tag in a picture, by number."""
    settings = cv2.aruco.DetectorParameters()
    settings.cornerRefinementMethod = refinement
    detector = cv2.aruco.ArucoDetector(PATTERNS, settings)
    corners, numbers, _ = detector.detectMarkers(cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY))
    numbers = [] if numbers is None else numbers.ravel().tolist()
    return {n: c.reshape(4, 2) for n, c in zip(numbers, corners, strict=True)}


def row(name, count=30, seed=1):
    """Found, median and largest error [mm] and NEES: ours, and OpenCV's AprilTag refinement."""
    experiment = setup(name)
    poses = random_poses(experiment, count, np.random.default_rng(seed))
    readings = read(experiment, poses, seed)
    plain, theirs = np.zeros(count, bool), []
    for i, picture in enumerate(pictures(experiment, poses, seed)):
        plain[i] = experiment.tag.id in found_by_opencv(picture)
        fine = found_by_opencv(picture, cv2.aruco.CORNER_REFINE_APRILTAG)
        if experiment.tag.id in fine:
            corners = fine[experiment.tag.id] - 0.5  # it counts pixels from their corners
            T = tag_pose(corners, experiment.intrinsics, experiment.tag.size)
            theirs.append(1e3 * np.linalg.norm((poses[i] - T)[:3, 3]))
    e, P = readings.error, readings.covariance[readings.found]
    ours = 1e3 * np.linalg.norm(e[:, :3], axis=1)
    return {
        "found": int(readings.found.sum()),
        "missed": int((plain & ~readings.found).sum()),
        "median_mm": float(np.median(ours)),
        "max_mm": float(ours.max()),
        "nees": float(np.einsum("ni,ni->n", e, np.linalg.solve(P, e[..., None])[..., 0]).mean()),
        "opencv": {
            "found": int(plain.sum()),
            "refined": len(theirs),
            "median_mm": float(np.median(theirs)) if theirs else None,
            "max_mm": float(max(theirs)) if theirs else None,
        },
    }


def right(name, one):
    """Whether a row is as good as it should be."""
    theirs = one["opencv"]["median_mm"] or np.inf
    sharp = name.startswith(("sharp", "noise 3", "light", "vignetting"))
    enough = max(0.12, theirs / 3.0) if sharp else theirs
    return not one["missed"] and one["median_mm"] <= enough and 3.0 <= one["nees"] <= 12.0


def main(seed=1):
    """Measure, write the file, and say which rows are not right."""
    rows = {name: row(name, seed=seed) for name in CONDITIONS}
    OUT.parent.mkdir(parents=True, exist_ok=True)
    OUT.write_text(json.dumps({"seed": seed, "rows": rows}, indent=1) + "\n", encoding="utf-8")
    print("30 pictures each: found, median, max [mm], NEES | OpenCV: found, refined, median, max")
    for name, one in rows.items():
        numbers, theirs = (
            [f"{x or 0:6.3g}" for x in part]
            for part in (
                [one[key] for key in ("found", "median_mm", "max_mm", "nees")],
                one["opencv"].values(),
            )
        )
        print(f"{name:18}", *numbers, "|", *theirs, "" if right(name, one) else "not right")
    return not all(right(name, one) for name, one in rows.items())


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
