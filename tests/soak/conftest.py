"""What the soak tests share: a course released once, and a worker that outlives a test."""

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
    """A course with the assignment released, to be copied, never written to."""
    return release_into(tmp_path_factory.mktemp("released") / "course")


@pytest.fixture(scope="module")
def place_of_copy(tmp_path_factory):
    """One place for a module's copies: a worker keeps its sandbox while its course is the same."""
    return tmp_path_factory.mktemp("copy") / "course"


@pytest.fixture
def course(released, place_of_copy):
    """A copy of the released course, to write to."""
    shutil.copytree(released.root, place_of_copy, symlinks=True)
    yield Course(place_of_copy)
    shutil.rmtree(place_of_copy)


@pytest.fixture(scope="session", autouse=True)
def _worker():
    yield
    worker().shutdown()


@pytest.fixture(scope="module")
def kept_worker():
    """What is graded in this process shares one worker, whose sandbox takes seconds to start."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(batch, "executor", lambda *_: nullcontext(worker()))
        yield
