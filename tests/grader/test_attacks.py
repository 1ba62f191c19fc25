"""One attack of each family, each hour; `tests/soak` has all of them."""

from __future__ import annotations

import copy
import json
import os

import pytest
from autograder import processes_of
from handmade import FULL, QUICK, raw
from soak.attacks import grader, others, points, secrets, shown
from soak.attacks.defended import spoken

from labkit.grader.grade import grade
from labkit.grader.sandbox.limits import Limits

FAST = Limits(cell=0.5, call=0.3, question=5.0, wall=30.0)
FAMILIES = {
    f"{module.__name__.rpartition('.')[2]}: {name.lower()}": next(iter(family.items()))
    for module in (points, others, secrets, grader, shown)
    for name, family in vars(module).items()
    if name.isupper() and isinstance(family, dict) and hasattr(next(iter(family.values())), "wins")
}


@pytest.mark.parametrize("family", FAMILIES)
def test_attacks_earn_nothing(family, _blank, solved, released, bundle, sandbox):
    """An attack earns what it deserves, says nothing, leaves nothing, and harms nobody after it."""
    _, attack = FAMILIES[family]
    words = {"root": released.root, "loot": "/tmp", "port": 1, "marker": "/usr/bin/env"}
    notebook = attack.filled(**words, exchange="/srv").planted(copy.deepcopy(_blank))
    result = grade(raw(notebook), "mallory", bundle, sandbox, FAST)
    assert result.score <= attack.earns and not result.rejected
    assert not list(spoken(json.loads(result.text()), 0, ""))
    assert os.geteuid() or not processes_of(sandbox.uid)
    assert grade(raw(solved), "honest", bundle, sandbox, QUICK).score == FULL
