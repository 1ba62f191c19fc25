"""A student for tests, who fills in some stubs, runs every cell and keeps the printed text."""

import json
import shutil
from collections.abc import Mapping
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib
import nbformat
import numpy as np

import labkit
from labkit.course import student as desk
from labkit.course.authoring.layout import Course
from labkit.course.authoring.release import inlined
from labkit.course.notebook import FILE

matplotlib.use("Agg")
COURSE = Course.here(Path(__file__))

STUB = ""
"""The stub as it was released."""
BROKEN = "def {name}(*args, **kwargs):\n    return 1 / 0\n"
FORGETS = "def {name}(*args, **kwargs):\n    pass\n"
"""Other unsolved forms of a part."""


@dataclass
class Sheet:
    """The results of running a notebook.

    Attributes:
        printed: The whole text on stdout.
        earned: The points of each question.
        used: The questions whose function the notebook uses in later cells.
    """

    printed: str = ""
    earned: dict[str, float] = field(default_factory=dict)
    used: tuple[str, ...] = ()

    def badges(self, name: str) -> bool:
        """Whether the notebook said that a stand-in replaces a part."""
        return f"[stand-in] {name}:" in self.printed


def questions(name):
    """The questions of an assignment, in order."""
    return tuple(problem.name for problem in COURSE.problems(name))


def fill(name, parts: Mapping[str, str]):
    """The released notebook with the given cells for its parts; "" keeps the stub."""
    notebook = nbformat.read(COURSE.release / name / f"{name}.ipynb", as_version=4)
    for cell in notebook.cells:
        grade_id = cell.metadata.get("nbgrader", {}).get("grade_id")
        if cell.metadata["lab"] == "answer" and parts.get(grade_id):
            cell.source = parts[grade_id].format(name=grade_id)
    return notebook


def solved(name):
    """The source of the answer for every part, and every value for the predictions."""
    sources = {p.name: inlined(p) for p in COURSE.problems(name)}
    sources |= {p.name: p.solved() for p in COURSE.predictions(name)}
    return {q: source.replace("{", "{{").replace("}", "}}") for q, source in sources.items()}


def run_here(name, parts, folder, monkeypatch, *, shortest=0.1):
    """Run a notebook's cells in this process with short simulations and unmarked closed loops.

    Runs with chosen gains are still marked, because their question has no other tests.

    Args:
        name: The assignment.
        parts: The cells, as for `fill`.
        folder: An empty folder.
        monkeypatch: The fixture of pytest.
        shortest: The longest duration of a simulation, in [s].
    """
    checks = json.loads((COURSE.release / name / FILE).read_text(encoding="utf-8"))
    for question in checks["questions"]:
        question["tests"]["items"] = [
            test
            for test in question["tests"]["items"]
            if all(case["$"] != "Loop" for case in test["cases"]["items"])
        ]
    (folder / FILE).write_text(json.dumps(checks), encoding="utf-8")
    monkeypatch.chdir(folder)
    desk._desks.clear()
    run = labkit.run

    def short_run(arm, target, controller, rate=200.0, duration=None):
        duration = getattr(target, "duration", None) if duration is None else duration
        most = np.inf if arm.plant.name == "own" else shortest  # an answer measures on that one
        return run(arm, target, controller, rate, min(duration, most))

    monkeypatch.setattr(labkit, "run", short_run)
    notebook, out, names = fill(name, parts), StringIO(), {"__name__": "__main__"}
    nbformat.write(notebook, folder / f"{name}.ipynb")  # its last cell reads it
    with redirect_stdout(out):
        for cell in notebook.cells:
            if cell.cell_type == "code":
                code = compile(cell.source, f"{name}, cell {cell.id}", "exec")
                exec(code, names)
    for value in names.values():
        if isinstance(value, labkit.Arm):
            value.close()
    matplotlib.pyplot.close("all")
    text = "\n".join(cell.source for cell in notebook.cells)
    return Sheet(
        out.getvalue(),
        {key: verdict.earned for key, (_, verdict) in desk.desk().checked.items()},
        tuple(q for q in questions(name) if f'use("{q}"' in text),
    )


def run_kernel(name, parts, folder):
    """Run a notebook in a real kernel; return the executed notebook and its memory [MB]."""
    from nbclient import NotebookClient
    from traitlets.config import Config

    shutil.copy(COURSE.release / name / FILE, folder)
    notebook = fill(name, parts)
    nbformat.write(notebook, folder / f"{name}.ipynb")  # its last cell reads it
    notebook.cells.append(
        nbformat.v4.new_code_cell(
            # getrusage would include the memory of this process, from which the kernel is forked.
            "print(next(x.split()[1] for x in open('/proc/self/status') if 'VmHWM' in x))"
        )
    )
    place = {"metadata": {"path": str(folder)}}
    with TemporaryDirectory() as sockets:
        # Sockets are files, because two kernels that start together may get the same free port.
        files = {"transport": "ipc", "ip": f"{sockets}/kernel"}
        NotebookClient(
            notebook,
            timeout=600,  # only so that no test hangs; `tests.bench` measures the time
            kernel_name="python3",
            resources=place,
            config=Config({"KernelManager": files}),
        ).execute()
    return notebook, float(notebook.cells.pop().outputs[0].text) / 1024
