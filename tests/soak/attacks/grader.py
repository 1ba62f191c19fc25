"""Attacks on the grader itself: its memory, disk, time and processes."""

from __future__ import annotations

from soak.attacks.attack import Attack, answers, cells, code_cell, function

MEMORY = cells(
    "reads",
    much_memory="x = bytearray(1_600 * 2**20)\nraise Exception('GOT memory')",
    a_large_file="open('full', 'wb').write(b'x' * 100 * 2**20)\nraise Exception('GOT 100 MB')",
    many_files="import os\nos.makedirs('many')\nfor k in range(6_000): open(f'many/{k}', 'w')\nraise Exception('GOT files')",
    files_in_memory="import os\nkept = []\nfor _ in range(60):\n    f = os.memfd_create('x')\n    kept.append(f)\n"
    "    os.posix_fallocate(f, 0, 60 * 2**20)\nraise Exception('GOT 3.6 GB')",
    a_device="import os, stat\nos.mknod('d', stat.S_IFBLK | 0o666, os.makedev(8, 0))\nraise Exception('GOT')",
    two_hundred_processes="import os, time\nfor _ in range(200):\n    if not os.fork():\n        time.sleep(20)\n        os._exit(0)\n"
    "raise Exception('GOT 200')",
    a_file_outside="open('{loot}/x', 'w').write('x')\nraise Exception('GOT write')",
)  # fmt: skip

PROCESSES = cells(
    "leaves",
    a_daemon_that_is_deaf="import os, signal, time\nif not os.fork():\n    os.setsid()\n"
    "    for s in range(1, 32):\n        if s not in (9, 19, 32): signal.signal(s, signal.SIG_IGN)\n    time.sleep(600)",
    a_process_that_stands_still="import os, signal\nif not os.fork():\n    os.setsid()\n    os.kill(os.getpid(), signal.SIGSTOP)",
    a_chain_of_processes="import os, time\nfor _ in range(20):\n    if os.fork(): break\n    os.setsid()\nelse:\n    time.sleep(600)\n"
    "if os.getppid() == 1 or os.getsid(0) == os.getpid(): time.sleep(600)",
    another_program="import subprocess\nsubprocess.Popen(['/usr/bin/sleep', '600'], start_new_session=True)",
    pipes_full_in_twenty_processes="import os, time\nfor _ in range(20):\n    if not os.fork():\n"
    "        for _ in range(50):\n            end = os.pipe()[1]\n            os.set_blocking(end, False)\n"
    "            try:\n                while True: os.write(end, b'x' * 65536)\n            except OSError: pass\n        time.sleep(600)",
)  # fmt: skip
PROCESSES["a daemon of the answer"] = Attack(
    "leaves",
    answer=function(
        "import os, time\nif not os.fork():\n    os.setsid()\n    time.sleep(600)\nreturn 0.0, 0.0, 0.0"
    ),
)

ENDS = cells(
    "dies",
    hard_exit="import os\nos._exit(0)",
    segmentation_fault="import ctypes\nctypes.string_at(0)",
    another_program_in_its_place="import os\nos.execv('/usr/bin/true', ['true'])",
    lines_closed="import os\nos.closerange(0, 1024)\nos._exit(0)",
) | answers(
    "dies",
    the_answer_exits="import os\nos._exit(0)",
    alarms_for_process_1="import os, signal\nfor s in (signal.SIGALRM, signal.SIGPROF): os.kill(1, s)\n"
    "os.kill(os.getppid(), signal.SIGALRM)\nos.kill(os.getpid(), signal.SIGALRM)",
    an_exception_that_cannot_be_said="class E(BaseException):\n    def __str__(self):\n        import os\n        os._exit(1)\nraise E",
)  # fmt: skip

ENDLESS = cells(
    "hangs",
    sleep="import time\ntime.sleep(1000)",
    deaf="import signal\nfor s in (signal.SIGALRM, signal.SIGPROF, signal.SIGXCPU, signal.SIGINT): signal.signal(s, signal.SIG_IGN)\n"
    "while True: pass",
    in_c="sum(range(10**13))",
    regular_expression="import re\nre.match('(a+)+b', 'a' * 60)",
    timers_off="import signal\nsignal.setitimer(signal.ITIMER_PROF, 0)\nsignal.setitimer(signal.ITIMER_REAL, 0)\nwhile True: pass",
    stands_still="import os, signal\nos.kill(os.getpid(), signal.SIGSTOP)",
) | answers(
    "hangs",
    the_answer_never_ends="while True: pass",
    an_answer_without_end="import itertools\nreturn itertools.count()",
    an_object_without_end="class All:\n    def __iter__(self):\n        while True: yield 0.0\nreturn All()",
    forks_that_answer_late="import os, time\nif os.fork(): time.sleep(1000)\nwhile True: pass",
)  # fmt: skip

REPLIES = answers(
    "heavy",
    empty_lists="return [[]] * 2_700_000",
    not_numbers="return [float('nan')] * 200_000",
    tables="return [{'a': {}}] * 500_000",
    wide_text="return '\\U0001f600' * 1_000_000",
    an_array_of_much_space="import numpy as np\nreturn np.zeros((500, 3000))",
    a_deep_list="x = []\nfor _ in range(900): x = [x] * 2 if _ < 18 else [x]\nreturn x",
    a_long_number="return [10**4000] * 500",
    coefficients="import labkit.course.judges as j\nreturn j.Ratio((1.0,) * 500_000, (1.0,) * 500_000)",
    a_long_exception="raise ValueError('x' * 10**7)",
)  # fmt: skip
REPLIES["coefficients"] = Attack(
    "heavy",
    answer=function(
        "class T: pass\nT.__module__, T.num = 'control.x', [[[1.0] * 500_000]]\nT.den = T.num\nreturn T()"
    ),
)


def _printing(notebook):
    """900 cells that print much and fail, with a raised limit of their process."""
    lift = (
        "import gc\nfor x in gc.get_objects():\n"
        "    if hasattr(type(x), '__name__') and type(x).__name__ in ('Notebook', 'Session', 'Runner'):\n"
        "        for name in list(getattr(x, '__dict__', {})):\n"
        "            if 'output' in name: setattr(x, name, 10**9 if 'most' in name else 0)"
    )
    loud = "print('\\U0001f600' * 20_000)\nraise Exception('x')"
    for k in range(900):
        notebook["cells"].append(code_cell(f"{lift if k == 0 else ''}\n{loud}", f"own-{k}"))
    return notebook


def _emoji(notebook):
    """One cell that answers all questions and has a comment of a million emoji.

    Zero is wrong everywhere, but one prediction is a number, and any number earns its point.
    """
    names = [
        c["metadata"]["nbgrader"]["grade_id"]
        for c in notebook["cells"]
        if c["metadata"].get("nbgrader", {}).get("solution")
    ]
    source = "\n".join(f"def {name}(*args): return 0.0" for name in names)
    notebook["cells"].append(code_cell(source + "\n# " + "\U0001f600" * 900_000, "own-0"))
    return notebook


def _failing(notebook):
    """Cells that take long and all fail because of an unknown name."""
    source = "x = sum(range(10**6))\nnobody_knows"
    notebook["cells"] += [code_cell(f"{source}  # {k}", f"own-{k}") for k in range(900)]
    return notebook


def _chained(notebook):
    """900 cells that depend on one another, with 345 names each."""
    for k in range(900):
        names = "=".join(f"{chr(97 + n % 26)}{n // 26}_{k}" for n in range(345))
        source = f"{names}=0\nlink{k}=1\ndef f{k}(): return link{k + 1}"
        notebook["cells"].append(code_cell(source, f"own-{k}"))
    notebook["cells"].append(code_cell("def bang_bang(t, T):\n    return link0", "own-x"))
    return notebook


def _statements(notebook):
    notebook["cells"].append(
        code_cell("x=1\n" * 480_000 + "def bang_bang(t, T): return 0, 0, 0", "own-0")
    )
    return notebook


def _names(notebook):
    """A cell with a name that is as long as a book."""
    for cell in notebook["cells"]:
        cell["id"] = "\U0001f600" * 20_000
        cell["metadata"].setdefault("nbgrader", {})["grade_id"] = "\U0001f600" * 20_000
    return notebook


FILES = {
    "900 cells that print": Attack("fills", shape=_printing),
    "a comment of a million emoji": Attack("fills", shape=_emoji, earns=1.0),
    "900 cells that fail": Attack("hangs", shape=_failing),
    "900 cells that lean on one another": Attack("fills", shape=_chained),
    "a line that is long to read": Attack("hangs", ("%lsmagic\n" + "x." * 30_000 + "a ?",)),
    "480,000 statements": Attack("fills", shape=_statements),
    "names as long as books": Attack("fills", shape=_names),
    "prints without end": Attack("fills", ("while True: print('x' * 10_000)",)),
    "writes past Python's streams": Attack(
        "fills",
        (
            "import os\nfor _ in range(3000): os.write(1, b'x' * 10_000); os.write(2, b'x' * 10_000)",
        ),
    ),
}

GRADER = {**MEMORY, **PROCESSES, **ENDS, **ENDLESS, **REPLIES, **FILES}
