"""Submissions: nothing but a plain file is read, whatever lies in a student's folder."""

from __future__ import annotations

import os
import socket

import pytest
from handmade import ROOT

from labkit.course.authoring.layout import Course
from labkit.grader.submission import Submission

NAME = "01_curves"
THINGS = {
    "folder": lambda path: path.mkdir(),
    "fifo": os.mkfifo,
    "dangling link": lambda path: path.symlink_to("nowhere"),
    "link": lambda path: path.symlink_to(ROOT / "README.md"),
    "socket": lambda path: socket.socket(socket.AF_UNIX).bind(path.name),
}


@pytest.mark.parametrize("thing", THINGS)
def test_what_is_not_a_plain_file_is_refused_in_a_sentence(thing, tmp_path, monkeypatch):
    """Whatever is called like the notebook, nothing but a plain file is read, and it is said."""
    submission = Submission.of(Course(tmp_path), NAME, "eve")
    submission.folder.mkdir(parents=True)
    monkeypatch.chdir(submission.folder)
    THINGS[thing](submission.folder / f"{NAME}.ipynb")
    data, _, why = submission.read()
    assert not data and f"{NAME}.ipynb" in why
