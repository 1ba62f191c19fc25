"""All attacks by their goals, and the sample that the gate runs."""

from __future__ import annotations

from soak.attacks.attack import Attack
from soak.attacks.grader import GRADER
from soak.attacks.others import OTHERS
from soak.attacks.points import POINTS
from soak.attacks.secrets import SECRETS
from soak.attacks.shown import TERMINAL

GOALS: dict[str, dict[str, Attack]] = {
    "points": POINTS,
    "others": OTHERS,
    "secrets": SECRETS,
    "the grader": GRADER,
    "whoever looks": TERMINAL,
}
ATTACKS: dict[str, Attack] = {
    f"{goal}: {name}": attack for goal, attacks in GOALS.items() for name, attack in attacks.items()
}
SAMPLE = {
    name: ATTACKS[name]
    for name in (
        "points: tests in the folder",
        "points: outputs that say 3.0",
        "points: line: verdict",
        "others: the time of the terminal's master",
        "others: half a character in a comment",
        "others: numbers to the end of the scale",
        "secrets: reads the bundle",
        "secrets: kernel: a lock on a file of the host",
        "secrets: in an exception's words",
        "secrets: after a restart, by the clock on the wall",
        "the grader: a daemon",
        "the grader: a comment of a million emoji",
        "whoever looks: escape",
    )
}
"""A few attacks for each goal, without those that take long."""
