"""The times of hand-ins in nbgrader's exchange: a folder's name, checked against the disk.

A student's own process writes the name, so it can state any time.  A modification time that is
later than the name is believed.  The owner of a file can set the modification time back, but not
the time of the last change of its inode (``st_ctime``, POSIX.1-2017, section 4.9).  If the exchange
was copied, the inode has the time of the copy.  That time is therefore believed only if another
hand-in, which states a later time but was on the disk earlier, shows that there was no copy since.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

SLACK = 300.0
"""The tolerance in [s], as nbgrader notes the time before it copies, and clocks differ."""


@dataclass(frozen=True)
class Times:
    """What is known about the time of one hand-in, in [s] since 1970.

    Attributes:
        stated: The time in the folder's name.
        written: The latest modification of the folder and its notebooks.
        changed: The latest change of their inodes.
    """

    stated: float
    written: float
    changed: float

    @classmethod
    def of(cls, folder: Path, stated: datetime) -> Times:
        """The times of a folder; links are not followed."""
        inside = [] if folder.is_symlink() else folder.glob("*.ipynb")
        found = [path.lstat() for path in (folder, *inside)]
        # a modification later than the last change is invented
        written = max(min(x.st_mtime, x.st_ctime) for x in found)
        return cls(stated.timestamp(), written, max(x.st_ctime for x in found))

    def contradicted(self, others: Iterable[Times]) -> datetime | None:
        """The later time at which the hand-in really came; None if nothing contradicts its name.

        Args:
            others: The times of the other hand-ins in the exchange.
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

        The other hand-in states a later time than this one, but was on the disk before it, and not
        before the time that it states itself.
        """
        return (
            other.stated > self.stated + SLACK
            and self.changed > other.changed + SLACK
            and other.changed + SLACK >= other.stated
        )
