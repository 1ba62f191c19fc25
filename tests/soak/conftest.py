"""Tools of all soak tests: a course released once, and a worker that outlives a test."""

from __future__ import annotations

import shutil
from contextlib import nullcontext

import pytest
from soak.attacks.place import release_into
from soak.commands import worker

from labkit.course.authoring.layout import Course
from labkit.grader.grading import batch


@pytest.fixture(scope="session")
def released(tmp_path_factory):
    """A course with the assignment released, which tests copy and do not write to."""
    return release_into(tmp_path_factory.mktemp("released") / "course")


@pytest.fixture(scope="module")
def place_of_copy(tmp_path_factory):
    """A fixed place for a module's copies, so that a worker keeps its sandbox for the course."""
    return tmp_path_factory.mktemp("copy") / "course"


@pytest.fixture
def course(released, place_of_copy):
    """A copy of the released course to which a test may write."""
    shutil.copytree(released.root, place_of_copy, symlinks=True)
    yield Course(place_of_copy)
    shutil.rmtree(place_of_copy)


@pytest.fixture(scope="session", autouse=True)
def _worker():
    yield
    worker().shutdown()


@pytest.fixture(scope="module")
def kept_worker():
    """Let all grading in this process share one worker, whose sandbox takes seconds to start."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(batch, "executor", lambda *_: nullcontext(worker()))
        yield
