"""Folders and zips of files that no platform named: whose each is, by a pattern of the lecturer's.

Such are the clones of GitHub Classroom, ``paths-ada/01_paths.ipynb``, or files from anywhere,
``01_paths_4711.ipynb``.  What stands for the student must be known to the roster: a login, an
address, a number, the name on GitHub, or the student's own name.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

from ..errors import LabkitError
from .clean import clean_line
from .platforms import File, LmsUser, Named, person
from .sandbox.limits import Limits
from .submission import read_file

Reader = Callable[[str], tuple[Named, ...]]
"""Reads whose a file is by its name, with folders."""
_PARTS = {"{student}": "(?P<student>[^/]+?)", "**": ".*", "*": "[^/]*"}


def reader(pattern: str) -> Reader:
    """A reader for names that are all made alike.

    Args:
        pattern: Such as ``paths-{student}/*.ipynb``; ``*`` stands for anything within one name,
            ``**`` for folders too.

    Raises:
        LabkitError: It does not say once where the student stands.
    """
    if pattern.count("{student}") != 1:
        raise LabkitError(
            f"{pattern!r} needs {{student}} once, such as in 'paths-{{student}}/*.ipynb'"
        )
    parts = re.split(r"(\{student\}|\*\*|\*)", pattern)
    whole = re.compile("".join(_PARTS.get(part, re.escape(part)) for part in parts))

    def read(name: str) -> tuple[Named, ...]:
        match = whole.fullmatch(name)
        if match is None:
            return ()
        who = person(match["student"])
        return (Named(LmsUser("files", who, who), clean_line(Path(name).name)),)

    return read


def in_folder(folder: Path, read: Reader) -> Iterator[File]:
    """The notebooks in a folder and all folders in it; links are not followed.

    Their times are when they were written here, by a download or a clone.
    """
    for top, folders, names in os.walk(folder):
        folders[:] = sorted(x for x in folders if not x.startswith("."))
        for name in sorted(x for x in names if x.endswith(".ipynb") and not x.startswith(".")):
            path = Path(top, name)
            label = str(path.relative_to(folder))
            when = datetime.fromtimestamp(int(path.lstat().st_mtime), UTC)
            load = partial(read_file, path, Limits().notebook)
            yield File(clean_line(label)[-120:], read(label), when, load)
