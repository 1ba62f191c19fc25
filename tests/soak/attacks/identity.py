"""Attacks in which a student pretends to be somebody else.

Ada Lovelace is participant 42 (Canvas: user 42; exchange: `ada`), and her work has been collected
before.  Eve is participant 77 and hands in a file in each of these attacks.
"""

from __future__ import annotations

import os
import re
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

ADA, EVE = 42, 77
MOODLE = "_assignsubmission_file_"
_GREEDY = re.compile(r"^.*?(?P<who>[^/+]*_42_|Ada Lovelace|lovelaceada|ada\b|42).*$", re.S | re.I)


@dataclass(frozen=True)
class Impostor:
    """One method of pretending to be somebody else.

    Attributes:
        names: The names of the files in the second download, which all contain Eve's work.
        system: "moodle", "canvas" or "exchange".
        twin: Whether a second Ada Lovelace, participant 43, was in the first download.
        put: How a file gets into the exchange, if it is not simply written there.
        quiet: Whether the target is the terminal or the folder, and not another student.
    """

    names: tuple[str, ...]
    system: str = "moodle"
    twin: bool = False
    put: Callable[[Path, Path], None] | None = None
    quiet: bool = False

    def believed(self) -> bool:
        """Whether a reader that trusts the name, or writes to its path, would be deceived."""
        return any(
            _GREEDY.match(name) or ".." in name or not name.isprintable() or len(name) > 255
            for name in self.names
        )


def write_zip(path: Path, files: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return path


def _link_folder(folder: Path, course: Path) -> None:
    folder.rmdir()
    folder.symlink_to(course / "submitted" / "ada" / "01_paths")


def _link_file(folder: Path, course: Path) -> None:
    (folder / "01_paths.ipynb").symlink_to(
        course / "submitted" / "ada" / "01_paths" / "01_paths.ipynb"
    )


def _hard_link(folder: Path, course: Path) -> None:
    os.link(course / "build/course/solution/01_paths/01_paths.ipynb", folder / "01_paths.ipynb")


def _link_secret(folder: Path, course: Path) -> None:
    (folder / "01_paths.ipynb").write_bytes(b"{}")
    (folder / "submission_secret.txt").symlink_to(course / "gradebook.db")


IMPOSTORS: dict[str, Impostor] = {
    "a number in the file's name": Impostor((f"Eve Mallory_77{MOODLE}x_42{MOODLE}01_paths(9).ipynb",)),
    "a number at once": Impostor((f"Eve Mallory_77{MOODLE}_42{MOODLE}01_paths.ipynb",)),
    "a whole name in the file's name": Impostor((f"Eve Mallory_77{MOODLE}Ada Lovelace_42{MOODLE}01_paths.ipynb",)),
    "a number, twice": Impostor((f"Eve Mallory_77{MOODLE}x_42{MOODLE}y_42{MOODLE}01_paths.ipynb",)),
    "a name in a folder": Impostor((f"Eve Mallory_77{MOODLE}/Ada Lovelace_42{MOODLE}01_paths.ipynb",)),
    "a folder in a folder": Impostor((f"Eve Mallory_77{MOODLE}/Ada Lovelace_42{MOODLE}/01_paths.ipynb",)),
    "a folder of Windows": Impostor((f"Eve Mallory_77{MOODLE}..\\Ada Lovelace_42{MOODLE}01_paths.ipynb",)),
    "a way up": Impostor((f"Eve Mallory_77{MOODLE}/../../Ada-Lovelace/01_paths/01_paths.ipynb",)),
    "another's display name": Impostor((f"Ada Lovelace_77{MOODLE}01_paths.ipynb",)),
    "another's display name, in other white space": Impostor((f"Ada\u00a0 Lovelace_77{MOODLE}01_paths.ipynb",)),
    "another's display name, with a hyphen": Impostor((f"Ada-Lovelace_77{MOODLE}01_paths.ipynb",)),
    "another's display name, in other letters": Impostor((f"ada lovelace_77{MOODLE}01_paths.ipynb",)),
    "a display name with a number": Impostor((f"Ada Lovelace 42_77{MOODLE}01_paths.ipynb",), twin=True),
    "a display name with a number and a hyphen": Impostor((f"Ada Lovelace-42_77{MOODLE}01_paths.ipynb",), twin=True),
    "the folder's own name": Impostor((f"Ada-Lovelace-42_77{MOODLE}01_paths.ipynb",), twin=True),
    "a number in Canvas's file": Impostor(("malloryeve_77_901_lovelaceada_42_900_01_paths.ipynb",), "canvas"),
    "a late number in Canvas's file": Impostor(("malloryeve_LATE_77_901_42_900_01_paths.ipynb",), "canvas"),
    "another's name in Canvas": Impostor(("lovelaceada_77_901_01_paths.ipynb",), "canvas"),
    "another's folder in the exchange": Impostor(("ada+01_paths+2030-01-01 00:00:00 UTC+x",), "exchange"),
    "another's folder, without the last part": Impostor(("ada+01_paths+2030-01-01 00:00:00 UTC",), "exchange"),
    "another's folder, in other letters": Impostor(("Ada+01_paths+2030-01-01 00:00:00 UTC+x",), "exchange"),
    "another's folder, and a space": Impostor(("ada +01_paths+2030-01-01 00:00:00 UTC+x",), "exchange"),
    "a link to another's folder": Impostor(("ada+01_paths+2030-01-01 00:00:00 UTC+y",), "exchange", put=_link_folder),
    "a link to another's file": Impostor(("ada+01_paths+2030-01-01 00:00:00 UTC+z",), "exchange", put=_link_file),
    "a hard link to the solution": Impostor(("ada+01_paths+2030-01-01 00:00:00 UTC+h",), "exchange", put=_hard_link),
    "a secret that is the gradebook": Impostor(("ada+01_paths+2030-01-01 00:00:00 UTC+s",), "exchange", put=_link_secret),
    "commands for the terminal": Impostor((f"Bob\x1b]0;owned\x07_77{MOODLE}\x1b[2J.ipynb",), quiet=True),
    "a line of its own": Impostor((f"Eve_77{MOODLE}x.ipynb\nAda-Lovelace: 01_paths.ipynb: taken.ipynb",), quiet=True),
    "a name as long as a book": Impostor((f"{'E' * 300}_77{MOODLE}{'x' * 300}.ipynb",), quiet=True),
    "a name of nothing": Impostor((f"..._77{MOODLE}01_paths.ipynb",), quiet=True),
}  # fmt: skip
