"""The Baxter Cup: entries run in the sandbox, on seeds of the term that no entry can read.

An entry is a notebook that calls `labkit.course.cup` with its controller.  The arm, the tour and
the seeds stay in this process; the sandbox is only asked for one command after another.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from datetime import date
from functools import partial
from pathlib import Path

import numpy as np

from ...control import Command, State
from ...course.authoring.layout import CUP, Course
from ...course.baxter_cup import CupRun, benchmarks, cup_run
from ...course.judges import Close
from ...course.own_arm import Arms
from ...course.question import Question
from ...course.serialize import read_record, record_data
from ...errors import LabkitError
from ...run import Controller
from ...trajectory import AnySample
from ..atomic import write
from ..clean import clean_line, few
from ..each import Failure, for_student
from ..grading.grade import parse
from ..grading.public_evidence import encode_to_fit, motion
from ..grading.worker import in_sandbox
from ..sandbox.launch import Sandbox
from ..sandbox.limits import Limits, slowness
from ..sandbox.mounts import NoIsolation
from ..sandbox.protocol import Disconnected
from ..sandbox.session import RemoteFunction, Session, Step
from ..seeds import seed_of
from ..submission import Submission, digest, students
from ..timestamp import read_stamp, read_time
from ..whys import rank

FOLDER = "cup"
"""The folder in ``results/`` with a file of entries for each student."""
SEEDS = 3
"""The number of runs of an entry, on the board and in the final."""
A_DAY = 3
"""The most entries of one handle that are run on the board in a day."""
LIMITS = Limits(question=60.0, wall=200.0)
"""A run asks a controller 3,000 times; it may take 60 s for all its answers."""
_LAW, _BY_POSE = (Question(name, 0.0, "", Close(), ()) for name in ("cup_law", "cup_by_pose"))
_ENTER = f"""
from dataclasses import replace
from labkit import BAXTER, Model
from labkit.course import cup
if not hasattr(cup, "make"):
    raise NameError("the notebook calls cup(...) nowhere")
{_LAW.name} = cup.make(Model("left", replace(BAXTER, name="cup")))
{_BY_POSE.name} = cup.workspace
"""


@dataclass(frozen=True)
class Entry:
    """The outcome of one notebook.

    Attributes:
        student: The student who handed it in.
        notebook: The hash of the file.
        day: The day on which it was run, as in 2026-11-22.
        final: Whether it was run on the seeds of the final.
        scores: The score on each seed, in [mm]; None if the arm did not reach the end.
        why: Why a run has no score; empty if all have one.
        motion: The first run in the viewer's format; empty in all but the last entry.
    """

    student: str
    notebook: str
    day: str
    final: bool
    scores: tuple[float | None, ...] = ()
    why: str = ""
    motion: str = ""

    @property
    def score(self) -> float:
        """The mean of all runs, in [mm]; infinite if one has no score."""
        known = [x for x in self.scores if x is not None]
        return float(np.mean(known)) if len(known) == SEEDS else np.inf

    @property
    def beaten(self) -> int:
        """The number of published benchmarks that it beats."""
        return sum(self.score < score for score in benchmarks().values())


def seeds(course: Course, final: bool) -> tuple[int, ...]:
    """The seeds of the board or of the final, by HMAC under the term's secret."""
    draw = partial(rank, seed_of(course), "final" if final else "board")
    return tuple(int.from_bytes(draw(f"{CUP}/{k}")[:4], "big") for k in range(SEEDS))


def play(course: Course, today: date, final: bool) -> Iterator[Entry | Failure]:
    """Run the last notebook of each handle, if it is new, at most `A_DAY` of a handle in a day.

    In the final, there is no such limit.

    Yields:
        Each entry that was run, or why it was not.

    Raises:
        NoIsolation: No sandbox can be made here.
    """
    limits = LIMITS.scaled(slowness())
    for handle, team in sorted(_entered(course).items()):
        student = team[-1]
        data, _, why = Submission.of(course, CUP, student).read()
        new = Entry(student, digest(data), str(today), final, why=why)
        if [x.notebook for x in _runs(course, [student], final)][-1:] == [new.notebook]:
            continue
        had = [x for x in _runs(course, team, final) if x.day == new.day]
        if not final and len(had) >= A_DAY:
            yield Failure(student, f"{handle} had {A_DAY} runs today; type the same tomorrow")
            continue
        run = partial(_run, new, data, limits, seeds(course, final))
        step = partial(in_sandbox, run, course, ("labkit", "numpy"))
        done = new if why else for_student(student, step, (NoIsolation,))
        if not isinstance(done, Failure):
            past = [replace(x, motion="") for x in of_student(course, student)]
            write(_path(course, student), json.dumps(record_data([*past, done]), indent=1))
        yield done


def of_student(course: Course, student: str) -> list[Entry]:
    """A student's entries, the last one at the end."""
    path = _path(course, student)
    try:
        return read_record(list[Entry], json.loads(path.read_text(encoding="utf-8")))
    except FileNotFoundError:
        return []
    except (LabkitError, ValueError) as error:
        raise LabkitError(
            f"{path} is damaged ({error}); restore it, or delete it, and its entries run again"
        ) from None


def latest(course: Course, final: bool) -> dict[str, Entry]:
    """The last entry of each present handle, on the board or in the final.

    The last entry of a team is the one whose notebook was handed in last.
    """
    runs = {handle: _runs(course, team, final) for handle, team in _entered(course).items()}
    return {handle: found[-1] for handle, found in runs.items() if found}


def _runs(course: Course, team: Sequence[str], final: bool) -> list[Entry]:
    """The entries of some students on the board or in the final."""
    return [x for student in team for x in of_student(course, student) if x.final is final]


def tied(course: Course) -> Iterator[str]:
    """A sentence for each team whose last notebooks have the same time, but differ."""

    def notebook(student: str) -> bytes:
        return Submission.of(course, CUP, student).read()[0]

    for handle, (*before, last) in sorted(_entered(course).items()):
        at = _handed_in(course, last)
        same = [x for x in before if _handed_in(course, x) == at]
        if others := [x for x in same if notebook(x) != notebook(last)]:
            yield (
                f"{handle}: the notebook of {last} counts, and {few(others)} handed in "
                f"another at the same time, as far as the download says; for the exact times type: "
                f"labkit students import WORKSHEET.csv --assignment {CUP}"
            )


def _entered(course: Course) -> dict[str, list[str]]:
    """The students who entered, by their present handle, in the order in which they handed in."""
    handles, found = Arms.of(course.root).handles, dict[str, list[str]]()
    for student in sorted(students(course, CUP), key=partial(_handed_in, course)):
        found.setdefault(handles.get(student, student), []).append(student)
    return found


def _handed_in(course: Course, student: str) -> float:
    """When a student's present notebook was handed in; without a file, before all others."""
    folder = Submission.of(course, CUP, student).folder
    if stated := read_time(read_stamp(folder)):
        return stated.timestamp()
    return max((path.stat().st_mtime for path in folder.glob("*.ipynb")), default=0.0)


def _run(new: Entry, data: bytes, limits: Limits, on: Sequence[int], sandbox: Sandbox) -> Entry:
    """The entry with its scores on some seeds."""
    cells = parse(data, sandbox, limits)
    if isinstance(cells, str):
        return replace(new, why=cells)
    steps = [Step(k, x["source"]) for k, x in enumerate(cells) if x["type"] == "code"]
    steps.append(Step(len(cells), _ENTER, (_LAW.name, _BY_POSE.name)))
    runs: list[CupRun] = []
    with closing(Session(sandbox, steps, limits)) as session:
        try:
            with suppress(Disconnected):
                session.start()
            by_pose = RemoteFunction(_BY_POSE, session)() is True
            session.close_question()
            for seed in on:
                runs.append(cup_run(lambda _: _controller(session), seed, by_pose))
                session.close_question()  # the next run begins with a fresh controller
            why = "" if np.isfinite([x.score for x in runs]).all() else "the arm ran away"
        except NoIsolation:
            raise
        except LabkitError as error:
            cell = next((x["error"] for x in session.failed()), "")
            why = clean_line(cell or str(error))
    scores = tuple(round(x.score, 2) if np.isfinite(x.score) else None for x in runs)
    shown = motion(runs[0].log, "The cup") if runs else None
    return replace(new, scores=scores, why=why, motion=encode_to_fit(shown) if shown else "")


def _controller(session: Session) -> Controller:
    """The entry's controller, which runs in the sandbox."""
    law = RemoteFunction(_LAW, session)

    def controller(state: State, target: AnySample) -> Command:
        command: Command = law(state, target)  # `run` refuses what is not one
        return command

    return controller


def _path(course: Course, student: str) -> Path:
    return course.results / FOLDER / f"{student}.json"
