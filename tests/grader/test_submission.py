"""Submissions: nothing but a plain file is read, whatever lies in a student's folder."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest
from handmade import ROOT

from labkit.course.authoring.layout import Course
from labkit.errors import LabkitError
from labkit.grader.submission import Submission, none_of, read_file

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
def test_what_is_not_a_plain_file_is_refused_in_a_sentence(kind, course, monkeypatch):
    """Whatever is called like the notebook, nothing but a plain file is read, and it is said."""
    submission = Submission.of(course, NAME, "eve")
    submission.folder.mkdir(parents=True)
    put_there(kind, submission.folder / f"{NAME}.ipynb")
    if kind == "unreadable":  # to root, nothing is

        def refuse(*args):
            raise PermissionError

        monkeypatch.setattr(os, "open", refuse)
    data, _, why = submission.read()
    assert not data
    assert "is not a file" in why or "is a link or cannot be opened" in why


def test_a_device_is_not_opened():
    """Opening a device may do something, so that it is looked at first."""
    with pytest.raises(LabkitError, match="zero is not a file"):
        read_file(Path("/dev/zero"), 1)


def test_who_handed_in_nothing_is_answered_with_near_names(tmp_path):
    """Or with the command that collects, where nobody did."""
    course = Course(tmp_path)
    assert "type: labkit collect 01_curves" in none_of(course, "01_curves", "ada")
    for student in ("Ada-Lovelace", "Bob-Hope"):
        (course.submitted / student / "01_curves").mkdir(parents=True)
    said = "no submission of {!r} for 01_curves; {}"
    near = (("ada", "did you mean Ada-Lovelace?"), ("bobhope", "did you mean Bob-Hope?"))
    for name, end in (*near, ("zz", "there are Ada-Lovelace, Bob-Hope")):
        assert none_of(course, "01_curves", name) == said.format(name, end)
