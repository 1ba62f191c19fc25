"""The gain of an attack without defence, in nbgrader's own engine or in one bare process.

Both run in a sandbox that protects the machine and the course of the tests, but leaves an attack all
rights, all files and the network.
"""

from __future__ import annotations

import json
import math
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import nbformat
from soak.attacks.attack import Attack, Notebook, code_cell
from soak.attacks.others import VICTIM
from soak.attacks.place import NAME, ROOT, Place, copied

from labkit.grader.sandbox.limits import slowness

BARE = Path(__file__).with_name("bare.py")
HIDDEN = "got 5.816534"
"""The bare grader's text for a right answer."""
HEAVY = 256_000
FULL = 2_000_000  # bytes


@dataclass
class Won:
    """The results of an attack.

    Attributes:
        score: The score in nbgrader's engine; None if the attack was not graded.
        victim: The score of the next student; None if that student was not graded.
        bare: The result of `bare.py`.
        changed: The files of the victim that were changed.
        notebook: The notebook as it was handed in.
    """

    notebook: Notebook
    score: float | None = None
    victim: float | None = None
    bare: Mapping[str, Any] = field(default_factory=dict)
    changed: tuple[str, ...] = ()


def _got(won: Won) -> bool:
    return "GOT" in won.bare["said"]


def _tells(won: Won) -> bool:
    said = won.bare["said"]
    return "GOT" in said or HIDDEN in said or len(started(said)) > 1


def _claims(won: Won) -> bool:
    """Whether a grader that trusts the content of the file gives points."""
    from nbgrader.utils import determine_grade

    cells = nbformat.reads(json.dumps(won.notebook), as_version=4).cells
    marked = [
        c for c in cells if c.cell_type == "code" and c.metadata.get("nbgrader", {}).get("grade")
    ]
    return sum(determine_grade(c)[0] or 0.0 for c in marked if c.outputs) > 0.0


def _unwritable(won: Won) -> bool:
    try:
        "".join(c["source"] for c in won.notebook["cells"] if isinstance(c["source"], str)).encode()
    except UnicodeEncodeError:
        return True
    return False


def _overflows(won: Won) -> bool:
    words = " ".join(str(c["source"]) for c in won.notebook["cells"])
    numbers = [float(x) for x in re.findall(r"-?[\d.]+e[+-]?\d+", words)]
    return not math.isfinite(max(numbers) - min(numbers))


COMMANDS = re.compile(
    r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]|^\[9/9\] everybody", re.M
)
"""Characters that a terminal obeys, and text that looks like a line of the grader."""

WINS: dict[str, Callable[[Won], bool]] = {
    "points": lambda won: bool(won.score),
    "labkit's points": lambda won: bool(won.score),
    "claims": _claims,
    "stops": lambda won: won.victim is None,
    "spoils": lambda won: bool(won.changed),
    "passes on": _got,
    "reads": _got,
    "tells": _tells,
    "forges": lambda won: won.bare["wire"] > 0,
    "leaves": lambda won: won.bare["left"] > 0,
    "dies": lambda won: won.bare["verdict"] is None and not won.bare["hung"],
    "hangs": lambda won: won.bare["hung"],
    "heavy": lambda won: (won.bare["verdict"] or (0, 0))[1] > HEAVY,
    "fills": lambda won: max(won.bare["bytes"], len(json.dumps(won.notebook))) > FULL,
    "commands": lambda won: bool(COMMANDS.search(won.bare["said"])),
    "unwritable": _unwritable,
    "overflows": _overflows,
}
"""For each goal of attacks, a function that says whether the attack reached it."""
ALONE = {"stops", "labkit's points"}


def started(text: str) -> set[str]:
    """The times in a text at which the cells ran."""
    return set(re.findall(r"started (\d+\.\d+)", text))


def undefended(attacks: Mapping[str, Attack], here: Place, scratch: Path) -> dict[str, Won]:
    """Run or grade the attacks without defence, and return the results of each."""
    filled = {name: here.filled(attack) for name, attack in attacks.items()}
    won = {name: Won(attack.planted(_short(here))) for name, attack in filled.items()}
    one = {n for n, a in attacks.items() if a.wins in ALONE or (a.wins == "points" and _books(a))}
    many = {n for n, a in attacks.items() if a.wins == "points"} - one
    others = attacks.keys() - one - many
    plain = plainly(copied(here, scratch / "plain"))
    for number, name in enumerate(sorted(one)):
        _alone(copied(plain, scratch / f"alone-{number}"), attacks[name], won[name])
    _points(plain, {n: attacks[n] for n in many}, won)
    _bare(here, {n: filled[n] for n in others}, won, scratch)
    for number, name in enumerate(sorted(n for n in others if attacks[n].wins == "spoils")):
        _spoils(copied(here, scratch / f"spoilt-{number}"), attacks[name], won[name], scratch)
    return won


def _books(attack: Attack) -> bool:
    return any("gradebook.db" in s and "update" in s for s in (*attack.cells, attack.answer))


def _short(here: Place) -> Notebook:
    """The assignment with only its graded cells, so that it runs quickly."""
    notebook = here.notebook()
    kept = [c for c in notebook["cells"] if c["metadata"]["lab"] in ("answer", "check")]
    return notebook | {"cells": kept}


TESTS = (
    "assert bang_bang(0.5, 2.0) == (0.125, 0.5, 1.0)",
    "import numpy as np\nnp.testing.assert_allclose(bang_bang(1.5, 2.0), (0.875, 0.5, -1.0))",
    "import numpy as np\noff = np.abs(np.subtract(bang_bang(0.5, 2.0), (0.125, 0.5, 1.0))).max()\n"
    "float(np.clip(1.0 - 1000.0 * off, 0.0, 1.0))",
    "s, ds, dds = bang_bang(1.0, 4.0)\nassert abs(s - 0.125) < 1e-9 and isinstance(s, float)",
    "worst = max(abs(a - b) for a, b in zip(bang_bang(1.5, 2.0), (0.875, 0.5, -1.0)))\nassert not worst > 1e-6",
    "import numpy as np\nassert np.allclose(bang_bang(3.0, 4.0), (0.875, 0.5, -0.25))",
    "### BEGIN HIDDEN TESTS\nassert bang_bang(0.25, 1.0) == (0.125, 1.0, 4.0)\n### END HIDDEN TESTS",
)  # fmt: skip
"""Typical tests, with a point each."""


def plainly(here: Place) -> Place:
    """A copy of the course with "plain", a notebook of one question with typical tests."""
    course = here.course
    with (course.root / "nbgrader_config.py").open("a") as file:
        file.write(
            f"c.pop('Autograde')\nc.Execute.timeout = {15 * slowness():.0f}\n"
        )  # nbgrader's own steps
    marks = {"schema_version": 3, "locked": False, "task": False, "grade": False, "solution": False}
    cells = [
        code_cell(
            "def bang_bang(t, duration):\n    ### BEGIN SOLUTION\n    return 0\n    ### END SOLUTION",
            "answer",
        )
    ]
    cells[0]["metadata"]["nbgrader"] = marks | {"grade_id": "bang_bang", "solution": True}
    for number, source in enumerate(TESTS):
        cell = code_cell(source, f"test-{number}")
        cell["metadata"]["nbgrader"] = marks | {"grade_id": cell["id"], "grade": True, "points": 1}
        cells.append(cell)
    notebook = {"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}
    (course.source / "plain").mkdir()
    (course.source / "plain" / "plain.ipynb").write_text(json.dumps(notebook))
    said = nbgrader(here, "generate_assignment", "plain", "--create")
    assert (course.release / "plain" / "plain.ipynb").exists(), said
    return here


def _points(here: Place, attacks: Mapping[str, Attack], won: dict[str, Won]) -> None:
    """Grade all attacks in one run of nbgrader."""
    blank = json.loads((here.course.release / "plain" / "plain.ipynb").read_text())
    students = {f"s{k:03d}": name for k, name in enumerate(attacks)}
    for student, name in students.items():
        planted = here.filled(attacks[name]).planted(json.loads(json.dumps(blank)))
        here.hand_in(student, planted, "plain")
    if students:
        nbgrader(here, "autograde", "plain", "--create")
    scores = marks(here, "plain")
    for student, name in students.items():
        won[name].score = scores.get(student)


def _alone(here: Place, attack: Attack, won: Won) -> None:
    """Grade an attack in a separate run, before an honest student."""
    name = NAME if attack.wins == "labkit's points" else "plain"
    blank = (
        _short(here)
        if name == NAME
        else json.loads((here.course.release / name / f"{name}.ipynb").read_text())
    )
    planted = here.filled(attack).planted(json.loads(json.dumps(blank)))
    if name == NAME:
        setup = code_cell("from labkit.course import check", "setup")
        planted["cells"].insert(len(attack.cells), setup)  # in the same place as in the notebook
    here.hand_in("eve", planted, name)
    here.hand_in(VICTIM, json.loads(json.dumps(blank)), name)
    nbgrader(here, "autograde", name, "--create")
    scores = marks(here, name)
    won.score, won.victim = scores.get("eve"), scores.get(VICTIM)


def _bare(here: Place, attacks: Mapping[str, Attack], won: dict[str, Won], scratch: Path) -> None:
    """Run each attack in a separate process that has the expected values."""
    jobs = [
        _job(here, name, attack, won[name].notebook)
        for name, attack in attacks.items()
        if attack.wins != "spoils"
    ]
    for name, found in run_bare(here, jobs, scratch).items():
        won[name].bare = found


def _job(here: Place, name: str, attack: Attack, notebook: Notebook) -> dict[str, Any]:
    own = [
        c for c in notebook["cells"] if str(c["id"]).startswith("own") and c["cell_type"] == "code"
    ]
    sources = [c["source"] for c in own]
    answer = [attack.planted(_short(here))] if attack.answer else []
    sources += [
        c["source"]
        for n in answer
        for c in n["cells"]
        if c["metadata"].get("nbgrader", {}).get("grade_id") == "bang_bang"
    ]
    return {
        "name": name,
        "cells": [s for s in sources if "\ud800" not in s and "\udfff" not in s],
        "then": attack.then.replace("GOT", r"G\x4fT"),
        "again": attack.wins == "tells",
        "folder": str(here.course.root / "autograded" / "mallory" / NAME),
        "seconds": slowness() * (2.5 if attack.wins == "hangs" else 20.0),
    }


def run_bare(here: Place, jobs: Iterable[Mapping[str, Any]], scratch: Path) -> dict[str, Any]:
    """Run jobs with `bare.py`."""
    scratch.mkdir(parents=True, exist_ok=True)
    asked, out = here.course.root / "jobs.json", here.course.root / "out.json"
    asked.write_text(json.dumps(list(jobs)))
    words = [sys.executable, "-P", str(BARE), str(asked), str(out)]
    done = subprocess.run(
        [*harmless(here, init=True), *words],
        env=environment(here),
        capture_output=True,
        timeout=1800 * slowness(),
    )
    assert out.exists(), done.stderr.decode()[-2000:]
    found = json.loads(out.read_text())
    out.unlink(), asked.unlink()
    return found


def _spoils(here: Place, attack: Attack, won: Won, scratch: Path) -> None:
    before = _state(here)
    run_bare(
        here,
        [
            _job(
                here,
                "it",
                here.filled(attack),
                won.notebook | {"cells": here.filled(attack).planted(_short(here))["cells"]},
            )
        ],
        scratch,
    )
    after = _state(here)
    won.changed = tuple(name for name in before if before[name] != after[name])


def _state(here: Place) -> dict[str, object]:
    """The victim's files, and the files on which all marks depend."""
    root = here.course.root
    files = (
        f"submitted/{VICTIM}/{NAME}/{NAME}.ipynb",
        f"feedback/{VICTIM}/{NAME}/{NAME}.html",
        f"autograded/{VICTIM}/{NAME}/{NAME}.ipynb",
        f"results/{NAME}/{VICTIM}.json",
        f"build/course/bundle/{NAME}.json",
        "nbgrader_config.py",
    )
    found: dict[str, object] = {}
    for name in files:
        with suppress(OSError):
            found[name] = (root / name).read_bytes()
        found.setdefault(name, None)
    return found | {"marks": marks(here, NAME)}


def marks(here: Place, assignment: str) -> dict[str, float]:
    """The scores in the gradebook of the students whom the engine graded.

    The settings of the course are not read, because an attack may have changed them.
    """
    from nbgrader.api import Gradebook

    root = here.course.root
    found: dict[str, float] = {}
    with suppress(Exception), Gradebook(f"sqlite:///{root}/gradebook.db") as book:
        for submission in book.assignment_submissions(assignment):
            student = submission.student.id
            file = root / "autograded" / student / assignment / f"{assignment}.ipynb"
            if file.exists():
                found[student] = submission.score
    return found


def nbgrader(here: Place, *words: str) -> str:
    """Run a command of nbgrader, which attacks may end or outlive; return its output."""
    program = Path(sys.executable).with_name("nbgrader")
    log = here.course.root / "log.txt"
    with log.open("wb") as out:
        subprocess.run(
            [*harmless(here), str(program), *words],
            cwd=here.course.root,
            env=environment(here),
            stdout=out,
            stderr=subprocess.STDOUT,
            check=False,
            timeout=900 * slowness(),
        )
    return log.read_text(errors="replace")


def environment(here: Place) -> dict[str, str]:
    home = here.course.root / "home"
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    secret = {"LABKIT_CANARY": "canary-5816534691"}
    return dict(os.environ, PYTHONPATH=str(ROOT), PATH=path, HOME=str(home)) | secret


def harmless(here: Place, *, init: bool = False) -> list[str]:
    """Arguments that protect the machine: all can be read, and only the course can be written."""
    root, loot = str(here.course.root), str(here.loot)
    words = ["bwrap", "--ro-bind", "/", "/", "--dev", "/dev", "--proc", "/proc"]
    words += ["--tmpfs", "/tmp", "--tmpfs", "/var/tmp"]
    for needed in (str(ROOT), sys.prefix):  # which may lie below /tmp
        words += ["--ro-bind", needed, needed]
    words += ["--bind", root, root, "--bind", loot, loot]
    words += ["--unshare-pid", "--unshare-ipc", "--unshare-uts", "--die-with-parent"]
    words += ["--cap-add", "ALL", "--new-session", *(["--as-pid-1"] if init else [])]
    if os.geteuid():
        words += ["--unshare-user", "--uid", "0", "--gid", "0"]
    return [*words, "--chdir", root]
