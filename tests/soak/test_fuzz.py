"""Hostile submissions, names and downloads in one class: every command, and nobody else is hurt.

Each test is one kind of `hostile`; all that are asked for share one class, so that -k tries any of
them alone.  A failure says which command broke which law.
"""

from __future__ import annotations

import pytest
from soak.attacks.place import release_into
from soak.classes import kinds
from soak.examined import BRIEFLY, LABKIT, NBGRADER, OTHERS, Examined
from soak.hostile import SAMPLE

pytestmark = pytest.mark.slow  # whole classes are graded

HANDED_IN = ("TEXTS", "MAGICS", "SOURCES", "NUMBERS", "OBJECTS", "LOADS", "RAISES", "REPLIES",
             "PEOPLE", "FILE_NAMES", "FILES", "NOTEBOOKS")  # fmt: skip
EXTREMES = ("largest", "largest of both signs", "smallest", "infinite", "nan, once", "huge int",
            "None", "nested", "large")  # fmt: skip
"""Numbers that go through every assignment, for each question has judges and drawings."""


def cases(*tables, sample=SAMPLE):
    """Each kind of some tables; those that are not in the gate's sample are marked."""
    return [
        pytest.param(kind, id=str(kind), marks=[] if str(kind) in sample else pytest.mark.soak)
        for kind in kinds(*tables)
    ]


def chosen(request, test):
    """The parameters with which this run of pytest is to do a test."""
    return [x.callspec.params for x in request.session.items if x.originalname == test.__name__]


@pytest.fixture(scope="module")
def labkit(request, released, tmp_path_factory):
    """What the kinds asked for break on their way through labkit's commands."""
    asked = [x["kind"] for x in chosen(request, test_labkit)]
    steps = BRIEFLY if SAMPLE.issuperset(map(str, asked)) else LABKIT
    return Examined(released.root, tmp_path_factory.mktemp("labkit"), steps).of(asked)


@pytest.fixture(scope="module")
def nbgrader(request, released, tmp_path_factory):
    """What they break on their way through nbgrader's own."""
    asked = [x["kind"] for x in chosen(request, test_nbgrader)]
    return Examined(released.root, tmp_path_factory.mktemp("nbgrader"), NBGRADER).of(asked)


@pytest.mark.xdist_group("fuzz: labkit")
@pytest.mark.parametrize("kind", cases(*HANDED_IN, "ENTRIES"))
def test_labkit(labkit, kind):
    """Collect, grade, feedback, tables, report and regrade: all others stay as without it."""
    assert kind not in labkit, "\n".join(labkit[kind])


@pytest.mark.xdist_group("fuzz: labkit")
def test_nothing_is_broken_by_nobody(labkit):
    """What breaks a law in a class is found by halving the class."""
    assert None not in labkit, "\n".join(labkit[None])


@pytest.mark.soak
@pytest.mark.xdist_group("fuzz: nbgrader")
@pytest.mark.parametrize("kind", kinds(*HANDED_IN), ids=str)
def test_nbgrader(nbgrader, kind):
    """`nbgrader autograde` and `generate_feedback`: all others stay as without it."""
    assert kind not in nbgrader, "\n".join(nbgrader[kind])


@pytest.fixture(scope="module")
def everywhere(request, tmp_path_factory):
    """What the kinds asked for break in one of the other assignments."""
    name = request.param
    asked = [x["kind"] for x in chosen(request, test_numbers) if x["everywhere"] == name]
    folder = tmp_path_factory.mktemp(name)
    return Examined(release_into(folder / "released", name).root, folder, OTHERS, name).of(asked)


NUMBERS = [kind for kind in kinds("NUMBERS") if kind.name in EXTREMES]
OTHER_NAMES = ("00_warmup", "02_model", "03_velocity_control", "04_torque_control",
               "05_impedance", "06_tags", "07_comparison")  # fmt: skip


@pytest.mark.soak
@pytest.mark.xdist_group("fuzz: numbers")
@pytest.mark.parametrize(
    ("everywhere", "kind"),
    [(name, kind) for name in OTHER_NAMES for kind in NUMBERS]
    + [("07_comparison", kind) for kind in kinds("COEFFICIENTS")],
    indirect=["everywhere"],
    ids=str,
)
def test_numbers(everywhere, kind):
    """Every question of every assignment judges and draws what is far off."""
    assert kind not in everywhere, "\n".join(everywhere[kind])
