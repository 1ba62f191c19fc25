"""Attacks: no undeserved point, no secret, no process left, no submission harmed by another."""

from __future__ import annotations

import copy
import os
from pathlib import Path

import pytest
from attacks import CLASSES
from handmade import FULL, QUICK, raw

from labkit.course.messages import why
from labkit.grader.grade import grade
from labkit.grader.sandbox.limits import Limits

FAST = Limits(cell=0.5, call=0.3, question=5.0, wall=30.0)


def said(result):
    """All that the student's code could make the result say."""
    words = [why(t) for q in result.questions for t in q.verdict.tests]
    return "\n".join([*words, *(f"{c['error']} {c['output']}" for c in result.cells)])


def processes_of(uid):
    """Processes that belong to a user."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if folder.stat().st_uid == uid:
                found.append(folder.name)
        except OSError:
            continue
    return found


TOGETHER = ("files", "network", "kernel")
"""Classes whose attacks are cells that do not disturb each other: they are in one notebook."""


@pytest.mark.slow
@pytest.mark.parametrize("kind", CLASSES)
def test_attacks_earn_nothing(kind, _blank, solved, released, bundle, sandbox):
    """An attack earns 0 points, reads nothing, leaves nothing, and harms nobody after it."""
    wrong = []
    everything = [[*CLASSES[kind]]] if kind in TOGETHER else [[name] for name in CLASSES[kind]]
    for names in everything:
        notebook, name = copy.deepcopy(_blank), " ".join(names)
        for one in names:
            CLASSES[kind][one].planted(notebook, root=released.root)
        result = grade(raw(notebook), "mallory", bundle, sandbox, FAST)
        text = said(result)
        if result.score or result.rejected or "GOT" in text:
            wrong.append((name, result.score, result.rejected, text[text.find("GOT") :][:90]))
        if any(ord(c) < 32 for q in result.questions for t in q.verdict.tests for c in why(t)):
            wrong.append((name, "control characters"))
        if os.geteuid() == 0 and processes_of(sandbox.uid):
            wrong.append((name, "left processes"))
    assert not wrong
    assert grade(raw(solved), "honest", bundle, sandbox, QUICK).score == FULL
