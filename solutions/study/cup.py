"""The published benchmarks of the Baxter Cup: ``python -m solutions.study.cup`` prints them."""

from __future__ import annotations

from labkit import BAXTER, Model
from labkit.course.baxter_cup import BENCHMARKS, PUBLIC_SEEDS, cup_run
from labkit.run import Controller

from .campaign import FEED_FORWARD, feed_forward
from .gains import all_controllers


def law(name: str, model: Model) -> Controller:
    """One of the laws that set a benchmark."""
    return feed_forward if name == FEED_FORWARD else all_controllers(model, BAXTER)[name].controller


def score(name: str, seed: int) -> float:
    """The score of a law, in [mm]."""
    return round(cup_run(lambda model: law(name, model), seed).score, 2)


if __name__ == "__main__":
    for name in BENCHMARKS:
        print(f'    "{name}": {tuple(score(name, seed) for seed in PUBLIC_SEEDS)},', flush=True)
