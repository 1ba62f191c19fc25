"""When hand-ins came into nbgrader's exchange: what a folder's name says, held against the disk.

A student's own process writes the name, so it can state any time.  A modification time that is
later than the name is believed.  The owner of a file may set that one back, but not the time of the
last change of its inode (``st_ctime``, POSIX.1-2017, section 4.9).  Where the exchange was copied,
that is the time of the copy, so it is believed only where a witness shows that there was no copy
since: a hand-in that says that it came later and was there earlier.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

SLACK = 300.0
"""nbgrader notes the time and then copies, and the clocks of two machines differ; in [s]."""


@dataclass(frozen=True)
class Times:
    """What is known of the time of one hand-in; all in [s] since 1970.

    Attributes:
        stated: What the folder's name says.
        written: The latest modification of the folder and its notebooks.
        changed: The latest change of their inodes.
    """

    stated: float
    written: float
    changed: float

    @classmethod
    def of(cls, folder: Path, stated: datetime) -> Times:
        """Those of a folder; nothing that is a link is followed."""
        inside = [] if folder.is_symlink() else folder.glob("*.ipynb")
        found = [path.lstat() for path in (folder, *inside)]
        # a modification after the last change was made up
        written = max(min(x.st_mtime, x.st_ctime) for x in found)
        return cls(stated.timestamp(), written, max(x.st_ctime for x in found))

    def contradicted(self, others: Iterable[Times]) -> datetime | None:
        """The later time at which it really came; None if nothing contradicts its name.

        Args:
            others: The hand-ins beside it.
        """
        if any(self._shown_by(other) for other in others):
            came = self.changed
        elif self.written > self.stated + SLACK:
            came = self.written
        else:
            return None
        return datetime.fromtimestamp(int(came), UTC)

    def _shown_by(self, other: Times) -> bool:
        """Whether another hand-in shows that this one came later than it states.

        The other states a later time, was on the disk before this one, and was not on the disk
        before the time that it states itself.
        """
        return (
            other.stated > self.stated + SLACK
            and self.changed > other.changed + SLACK
            and other.changed + SLACK >= other.stated
        )
