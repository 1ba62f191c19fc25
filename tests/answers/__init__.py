"""Plausible wrong answers, to measure how many mistakes the checks name.

Their author wrote them from the notebooks' stubs and the model answers, and had read neither the
known mistakes nor the judges.  So they represent answers that nobody has foreseen: never add a
known mistake because it is here, or the measure is worth nothing.

There is a file for each notebook.  Each answer is a whole cell of a notebook with `np` and `lk`,
below a line `# %% question: what is wrong`.
"""

import re
from pathlib import Path
from typing import NamedTuple

HERE = Path(__file__).parent
_HEAD = re.compile(r"^# %% (\w+): (.+)\n", re.M)


class Answer(NamedTuple):
    """One answer cell: its notebook, question, description and code."""

    topic: str
    question: str
    says: str
    source: str


def read(topic: str) -> tuple[Answer, ...]:
    """The answers to one notebook, such as ``read("warmup")``."""
    cells = iter(_HEAD.split((HERE / f"{topic}.txt").read_text(encoding="utf-8"))[1:])
    found = zip(cells, cells, cells, strict=True)
    return tuple(Answer(topic, name, says, source.strip() + "\n") for name, says, source in found)


TOPICS = tuple(sorted(path.stem for path in HERE.glob("*.txt")))
