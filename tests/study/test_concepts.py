"""The concept test: each key is computed, each distractor is a known mistake or says why."""

from __future__ import annotations

import re
import tomllib

import numpy as np
import pytest
from courses import ROOT

import labkit as lk
from labkit.course.authoring.layout import OUTCOMES, Course
from solutions.study.concepts import FILE, paper

COURSE = Course(ROOT)
ITEMS = tomllib.loads(FILE.read_text(encoding="utf-8"))["item"]
FORMS = ("a", "b")
NUMBER = re.compile(r"[-−]?\d+(?:\.(\d+))?")


def turn(angle):
    """The orientation error in world axes of a tool whose x axis is the world's ±y axis."""
    actual = lk.se3.rotation([0, 0, np.sign(angle) * np.pi / 2])
    return lk.se3.orientation_error(actual @ lk.se3.rotation([abs(angle), 0, 0]), actual)


def in_a(origin, degrees):
    """The point (1, 0, 0) of a frame at ``origin`` that is turned about z."""
    return origin + lk.se3.rotation([0, 0, np.radians(degrees)]) @ [1.0, 0.0, 0.0]


def peak(scaling, distance=1.0):
    """The largest acceleration of a motion along a line of that length."""
    t = np.linspace(0.0, scaling.duration, 2001)
    return distance * max(abs(scaling(x)[2]) for x in t)


def same_peak(duration, known, other):
    """The peak of a motion that has a known one, over another duration."""
    return [known * peak(lk.Quintic(other)) / peak(lk.Quintic(duration))]


def torques(factor):
    """How many times the Coriolis torques are as large at another speed, and gravity's."""
    model = lk.Model("left")
    q, dq = model.robot.ready, 0.1 * np.arange(1, 8)
    slow, fast = (model.coriolis(q, k * dq) @ (k * dq) for k in (1, factor))
    return [float(fast @ slow / (slow @ slow)), 1.0]


def velocity_loop(kp, kd, speed=0.0, start=0.0, duration=6.0):
    """The error of a joint that moves at exactly kp e + kd de/dt, by Euler's steps of a ms."""
    e, dt, errors = start, 1e-4, []
    for _ in range(int(duration / dt)):
        e += dt * (speed - kp * e) / (1.0 + kd)
        errors.append(e)
    return np.array(errors)


def rate(kp, kd):
    errors = velocity_loop(kp, kd, start=1.0, duration=1.0)
    return [-np.log(errors[-1])]


def on_wall(depth, tip, wall):
    """The force where the spring of the tip and that of the wall balance."""
    x = np.linspace(0.0, depth, 100_001)
    rest = x[np.argmin(abs(tip * (depth - x) - wall * x))]
    return [wall * rest]


def interval(mean, deviation, n, t):
    half = t * deviation / np.sqrt(n)
    return [mean - half, mean + half]


COMPUTED = {
    "turn in world axes": lambda: (turn(0.1), turn(-0.2)),
    "a point in another frame": lambda: (in_a([1, 0, 0], 90), in_a([0, 2, 0], -90)),
    "the price of smoothness": lambda: (
        [peak(lk.Quintic(1.0), 0.5)],
        [peak(lk.Cubic(2.0), 0.8)],
    ),
    "another duration": lambda: (same_peak(2.0, 1.2, 4.0), same_peak(3.0, 0.4, 1.5)),
    "force and torque": lambda: ([0.5 * 10], [0.4 * 20]),  # the power is the same on both sides
    "torques at another speed": lambda: (torques(2.0), torques(3.0)),
    "what D does to a velocity loop": lambda: (rate(3.0, 2.0), rate(8.0, 3.0)),
    "without feed-forward": lambda: (
        [velocity_loop(4.0, 0.0, 0.2)[-1]],
        [velocity_loop(5.0, 0.0, 0.5)[-1]],
    ),
    "a spring and a wall": lambda: (on_wall(0.04, 1000, 3000), on_wall(0.05, 1000, 4000)),
    "age, not noise": lambda: ([100 * 0.08], [250 * 0.04]),
    "decided or not": lambda: (interval(2, 2, 5, 2.776), interval(3, 3, 4, 3.182)),
}


@pytest.mark.parametrize("name", COMPUTED)
def test_the_right_answer_is_what_comes_out(name):
    """To the last digit that is printed, in both forms; no wrong answer says the same."""
    (item,) = [x for x in ITEMS if x["name"] == name]
    for wording, computed in zip((item["a"], item["b"]), COMPUTED[name](), strict=True):
        printed = [(float(m[0].replace("−", "-")), 0.5001 * 0.1 ** len(m[1] or ""))
                   for m in NUMBER.finditer(wording["right"].replace("m/s²", ""))]  # fmt: skip
        assert len(printed) == len(computed)
        for (value, digit), number in zip(printed, computed, strict=True):
            assert abs(value - number) <= digit, (name, wording["right"], computed)
        assert len({wording["right"], *wording["wrong"]}) == 4


def test_every_distractor_has_its_reason():
    """A name of a question is that of one of its known mistakes; a quarter are such."""
    known = {f"{p.name}: {w.name}" for name in COURSE.names() for p in COURSE.problems(name)
             for w in p.wrong}  # fmt: skip
    reasons = [reason for item in ITEMS for reason in item["because"]]
    named = [reason for reason in reasons if re.match(r"\w+: ", reason)]
    assert set(named) <= known | {x for x in named if x.endswith(".")}
    assert sum(reason in known for reason in reasons) >= 9


def test_a_form_has_all_items_and_its_key_uses_all_letters():
    """Twelve items for all outcomes; no letter is the key too often."""
    assert len(ITEMS) == 12 and {item["outcome"] for item in ITEMS} == set(OUTCOMES)
    for form in FORMS:
        sheet, key = paper(form).split("# Key")
        assert all(item[form]["asks"] in sheet for item in ITEMS)
        letters = re.findall(r"\((\w)\): right", key)
        assert len(letters) == 12 and max(map(letters.count, "abcd")) <= 6


def test_no_public_file_has_an_item():
    """Neither what goes into the students' zip nor the book's sources."""
    parts = [text for item in ITEMS for text in (item["a"]["asks"], item["b"]["asks"])]
    places = [*ROOT.glob("assignments/*/*"), *ROOT.glob("book/**/*.md"), *ROOT.glob("book/**/*.py"),
              *ROOT.glob("labkit/**/*.py"), *ROOT.glob("labkit/**/*.j2")]  # fmt: skip
    for path in places:
        if path.is_file():
            text = path.read_text(encoding="utf-8", errors="replace")
            assert not any(part in text for part in parts), path
