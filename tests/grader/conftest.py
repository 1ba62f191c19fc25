"""A released course in a temporary folder, and a sandbox, for the tests of the grader."""

from __future__ import annotations

import copy
import json
import shutil
from functools import cache

import nbgrader.api
import pytest
from courses import synthetic
from handmade import NAME

from labkit.course.authoring.bundle import Bundle
from labkit.course.authoring.layout import Course
from labkit.grader.release import release
from labkit.grader.sandbox.launch import Sandbox

SEED = 7


@pytest.fixture(scope="session", autouse=True)
def _version_of_the_tables():
    """One answer for all: for each new gradebook nbgrader starts a program to learn a constant."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(nbgrader.api, "get_alembic_version", cache(nbgrader.api.get_alembic_version))
        yield


@pytest.fixture(scope="session")
def released(tmp_path_factory):
    """The course of three questions, released, to which no test writes."""
    course = synthetic(tmp_path_factory.mktemp("course"))
    release(course, NAME, SEED)
    return course


@pytest.fixture
def course(released, tmp_path):
    """A copy of the released course to which a test may write."""
    root = tmp_path / "course"
    shutil.copytree(released.root, root, symlinks=True)
    return Course(root)


@pytest.fixture(scope="session")
def bundle(released):
    return Bundle.of(released, NAME)


@pytest.fixture(scope="session")
def sandbox():
    with Sandbox() as sandbox:
        yield sandbox


@pytest.fixture(scope="session")
def _blank(released):
    return json.loads((released.release / NAME / f"{NAME}.ipynb").read_text())


@pytest.fixture(scope="session")
def _solved(released):
    return json.loads((released.solution / NAME / f"{NAME}.ipynb").read_text())


@pytest.fixture
def blank(_blank):
    """The assignment as students receive it, as JSON data."""
    return copy.deepcopy(_blank)


@pytest.fixture
def solved(_solved):
    """The assignment with the right answers, as JSON data."""
    return copy.deepcopy(_solved)
