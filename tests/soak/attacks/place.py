"""A course whose secrets all contain a canary, and the values that attacks receive about it."""

from __future__ import annotations

import json
import os
import shutil
import socket
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from fcntl import LOCK_EX, LOCK_NB, flock
from pathlib import Path
from tempfile import mkdtemp

import numpy
from soak.attacks.attack import CANARY, Attack, Notebook
from soak.attacks.others import VICTIM

from labkit.course.authoring.layout import Course
from labkit.course.notebook import grade_id, kind, nbgrader_info
from labkit.grader.release import release

NAME = "01_paths"
ROOT = Path(__file__).parents[3]
SEED = 7
MARKER = numpy.__file__
"""A file of the host that is visible in every sandbox."""


@dataclass(frozen=True)
class Place:
    """A course and its surroundings.

    Attributes:
        course: The course.
        loot: A folder to which everybody may write.
        words: The values for the words in braces of an attack.
    """

    course: Course
    loot: Path
    words: dict[str, object]

    def filled(self, attack: Attack) -> Attack:
        """The attack with the values of this place."""
        return attack.filled(**self.words)

    def notebook(self, *, solved: bool = False) -> Notebook:
        """The assignment as students receive it, or solved."""
        return solved_code(self.course) if solved else handed_out(self.course)

    def hand_in(self, student: str, notebook: Notebook, assignment: str = NAME) -> None:
        """Put a notebook where the grader looks for it."""
        folder = self.course.submitted / student / assignment
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{assignment}.ipynb").write_text(json.dumps(notebook))


def handed_out(course: Course, assignment: str = NAME) -> Notebook:
    """An assignment as students receive it."""
    return _read(course.release, assignment)


def solved_code(course: Course, assignment: str = NAME) -> Notebook:
    """An assignment with right code but no text, because a text would wait for a person's mark."""
    right = {grade_id(c): c["source"] for c in _read(course.solution, assignment)["cells"]}
    notebook = handed_out(course, assignment)
    for cell in notebook["cells"]:
        if kind(cell) == "answer":
            cell["source"] = right[grade_id(cell)]
    return notebook


def full_marks(course: Course) -> tuple[float, float]:
    """The points for right code, and the points including the text that a person marks."""
    cells = handed_out(course)["cells"]
    code, text = (
        sum(nbgrader_info(c)["points"] for c in cells if kind(c) == which)
        for which in ("check", "why")
    )
    return float(code), float(code + text)


def _read(folder: Path, assignment: str) -> Notebook:
    return json.loads((folder / assignment / f"{assignment}.ipynb").read_text("utf-8"))


def release_into(root: Path, assignment: str = NAME, seed: int = SEED) -> Course:
    """A course with an assignment released."""
    root.mkdir(parents=True, exist_ok=True)
    if not (root / "solutions").exists():
        (root / "solutions").symlink_to(ROOT / "solutions")
        shutil.copy(ROOT / "nbgrader_config.py", root)
    course = Course(root)
    release(course, assignment, seed)
    return course


@contextmanager
def place(root: Path, of: Course) -> Iterator[Place]:
    """A copy of a course, with canaries, a server, a locked file and an exchange."""
    shutil.copytree(of.root, root, symlinks=True)
    course, loot = Course(root), root.with_name("loot")
    loot.mkdir(mode=0o777)
    loot.chmod(0o777)
    _plant(course)
    shared = Path("/usr/local/share")
    where = shared if os.access(shared, os.W_OK) else root
    exchange = Path(mkdtemp(prefix="labkit-test-exchange-", dir=where))
    with ExitStack() as ends:
        ends.callback(shutil.rmtree, exchange)
        exchange.chmod(0o755)
        _write(exchange / "inbound" / VICTIM / f"{NAME}.ipynb", CANARY)
        port = ends.enter_context(_servers(loot))
        marker = ends.enter_context(open(MARKER))
        with suppress(BlockingIOError):  # a parallel test holds the lock, which has the same effect
            flock(marker, LOCK_EX | LOCK_NB)
        words = {"root": root, "loot": loot, "port": port, "exchange": exchange}
        yield Place(course, loot, words | {"marker": MARKER})


def _plant(course: Course) -> None:
    """Put a canary into everything that students may not read."""
    root = course.root
    solutions = root / "solutions"
    target = solutions.resolve()
    solutions.unlink()
    shutil.copytree(target, solutions, ignore=shutil.ignore_patterns("__pycache__"))
    with (solutions / "paths" / "answers.py").open("a") as file:
        file.write(f"\n# {CANARY}\n")
    for folder in (course.source, course.solution):
        path = folder / NAME / f"{NAME}.ipynb"
        data = json.loads(path.read_text())
        path.write_text(json.dumps(data | {"metadata": data["metadata"] | {"canary": CANARY}}))
    path = course.bundle / f"{NAME}.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"canary": CANARY}))
    _name_in_the_gradebook(course)
    _write(
        root / "course_private" / "term.json", json.dumps({"secret": 32 * "7", "canary": CANARY})
    )
    _write(root / "home" / ".ssh" / "id_ed25519", CANARY)
    _write(root / "home/.local/share/jupyter/runtime/kernel-1.json", CANARY)
    solved = solved_code(course)
    solved["cells"][0]["source"] = [*solved["cells"][0]["source"], f"\n\n{CANARY}"]
    folder = course.submitted / VICTIM / NAME
    _write(folder / f"{NAME}.ipynb", json.dumps(solved))
    _write(folder / "submission_secret.txt", CANARY)
    _write(root / "feedback" / VICTIM / NAME / f"{NAME}.html", CANARY)
    _write(root / "autograded" / VICTIM / NAME / f"{NAME}.ipynb", CANARY)
    _write(root / "autograded" / "mallory" / NAME / f"{NAME}.ipynb", json.dumps(solved))
    _write(root / "course_private" / "lms.json", json.dumps({CANARY: {}}))
    _write(root / "results" / NAME / f"{VICTIM}.json", json.dumps(CANARY))


def _name_in_the_gradebook(course: Course) -> None:
    from labkit.grader.gradebook import open_gradebook

    with open_gradebook(course) as book:
        book.update_or_create_student(VICTIM, first_name=CANARY)
        for notebook in book.update_or_create_submission(NAME, VICTIM).notebooks:
            for grade in notebook.grades:
                grade.auto_score = grade.max_score
        book.db.commit()


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


@contextmanager
def _servers(loot: Path) -> Iterator[int]:
    """Start servers outside the sandbox: on a port, on an abstract name and on a file."""

    def serve(end: socket.socket) -> None:
        with suppress(OSError):
            while True:
                caller, _ = end.accept()
                with caller:
                    caller.sendall(b"GOT")

    def stop(end: socket.socket) -> None:
        with suppress(OSError):
            end.shutdown(socket.SHUT_RDWR)

    with ExitStack() as ends:
        tcp = ends.enter_context(socket.create_server(("127.0.0.1", 0)))
        port = tcp.getsockname()[1]
        found = [tcp]
        here = os.getcwd()
        os.chdir(loot)  # the path of a socket must be short
        try:
            for name in (f"\0labkit-test-{port}", "socket"):
                end = ends.enter_context(socket.socket(socket.AF_UNIX))
                end.bind(name)
                end.listen()
                found.append(end)
        finally:
            os.chdir(here)
        (loot / "socket").chmod(0o777)
        for end in found:
            threading.Thread(target=serve, args=(end,), daemon=True).start()
            ends.callback(stop, end)
        yield port
