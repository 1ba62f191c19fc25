"""A course whose own files are damaged, a download that is none, a disk that is full."""

from __future__ import annotations

import os
import shutil
import subprocess
import time
from pathlib import Path

import pytest
from soak import laws
from soak.classes import NAME, copied, hand_in_honest, kinds, write_downloads
from soak.commands import Ended, typed
from soak.examined import EXPORTS, FEEDBACK, GRADE, LABKIT, REGRADE, REPORT, Step

pytestmark = [pytest.mark.soak, pytest.mark.xdist_group("fuzz: course")]

COLLECT = LABKIT[0]
STEPS = (GRADE, FEEDBACK, *EXPORTS, REPORT, REGRADE, COLLECT, Step("release"))
VICTIM = "kim"
"""Whose result is damaged."""


def words_of(step):
    words = step.words(NAME)
    return [*words[:2], NAME] if step.line == "release" else words


@pytest.fixture(scope="module")
def graded(released, place_of_copy, tmp_path_factory):
    """A course in which the honest are collected and graded."""
    root = copied(released.root, place_of_copy)
    (root / "aside").mkdir()
    hand_in_honest(root)
    write_downloads(root, ())
    for step in LABKIT[:4]:
        assert typed(root, *step.words(NAME)).code == 0
    return Path(shutil.move(root, tmp_path_factory.mktemp("graded") / "course"))


@pytest.fixture(scope="module")
def fresh(graded, place_of_copy):
    """Make a copy of it, where the one before was: the worker keeps its sandbox."""

    def make():
        shutil.rmtree(place_of_copy, ignore_errors=True)
        return copied(graded, place_of_copy)

    return make


@pytest.fixture(scope="module")
def clean(fresh):
    """What the honest have after each command."""
    found = {}
    for step in STEPS:
        course = fresh()
        found[step] = laws.seen(course, typed(course, *words_of(step)))
    return found


def handed_in(course):
    """All files below ``submitted/``."""
    files = (course / "submitted").rglob("*")
    return {str(x.relative_to(course)): x.read_bytes() for x in files if x.is_file()}


@pytest.mark.parametrize("kind", kinds("STATES"), ids=str)
def test_state(fresh, clean, kind):
    """Each command ends with a sentence or does its work; no mark is lost, none made up."""
    wrong = []
    for step in STEPS:
        if kind.name.startswith("result: ") and step.line == "release":
            continue  # which reads none
        course = fresh()
        kind.thing(course)
        time.sleep(0.1)  # what was written before is not the command's
        wrong += (f"{step.line}: {says}" for says in broken(course, step, kind, clean))
    assert not wrong, "\n".join(wrong)


def broken(course, step, kind, clean):
    """The laws that a command breaks in a damaged course."""
    mine = kind.name.startswith("result: ")  # one student's, so the others are done
    since, before = time.time(), laws.seen(course, Ended((), 0, b"", b""))
    ended = typed(course, *words_of(step))
    yield from laws.said(ended, (0, 1) if mine else (0, 1, 2))
    yield from (f"{path.name}: {says}" for path, says in laws.written(course, since - 0.05))
    if ended.code is None:
        return
    now = laws.seen(course, ended)
    kept = {
        key: value
        for key, value in clean[step].items()
        if _due(step, key, mine, ended.code) and (key in before or _makes(step, key))
    }
    yield from laws.changed(kept, now)
    yield from laws.made_up(clean[step], now)
    if step is GRADE and ended.code == 0:
        for table in EXPORTS:
            again = typed(course, *table.words(NAME))
            if again.code == 2:  # refused as a whole
                yield from laws.said(again, (2,))
            else:
                yield from laws.changed(clean[table], laws.seen(course, again))


def _makes(step, key):
    """Whether a step makes something anew; what a damage took away, no other step owes."""
    makers = {"html": (FEEDBACK,), "ipynb": (GRADE,), "result": (GRADE, REGRADE)}
    return step in makers.get(key.rpartition(" ")[2], (step,))


def _due(step, key, mine, code):
    """Whether something must be there after a command that ended like this."""
    if mine and key == f"{VICTIM}'s result" and step is not GRADE:
        return False  # a damaged one stays as it is until it is graded
    if code == 0:
        return True
    if key.endswith("result"):
        return not (mine and key.startswith(VICTIM))
    return mine and code == 1 and not key.startswith(VICTIM)


@pytest.mark.parametrize("kind", kinds("DOWNLOADS"), ids=str)
def test_download(fresh, kind):
    """A download that is damaged is refused in a sentence; nobody's earlier work changes."""
    course = fresh()
    before, since = handed_in(course), time.time()
    kind.thing(course / "downloads" / "moodle.zip")
    ended = typed(course, *COLLECT.words(NAME))
    wrong = [*laws.said(ended, (0, 1, 2))]
    wrong += (f"{path}: {says}" for path, says in laws.written(course, since - 0.05))
    now = handed_in(course)
    wrong += (f"{name} changed" for name, data in before.items() if now.get(name) != data)
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("kind", kinds("LISTS"), ids=str)
def test_list(fresh, clean, kind):
    """A list of students is taken or refused in a sentence; nobody's mark changes."""
    course = fresh()
    (course / "list.csv").write_bytes(kind.thing)
    wrong = [*laws.said(typed(course, "labkit", "roster", "list.csv"), (0, 2))]
    for step in EXPORTS:
        ended = typed(course, *step.words(NAME))
        wrong += laws.said(ended, (0, 1))
        wrong += laws.changed(clean[step], laws.seen(course, ended))
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("kind", kinds("RULES"), ids=str)
def test_rules(fresh, clean, kind):
    """Rules are followed or refused in a sentence by each command; nobody's mark changes."""
    wrong = []
    course = fresh()
    (course / "course.toml").write_bytes(kind.thing)
    for step in (EXPORTS[0], FEEDBACK, GRADE, COLLECT):
        ended = typed(course, *step.words(NAME))
        wrong += (f"{step.line}: {says}" for says in laws.said(ended, (0, 1, 2)))
        if ended.code != 2:
            wrong += laws.changed(clean[step], laws.seen(course, ended))
    assert not wrong, "\n".join(wrong)


def may_mount():
    """Whether this user may make a small disk, in a name space of its own."""
    words = ["unshare", "--mount", "mount", "-t", "tmpfs", "none", "/mnt"]
    return os.geteuid() == 0 and not subprocess.run(words, capture_output=True).returncode


@pytest.fixture
def small_disk(tmp_path):
    """A folder on a disk of 16 MB."""
    place = tmp_path / "disk"
    place.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16m", "none", place], check=True)
    yield place
    subprocess.run(["umount", "--lazy", place], check=True)


@pytest.mark.parametrize("room", (0, 4, 12, 40) if may_mount() else ())
def test_full_disk(graded, clean, small_disk, room):
    """Each command ends with a sentence where so many kB are left; with room all is made good."""
    course = copied(graded, small_disk / "course")
    wrong = []
    for step in (GRADE, FEEDBACK, REPORT, COLLECT, REGRADE):
        for result in (course / "results" / NAME).glob("[a-z]*.json") if step is GRADE else ():
            result.unlink()
        (course / "full").write_bytes(b"")
        left = os.statvfs(course)
        (course / "full").write_bytes(bytes(max(0, left.f_bavail * left.f_frsize - 1024 * room)))
        ended = typed(course, *step.words(NAME))
        wrong += (f"{step.line}: {says}" for says in laws.said(ended, (0, 1, 2)))
    (course / "full").unlink()
    for step in (GRADE, FEEDBACK, *EXPORTS):
        ended = typed(course, *step.words(NAME))
        wrong += (f"with room, {step.line}: {says}" for says in laws.said(ended, (0,)))
        wrong += laws.changed(clean[step], laws.seen(course, ended))
    wrong += (f"left behind: {path.name}" for path in course.rglob(".*.new"))
    assert not wrong, "\n".join(wrong)
