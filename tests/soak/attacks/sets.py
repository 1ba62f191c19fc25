"""All attacks by their goals."""

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
