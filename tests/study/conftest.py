"""The makers' studies, whose workers are processes of their own."""

import pytest
from courses import ROOT


@pytest.fixture(autouse=True)
def _this_repository(monkeypatch):
    """Its ``solutions`` come before those of a course that a test of the grader has made."""
    monkeypatch.syspath_prepend(ROOT)
