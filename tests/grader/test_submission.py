"""Submissions: nothing but a plain file is read, whatever lies in a student's folder."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest
from handmade import ROOT

from labkit.course.authoring.layout import Course
from labkit.errors import LabkitError
from labkit.grader.submission import Submission, read_file

NAME = "01_curves"


def put_there(kind, path):
    """Something at a path that is not a plain file, or one that may not be read."""
    if kind == "folder":
        path.mkdir()
    elif kind == "fifo":
        os.mkfifo(path)
    elif kind == "dangling link":
        path.symlink_to("nowhere")
    elif kind == "link":
        path.symlink_to(ROOT / "README.md")
    elif kind == "socket":
        with socket.socket(socket.AF_UNIX) as end:
            end.bind(f"/proc/self/fd/{os.open(path.parent, os.O_PATH)}/{path.name}")
    else:
        path.write_text("{}")


@pytest.mark.parametrize(
    "kind", ["folder", "fifo", "dangling link", "link", "socket", "unreadable"]
)
def test_what_is_not_a_plain_file_is_refused_in_a_sentence(kind, tmp_path, monkeypatch):
    """Whatever is called like the notebook, nothing but a plain file is read, and it is said."""
    submission = Submission.of(Course(tmp_path), NAME, "eve")
    submission.folder.mkdir(parents=True)
    put_there(kind, submission.folder / f"{NAME}.ipynb")
    if kind == "unreadable":  # to root, nothing is

        def refuse(*args):
            raise PermissionError

        monkeypatch.setattr(os, "open", refuse)
    data, _, why = submission.read()
    assert not data and f"{NAME}.ipynb" in why


def test_a_device_is_not_opened(monkeypatch):
    """Opening a device may do something, so that it is looked at first."""
    monkeypatch.setattr(os, "open", lambda *args: pytest.fail("opened"))
    with pytest.raises(LabkitError):
        read_file(Path("/dev/zero"), 1)
