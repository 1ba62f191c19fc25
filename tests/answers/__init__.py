"""Plausible answers, right and wrong, to measure how many mistakes the checks name correctly.

Their authors wrote them from the notebooks' stubs and the model answers, and had read neither the
known mistakes nor the judges.  So they represent answers that nobody has foreseen: never add a
known mistake because it is here, or the measure is worth nothing.  To improve the naming, look only
at the wrong answers that are not `held`; those in ``second`` and later sets, by other authors, are
all held.

There is a file for each notebook.  Each answer is a whole cell of a notebook with `np` and `lk`,
below a line `# %% question wrong: what is wrong` or `# %% question right: how it is written`.
"""

import re
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

HERE = Path(__file__).parent
AUTHORS = ("", "second", "third", "fourth")
"""The authors of the answers, by the names of their folders."""
_HEAD = re.compile(r"^# %% (\w+) (right|wrong): (.+)\n", re.M)


class Answer(NamedTuple):
    """One answer cell: its notebook, question, kind, description, code and author."""

    topic: str
    question: str
    right: bool
    says: str
    source: str
    author: str

    @property
    def held(self) -> bool:
        """Whether it is hidden from those who improve the naming; a hash of the source decides.

        With this number in front, the hash withholds about half of each question's wrong answers.
        """
        return bool(self.author) or sha256(f"1774{self.source}".encode()).digest()[0] % 2 == 1


def read(topic: str) -> tuple[Answer, ...]:
    """The answers to one notebook, such as ``read("warmup")``."""
    return tuple(answer for author in AUTHORS for answer in _read(topic, author))


def _read(topic: str, author: str) -> Iterator[Answer]:
    cells = iter(_HEAD.split((HERE / author / f"{topic}.txt").read_text(encoding="utf-8"))[1:])
    for question, verdict, says, source in zip(cells, cells, cells, cells, strict=True):
        yield Answer(topic, question, verdict == "right", says, source.strip() + "\n", author)


TOPICS = tuple(sorted(path.stem for path in HERE.glob("*.txt")))
