"""Whose a file in a download is, by the name that Moodle or Canvas gave it.

Both put what they know of the person first and the student's own name of the file last, so a name
is read from its beginning, and nothing that a student calls a file changes whose it is.

Moodle writes ``NAME_PARTICIPANT_assignsubmission_file`` and then ``/FILE``, with the student's own
folders between, or ``_FILE``.  It makes spaces of the underscores in NAME, so the first number is
the participant's; a name with an underscore in front is a team's, or somebody else's work
(github.com/moodle/moodle, ``mod/assign/classes/downloader.php``).

Canvas writes ``NAME_[LATE_]USER_ATTACHMENT_FILE``.  NAME is in small letters, without spaces, and
may end in an underscore and a number; then the name can be read in two ways if the file's own name
begins with a number too (github.com/instructure/canvas-lms, ``lib/content_zipper.rb``).
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

from .clean import clean_line
from .lms import Known

_MOODLE = re.compile(
    r"(?P<name>[^_/]*)_(?P<number>0|[1-9][0-9]{0,18})_assignsubmission_"
    r"(?P<kind>[a-z]+)(?:_?/(?:[^/]+/)*|_)(?P<file>[^/]+)"
)
_CANVAS = re.compile(
    r"(?P<name>\w*?)_(?P<late>LATE_)?(?P<number>[0-9]+)_(?P<attachment>[0-9]+)_(?P<file>[^/]+)"
)
_NUMBER_FIRST = re.compile(r"([0-9]+)_([^/]+)")
_ID = re.compile(r"[1-9][0-9]{0,18}")


@dataclass(frozen=True)
class Named:
    """One way to read the name of a file in a download.

    Attributes:
        who: The person.
        file: What the student called the file.
        late: Whether Canvas counts it as late.
        kind: What Moodle calls the way of handing in; "file", or another, such as "onlinetext".
    """

    who: Known
    file: str
    late: bool = False
    kind: str = "file"


def readings(entry: str) -> tuple[Named, ...]:
    """The ways to read a name: none if it is nobody's, two if it could be either of two people's.

    Args:
        entry: The name of the file with its folders, as it stands in the download.
    """
    if match := _MOODLE.fullmatch(entry):
        who = Known("moodle", match["number"], person(match["name"]))
        return (Named(who, clean_line(match["file"]), kind=match["kind"]),)
    match = _CANVAS.fullmatch(entry)
    if match is None or "assignsubmission" in match["name"] or match["name"] == "anon":
        return ()
    name, number, attachment = match["name"], match["number"], match["attachment"]
    found = [(name, number, attachment, match["file"])]
    if not match["late"] and (more := _NUMBER_FIRST.fullmatch(match["file"])):
        found.append((f"{name}_{number}", attachment, more[1], more[2]))
    return tuple(
        Named(Known("canvas", user, person(called)), clean_line(file), bool(match["late"]))
        for called, user, number, file in found
        if _ID.fullmatch(user) and _ID.fullmatch(number)
    )


def person(name: str) -> str:
    """A person's name in one form, however it was typed."""
    return unicodedata.normalize("NFC", clean_line(name, 200))
