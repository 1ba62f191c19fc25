"""Attacks on the marks of other students."""

from __future__ import annotations

from soak.attacks.attack import RIGHT, WORTH, Attack, code_cell, function

VICTIM = "zoe"
"""An innocent student, who is the last one in the alphabet."""


def _twice(notebook):
    """The cell of an answer is there twice under the same name."""
    place = next(
        k
        for k, c in enumerate(notebook["cells"])
        if c["metadata"].get("nbgrader", {}).get("solution")
    )
    notebook["cells"].insert(place, notebook["cells"][place])
    return notebook


def _version(number):
    def shape(notebook):
        for cell in notebook["cells"]:
            if "nbgrader" in cell["metadata"]:
                cell["metadata"]["nbgrader"]["schema_version"] = number
        return notebook

    return shape


BATCH = {
    "a cell's name twice": Attack("stops", shape=_twice),
    "metadata from the future": Attack("stops", shape=_version(99)),
    "kills everybody": Attack("stops", ("import os\nos.kill(-1, 9)",)),
    "terminates everybody from the answer": Attack(
        "stops", answer=function("import os\nos.kill(-1, 15)\nos.kill(os.getppid(), 15)")
    ),
    "the gradebook locked": Attack(
        "stops",
        ("import os, sqlite3, time\nif not os.fork():\n    os.setsid()\n"
         "    book = sqlite3.connect('{root}/gradebook.db', timeout=9, isolation_level=None)\n"
         "    book.execute('begin exclusive')\n    time.sleep(25)\n    os._exit(0)\ntime.sleep(1)",),
    ),
}  # fmt: skip

_SQL = "update grade set manual_score = 0.0"
FILES = {
    name: Attack("spoils", (source,))
    for name, source in {
        "everybody's marks to nothing": "import sqlite3\nbook = sqlite3.connect('{root}/gradebook.db', timeout=3)\n"
        f"book.execute('{_SQL}')\nbook.commit()",
        "a classmate's work deleted": f"import shutil\nshutil.rmtree('{{root}}/submitted/{VICTIM}')",
        "a classmate's work changed": f"open('{{root}}/submitted/{VICTIM}/01_paths/01_paths.ipynb', 'w').write('x')",
        "a classmate's page changed": f"open('{{root}}/feedback/{VICTIM}/01_paths/01_paths.html', 'w').write('x')",
        "a classmate's result changed": f"open('{{root}}/results/01_paths/{VICTIM}.json', 'w').write('x')",
        "a classmate's marked copy changed": f"open('{{root}}/autograded/{VICTIM}/01_paths/01_paths.ipynb', 'w').write('x')",
        "settings for the next": "open('{root}/nbgrader_config.py', 'a').write('\\nimport os; os._exit(1)\\n')",
        "the bundle changed": "open('{root}/build/course/bundle/01_paths.json', 'a').write('x')",
        "a course moved away": "import os\nos.rename('{root}/submitted', '{root}/submitted-')",
        "found from where it works": f"import os, shutil\nfor up in range(9):\n"
        f"    shutil.rmtree('../' * up + 'submitted/{VICTIM}', ignore_errors=True)",
    }.items()
}  # fmt: skip


def left(plant: str, find: str) -> Attack:
    """An attack that leaves something behind for an accomplice, who is graded next."""
    return Attack("passes on", (plant,), RIGHT + function("return right(t, duration)"), WORTH, find)


_GOT = "raise Exception('GOT ' + str(found))"
_LIBC = "import ctypes\nlibc = ctypes.CDLL(None, use_errno=True)\n"
LEFT = {
    "a file in /tmp": left("open('/tmp/left', 'w').write('x')", f"found = open('/tmp/left').read()\n{_GOT}"),
    "a segment of shared memory": left(
        _LIBC + "assert libc.shmget(5816, 4096, 0o1666) >= 0",
        _LIBC + f"found = libc.shmget(5816, 4096, 0)\nif found >= 0: {_GOT}"),
    "a process that listens": left(
        "import os, socket, time\nif not os.fork():\n    os.setsid()\n"
        "    s = socket.socket(socket.AF_UNIX)\n    s.bind('\\0left')\n    s.listen()\n    time.sleep(60)",
        f"import socket\ns = socket.socket(socket.AF_UNIX)\ns.connect('\\0left')\nfound = 'it'\n{_GOT}"),
    "a lock that a daemon holds": left(
        "import fcntl, os, time\nif not os.fork():\n    os.setsid()\n    file = open('{marker}')\n"
        "    fcntl.flock(file, fcntl.LOCK_EX)\n    time.sleep(60)\ntime.sleep(0.3)",
        "import fcntl\nfile = open('{marker}')\ntry: fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)\n"
        f"except BlockingIOError as found: {_GOT}"),
    "labkit changed in memory": left(
        "import labkit\nlabkit.left = 'x'", f"import labkit\nfound = labkit.left\n{_GOT}"),
}  # fmt: skip


def _with(source: str):
    def shape(notebook):
        notebook["cells"].insert(0, code_cell(source, "own-0"))
        return notebook

    return shape


AFTER = {
    "half a character in a comment": Attack("unwritable", shape=_with("# \ud800")),
    "half a character in a name": Attack("unwritable", shape=_with("x = '\udfff'")),
    "numbers to the end of the scale": Attack(
        "overflows", answer=function("return -1e308, 1e308, -1e308")
    ),
    "the largest and the smallest": Attack(
        "overflows", answer=function("return 5e-324, -1.79e308, 1.79e308")
    ),
}
"""Attacks that break the writing of results for everybody."""

OTHERS = {**BATCH, **FILES, **LEFT, **AFTER}
