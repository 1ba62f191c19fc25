"""What the tests share: hypothesis set to repeat itself, and states of the arm drawn from a seed."""

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

import labkit as lk

settings.register_profile(
    "labkit",
    max_examples=40,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("labkit")


@pytest.fixture(params=["left", "right"])
def side(request):
    """Each of Baxter's arms."""
    return request.param


@pytest.fixture
def random():
    """Random numbers, the same in every run."""
    return np.random.default_rng(2019)


@pytest.fixture
def states(random):
    """Call with a side and a count: joint angles inside their limits, and speeds."""

    def draw(side="left", count=20):
        r = lk.robot(side)
        q = random.uniform(r.lower, r.upper, (count, 7))
        return list(zip(q, random.uniform(-r.speed, r.speed, (count, 7)), strict=True))

    return draw


@pytest.fixture
def arm():
    """An ideal left arm at rest in its neutral pose."""
    with lk.Arm() as arm:
        yield arm
