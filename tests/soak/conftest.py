"""Tools of all soak tests: a course released once."""

from __future__ import annotations

import pytest
from soak.attacks.place import release_into


@pytest.fixture(scope="session")
def released(tmp_path_factory):
    """A course with the assignment released, which tests copy and do not write to."""
    return release_into(tmp_path_factory.mktemp("released") / "course")
